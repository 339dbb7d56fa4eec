//! One more row of quads in a sheet, from the outer walk straight inward to where it turns, and out again.
//!
//! The edge from which a row starts was taken out of the walk, so both its ends are still one node. The sheet is
//! opened along a way of its edges, each node of it becomes two, and quads fill the gap. Where the way turns, the
//! node within the bend keeps one quad of four and gets two, the other keeps three and gets two: a node of three
//! quads and one of five. A row that turns back is twice as wide: three nodes for one, and a last quad around
//! the end of the way, where five quads meet then, and three opposite.
//!
//! Cost: O(quads) a row.

use crate::meshing::course::Course;
use crate::meshing::sheet::Sheet;
use rustc_hash::FxHashMap;

/// A row between two edges of the outer walk, which start at these visits; the second follows the first if the
/// row turns back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row {
    pub edges: [usize; 2],
    pub turns_back: bool,
}

impl Row {
    /// True if both ends are at most next to those of `other`.
    pub fn is_beside(&self, other: &Row) -> bool {
        (0..2).all(|end| self.edges[end].abs_diff(other.edges[end]) < 2)
    }
}

/// What rows start from.
pub(crate) struct Rim<'a> {
    /// The outer walk with all its edges.
    pub outer: &'a Course,
    /// Number of visits, on all walks: later nodes are inside.
    pub visits: usize,
    /// The visits that occur while no row is laid: of each run whose edges were taken out, the first stands for all.
    pub first: &'a [u32],
}

impl Rim<'_> {
    /// The visit after `visit` while no row is laid.
    fn next(&self, visit: u32) -> u32 {
        let after = self.first.partition_point(|&it| it <= visit);
        let is_outer = |&&it: &&u32| (it as usize) < self.outer.direction.len();
        self.first.get(after).filter(is_outer).copied().unwrap_or(0)
    }
}

/// Lays one row into a sheet over all visits; `None` if the row has no way.
pub(crate) fn insert(sheet: &mut Sheet, rim: &Rim, row: &Row) -> Option<()> {
    let sides = Sides::of(&sheet.quads);
    let [p, q] = row.edges;
    if row.turns_back {
        let way = straight_in(sheet, &sides, rim, [p, 2])?;
        // Halfway to the opposite side; next to the walk the last quad would be flat there.
        let depth = way.len() / 2;
        if depth < 2 {
            return None;
        }
        turn_back(sheet, &sides, &way[..=depth], p as u32);
        return Some(());
    }
    let [one, two] = [p, q].map(|edge| straight_in(sheet, &sides, rim, [edge, 1]));
    let (one, two) = (one?, two?);
    let inside = 1..two.len() - 1;
    let (i, j) = (1..one.len() - 1).find_map(|i| {
        let j = inside.clone().find(|&j| two[j] == one[i])?;
        Some((i, j))
    })?;
    let mut way = one[..=i].to_vec();
    way.extend(two[..j].iter().rev());
    open(sheet, &sides, &way, [p, q].map(|it| it as u32));
    Some(())
}

/// The sides of quads: (from, to) -> quad on its left.
struct Sides(FxHashMap<[u32; 2], u32>);

impl Sides {
    fn of(quads: &[[u32; 4]]) -> Sides {
        let mut sides = FxHashMap::default();
        sides.reserve(4 * quads.len());
        for (k, quad) in quads.iter().enumerate() {
            for side in 0..4 {
                sides.insert([quad[side], quad[(side + 1) % 4]], k as u32);
            }
        }
        Sides(sides)
    }

    fn left(&self, from: u32, to: u32) -> Option<u32> {
        self.0.get(&[from, to]).copied()
    }
}

/// The corner of `quad` so many places after `node`.
fn corner(quad: &[u32; 4], node: u32, places: usize) -> u32 {
    let at = (quad.iter().position(|&it| it == node)).expect("a corner of the quad");
    quad[(at + places) % 4]
}

