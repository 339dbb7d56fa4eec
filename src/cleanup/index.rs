//! Grids over segments and points: which edges and nodes come near a segment.

use crate::cleanup::cells::Cells;
use crate::cleanup::cells::Grid;
use crate::geometry::point::Point;
use crate::geometry::window::Window;
use smallvec::SmallVec;

/// Edges by the square cells that they pass, nodes by the cell that they lie in. A segment occupies
/// every cell that it touches (and now and then one beside it), so a query misses nothing. Queries
/// and updates cost O(cells passed + what is there).
pub(super) struct Index {
    edges: Cells<SmallVec<[Held; HELD]>>,
    /// Of a graph that is being changed: looking at one takes none.
    nodes: Option<Chains>,
}

/// Owns no edge.
pub(super) const NO_NODE: u32 = u32::MAX;

/// Most cells for each node: where lines are few and far between, cells are wider.
const CELLS_A_NODE: usize = 64;

/// Fewer nodes than this are in most blocks of cells that hold any.
const NODES_A_BLOCK: usize = 2;

/// Side of a cell, in lengths of an edge: with smaller ones a query looks into more cells than it
/// saves edges. (Measured in instructions from .7 to 1.4.)
const CELL: f64 = 1.4;

/// Edges that lie in the cell itself, and need no second look elsewhere: most cells hold no more.
const HELD: usize = 4;

/// Cells of nodes are smaller: a node lies in one, however small it is, an edge in many.
const NODE_CELL: f64 = 0.7;

/// Nodes by cell: the nodes of one are a chain, as each node is in one cell only.
struct Chains {
    /// Where the chain of a cell begins: the node's id and one, or zero.
    heads: Cells<u32>,
    /// By node: where it is, and the next one, as in `heads`.
    links: Vec<(Point, u32)>,
}

impl Chains {
    fn insert(&mut self, node: u32, p: Point) {
        let head = self.heads.at(self.heads.grid.cell(p));
        if self.links.len() <= node as usize {
            self.links.resize(node as usize + 1, (p, 0));
        }
        self.links[node as usize] = (p, *head);
        *head = node + 1;
    }

    fn shift(&mut self, node: u32, from: Point, to: Point) {
        let grid = &self.heads.grid;
        if grid.cell(from) == grid.cell(to) {
            self.links[node as usize].0 = to;
            return;
        }
        self.remove(node, from);
        self.insert(node, to);
    }

