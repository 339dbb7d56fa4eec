//! Walks around faces, a tile at a time.

use crate::noding::arrangement::Arrangement;
use crate::partition::star::HalfEdge;
use crate::partition::star::Stars;
use crate::partition::star::head;

/// Any set of nodes with the half-edges that leave them; each node of the arrangement is in one.
pub struct Tile {
    /// Ascending.
    nodes: Vec<u32>,
    /// Half-edges that leave each of `nodes`.
    stars: Stars,
}

impl Tile {
    /// The tile of `nodes`, ascending, given the stars of all nodes.
    pub(super) fn new(nodes: Vec<u32>, all: &Stars) -> Tile {
        let mut stars = Stars {
            start: vec![0],
            out: Vec::new(),
        };
        for &node in &nodes {
            stars.out.extend_from_slice(all.of(node as usize));
            stars.start.push(stars.out.len() as u32);
        }
        Tile { nodes, stars }
    }

    /// Where in `stars.out` the half-edge after `half` is, on the same walk: the first clockwise
    /// from where we came from, so that the face stays on the left. `None` if `half` leaves the
    /// tile.
    fn next(&self, arrangement: &Arrangement, half: HalfEdge) -> Option<usize> {
        let k = self.nodes.binary_search(&head(arrangement, half)).ok()?;
        let star = self.stars.of(k);
        let back = star.iter().position(|&out| out == half ^ 1)?;
        let turn = if back == 0 { star.len() } else { back } - 1;
        Some(self.stars.start[k] as usize + turn)
    }
}

/// Square tiles of side `cells`, those without nodes left out. O(n log n).
pub fn tiles(arrangement: &Arrangement, cells: u32) -> Vec<Tile> {
    let all = Stars::of_all(arrangement);
    let side = i64::from(cells.max(1));
    let tile_of = |node: u32| {
        let at = arrangement.points[node as usize];
        (
            i64::from(at.x).div_euclid(side),
            i64::from(at.y).div_euclid(side),
        )
    };
    let mut nodes: Vec<u32> = (0..arrangement.points.len() as u32).collect();
    nodes.sort_by_key(|&node| tile_of(node));
    nodes
        .chunk_by(|&a, &b| tile_of(a) == tile_of(b))
        .map(|tile| Tile::new(tile.to_vec(), &all))
        .collect()
}

/// A stretch of a walk inside one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// The half-edge that enters the tile; the last one of the fragment before.
    pub entry: HalfEdge,
    /// The half-edges after it that leave nodes of the tile; the last one leaves the tile.
    pub halves: Vec<HalfEdge>,
}

/// What one tile knows of the walks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileWalks {
    /// Walks that close inside the tile.
    pub closed: Vec<Vec<HalfEdge>>,
    /// Stretches of walks that leave it.
    pub open: Vec<Fragment>,
}

/// Walks around the faces at the nodes of `tile`. O(n log n) in its half-edges.
pub fn walk_tile(arrangement: &Arrangement, mut tile: Tile) -> TileWalks {
    tile.stars.sort_by_angle(arrangement);
    let mut walked = vec![false; tile.stars.out.len()];
    let mut follow = |slot: usize| {
        let mut halves = Vec::new();
        let mut at = Some(slot);
        while let Some(slot) = at
            && !walked[slot]
        {
            walked[slot] = true;
            halves.push(tile.stars.out[slot]);
            at = tile.next(arrangement, tile.stars.out[slot]);
        }
        halves
    };
    let mut found = TileWalks::default();
    for &out in &tile.stars.out {
        let entry = out ^ 1;
        let leaves = (tile.nodes.binary_search(&head(arrangement, out))).is_err();
        if leaves && let Some(slot) = tile.next(arrangement, entry) {
            let halves = follow(slot);
            found.open.push(Fragment { entry, halves });
        }
    }
    for slot in 0..tile.stars.out.len() {
        let halves = follow(slot);
        if !halves.is_empty() {
            found.closed.push(halves);
        }
    }
    found
}

/// Joins the fragments of all tiles. Each walk begins at its least half-edge and they are sorted
/// by it, so the result does not depend on the tiles. O(n log n) in half-edges.
pub fn join(tiles: Vec<TileWalks>) -> Vec<Vec<HalfEdge>> {
    let mut walks = Vec::new();
    let mut open = Vec::new();
    for tile in tiles {
        walks.extend(tile.closed);
        open.extend(tile.open);
    }
    open.sort_unstable_by_key(|fragment| fragment.entry);
    for first in 0..open.len() {
        let mut walk = Vec::new();
        let mut at = first;
        while !open[at].halves.is_empty() {
            walk.append(&mut open[at].halves);
            let last = walk[walk.len() - 1];
            at = open
                .binary_search_by_key(&last, |fragment| fragment.entry)
                .expect("each half-edge that leaves a tile enters one");
        }
        if !walk.is_empty() {
            walks.push(walk);
        }
    }
    for walk in &mut walks {
        begin_at_least(walk);
    }
    walks.sort_unstable();
    walks
}

/// Rotates a closed sequence of distinct ids so that it begins with the least.
pub(super) fn begin_at_least(walk: &mut [u32]) {
    let least = (0..walk.len()).min_by_key(|&k| walk[k]).unwrap_or(0);
    walk.rotate_left(least);
}
