//! Alternating trees of regions: which odd nodes are matched, through which blossoms.

use crate::parity::flood::Flood;
use crate::parity::flood::Meeting;
use crate::parity::flood::Member;
use crate::parity::flood::NONE;
use crate::parity::flood::OUTSIDE_MATE;
use crate::parity::flood::Touch;
use crate::parity::graph::Graph;

/// A node of an alternating tree: a shrinking inner region and the growing outer region that it is
/// matched to; the root has no inner one.
struct TreeNode {
    inner: u32,
    outer: u32,
    /// From the inner to the outer region.
    across: Touch,
    parent: u32,
    /// From the parent's outer region to this inner one.
    down: Touch,
    children: Vec<u32>,
    /// Stamp of the last search for a common ancestor.
    stamp: u32,
}

/// A matching in the making.
pub struct Matching<'a> {
    pub flood: Flood<'a>,
    trees: Vec<TreeNode>,
    /// Odd nodes' trees that are not dissolved yet.
    pub open: usize,
    stamp: u32,
}

const NO_TOUCH: Touch = Touch {
    from: NONE,
    to: NONE,
};

impl<'a> Matching<'a> {
    /// Matches all odd nodes at least total distance, or as far as `events_max` allows: then
    /// `open` trees are left, and the radii are still feasible dual variables.
    ///
    /// Needs a graph that is not [`hopeless`](Graph::hopeless).
    pub fn solve(graph: &'a Graph, events_max: u64) -> Matching<'a> {
        let flood = Flood::new(graph);
        let open = flood.regions.len();
        let mut matching = Matching {
            flood,
            trees: Vec::new(),
            open,
            stamp: 0,
        };
        for region in 0..open as u32 {
            matching.push_tree(NONE, region, NO_TOUCH, NONE, NO_TOUCH);
        }
        while matching.open > 0 {
            match matching.flood.next_meeting(events_max) {
                Some(meeting) => matching.react(meeting),
                None => break,
            }
        }
        matching
    }

    fn push_tree(
        &mut self,
        inner: u32,
        outer: u32,
        across: Touch,
        parent: u32,
        down: Touch,
    ) -> u32 {
        let id = self.trees.len() as u32;
        self.trees.push(TreeNode {
            inner,
            outer,
            across,
            parent,
            down,
            children: Vec::new(),
            stamp: 0,
        });
        self.flood.regions[outer as usize].tree = id;
        if inner != NONE {
            self.flood.regions[inner as usize].tree = id;
        }
        if parent != NONE {
            self.trees[parent as usize].children.push(id);
        }
        id
    }

    fn tree_of(&self, region: u32) -> u32 {
        self.flood.regions[region as usize].tree
    }

    fn react(&mut self, meeting: Meeting) {
        match meeting {
            Meeting::Outside { region, touch } => {
                self.dissolve(self.tree_of(region));
                let region = &mut self.flood.regions[region as usize];
                (region.mate, region.mate_touch) = (OUTSIDE_MATE, touch);
            }
            Meeting::Regions { a, b, touch } => self.meet(a, b, touch),
            Meeting::Imploded { region } => {
                // Its two neighbours in the tree touch each other through it.
                let node = &self.trees[self.tree_of(region) as usize];
                let touch = Touch {
                    from: node.down.from,
                    to: node.across.to,
                };
                let (a, b) = (self.trees[node.parent as usize].outer, node.outer);
                self.meet(a, b, touch);
            }
            Meeting::Shattered { region } => self.shatter(region),
        }
    }

    fn meet(&mut self, a: u32, b: u32, touch: Touch) {
        match (self.tree_of(a), self.tree_of(b)) {
            (NONE, _) => self.reach_matched(b, a, touch.reversed()),
            (_, NONE) => self.reach_matched(a, b, touch),
            (m, n) => match self.common_ancestor(m, n) {
                Some(ancestor) => self.close_cycle(m, n, ancestor, touch),
                None => {
                    self.dissolve(m);
                    self.dissolve(n);
                    self.mate(a, b, touch);
                }
            },
        }
    }

    fn mate(&mut self, a: u32, b: u32, touch: Touch) {
        for (region, mate, touch) in [(a, b, touch), (b, a, touch.reversed())] {
            let region = &mut self.flood.regions[region as usize];
            (region.mate, region.mate_touch) = (mate, touch);
        }
    }

    /// A growing region touches one that is matched already: it and its mate join the tree, or,
    /// if that is the outside, hand it on.
    fn reach_matched(&mut self, growing: u32, matched: u32, touch: Touch) {
        let tree = self.tree_of(growing);
        let mate = self.flood.regions[matched as usize].mate;
        if mate == OUTSIDE_MATE {
            self.dissolve(tree);
            self.mate(growing, matched, touch);
            return;
        }
        let across = self.flood.regions[matched as usize].mate_touch;
        self.push_tree(matched, mate, across, tree, touch);
        for region in [matched, mate] {
            self.flood.regions[region as usize].mate = NONE;
        }
        self.flood.shrink(matched);
        self.flood.grow(mate);
    }

    /// Turns a whole tree into matched pairs, except the outer region of `exit`, which the caller
    /// matches: along the way from there to the root pairs shift by one.
    fn dissolve(&mut self, exit: u32) {
        let mut node = exit;
        let mut shifted = Vec::new();
        while self.trees[node as usize].parent != NONE {
            shifted.push(node);
            node = self.trees[node as usize].parent;
        }
        let root = node;
        for &node in &shifted {
            let TreeNode {
                inner,
                parent,
                down,
                ..
            } = self.trees[node as usize];
            let above = self.trees[parent as usize].outer;
            self.mate(above, inner, down);
            self.trees[node as usize].inner = NONE;
            self.flood.regions[inner as usize].tree = NONE;
            self.flood.freeze(inner);
        }
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let TreeNode {
                inner,
                outer,
                across,
                ..
            } = self.trees[node as usize];
            if inner != NONE {
                self.mate(inner, outer, across);
                self.flood.regions[inner as usize].tree = NONE;
                self.flood.freeze(inner);
            }
            self.flood.regions[outer as usize].tree = NONE;
            self.flood.freeze(outer);
            stack.append(&mut self.trees[node as usize].children);
        }
        self.open -= 1;
    }