    fn remove(&mut self, node: u32, p: Point) {
        let head = self.heads.at(self.heads.grid.cell(p));
        let next = self.links[node as usize].1;
        if *head == node + 1 {
            *head = next;
            return;
        }
        let mut before = *head as usize - 1;
        while self.links[before].1 != node + 1 {
            before = self.links[before].1 as usize - 1;
        }
        self.links[before].1 = next;
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
    /// An empty index for edges of about `side` grid units between so many nodes, most of them in
    /// the window.
    pub(super) fn new(side: f64, window: Window, nodes: usize) -> Index {
        let grid = Grid::over(window, CELL * side, CELLS_A_NODE * (nodes + 64));
        Index {
            edges: Cells::new(grid, nodes / NODES_A_BLOCK),
            nodes: None,
        }
    }

    pub(super) fn insert(&mut self, held: Held) {
        let [a, b] = held.at;
        let grid = self.edges.grid;
        grid.passed(a, b, 0.0, |cell| {
            self.edges.at(cell).push(held);
            false
        });
    }

    pub(super) fn remove(&mut self, edge: u32, a: Point, b: Point) {
        let grid = self.edges.grid;
        grid.passed(a, b, 0.0, |cell| {
            let held = self.edges.at(cell);
            let at = held.iter().position(|it| it.edge == edge);
            held.swap_remove(at.expect("an edge occupies all its cells"));
            false
        });
    }

    /// An edge that was between these points and is now as `held` says.
    pub(super) fn replace(&mut self, [p, q]: [Point; 2], held: Held) {
        let grid = self.edges.grid;
        let (was, is) = (grid.box_of(p, q), grid.box_of(held.at[0], held.at[1]));
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

    /// Takes up these nodes, and from now on each one that is inserted.
    pub(super) fn take_nodes(&mut self, nodes: impl ExactSizeIterator<Item = (u32, Point)>) {
        let len = nodes.len();
        let mut chains = Chains {
            heads: Cells::new(self.edges.grid.finer(NODE_CELL), len / NODES_A_BLOCK),
            links: Vec::with_capacity(len),
        };
        nodes.for_each(|(node, p)| chains.insert(node, p));
        self.nodes = Some(chains);
    }

    pub(super) fn insert_node(&mut self, node: u32, p: Point) {
        if let Some(nodes) = &mut self.nodes {
            nodes.insert(node, p);
        }
    }

    pub(super) fn move_node(&mut self, node: u32, from: Point, to: Point) {
        if let Some(nodes) = &mut self.nodes {
            nodes.shift(node, from, to);
        }
    }

    pub(super) fn remove_node(&mut self, node: u32, p: Point) {
        if let Some(nodes) = &mut self.nodes {
            nodes.remove(node, p);
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
        self.any_in(bounding_box([a, b, c]), a, b, height, is)
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
        self.edges.grid.passed(a, b, margin + 1.0, |cell| {
            self.edges.get(cell).iter().any(|it| {
                let [p, q] = it.at;
                // one branch for all four: it is taken by few
                let is_aside = (q.x < low.x)
                    | (p.x > high.x)
                    | (p.y.max(q.y) < low.y)
                    | (p.y.min(q.y) > high.y);
                !is_aside && is(it)
            })
        })
    }

    /// The edges within `reach` of a node at `p` but its own, and now and then one that is a cell
    /// farther; sorted, each once.
    pub(super) fn edges_near(&self, node: u32, p: Point, reach: f64, found: &mut Vec<u32>) {
        found.clear();
        self.each_edge_near(node, p, reach, |held| found.push(held.edge));
        found.sort_unstable();
        found.dedup();
    }

    /// The same in no order that means anything, and some are told twice.
    #[inline]
    pub(super) fn each_edge_near(
        &self,
        node: u32,
        p: Point,
        reach: f64,
        mut tell: impl FnMut(&Held),
    ) {
        self.any(p, p, reach, |held| {
            // most that come so near are its own
            let is_own = (held.ends[0] == node) | (held.ends[1] == node);
            if !is_own && is_within(p, held.at, reach) {
                tell(held);
            }
            false
        });
    }

    /// The nodes within `reach` of the segment `a b`, its ends included, and now and then one that
    /// is a cell farther; each once, in no order that means anything.
    #[inline]
    pub(super) fn each_node_near(&self, a: Point, b: Point, reach: f64, mut tell: impl FnMut(u32)) {
        self.any_node(a, b, reach, |node, p| {
            if is_within(p, [a, b], reach) {
                tell(node);
            }
            false
        });
    }

    /// True if a node in the bounding box of the triangle is what is looked for: told where it is.
    /// `height`: of the third corner above the first side.
    #[inline]
    pub(super) fn any_node_at(
        &self,
        [a, b, c]: [Point; 3],
        height: f64,
        mut is: impl FnMut(Point) -> bool,
    ) -> bool {
        let [low, high] = bounding_box([a, b, c]);
        self.any_node(a, b, height, |_, p| {
            let is_in = (low.x <= p.x) & (p.x <= high.x) & (low.y <= p.y) & (p.y <= high.y);
            is_in && is(p)
        })
    }

    /// True if a node in the cells that are within `margin` of the segment `a b` is what is looked for.
    #[inline]
    fn any_node(
        &self,
        a: Point,
        b: Point,
        margin: f64,
        mut is: impl FnMut(u32, Point) -> bool,
    ) -> bool {
        let nodes = self.nodes.as_ref().expect("nodes were taken up");
        nodes.heads.grid.passed(a, b, margin + 1.0, |cell| {
            let mut next = *nodes.heads.get(cell);
            while next > 0 {
                let (p, after) = nodes.links[next as usize - 1];
                if is(next - 1, p) {
                    return true;
                }
                next = after;
            }
            false
        })
    }
}

/// Its lower and its upper corner.
fn bounding_box([a, b, c]: [Point; 3]) -> [Point; 2] {
    [
        Point::new(a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y)),
        Point::new(a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y)),
    ]
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
