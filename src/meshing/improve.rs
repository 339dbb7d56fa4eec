//! Topological clean-up: operations that bring valences to their ideals, each kept only if the
//! shape around it, after local smoothing, is good enough.
//!
//! Three kinds of pass. *Valence*: the cost of the valences must fall. *Rescue*: near a bad quad it
//! may rise a little if the worst shape gains. *Energy*: it may rise a little if the shapes gain as
//! a sum, which moves irregular nodes to where they hurt least.

use crate::geometry::point::Xy;
use crate::meshing::edits::Edit;
use crate::meshing::edits::candidates;
use crate::meshing::edits::edit;
use crate::meshing::edits::valence_cost;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::lift::worth;
use crate::meshing::refill::refills;
use crate::meshing::smooth::OPEN;
use crate::meshing::smooth::PERFECT;
use crate::meshing::smooth::smooth_few;
use crate::meshing::star::Phase;
use crate::meshing::triangulate::NONE;

/// A scaled Jacobian that need not get better for an operation to be kept.
const GOOD: f64 = 0.35;

/// Below this scaled Jacobian a quad that no operation helps has its surroundings filled again. Measured on
/// three cities: .45 raises the 1 % quantile of shapes by .001 more, for twice the time.
const REFILLED: f64 = 0.4;

/// In a pass at most one quad in so many, and two: in a city one in 300 needs it, but where edges of
/// all lengths mingle nearly all do, in vain, and the mesh would take three times as long.
const REFILL_EVERY: usize = 100;

/// How the surroundings of an operation are smoothed, and how many sweeps; after each stage one
/// looks whether it was worth it.
const STAGES: [(Phase, usize); 3] = [(OPEN, 2), (OPEN, 3), (PERFECT, 5)];

/// What a pass is after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pass {
    /// Lower the valence cost.
    Valence,
    /// Mend quads whose scaled Jacobian is below this.
    Rescue(f64),
    /// Lower the sum of (1 - scaled Jacobian)^2.
    Energy,
}

impl Pass {
    /// Operations must change the valence cost by less than this.
    fn limit(self) -> f32 {
        match self {
            Pass::Valence => -0.3,
            Pass::Rescue(_) => 2.5,
            Pass::Energy => 1.1,
        }
    }

    /// What becomes of an operation after a stage of smoothing. Most operations fail, and most of
    /// the time goes into failing: to undo what hardly can become good enough saves an eighth of
    /// all time and loses a fiftieth of the operations that would have been kept.
    fn judge(self, stage: usize, before: &Shape, now: &Shape) -> Verdict {
        let no_worse = now.least >= before.least.min(GOOD);
        let (content, hopeless) = match self {
            Pass::Valence => (no_worse, now.least < before.least - [1.0, 0.6, 0.0][stage]),
            Pass::Rescue(_) => (
                now.least > before.least + 0.05,
                now.least < before.least - [1.5, 0.3, 0.0][stage],
            ),
            Pass::Energy => (
                no_worse && now.energy <= 0.95 * before.energy - 0.01,
                now.energy > [1.2, 1.05, 1.0][stage] * before.energy,
            ),
        };
        match (content, hopeless) {
            (true, _) => Verdict::Keep,
            (_, true) => Verdict::Undo,
            _ => Verdict::Smooth,
        }
    }

    fn lane(self) -> usize {
        match self {
            Pass::Valence => 0,
            Pass::Rescue(_) => 1,
            Pass::Energy => 2,
        }
    }
}

/// What becomes of an operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    Keep,
    /// Smooth on, and ask again; after the last stage it is undone.
    Smooth,
    Undo,
}

/// The clean-up of one mesh, with its memory of what was tried in vain.
pub(crate) struct Cleaner {
    pub kernel: Kernel,
    size_m: f64,
    /// How many more quads may have their surroundings filled again in this pass.
    refills: usize,
    /// Counts accepted operations.
    clock: u32,
    /// Clock when a node's surroundings last changed.
    changed: Vec<u32>,
    /// Clock when all operations on a quad last failed, a lane a kind of pass; 0 for never.
    failed: Vec<[u32; 3]>,
}