/// The nodes straight inward from where [edge, count] were taken out, up to a walk or an irregular node.
fn straight_in(
    sheet: &Sheet,
    sides: &Sides,
    rim: &Rim,
    [edge, count]: [usize; 2],
) -> Option<Vec<u32>> {
    let direction = &rim.outer.direction;
    let after = direction[(edge + count) % direction.len()];
    let start = edge as u32;
    let quad = |from: u32, to: u32| Some(&sheet.quads[sides.left(from, to)? as usize]);
    let mut ahead = rim.next(start);
    for _ in 0..(direction[edge] + 5 - after) % 4 {
        ahead = corner(quad(start, ahead)?, start, 3);
    }
    let mut way = vec![start, ahead];
    while ahead as usize >= rim.visits && way.len() <= sheet.quads.len() {
        let from = way[way.len() - 2];
        let turned = corner(quad(from, ahead)?, ahead, 1);
        let straight = corner(quad(turned, ahead)?, ahead, 1);
        let other = corner(quad(straight, ahead)?, ahead, 1);
        if corner(quad(other, ahead)?, ahead, 1) != from {
            break;
        }
        way.push(straight);
        ahead = straight;
    }
    Some(way)
}

/// The quads on the right of `way` at its node `k`.
fn on_the_right(sheet: &Sheet, sides: &Sides, way: &[u32], k: usize) -> Vec<u32> {
    let node = way[k];
    let mut quads = Vec::new();
    if k + 1 < way.len() {
        let mut ahead = way[k + 1];
        while let Some(quad) = sides.left(ahead, node) {
            quads.push(quad);
            ahead = corner(&sheet.quads[quad as usize], node, 1);
            if k > 0 && ahead == way[k - 1] {
                break;
            }
        }
    } else {
        let mut back = way[k - 1];
        while let Some(quad) = sides.left(node, back) {
            quads.push(quad);
            back = corner(&sheet.quads[quad as usize], node, 3);
        }
    }
    quads
}

fn rename(quad: &mut [u32; 4], from: u32, to: u32) {
    for node in quad {
        if *node == from {
            *node = to;
        }
    }
}

/// Gives the quads beside each node of a way another node, that on the right instead of that on the left.
fn part(sheet: &mut Sheet, beside: &[Vec<u32>], left: &[u32], right: &[u32]) {
    for ((quads, &from), &to) in beside.iter().zip(left).zip(right) {
        for &quad in quads {
            rename(&mut sheet.quads[quad as usize], from, to);
        }
    }
}

/// Opens the sheet along `way` for a row of quads, whose ends are the edges from `edges` on.
fn open(sheet: &mut Sheet, sides: &Sides, way: &[u32], edges: [u32; 2]) {
    let last = way.len() - 1;
    let beside: Vec<Vec<u32>> = (0..=last)
        .map(|k| on_the_right(sheet, sides, way, k))
        .collect();
    // The walk has the inside on its left: where the row starts, the first visit is on the left of the way, where it
    // ends, on the right.
    let mut left = way.to_vec();
    let mut right = way.to_vec();
    right[0] = edges[0] + 1;
    left[last] = edges[1] + 1;
    for k in 1..last {
        right[k] = sheet.node(sheet.nodes[way[k] as usize]);
    }
    for quad in &mut sheet.quads {
        rename(quad, way[last], left[last]);
    }
    part(sheet, &beside, &left, &right);
    for k in 0..last {
        let quad = [left[k], right[k], right[k + 1], left[k + 1]];
        sheet.quads.push(quad);
    }
}

/// Opens the sheet along `way` for a row that comes back beside itself. It starts at the first of three visits whose
/// edges were taken out; its last node is where the row turns.
fn turn_back(sheet: &mut Sheet, sides: &Sides, way: &[u32], first: u32) {
    let last = way.len() - 1;
    let beside: Vec<Vec<u32>> = (0..last)
        .map(|k| on_the_right(sheet, sides, way, k))
        .collect();
    let left = &way[..last];
    let (mut middle, mut right) = (vec![first + 1], vec![first + 2]);
    for &node in &left[1..] {
        let at = sheet.nodes[node as usize];
        middle.push(sheet.node(at));
        right.push(sheet.node(at));
    }
    part(sheet, &beside, left, &right);
    for k in 0..last - 1 {
        (sheet.quads).push([left[k], middle[k], middle[k + 1], left[k + 1]]);
        (sheet.quads).push([middle[k], right[k], right[k + 1], middle[k + 1]]);
    }
    let k = last - 1;
    sheet.quads.push([left[k], middle[k], right[k], way[last]]);
}
