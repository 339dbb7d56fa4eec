//! The planar graph while it is being changed.

use smallvec::SmallVec;

use crate::cleanup::attempt::Deed;
use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::edge::Draft;
use crate::cleanup::edge::Edge;
use crate::cleanup::edge::Fused;
use crate::cleanup::edge::Loose;
use crate::cleanup::edge::Pieces;
use crate::cleanup::edge::as_cut;
use crate::cleanup::edge::thin_out;
use crate::cleanup::edge::turned;
use crate::cleanup::index::Held;
use crate::cleanup::index::Index;
use crate::cleanup::measure::Measure;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::window::Window;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::rim::vote;

/// What may be done with a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stand {
    /// Everything.
    Open,
    /// Everything, but nothing needs to be done unless something changes there.
    Settled,
    /// It may neither move nor go: others see it too.
    Tied,
}

/// Nodes, edges and their index. Ids are never reused, so they order things the same on each run.
pub(super) struct Graph<'a> {
    pub(super) measure: &'a Measure<'a>,
    /// Where nodes may come to lie; everywhere if none.
    bounds: Option<Window>,
    pub(super) at: Vec<Point>,
    /// What may be done with each node.
    pub(super) stand: Vec<Stand>,
    /// Edges at each node.
    pub(super) star: Vec<SmallVec<[u32; 4]>>,
    /// Least wished edge length of the edges at each node, metres.
    size_at_m: Vec<f64>,
    pub(super) edges: Vec<Edge>,
    /// What each edge carries, from its first end to its second; apart from it, as most that is asked of an edge is
    /// where it is.
    pub(super) pieces: Vec<Pieces>,
    pub(super) index: Index,
    /// Every node that an edge was taken from or given to, in order: what later steps look at.
    pub(super) touched: Vec<u32>,
    /// Every edge that came, moved or took up another one, in order.
    pub(super) changed: Vec<u32>,
    pub(super) changes: Vec<Change>,
    pub(super) dropped: Vec<Dropped>,
    /// Of the attempt under way, if there is one.
    pub(super) deeds: Option<Vec<Deed>>,
}

