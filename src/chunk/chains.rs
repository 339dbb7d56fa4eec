//! The mesh edges of each line, in the order and direction in which it was digitised.

use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;

/// One mesh edge that represents a stretch of a line, in the line's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Global id of the node where the stretch begins.
    pub from: u32,
    /// Global id of the node where it ends.
    pub to: u32,
    /// Station of the begin, metres along the line as read.
    pub from_m: f64,
    /// Station of the end; not below `from_m`.
    pub to_m: f64,
    /// The curve that the edge lies on.
    pub curve: u32,
    /// True if the line runs along the curve, false if against it.
    pub forward: bool,
}

/// The steps of all lines. 8 bytes a piece.
#[derive(Clone, Debug)]
pub struct LineEdges<'a> {
    frame: FrameView<'a>,
    /// Line -> pieces, CSR.
    start: Vec<u32>,
    /// Line by line: row of the piece.
    piece: Vec<u32>,
    /// Line by line: row of the edge's first node in `curve_nodes`.
    entry: Vec<u32>,
    /// Whose tolerances say how long a stretch may lie on its edge either way.
    lines: LinesView<'a>,
}

impl<'a> LineEdges<'a> {
    /// Sorts the pieces of the frame by their line. O(pieces).
    pub fn of(mesh: &'a Mesh) -> LineEdges<'a> {
        let frame = mesh.frame();
        let lines = mesh.lines().lines();
        let mut start = vec![0_u32; lines + 1];
        for &line in frame.piece_line {
            start[line as usize + 1] += 1;
        }
        for line in 0..lines {
            start[line + 1] += start[line];
        }
        let mut next = start.clone();
        let mut piece = vec![0_u32; frame.piece_line.len()];
        let mut entry = vec![0_u32; frame.piece_line.len()];
        for curve in 0..frame.curves() {
            for edge in frame.edges_of(curve) {
                for row in frame.pieces_of(edge) {
                    let slot = &mut next[frame.piece_line[row] as usize];
                    piece[*slot as usize] = row as u32;
                    entry[*slot as usize] = (edge + curve) as u32;
                    *slot += 1;
                }
            }
        }
        LineEdges {
            frame,
            start,
            piece,
            entry,
            lines: mesh.lines(),
        }
    }

    fn step(&self, slot: usize) -> Step {
        let (row, entry) = (self.piece[slot] as usize, self.entry[slot] as usize);
        let starts = self.frame.curve_start;
        let curve = starts.partition_point(|&s| s as usize <= entry) - 1;
        let [a, b] = [0, 1].map(|k| self.frame.curve_nodes[entry + k]);
        let [p, q] = [self.frame.piece_from_m[row], self.frame.piece_to_m[row]];
        let forward = p <= q;
        let (from, to, from_m, to_m) = if forward { (a, b, p, q) } else { (b, a, q, p) };
        Step {
            from,
            to,
            from_m,
            to_m,
            curve: curve as u32,
            forward,
        }
    }

    /// The connected chains of `line`, each in digitised order. A chain ends where nothing that
    /// follows begins at its last node: at a stretch that was dropped.
    pub fn chains_of(&self, line: usize) -> Vec<Vec<Step>> {
        let slots = self.start[line] as usize..self.start[line + 1] as usize;
        let mut steps: Vec<Step> = slots.map(|slot| self.step(slot)).collect();
        steps.sort_by(|a, b| {
            (a.from_m.total_cmp(&b.from_m))
                .then(a.to_m.total_cmp(&b.to_m))
                .then((a.from, a.to).cmp(&(b.from, b.to)))
        });
        order_points(&mut steps);
        let tolerance_m = self.lines.tolerance_m(line);
        let mut chains: Vec<Vec<Step>> = Vec::new();
        for leg in steps.chunk_by(|a, b| a.to == b.from) {
            let joined = (chains.last_mut()).is_some_and(|chain| fold(chain, leg, tolerance_m));
            if !joined {
                chains.push(leg.to_vec());
            }
        }
        chains
    }
}

/// Adds `leg` to `chain` although it does not begin at its end, if the difference is a loop or a
/// hook within the tolerance: folded onto mesh edges, its legs may well lie on the same edges in
/// one direction. Edges that are run through once more are run through once, and a leg that ends
/// where the chain does leads away from there.
fn fold(chain: &mut Vec<Step>, leg: &[Step], tolerance_m: f64) -> bool {
    let short = |part: &[Step]| {
        let span_m = part[part.len() - 1].to_m - part[0].from_m;
        span_m <= tolerance_m
    };
    let same =
        |a: &[Step], b: &[Step]| (a.iter().zip(b)).all(|(a, b)| (a.from, a.to) == (b.from, b.to));
    let repeated = (1..=leg.len().min(chain.len()))
        .rev()
        .find(|&n| same(&chain[chain.len() - n..], leg) && short(&leg[..n]));
    if let Some(n) = repeated {
        let last = chain.len() - 1;
        chain[last].to_m = leg[n - 1].to_m;
        chain.extend(&leg[n..]);
        return true;
    }
    let (begin_m, end_m) = (leg[0].from_m, leg[leg.len() - 1].to_m);
    let leads_back = chain[chain.len() - 1].to == leg[leg.len() - 1].to;
    if !leads_back || !short(leg) {
        return false;
    }
    chain.extend(leg.iter().rev().map(|step| Step {
        from: step.to,
        to: step.from,
        from_m: begin_m + (end_m - step.to_m),
        to_m: begin_m + (end_m - step.from_m),
        forward: !step.forward,
        ..*step
    }));
    true
}

/// Steps of no length (several mesh edges for one point of the line, as where an end was joined to
/// another line) have no direction and no order of their own: each takes that which goes on from
/// the step before, or leads to the one after.
fn order_points(steps: &mut [Step]) {
    let is_point = |s: &Step| s.from_m == s.to_m;
    let turn = |s: &mut Step| {
        std::mem::swap(&mut s.from, &mut s.to);
        s.forward = !s.forward;
    };
    for k in 0..steps.len() {
        if !is_point(&steps[k]) {
            continue;
        }
        let group = (steps[k..].iter())
            .take_while(|s| is_point(s) && s.from_m == steps[k].from_m)
            .count();
        let before = (k > 0).then(|| steps[k - 1].to);
        let fits = |s: &Step| before.is_some_and(|node| s.from == node || s.to == node);
        if let Some(found) = (k..k + group).find(|&j| fits(&steps[j])) {
            steps.swap(k, found);
            if Some(steps[k].from) != before {
                turn(&mut steps[k]);
            }
        } else if k == 0 {
            // The first step of the line: it must lead to what comes after.
            let after = steps.get(k + 1).copied();
            if after.is_some_and(|s| s.from == steps[k].from) {
                turn(&mut steps[k]);
            }
        }
    }
}
