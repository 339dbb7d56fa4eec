//! Hash grids over segments and points: which edges and nodes come near a segment.

use rustc_hash::FxHashMap;

use crate::geometry::point::Point;

/// Edges by the square cells that they pass, nodes by the cell that they lie in. A segment occupies
/// every cell that it touches (and now and then one beside it), so a query misses nothing. Queries
/// and updates cost O(cells passed + what is there).
pub(super) struct Index {
    edges: Cells<Held>,
    /// Of a graph that is being changed: looking at one takes none.
    nodes: Option<Cells<(u32, Point)>>,
}

/// What lies in each cell of a grid.
struct Cells<T> {
    side: f64,
    /// Cells by blocks: most queries stay inside one, and hash once.
    blocks: FxHashMap<(i32, i32), Block<T>>,
}

/// Cells a side of a block, as a power of two.
const BLOCK: u32 = 2;

/// The cells of a block, row by row.
type Block<T> = [Vec<T>; 1 << (2 * BLOCK)];

/// Cells of nodes are smaller: a node lies in one, however small it is, an edge in many.
const NODE_CELL: f64 = 0.5;

impl<T> Cells<T> {
    fn new(side: f64) -> Cells<T> {
        let blocks = FxHashMap::default();
        Cells { side, blocks }
    }

    /// The cell that `p` lies in.
    fn cell(&self, p: Point) -> (i32, i32) {
        let per_side = 1.0 / self.side;
        [p.x, p.y].map(|v| floor(f64::from(v) * per_side)).into()
    }

    fn at(&mut self, cell: (i32, i32)) -> &mut Vec<T> {
        &mut self.blocks.entry(block(cell)).or_default()[within(cell)]
    }

    /// True if something that is held in a cell within `margin` of the segment is what is looked
    /// for.
    #[inline]
    fn any(&self, a: Point, b: Point, margin: f64, mut is: impl FnMut(&T) -> bool) -> bool {
        let mut last: (Option<(i32, i32)>, Option<&Block<T>>) = (None, None);
        passed(self.side, a, b, margin, |cell| {
            if last.0 != Some(block(cell)) {
                last = (Some(block(cell)), self.blocks.get(&block(cell)));
            }
            last.1
                .is_some_and(|block| block[within(cell)].iter().any(&mut is))
        })
    }
}

/// An edge, its ends and where they are, so that a query need not look them up.
#[derive(Clone, Copy)]
pub(super) struct Held {
    pub(super) edge: u32,
    pub(super) ends: [u32; 2],
    /// The first is not right of the second.
    at: [Point; 2],
}

impl Held {
    pub(super) fn new(edge: u32, [a, b]: [u32; 2], [p, q]: [Point; 2]) -> Held {
        let (ends, at) = match p.x <= q.x {
            true => ([a, b], [p, q]),
            false => ([b, a], [q, p]),
        };
        Held { edge, ends, at }
    }

    /// Where its ends are.
    #[inline]
    pub(super) fn at(&self) -> [Point; 2] {
        self.at
    }
}

impl Index {
    /// An empty index for edges of about `side` grid units.
    pub(super) fn new(side: f64) -> Index {
        Index {
            edges: Cells::new(side),
            nodes: None,
        }
    }

    pub(super) fn insert(&mut self, held: Held) {
        passed(self.edges.side, held.at[0], held.at[1], 0.0, |cell| {
            self.edges.at(cell).push(held);
            false
        });
    }

    pub(super) fn remove(&mut self, edge: u32, a: Point, b: Point) {
        passed(self.edges.side, a, b, 0.0, |cell| {
            let held = self.edges.at(cell);
            let at = held.iter().position(|it| it.edge == edge);
            held.swap_remove(at.expect("an edge occupies all its cells"));
            false
        });
    }

    /// An edge that was between these points and is now as `held` says.
    pub(super) fn replace(&mut self, [p, q]: [Point; 2], held: Held) {
        let side = self.edges.side;
        let (was, is) = (box_of(side, p, q), box_of(side, held.at[0], held.at[1]));
        if was != is || !was.is_row() {
            self.remove(held.edge, p, q);
            self.insert(held);
            return;
        }
        // most stay in the cells where they were
        was.any(|cell| {
            let mut there = self.edges.at(cell).iter_mut();
            let it = there.find(|it| it.edge == held.edge);
            *it.expect("an edge occupies all its cells") = held;
            false
        });
    }