impl<'a> Graph<'a> {
    pub(super) fn new(arrangement: &Arrangement, measure: &'a Measure<'a>) -> Graph<'a> {
        let all: Vec<u32> = (0..arrangement.edges.len() as u32).collect();
        Graph::of(arrangement, &all, measure)
    }

    /// The graph of all nodes and these edges, which get new ids in this order.
    pub(super) fn of(
        arrangement: &Arrangement,
        edges: &[u32],
        measure: &'a Measure<'a>,
    ) -> Graph<'a> {
        let ends = |edge: u32| arrangement.edges[edge as usize];
        let lengths = edges.iter().map(|&edge| {
            let [a, b] = ends(edge).map(|node| arrangement.points[node as usize]);
            a.distance(b)
        });
        let mean = lengths.sum::<f64>() / edges.len().max(1) as f64;
        let mut graph = Graph::without_edges(measure, arrangement.points.clone(), mean, None);
        for &edge in edges {
            let (pieces, inside) = as_cut(arrangement, measure.domain, edge);
            graph.add(ends(edge), pieces, inside);
        }
        graph
    }

    /// The graph of these nodes, in which everything is still to be done. `length`: the mean one of
    /// the edges that it will get, cells. The index is no finer, however small the mesh size is: so
    /// an edge takes a few cells, and memory follows their number.
    pub(super) fn without_edges(
        measure: &'a Measure<'a>,
        at: Vec<Point>,
        length: f64,
        bounds: Option<Window>,
    ) -> Graph<'a> {
        let side = length.max(measure.default_m / measure.grid().cell_m);
        Graph {
            measure,
            bounds,
            stand: vec![Stand::Open; at.len()],
            star: vec![SmallVec::new(); at.len()],
            size_at_m: vec![f64::INFINITY; at.len()],
            edges: Vec::with_capacity(4 * at.len()),
            pieces: Vec::with_capacity(4 * at.len()),
            index: Index::new(side.max(8.0), around(&at), at.len()),
            touched: Vec::with_capacity(4 * at.len()),
            changed: Vec::with_capacity(4 * at.len()),
            changes: Vec::new(),
            dropped: Vec::new(),
            deeds: None,
            at,
        }
    }

    /// Adds an edge that is not there yet.
    pub(super) fn add(&mut self, ends: [u32; 2], mut pieces: Pieces, inside: [bool; 2]) -> u32 {
        thin_out(&mut pieces);
        let id = self.edges.len() as u32;
        let (size_m, rank) = self.size_and_rank(&pieces);
        self.pieces.push(pieces);
        self.edges.push(Edge {
            ends,
            inside,
            size_m,
            rank,
            alive: true,
        });
        self.link(id);
        ends.iter().for_each(|&node| self.touch(node));
        self.did(Deed::Added);
        id
    }

    /// Makes the edge known to its ends and to the index.
    pub(super) fn link(&mut self, edge: u32) {
        let it = &self.edges[edge as usize];
        for node in it.ends {
            if self.star[node as usize].is_empty() {
                self.index.insert_node(node, self.at[node as usize]);
            }
            self.star[node as usize].push(edge);
            let least_m = &mut self.size_at_m[node as usize];
            *least_m = least_m.min(it.size_m);
        }
        self.changed.push(edge);
        self.hold(edge);
    }

    /// Makes the edge known to the index.
    fn hold(&mut self, edge: u32) {
        let ends = self.edges[edge as usize].ends;
        let at = ends.map(|node| self.point(node));
        self.index.insert(Held::new(edge, ends, at));
    }

    /// Makes its ends and the index forget the edge.
    pub(super) fn unlink(&mut self, edge: u32) {
        let ends = self.edges[edge as usize].ends;
        for node in ends {
            self.star[node as usize].retain(|held| *held != edge);
            if self.star[node as usize].is_empty() {
                self.index.remove_node(node, self.at[node as usize]);
            }
            self.measure_size(node);
        }
        let [a, b] = ends.map(|node| self.point(node));
        self.index.remove(edge, a, b);
    }

    /// From now on the index knows where nodes with edges are.
    pub(super) fn take_nodes(&mut self) {
        let nodes = self.all_nodes();
        let at = nodes.iter().map(|&node| (node, self.at[node as usize]));
        self.index.take_nodes(at);
    }

    /// Puts a node to another place, with its edges.
    pub(super) fn place(&mut self, node: u32, to: Point) {
        let from = std::mem::replace(&mut self.at[node as usize], to);
        // without edges it is nowhere
        if !self.star[node as usize].is_empty() {
            self.index.move_node(node, from, to);
        }
        for k in 0..self.star[node as usize].len() {
            let edge = self.star[node as usize][k];
            let ends = self.edges[edge as usize].ends;
            let at = ends.map(|end| self.point(end));
            let was = ends.map(|end| if end == node { from } else { self.point(end) });
            self.index.replace(was, Held::new(edge, ends, at));
            self.changed.push(edge);
        }
    }

    /// Something changed at this node: it is to be looked at again.
    pub(super) fn touch(&mut self, node: u32) {
        self.touched.push(node);
        if self.stand[node as usize] == Stand::Settled {
            self.stand[node as usize] = Stand::Open;
            self.did(Deed::Woken(node));
        }
    }

    /// A new node without edges.
    pub(super) fn add_node(&mut self, p: Point) -> u32 {
        let node = self.at.len() as u32;
        self.at.push(p);
        self.stand.push(Stand::Open);
        self.star.push(SmallVec::new());
        self.size_at_m.push(f64::INFINITY);
        self.did(Deed::AddedNode);
        node
    }

    /// Takes the newest node back, which has no edges.
    pub(super) fn pop_node(&mut self) {
        self.at.pop();
        self.stand.pop();
        self.star.pop();
        self.size_at_m.pop();
    }

    pub(super) fn set_stand(&mut self, node: u32, stand: Stand) {
        self.stand[node as usize] = stand;
    }

    /// True if a node may move or go.
    #[inline]
    pub(super) fn is_free(&self, node: u32) -> bool {
        self.stand[node as usize] != Stand::Tied
    }

    /// True if an edge may change: one of its ends is free.
    pub(super) fn may_change(&self, edge: u32) -> bool {
        self.edges[edge as usize]
            .ends
            .iter()
            .any(|&it| self.is_free(it))
    }

    /// True if a node may come to lie here.
    pub(super) fn reaches(&self, p: Point) -> bool {
        self.bounds.is_none_or(|it| it.owns(p))
    }

    fn size_and_rank(&self, pieces: &[Piece]) -> (f64, f64) {
        let mut size = f64::INFINITY;
        let mut rank = 0.0_f64;
        for piece in pieces {
            size = size.min(self.measure.size_m[piece.line as usize]);
            rank = rank.max(self.measure.rank[piece.line as usize]);
        }
        if pieces.is_empty() {
            size = self.measure.default_m;
        }
        (size, rank)
    }

    /// Takes the edge out; its record stays, dead.
    pub(super) fn remove(&mut self, edge: u32) {
        self.unlink(edge);
        let it = &mut self.edges[edge as usize];
        it.alive = false;
        let ends = it.ends;
        ends.iter().for_each(|&node| self.touch(node));
        self.did(Deed::Removed(edge));
    }

    /// Takes the edge out for good, with a row for every piece.
    pub(super) fn delete(&mut self, edge: u32, reason: Reason) {
        for piece in self.pieces[edge as usize].clone() {
            self.drop_piece(&piece, reason);
        }
        self.remove(edge);
    }

    pub(super) fn drop_piece(&mut self, piece: &Piece, reason: Reason) {
        self.dropped.push(Dropped {
            line: piece.line,
            reason,
            from_m: piece.from_m.min(piece.to_m),
            to_m: piece.from_m.max(piece.to_m),
        });
    }

    /// Adds what `draft` says from node `from`, or puts its pieces on the edge that is there. In
    /// that case `beside` tells the sides of the merged edge.
    pub(super) fn add_or_fuse(&mut self, from: u32, draft: Draft, fused: Option<Fused>) -> u32 {
        let Some(Fused { edge, inside }) = fused else {
            return self.add([from, draft.to], draft.pieces, draft.inside);
        };
        let it = &mut self.edges[edge as usize];
        let pieces = &mut self.pieces[edge as usize];
        if it.ends[0] == from {
            pieces.extend(draft.pieces);
            it.inside = inside;
        } else {
            pieces.extend(draft.pieces.iter().map(turned));
            it.inside = [inside[1], inside[0]];
        }
        thin_out(pieces);
        let (size_m, rank) = self.size_and_rank(&self.pieces[edge as usize]);
        let it = &mut self.edges[edge as usize];
        (it.size_m, it.rank) = (size_m, rank);
        let ends = it.ends;
        ends.iter().for_each(|&node| self.measure_size(node));
        self.changed.push(edge);
        edge
    }

    /// What becomes of a draft that falls onto the edge between `from` and `draft.to`, if there is
    /// one. `on_left`: the draft came from the left of that edge. `Err` if the domain would vanish
    /// on both sides, or a hole between them: the outline may move but not go; or a loop that is
    /// to be kept.
    pub(super) fn fuse(
        &self,
        from: u32,
        draft: &Draft,
        on_left: bool,
    ) -> Result<Option<Fused>, ()> {
        let Some(edge) = self.find(from, draft.to) else {
            return Ok(None);
        };
        let pieces = self.pieces_from(edge, from);
        if self.measure.would_flatten(&draft.pieces, &pieces) {
            return Err(());
        }
        let there = self.edges[edge as usize].inside_from(from);
        let (inside, between) = if on_left {
            ([draft.inside[0], there[1]], [draft.inside[1], there[0]])
        } else {
            ([there[0], draft.inside[1]], [there[1], draft.inside[0]])
        };
        // both know the strip between them: it is one face
        debug_assert_eq!(between[0], between[1]);
        let was_rim = draft.inside[0] != draft.inside[1];
        if inside == [false, false] || (was_rim && inside == [true, true]) {
            return Err(());
        }
        Ok(Some(Fused { edge, inside }))
    }

    /// What an edge carries in the direction away from `node`.
    pub(super) fn pieces_from(&self, edge: u32, node: u32) -> Pieces {
        let pieces = &self.pieces[edge as usize];
        if self.edges[edge as usize].ends[0] == node {
            pieces.clone()
        } else {
            pieces.iter().map(turned).collect()
        }
    }

    /// The edge between two nodes.
    #[inline]
    pub(super) fn find(&self, u: u32, v: u32) -> Option<u32> {
        let (u, v) = if self.star[u as usize].len() <= self.star[v as usize].len() {
            (u, v)
        } else {
            (v, u)
        };
        let star = &self.star[u as usize];
        star.iter()
            .copied()
            .find(|&e| self.edges[e as usize].other(u) == v)
    }

    #[inline]
    pub(super) fn is_there(&self, edge: u32) -> bool {
        self.edges[edge as usize].alive
    }

    #[inline]
    pub(super) fn point(&self, node: u32) -> Point {
        self.at[node as usize]
    }

    /// From `node` along an edge to its other end, cells.
    pub(super) fn heading(&self, node: u32, edge: u32) -> (i64, i64) {
        let (at, end) = (
            self.point(node),
            self.point(self.edges[edge as usize].other(node)),
        );
        (
            i64::from(end.x) - i64::from(at.x),
            i64::from(end.y) - i64::from(at.y),
        )
    }

    #[inline]
    pub(super) fn metres(&self, node: u32) -> Xy {
        self.measure.metres(self.at[node as usize])
    }

    pub(super) fn degree(&self, node: u32) -> usize {
        self.star[node as usize].len()
    }

    /// The nodes at the other ends of a node's edges.
    pub(super) fn neighbours(&self, node: u32) -> SmallVec<[u32; 6]> {
        let star = &self.star[node as usize];
        star.iter()
            .map(|&e| self.edges[e as usize].other(node))
            .collect()
    }

    #[inline]
    pub(super) fn ends_m(&self, edge: u32) -> (Xy, Xy) {
        let [a, b] = self.edges[edge as usize].ends;
        (self.metres(a), self.metres(b))
    }

    /// Least wished edge length of the edges at a node, metres.
    #[inline]
    pub(super) fn size_at_m(&self, node: u32) -> f64 {
        self.size_at_m[node as usize]
    }

    fn measure_size(&mut self, node: u32) {
        let star = &self.star[node as usize];
        let sizes = star.iter().map(|&e| self.edges[e as usize].size_m);
        self.size_at_m[node as usize] = sizes.fold(f64::INFINITY, f64::min);
    }

    /// All nodes that have edges.
    pub(super) fn all_nodes(&self) -> Vec<u32> {
        let all = 0..self.at.len() as u32;
        all.filter(|&node| self.degree(node) > 0).collect()
    }

    /// Those at which there is something to do.
    pub(super) fn nodes(&self) -> Vec<u32> {
        let all = 0..self.at.len() as u32;
        let is_open = |node: u32| self.degree(node) > 0 && self.stand[node as usize] == Stand::Open;
        all.filter(|&node| is_open(node)).collect()
    }

    /// The nodes touched since `touched` had this length, and their neighbours.
    pub(super) fn nodes_since(&self, mark: usize) -> Vec<u32> {
        let mut is_in = vec![false; self.at.len()];
        let mut nodes = Vec::new();
        let mut take = |node: u32, nodes: &mut Vec<u32>| {
            if !std::mem::replace(&mut is_in[node as usize], true) {
                nodes.push(node);
            }
        };
        for &node in &self.touched[mark..] {
            take(node, &mut nodes);
        }
        for k in 0..nodes.len() {
            let near = self.neighbours(nodes[k]);
            near.into_iter().for_each(|it| take(it, &mut nodes));
        }
        nodes.retain(|&node| self.degree(node) > 0);
        nodes.sort_unstable();
        nodes
    }

    /// An edge as it stands for itself.
    pub(super) fn loose(&self, edge: u32) -> Loose {
        let it = &self.edges[edge as usize];
        Loose {
            ends: it.ends.map(|end| self.point(end)),
            pieces: self.pieces[edge as usize].clone(),
            inside: it.inside,
        }
    }

    /// Ids of the live edges.
    pub(super) fn live(&self) -> Vec<u32> {
        let all = 0..self.edges.len() as u32;
        all.filter(|&e| self.edges[e as usize].alive).collect()
    }

    pub(super) fn note(&mut self, what: &'static str, at: Point, moved_m: f64) {
        self.changes.push(Change { what, at, moved_m });
    }

    /// The arrangement as it is now. Ring pieces stay on the rim only, as after clipping; a closed
    /// wall that carries nothing else goes.
    pub(super) fn arrangement(&self) -> Arrangement {
        let mut stretches = Vec::with_capacity(self.edges.len());
        for id in self.live() {
            let edge = &self.edges[id as usize];
            let rim = i32::from(edge.inside[0]) - i32::from(edge.inside[1]);
            let stays = |piece: &&Piece| {
                let vote = vote(self.measure.domain, piece);
                vote == 0 || (rim != 0 && vote == rim)
            };
            let pieces = self.pieces[id as usize].iter().filter(stays);
            stretches.extend(pieces.map(|&piece| (edge.ends, Some(piece))));
        }
        Arrangement::from_stretches(&self.at, stretches)
    }
}

/// The window around all nodes; the last ones are on its upper border, beyond which cells go on.
fn around(at: &[Point]) -> Window {
    let (mut min, mut max) = (at.first().copied(), at.first().copied());
    for p in at {
        min = min.map(|it| Point::new(it.x.min(p.x), it.y.min(p.y)));
        max = max.map(|it| Point::new(it.x.max(p.x), it.y.max(p.y)));
    }
    let nowhere = Point::new(0, 0);
    Window {
        min: min.unwrap_or(nowhere),
        max: max.unwrap_or(nowhere),
    }
}
