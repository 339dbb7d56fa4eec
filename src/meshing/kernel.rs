//! The working mesh of the finish: quads with their neighbours, and one kind of edit.
//!
//! A *side* is a quad and one of its four edges: `quad * 4 + corner`, from that corner to the next.
//! Every edit takes out some quads (the cavity) and puts others with the same outline in their
//! place; the same call with the two lists exchanged undoes it. Half-edge structures usually offer
//! a dozen operations; one that rebuilds a few quads, rarely a hundred, is fast enough (n log n in
//! their number) and cannot leave half an edit behind.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::buckets::sorted_by_node;
use crate::meshing::draft::Draft;
use crate::meshing::triangulate::NONE;
use crate::meshing::visits::Visits;
use smallvec::SmallVec;

/// A short list of quads or nodes: an edit rarely touches more than eight.
pub(crate) type Few<T> = SmallVec<[T; 12]>;

/// The part of a draft that is worked on (all but its settled quads).
pub(crate) struct Kernel {
    /// Positions, metres.
    pub nodes: Vec<Xy>,
    /// Node -> node of the draft; [`NONE`] for one made here.
    pub origin: Vec<u32>,
    /// True on the outline (a walk, or the border to settled quads): such a node never moves and
    /// its edges on the outline stay.
    pub held: Vec<bool>,
    /// How many quads each node should have: 4 inside, angle / 90 degrees on the outline.
    pub ideal: Vec<f32>,
    /// How many quads each node has; 0 if it is gone.
    pub valence: Vec<u32>,
    /// One side that starts at the node; on the outline the one that lies on it, from which a
    /// counter-clockwise turn meets all quads of the node.
    pub spoke: Vec<u32>,
    /// 1 / (wished edge length)^2 around each node, 1 / m2; set by `smooth::wish`.
    pub scale: Vec<f64>,
    /// On the outline: how deep the quads across its side that starts here are likely to be, metres; 0 if unknown. Set
    /// by [`look_across`](Kernel::look_across).
    pub across_m: Vec<f64>,
    /// How far from its best place each node may be, wished lengths: what it, or a neighbour since,
    /// moved by last; infinite if its surroundings are new.
    pub unrest: Vec<f32>,
    /// Corners, counter-clockwise; all [`NONE`] if the quad is gone.
    pub quads: Vec<[u32; 4]>,
    /// The same edge in the neighbour; [`NONE`] on the outline.
    pub twins: Vec<[u32; 4]>,
    /// Slots of quads that are gone.
    vacant: Vec<u32>,
}

/// The quad of a side.
pub(crate) fn quad_of(side: u32) -> u32 {
    side >> 2
}

/// The side after `side` in its quad.
pub(crate) fn after(side: u32) -> u32 {
    (side & !3) | ((side + 1) & 3)
}

/// The side before `side` in its quad.
pub(crate) fn before(side: u32) -> u32 {
    (side & !3) | ((side + 3) & 3)
}

impl Kernel {
    /// Reads `draft.quads[draft.settled..]`. A node where the outline touches itself becomes one
    /// node a sector.
    pub fn of(draft: &Draft, visits: &Visits) -> Kernel {
        let zone = &draft.quads[draft.settled..];
        let mut local = vec![NONE; draft.nodes.len()];
        let mut kernel = Kernel {
            nodes: Vec::new(),
            origin: Vec::new(),
            held: Vec::new(),
            ideal: Vec::new(),
            valence: Vec::new(),
            spoke: Vec::new(),
            scale: Vec::new(),
            unrest: Vec::new(),
            across_m: Vec::new(),
            quads: Vec::with_capacity(zone.len()),
            twins: vec![[NONE; 4]; zone.len()],
            vacant: Vec::new(),
        };
        for quad in zone {
            let corners = quad.map(|node| {
                if local[node as usize] == NONE {
                    local[node as usize] = kernel.add_node(draft.nodes[node as usize], node);
                }
                local[node as usize]
            });
            kernel.quads.push(corners);
        }
        kernel.find_twins(visits);
        kernel.find_spokes();
        kernel
    }

    /// A node without quads.
    pub fn add_node(&mut self, at: Xy, origin: u32) -> u32 {
        self.nodes.push(at);
        self.origin.push(origin);
        self.held.push(false);
        self.ideal.push(4.0);
        self.valence.push(0);
        self.spoke.push(NONE);
        self.scale.push(1.0);
        self.unrest.push(f32::INFINITY);
        self.across_m.push(0.0);
        self.nodes.len() as u32 - 1
    }