impl Cleaner {
    pub fn new(kernel: Kernel, size_m: f64) -> Cleaner {
        Cleaner {
            size_m,
            refills: 0,
            changed: vec![1; kernel.nodes.len()],
            failed: vec![[0; 3]; kernel.quads.len()],
            clock: 1,
            kernel,
        }
    }

    /// Forgets failed rescues: smoothing in between may have opened a way.
    pub fn forget(&mut self) {
        for failed in &mut self.failed {
            failed[1] = 0;
        }
    }

    /// Sweeps over all quads until nothing changes, at most `sweeps` times; returns how many
    /// operations were kept.
    pub fn run(&mut self, pass: Pass, sweeps: usize) -> usize {
        let mut kept = 0;
        self.refills = self.kernel.quads.len() / REFILL_EVERY + 2;
        for _ in 0..sweeps {
            let before = kept;
            for quad in 0..self.kernel.quads.len() as u32 {
                if self.kernel.lives(quad) && self.worth_trying(quad, pass) {
                    kept += usize::from(self.improve(quad, pass));
                }
            }
            if kept == before {
                break;
            }
        }
        kept
    }

    fn worth_trying(&self, quad: u32, pass: Pass) -> bool {
        let nodes = self.kernel.quads[quad as usize];
        let failed = self.failed[quad as usize][pass.lane()];
        if nodes
            .iter()
            .all(|&node| self.changed[node as usize] <= failed)
        {
            return false;
        }
        let irregular = || {
            nodes.iter().any(|&node| {
                let count = self.kernel.valence[node as usize] as i32;
                valence_cost(&self.kernel, node, count) > 0.6
            })
        };
        match pass {
            Pass::Valence => irregular(),
            Pass::Rescue(below) => worth(&self.kernel, quad, self.size_m) < below,
            Pass::Energy => self.kernel.quality(quad) < 0.85 && irregular(),
        }
    }

    /// Tries the operations on one quad, best valences first, until one is kept.
    fn improve(&mut self, quad: u32, pass: Pass) -> bool {
        let fills = matches!(pass, Pass::Rescue(_));
        let judge = |stage, before: &Shape, now: &Shape| pass.judge(stage, before, now);
        for (_, operation) in candidates(&self.kernel, quad, pass.limit(), fills) {
            if let Some(edit) = edit(&self.kernel, operation)
                && self.attempt(&edit, judge)
            {
                return true;
            }
        }
        if fills && self.refills > 0 && self.kernel.quality(quad) < REFILLED {
            self.refills -= 1;
            for edit in refills(&self.kernel, quad) {
                if self.attempt(&edit, judge) {
                    return true;
                }
            }
        }
        // The slot may hold another quad after an undone operation; then this quad is tried again
        // for nothing, no more.
        self.failed[quad as usize][pass.lane()] = self.clock;
        false
    }

    /// Makes the edit, smooths around it and keeps it or undoes it: `judge` is given the stage of
    /// smoothing and the shapes before and now of all quads that may have changed.
    pub fn attempt(
        &mut self,
        edit: &Edit,
        judge: impl Fn(usize, &Shape, &Shape) -> Verdict,
    ) -> bool {
        let distinct = |corners: &[u32; 4]| (0..4).all(|k| !corners[..k].contains(&corners[k]));
        if !edit.new.iter().all(distinct) {
            return false;
        }
        let mut nodes: Vec<u32> = edit.new.iter().flatten().copied().collect();
        nodes.extend(
            edit.old
                .iter()
                .flat_map(|&quad| self.kernel.quads[quad as usize]),
        );
        nodes.sort_unstable();
        nodes.dedup();
        let first_born = self.kernel.nodes.len() as u32;
        let there: Few<u32> = nodes
            .iter()
            .copied()
            .filter(|&node| node < first_born)
            .collect();
        let before = self.shape(&there);
        let undo: Few<[u32; 4]> = edit
            .old
            .iter()
            .map(|&quad| self.kernel.quads[quad as usize])
            .collect();
        let places: Few<Xy> = there
            .iter()
            .map(|&node| self.kernel.nodes[node as usize])
            .collect();
        self.bear(edit, &nodes);
        let Some(slots) = self.kernel.replace(&edit.old, &edit.new) else {
            self.unbear(first_born);
            return false;
        };
        if let Some((node, to)) = edit.moved {
            self.kernel.nodes[node as usize] = to;
        }
        self.changed.resize(self.kernel.nodes.len(), self.clock);
        self.failed.resize(self.kernel.quads.len(), [0; 3]);
        nodes.retain(|&node| self.kernel.valence[node as usize] > 0);
        if self.sound(&nodes) && self.settle(&nodes, &before, judge) {
            self.note(&nodes, &slots);
            return true;
        }
        for (&node, &place) in there.iter().zip(&places) {
            self.kernel.nodes[node as usize] = place;
        }
        self.kernel
            .replace(&slots, &undo)
            .expect("an edit can be undone");
        self.unbear(first_born);
        false
    }