    /// Takes up all nodes, and from now on each one that is inserted.
    pub(super) fn take_nodes(&mut self, at: &[Point]) {
        self.nodes = Some(Cells::new(NODE_CELL * self.edges.side));
        (0..)
            .zip(at)
            .for_each(|(node, &p)| self.insert_node(node, p));
    }

    pub(super) fn insert_node(&mut self, node: u32, p: Point) {
        if let Some(nodes) = &mut self.nodes {
            nodes.at(nodes.cell(p)).push((node, p));
        }
    }

    pub(super) fn remove_node(&mut self, node: u32, p: Point) {
        if let Some(nodes) = &mut self.nodes {
            let held = nodes.at(nodes.cell(p));
            let at = held.iter().position(|it| it.0 == node);
            held.swap_remove(at.expect("a node is in its cell"));
        }
    }

    /// True if one of the edges whose bounding box comes within `margin` of that of the segment
    /// `a b`, and that share a cell with what is within `margin` of it, is what is looked for. In
    /// no order that means anything, and some are asked twice.
    pub(super) fn any(
        &self,
        a: Point,
        b: Point,
        margin: f64,
        is: impl FnMut(&Held) -> bool,
    ) -> bool {
        let reach = margin.ceil() as i32 + 1;
        let low = Point::new(a.x.min(b.x) - reach, a.y.min(b.y) - reach);
        let high = Point::new(a.x.max(b.x) + reach, a.y.max(b.y) + reach);
        self.any_in([low, high], a, b, margin, is)
    }

    /// True if one of the edges whose bounding box meets that of the triangle is what is looked
    /// for. `height`: of the third corner above the first side.
    pub(super) fn any_at(
        &self,
        [a, b, c]: [Point; 3],
        height: f64,
        is: impl FnMut(&Held) -> bool,
    ) -> bool {
        let low = Point::new(a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y));
        let high = Point::new(a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y));
        self.any_in([low, high], a, b, height, is)
    }

    #[inline]
    fn any_in(
        &self,
        [low, high]: [Point; 2],
        a: Point,
        b: Point,
        margin: f64,
        mut is: impl FnMut(&Held) -> bool,
    ) -> bool {
        self.edges.any(a, b, margin + 1.0, |it| {
            let [p, q] = it.at;
            // one branch for all four: it is taken by few
            let is_aside =
                (q.x < low.x) | (p.x > high.x) | (p.y.max(q.y) < low.y) | (p.y.min(q.y) > high.y);
            !is_aside && is(it)
        })
    }

    /// The edges within `reach` of a point, and now and then one that is a cell farther; sorted,
    /// each once.
    pub(super) fn edges_near(&self, p: Point, reach: f64, found: &mut Vec<u32>) {
        found.clear();
        self.any(p, p, reach, |held| {
            if is_within(p, held.at, reach) {
                found.push(held.edge);
            }
            false
        });
        found.sort_unstable();
        found.dedup();
    }

    /// The nodes within `reach` of the segment `a b`, its ends included, and now and then one that
    /// is a cell farther; sorted, each once. Nodes without edges too, if they were taken up.
    pub(super) fn nodes_near(&self, a: Point, b: Point, reach: f64, found: &mut Vec<u32>) {
        found.clear();
        let nodes = self.nodes.as_ref().expect("nodes were taken up");
        nodes.any(a, b, reach + 1.0, |&(node, p)| {
            if is_within(p, [a, b], reach) {
                found.push(node);
            }
            false
        });
        found.sort_unstable();
    }
}