    /// Undoes the last [`add_node`](Kernel::add_node); the node must have no quads.
    pub fn drop_last_node(&mut self) {
        debug_assert_eq!(self.valence.last(), Some(&0));
        self.nodes.pop();
        self.origin.pop();
        self.held.pop();
        self.ideal.pop();
        self.valence.pop();
        self.spoke.pop();
        self.scale.pop();
        self.unrest.pop();
        self.across_m.pop();
    }

    /// Puts the quads and positions back into the draft.
    pub fn store(&self, draft: &mut Draft) {
        draft.quads.truncate(draft.settled);
        let mut number = self.origin.clone();
        for node in 0..self.nodes.len() {
            if number[node] != NONE {
                draft.nodes[number[node] as usize] = self.nodes[node];
            } else if self.valence[node] > 0 {
                number[node] = draft.nodes.len() as u32;
                draft.nodes.push(self.nodes[node]);
            }
        }
        let alive = self.quads.iter().filter(|quad| quad[0] != NONE);
        draft
            .quads
            .extend(alive.map(|quad| quad.map(|node| number[node as usize])));
    }

    fn find_twins(&mut self, visits: &Visits) {
        let mut edges: Vec<(u64, u32)> = Vec::with_capacity(4 * self.quads.len());
        for side in 0..4 * self.quads.len() as u32 {
            let (a, b) = (self.start(side), self.end(side));
            // The two sides of a line of one edge join the same two visits, and are not twins.
            let [from, to] = [a, b].map(|node| self.origin[node as usize]);
            if (from.max(to) as usize) < visits.len() && visits.next(from) == to {
                continue;
            }
            edges.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), side));
        }
        let lower = |&(edge, _): &(u64, u32)| (edge >> 32) as usize;
        for same in sorted_by_node(&edges, self.nodes.len(), lower).chunk_by(|p, q| p.0 == q.0) {
            // Two nodes with several edges between them: whose twin is whose cannot be said. Without
            // twins they are outline, and the check of the promises refuses the patch.
            if let &[(_, side), (_, twin)] = same
                && self.start(side) == self.end(twin)
            {
                self.set_twin(side, twin);
                self.set_twin(twin, side);
            }
        }
    }

    fn find_spokes(&mut self) {
        for side in 0..4 * self.quads.len() as u32 {
            let node = self.start(side) as usize;
            self.valence[node] += 1;
            if self.spoke[node] == NONE {
                self.spoke[node] = side;
            }
        }
        for side in 0..4 * self.quads.len() as u32 {
            if self.twin(side) != NONE {
                continue;
            }
            let mut node = self.start(side);
            if self.held[node as usize] {
                // A second sector at the same place.
                node = self.add_node(self.nodes[node as usize], self.origin[node as usize]);
            }
            self.claim_sector(side, node);
        }
    }

    /// Fills in [`across_m`](Kernel::across_m); without it nothing is known.
    pub fn look_across(&mut self, visits: &Visits) {
        for side in 0..4 * self.quads.len() as u32 {
            let (from, to) = (self.start(side), self.end(side));
            let [visit, next] = [from, to].map(|node| self.origin[node as usize]);
            if self.twin(side) == NONE
                && let Some(&across_m) = visits.across_m.get(visit as usize)
                && visits.next(visit) == next
            {
                self.across_m[from as usize] = across_m;
            }
        }
    }

    /// Makes `node` the node of the sector that begins with the outline side `first`.
    fn claim_sector(&mut self, first: u32, node: u32) {
        let old = self.start(first);
        let mut side = first;
        let mut count = 0;
        let incoming = loop {
            self.quads[quad_of(side) as usize][(side & 3) as usize] = node;
            count += 1;
            let incoming = before(side);
            if self.twin(incoming) == NONE {
                break incoming;
            }
            side = self.twin(incoming);
        };
        if old != node {
            self.valence[old as usize] -= count;
        }
        let [at, next, previous] =
            [node, self.end(first), self.start(incoming)].map(|node| self.nodes[node as usize]);
        let node = node as usize;
        self.valence[node] = count;
        self.spoke[node] = first;
        self.held[node] = true;
        self.ideal[node] = (turn_rad(at, next, previous) / std::f64::consts::FRAC_PI_2) as f32;
    }

    /// The node where `side` starts.
    pub fn start(&self, side: u32) -> u32 {
        self.quads[quad_of(side) as usize][(side & 3) as usize]
    }

    /// The node where `side` ends.
    pub fn end(&self, side: u32) -> u32 {
        self.start(after(side))
    }

    /// The same edge from the other side, or [`NONE`].
    pub fn twin(&self, side: u32) -> u32 {
        self.twins[quad_of(side) as usize][(side & 3) as usize]
    }

    fn set_twin(&mut self, side: u32, twin: u32) {
        self.twins[quad_of(side) as usize][(side & 3) as usize] = twin;
    }

    /// The sides that start at `node`, counter-clockwise.
    pub fn spokes(&self, node: u32) -> Few<u32> {
        let first = self.spoke[node as usize];
        let mut spokes = Few::new();
        let mut side = first;
        while side != NONE {
            spokes.push(side);
            side = self.twin(before(side));
            if side == first {
                break;
            }
        }
        spokes
    }

    /// Positions of the corners of `quad`.
    pub fn corners(&self, quad: u32) -> [Xy; 4] {
        self.quads[quad as usize].map(|node| self.nodes[node as usize])
    }

    /// The likely area of what lies across side `k` of a quad, which is on the outline, m2; none if nothing is known.
    pub fn across_m2(&self, quad: u32, k: usize) -> Option<f64> {
        let corners = self.corners(quad);
        let across_m = self.across_m[self.quads[quad as usize][k] as usize];
        let area_m2 = across_m * distance(corners[k], corners[(k + 1) % 4]);
        (area_m2 > 0.0).then_some(area_m2)
    }

    /// Scaled Jacobian of `quad`.
    pub fn quality(&self, quad: u32) -> f64 {
        scaled_jacobian(&self.corners(quad))
    }

    /// True if the slot holds a quad.
    pub fn lives(&self, quad: u32) -> bool {
        self.quads[quad as usize][0] != NONE
    }

    /// Replaces the quads `old` by quads with the corners `new` and returns their slots, or `None`,
    /// and nothing is changed, if the outlines of the two do not fit.
    pub fn replace(&mut self, old: &[u32], new: &[[u32; 4]]) -> Option<Few<u32>> {
        let outline = self.outline(old)?;
        let partners = partners(new, &outline)?;
        for &quad in old {
            for node in self.quads[quad as usize] {
                self.valence[node as usize] -= 1;
            }
            self.quads[quad as usize] = [NONE; 4];
        }
        self.vacant.extend(old.iter().rev());
        let slots: Few<u32> = new.iter().map(|&corners| self.put(corners)).collect();
        for (k, &partner) in partners.iter().enumerate() {
            let side = slots[k / 4] * 4 + k as u32 % 4;
            let twin = match partner {
                Partner::Inside(other) => slots[other / 4] * 4 + other as u32 % 4,
                Partner::Outside(twin) => twin,
            };
            self.set_twin(side, twin);
            if let Partner::Outside(twin) = partner
                && twin != NONE
            {
                self.set_twin(twin, side);
            }
        }
        for side in slots.iter().flat_map(|&slot| 4 * slot..4 * slot + 4) {
            let node = self.start(side) as usize;
            if !self.held[node] || self.twin(side) == NONE {
                self.spoke[node] = side;
            }
        }
        Some(slots)
    }

    fn put(&mut self, corners: [u32; 4]) -> u32 {
        for node in corners {
            self.valence[node as usize] += 1;
        }
        let slot = self.vacant.pop().unwrap_or_else(|| {
            self.quads.push([NONE; 4]);
            self.twins.push([NONE; 4]);
            self.quads.len() as u32 - 1
        });
        self.quads[slot as usize] = corners;
        slot
    }

    /// The outer edges of some quads, sorted: start, end, twin. `None` if one occurs twice.
    fn outline(&self, cavity: &[u32]) -> Option<Few<(u32, u32, u32)>> {
        let mut inside: Few<u32> = cavity.into();
        inside.sort_unstable();
        let mut outline: Few<(u32, u32, u32)> = Few::new();
        for side in cavity.iter().flat_map(|&quad| 4 * quad..4 * quad + 4) {
            let twin = self.twin(side);
            if twin == NONE || inside.binary_search(&quad_of(twin)).is_err() {
                outline.push((self.start(side), self.end(side), twin));
            }
        }
        outline.sort_unstable();
        let twice = |pair: &[(u32, u32, u32)]| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1);
        (!outline.windows(2).any(twice)).then_some(outline)
    }
}