    fn common_ancestor(&mut self, m: u32, n: u32) -> Option<u32> {
        self.stamp += 1;
        // Both climb in turns, so that a near ancestor is found in near time.
        let mut ends = [m, n];
        while ends != [NONE, NONE] {
            for end in &mut ends {
                if *end == NONE {
                    continue;
                }
                let node = &mut self.trees[*end as usize];
                if node.stamp == self.stamp {
                    return Some(*end);
                }
                node.stamp = self.stamp;
                *end = node.parent;
            }
        }
        None
    }

    /// Two outer regions of one tree touch: the odd cycle through `ancestor` becomes a blossom.
    fn close_cycle(&mut self, m: u32, n: u32, ancestor: u32, touch: Touch) {
        let up = |from: u32, trees: &[TreeNode]| {
            let mut path = Vec::new();
            let mut node = from;
            while node != ancestor {
                path.push(node);
                node = trees[node as usize].parent;
            }
            path
        };
        let (left, right) = (up(m, &self.trees), up(n, &self.trees));
        let mut cycle = Vec::new();
        let mut region = self.trees[ancestor as usize].outer;
        for &node in left.iter().rev() {
            let node = &self.trees[node as usize];
            cycle.push(Member {
                region,
                touch: node.down,
            });
            cycle.push(Member {
                region: node.inner,
                touch: node.across,
            });
            region = node.outer;
        }
        cycle.push(Member { region, touch });
        for &node in &right {
            let node = &self.trees[node as usize];
            cycle.push(Member {
                region: node.outer,
                touch: node.across.reversed(),
            });
            cycle.push(Member {
                region: node.inner,
                touch: node.down.reversed(),
            });
        }
        // What hung on the cycle hangs on the blossom; NONE as inner marks the nodes it swallows.
        for &node in left.iter().chain(&right) {
            self.trees[node as usize].inner = NONE;
        }
        let mut orphans = Vec::new();
        for &node in left.iter().chain(&right).chain([&ancestor]) {
            orphans.append(&mut self.trees[node as usize].children);
        }
        orphans.retain(|&node| self.trees[node as usize].inner != NONE);
        for &node in &orphans {
            self.trees[node as usize].parent = ancestor;
        }
        self.trees[ancestor as usize].children = orphans;
        let blossom = self.flood.wrap(cycle);
        self.trees[ancestor as usize].outer = blossom;
        self.flood.regions[blossom as usize].tree = ancestor;
    }