/// True if `p` is within `reach`, and a cell for rounding, of the segment `a b`.
#[inline]
fn is_within(p: Point, [a, b]: [Point; 2], reach: f64) -> bool {
    let [p, a, b] = [p, a, b].map(|it| [f64::from(it.x), f64::from(it.y)]);
    let limit = reach + 1.0;
    // most are beside the bounding box
    let is_beside = |k: usize| (a[k].min(b[k]) - limit <= p[k]) & (p[k] <= a[k].max(b[k]) + limit);
    if !(is_beside(0) & is_beside(1)) {
        return false;
    }
    let from = |o: [f64; 2]| [p[0] - o[0], p[1] - o[1]];
    let dot = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], from(a));
    let (along, length2, limit2) = (dot(u, v), dot(u, u), limit * limit);
    if along <= 0.0 {
        dot(v, v) <= limit2
    } else if along >= length2 {
        dot(from(b), from(b)) <= limit2
    } else {
        // twice the area over the length is the distance: without a root or a division
        let area = u[0] * v[1] - u[1] * v[0];
        area * area <= limit2 * length2
    }
}

fn block((column, row): (i32, i32)) -> (i32, i32) {
    (column >> BLOCK, row >> BLOCK)
}

fn within((column, row): (i32, i32)) -> usize {
    let low = (1 << BLOCK) - 1;
    (((row & low) << BLOCK) | (column & low)) as usize
}

/// The next integer below; without a call, which `f64::floor` is on machines of no certain age.
fn floor(v: f64) -> i32 {
    let cut = v as i32;
    cut - i32::from(f64::from(cut) > v)
}

/// A rectangle of cells.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Range {
    first: i32,
    last: i32,
    bottom: i32,
    top: i32,
}

impl Range {
    fn of(side: f64, low: [f64; 2], high: [f64; 2]) -> Range {
        let per_side = 1.0 / side;
        let cell = |v: f64| floor(v * per_side);
        Range {
            first: cell(low[0]),
            last: cell(high[0]),
            bottom: cell(low[1]),
            top: cell(high[1]),
        }
    }

    /// True if a segment from side to side passes all of it.
    fn is_row(&self) -> bool {
        self.first == self.last || self.bottom == self.top
    }

    /// Calls `visit` for every cell, until it says true.
    fn any(&self, mut visit: impl FnMut((i32, i32)) -> bool) -> bool {
        let mut columns = self.first..=self.last;
        columns.any(|column| (self.bottom..=self.top).any(|row| visit((column, row))))
    }
}

/// The cells of the bounding box of a segment.
fn box_of(side: f64, p: Point, q: Point) -> Range {
    let low = [p.x.min(q.x), p.y.min(q.y)].map(f64::from);
    let high = [p.x.max(q.x), p.y.max(q.y)].map(f64::from);
    Range::of(side, low, high)
}

/// Calls `visit` for every cell within `margin` of the segment, until it says true: column by
/// column, the rows that the segment passes inside the column widened by the margin.
fn passed(
    side: f64,
    p: Point,
    q: Point,
    margin: f64,
    mut visit: impl FnMut((i32, i32)) -> bool,
) -> bool {
    let (a, b) = (p.min(q), p.max(q));
    let (ax, ay) = (f64::from(a.x), f64::from(a.y));
    let (bx, by) = (f64::from(b.x), f64::from(b.y));
    let (low, high) = (ay.min(by), ay.max(by));
    let range = Range::of(
        side,
        [ax - margin, low - margin],
        [bx + margin, high + margin],
    );
    if range.is_row() {
        // most segments are shorter than a cell
        return range.any(visit);
    }
    let per_side = 1.0 / side;
    let cell = |v: f64| floor(v * per_side);
    let Range { first, last, .. } = range;
    let slope = if bx > ax { (by - ay) / (bx - ax) } else { 0.0 };
    (first..=last).any(|column| {
        let from = (f64::from(column) * side - margin).clamp(ax, bx);
        let to = (f64::from(column + 1) * side + margin).clamp(ax, bx);
        let (y0, y1) = if bx > ax {
            (ay + slope * (from - ax), ay + slope * (to - ax))
        } else {
            (ay, by)
        };
        let bottom = (y0.min(y1) - 1.0).clamp(low, high) - margin;
        let top = (y0.max(y1) + 1.0).clamp(low, high) + margin;
        (cell(bottom)..=cell(top)).any(|row| visit((column, row)))
    })
}