/// Where the other side of an edge of a new quad is.
#[derive(Clone, Copy)]
enum Partner {
    /// Another new quad's edge, `quad * 4 + corner` in the list of new quads.
    Inside(usize),
    /// An edge of the outline, with the twin beyond it.
    Outside(u32),
}

/// Finds the partner of every edge of the new quads; `None` unless their outline is `outline`,
/// which is sorted.
fn partners(new: &[[u32; 4]], outline: &[(u32, u32, u32)]) -> Option<Few<Partner>> {
    let edge = |k: usize| (new[k / 4][k % 4], new[k / 4][(k + 1) % 4]);
    let mut edges: Few<((u32, u32), usize)> = (0..4 * new.len()).map(|k| (edge(k), k)).collect();
    edges.sort_unstable();
    let inside = |sought: (u32, u32)| {
        let first = edges.partition_point(|&(edge, _)| edge < sought);
        let same = move |&&(edge, _): &&((u32, u32), usize)| edge == sought;
        edges[first..].iter().take_while(same).map(|&(_, k)| k)
    };
    let on = |sought: (u32, u32)| {
        let found = outline.binary_search_by_key(&sought, |&(from, to, _)| (from, to));
        found.ok().map(|at| outline[at].2)
    };
    let mut partners = Few::new();
    let mut outer = 0;
    for k in 0..4 * new.len() {
        let (start, end) = edge(k);
        let mut inside = inside((end, start));
        let (first, second) = (inside.next(), inside.next());
        match (first, on((start, end))) {
            // Both directions are on the outline at a line of one edge.
            (Some(_), Some(twin)) if on((end, start)).is_some() => {
                partners.push(Partner::Outside(twin));
                outer += 1;
            }
            (Some(other), None) if second.is_none() => partners.push(Partner::Inside(other)),
            (None, Some(twin)) => {
                partners.push(Partner::Outside(twin));
                outer += 1;
            }
            _ => return None,
        }
    }
    (outer == outline.len()).then_some(partners)
}