    /// Adds the new nodes of an edit; each wishes the mean length of the nodes around.
    fn bear(&mut self, edit: &Edit, nodes: &[u32]) {
        let old = nodes
            .iter()
            .filter(|&&node| (node as usize) < self.kernel.nodes.len());
        let scales: Few<f64> = old.map(|&node| self.kernel.scale[node as usize]).collect();
        let mean = scales.iter().sum::<f64>() / scales.len() as f64;
        for &at in &edit.born {
            let node = self.kernel.add_node(at, NONE);
            self.kernel.scale[node as usize] = mean;
        }
    }

    fn unbear(&mut self, first_born: u32) {
        while self.kernel.nodes.len() > first_born as usize {
            self.kernel.drop_last_node();
        }
        self.changed.truncate(first_born as usize);
    }

    /// No free node with fewer than three quads, no outline node with none.
    fn sound(&self, nodes: &[u32]) -> bool {
        let enough =
            |node: usize| self.kernel.valence[node] >= if self.kernel.held[node] { 1 } else { 3 };
        nodes.iter().all(|&node| enough(node as usize))
    }

    /// Smooths the free ones of `nodes` until there is a verdict; true if it is to keep them so.
    fn settle(
        &mut self,
        nodes: &[u32],
        before: &Shape,
        judge: impl Fn(usize, &Shape, &Shape) -> Verdict,
    ) -> bool {
        let free = |&&node: &&u32| !self.kernel.held[node as usize];
        let free: Few<u32> = nodes.iter().filter(free).copied().collect();
        for (stage, (phase, sweeps)) in STAGES.into_iter().enumerate() {
            smooth_few(&mut self.kernel, &free, phase, sweeps);
            match judge(stage, before, &self.shape(nodes)) {
                Verdict::Keep => return true,
                Verdict::Undo => return false,
                Verdict::Smooth => {}
            }
        }
        false
    }

    /// Remembers that everything around `nodes` is new.
    fn note(&mut self, nodes: &[u32], slots: &[u32]) {
        self.clock += 1;
        for &slot in slots {
            self.failed[slot as usize] = [0; 3];
        }
        for &node in nodes {
            for side in self.kernel.spokes(node) {
                for corner in self.kernel.quads[quad_of(side) as usize] {
                    self.changed[corner as usize] = self.clock;
                    self.kernel.unrest[corner as usize] = f32::INFINITY;
                }
            }
        }
    }

    /// The shape of all quads around `nodes`.
    fn shape(&self, nodes: &[u32]) -> Shape {
        let mut quads: Vec<u32> = Vec::with_capacity(32);
        for &node in nodes {
            quads.extend(self.kernel.spokes(node).iter().map(|&side| quad_of(side)));
        }
        quads.sort_unstable();
        quads.dedup();
        let mut shape = Shape {
            least: 1.0,
            loss: 0.0,
            energy: 0.0,
        };
        for quad in quads {
            let quality = self.kernel.quality(quad);
            shape.least = shape.least.min(worth(&self.kernel, quad, self.size_m));
            shape.loss += 1.0 - quality;
            shape.energy += (1.0 - quality).powi(2);
        }
        shape
    }
}

/// The shape of some quads.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    /// Least [`worth`].
    pub least: f64,
    /// Sum of 1 - scaled Jacobian.
    pub loss: f64,
    /// Sum of (1 - scaled Jacobian)^2.
    pub energy: f64,
}