    /// An inner blossom has shrunk to nothing: the even way around its cycle stays in the tree,
    /// the rest are matched in pairs.
    fn shatter(&mut self, blossom: u32) {
        let bottom = self.tree_of(blossom);
        let TreeNode {
            across,
            parent,
            down,
            ..
        } = self.trees[bottom as usize];
        let entry = self.flood.member_with(blossom, down.to);
        let exit = self.flood.member_with(blossom, across.from);
        let cycle = self.flood.unwrap(blossom);
        let n = cycle.len();
        let ahead = (exit + n - entry) % n;
        let forward = ahead.is_multiple_of(2);
        let steps = if forward { ahead } else { n - ahead };
        // The k-th member from the entry along the way, and the touch from it to the next.
        let member = |k: usize| match forward {
            true => cycle[(entry + k) % n],
            false => {
                let at = (entry + n - k) % n;
                let touch = cycle[(at + n - 1) % n].touch.reversed();
                Member {
                    region: cycle[at].region,
                    touch,
                }
            }
        };
        for k in (steps + 1..n).step_by(2) {
            let (one, other) = (member(k), member(k + 1));
            self.mate(one.region, other.region, one.touch);
            self.flood.freeze(one.region);
            self.flood.freeze(other.region);
        }
        (self.trees[parent as usize].children).retain(|&child| child != bottom);
        let (mut above, mut down) = (parent, down);
        for k in (0..steps).step_by(2) {
            let (inner, outer) = (member(k), member(k + 1));
            above = self.push_tree(inner.region, outer.region, inner.touch, above, down);
            down = outer.touch;
            self.flood.shrink(inner.region);
            self.flood.grow(outer.region);
        }
        let last = member(steps).region;
        let node = &mut self.trees[bottom as usize];
        (node.inner, node.parent, node.down) = (last, above, down);
        self.trees[above as usize].children.push(bottom);
        self.flood.regions[last as usize].tree = bottom;
        self.flood.shrink(last);
    }

    /// The matched pairs of odd nodes, blossoms resolved. Regions of open trees have none.
    pub fn pairs(&self) -> Vec<Touch> {
        let regions = &self.flood.regions;
        let mut pairs = Vec::new();
        let mut exposed: Vec<(u32, u32)> = Vec::new();
        for (id, region) in regions.iter().enumerate() {
            let first = region.mate == OUTSIDE_MATE || (id as u32) < region.mate;
            if region.alive && region.parent == NONE && region.mate != NONE && first {
                pairs.push(region.mate_touch);
                exposed.push((id as u32, region.mate_touch.from));
                if region.mate != OUTSIDE_MATE {
                    exposed.push((region.mate, region.mate_touch.to));
                }
            }
        }
        // In a blossom the member that is matched outwards leaves an even chain of the others.
        while let Some((region, source)) = exposed.pop() {
            let cycle = &regions[region as usize].members;
            if cycle.is_empty() {
                continue;
            }
            let at = self.flood.member_with(region, source);
            exposed.push((cycle[at].region, source));
            for k in (1..cycle.len()).step_by(2) {
                let one = cycle[(at + k) % cycle.len()];
                let other = cycle[(at + k + 1) % cycle.len()];
                pairs.push(one.touch);
                exposed.push((one.region, one.touch.from));
                exposed.push((other.region, one.touch.to));
            }
        }
        pairs
    }
}