/// The angle from `next` counter-clockwise to `previous`, seen from `at`, in (0, 2 pi].
pub(crate) fn turn_rad(at: Xy, next: Xy, previous: Xy) -> f64 {
    let toward = |p: Xy| (p[1] - at[1]).atan2(p[0] - at[0]);
    let turn = toward(previous) - toward(next);
    if turn <= 0.0 {
        turn + std::f64::consts::TAU
    } else {
        turn
    }
}

/// A grid of unit quads whose outer nodes are the walk.
#[cfg(test)]
pub(crate) fn grid(columns: usize, rows: usize) -> Kernel {
    let around = 2 * (columns + rows);
    let side = |k: usize| match k {
        _ if k < columns => [k, 0],
        _ if k < columns + rows => [columns, k - columns],
        _ if k < 2 * columns + rows => [2 * columns + rows - k, rows],
        _ => [0, around - k],
    };
    let mut places: Vec<[usize; 2]> = (0..around).map(side).collect();
    let inner = (columns - 1) * (rows - 1);
    places.extend((0..inner).map(|k| [1 + k % (columns - 1), 1 + k / (columns - 1)]));
    let node = |at: [usize; 2]| places.iter().position(|&place| place == at).unwrap() as u32;
    let quads = (0..columns * rows).map(|k| {
        let (x, y) = (k % columns, k / columns);
        [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(node)
    });
    let nodes: Vec<Xy> = places.iter().map(|it| it.map(|x| x as f64)).collect();
    let visits = Visits {
        nodes: nodes[..around].to_vec(),
        walk_start: vec![0, around as u32],
        unique: (0..around as u32).collect(),
        on_seam: vec![false; around],
        across_m: Vec::new(),
    };
    let draft = Draft {
        quads: quads.collect(),
        nodes,
        visits: around,
        settled: 0,
        method: crate::meshing::patch::Method::Strip,
    };
    Kernel::of(&draft, &visits)
}

/// A grid whose inner nodes have moved by up to `by` of a cell.
#[cfg(test)]
pub(crate) fn shaken(moves: &[[f64; 2]], by: f64) -> Kernel {
    let mut kernel = grid(5, 4);
    crate::meshing::smooth::wish(&mut kernel, 1.0);
    let inner = (0..kernel.nodes.len()).filter(|&node| !kernel.held[node]);
    for (node, [x, y]) in inner.collect::<Vec<_>>().into_iter().zip(moves) {
        let at = kernel.nodes[node];
        kernel.nodes[node] = [at[0] + by * x, at[1] + by * y];
    }
    kernel
}
