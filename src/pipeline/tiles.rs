//! Work that is done tile by tile on all cores: noding, clean-up, and the walks of the partition.

use crate::cleanup;
use crate::cleanup::Band;
use crate::cleanup::Cleaned;
use crate::cleanup::District;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding;
use crate::noding::Gathered;
use crate::noding::Tile;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::partition;
use crate::partition::subdomains::Partition;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use rayon::iter::IndexedParallelIterator;
use rayon::iter::IntoParallelIterator;
use rayon::iter::ParallelBridge;
use rayon::iter::ParallelIterator;
use std::cmp::Reverse;

/// Tiles a side of the domain, unless the job says otherwise: some hundred tiles keep two to many
/// cores busy to the end, and a tile of a few thousand segments stays in cache.
const TILES_A_SIDE: i64 = 12;

/// Each part is a job of its own. With more in a job, one core is still busy with its last ones when the others have
/// none left: half a second on malta-osm at 35.2.
pub(super) const ONE: usize = 1;

/// Side of a tile, cells.
pub(super) fn tile_cells(job: &Job, domain: &Domain) -> i32 {
    let points = || domain.lines.iter().flat_map(|line| &line.points);
    let span = |of: fn(&crate::geometry::point::Point) -> i32| {
        let (low, high) = (points().map(of).min(), points().map(of).max());
        i64::from(high.unwrap_or(0)) - i64::from(low.unwrap_or(0))
    };
    let whole = span(|p| p.x).max(span(|p| p.y)).max(1);
    let wished = match job.tile_m {
        Some(tile_m) => (tile_m / domain.grid.cell_m).round() as i64,
        None => whole / TILES_A_SIDE + 1,
    };
    // Fewer than a million tiles, whatever the job says: each costs memory.
    wished.clamp(whole / 1000 + 1, 1 << 29) as i32
}

/// Nodes all tiles in parallel, stitches and clips them; phase A. Returns the arrangement and what was
/// cut away.
pub(super) fn node(
    domain: &Domain,
    tile_cells: i32,
    count: &(dyn Fn(u64) + Sync),
) -> (Arrangement, Vec<Piece>) {
    let tiles = noding::tiles(domain, &noding::Options { tile_cells });
    let share = 1000 / tiles.len().max(1) as u64;
    let segments = |tile: &Tile| tile.segments.len() as i64;
    let found = largest_first(&tiles, segments, |tile| {
        let nodes = noding::node_tile(domain, tile);
        count(share);
        nodes
    });
    clip(domain, stitch(domain, noding::gather(found)))
}

fn stitch(domain: &Domain, gathered: Gathered) -> Arrangement {
    let (nodes, stretches) = rayon::join(|| gathered.nodes(), || gathered.stretches(domain));
    drop(gathered);
    Arrangement::from_sorted(nodes, stretches)
}

/// Each core finds the sides of a share of the edges: for more shares, each would meet all rings again.
fn clip(domain: &Domain, arrangement: Arrangement) -> (Arrangement, Vec<Piece>) {
    let rings = noding::Rings::of(domain, &arrangement);
    let edges = arrangement.edges.len() as u32;
    let share = edges.div_ceil(rayon::current_num_threads() as u32).max(1);
    let shares: Vec<u32> = (0..edges).step_by(share as usize).collect();
    let inside: Vec<[bool; 2]> = (shares.into_par_iter())
        .flat_map_iter(|from| {
            let until = (from + share).min(edges);
            rings.sides_inside(&arrangement, from..until)
        })
        .collect();
    noding::clip_to(domain, arrangement, &inside)
}

/// Cleans all districts in parallel, then all bands between them, and joins them. They do not depend
/// on the tiles.
pub(super) fn clean(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    options: &cleanup::Options,
    count: &(dyn Fn(u64) + Sync),
) -> Cleaned {
    let (measure, layout) = rayon::join(
        || cleanup::Measure::new(domain, sizes, options),
        || cleanup::layout(domain, sizes, &arrangement, &cleanup::GRAIN),
    );
    let site = cleanup::site(measure, layout, arrangement, options);
    let parts = site.districts().len() + site.bands().len();
    let share = 1000 / (parts + 1) as u64;
    let counted = |made| {
        count(share);
        made
    };
    let made = largest_first(site.districts(), District::work, |it| {
        counted(cleanup::clean_district(&site, it))
    });
    let met = cleanup::meet(&site, made);
    let bands = largest_first(site.bands(), Band::work, |it| {
        counted(cleanup::clean_band(&site, &met, it))
    });
    let (joined, given) = rayon::join(|| cleanup::join(&site, met, bands), || site.given());
    let (threaded, (moved, left)) = rayon::join(
        || joined.threaded(&given),
        || rayon::join(|| joined.moved(), || joined.left()),
    );
    joined.cleaned(&given, moved, left, threaded)
}

/// Walks all tiles in parallel and joins the walks into sub-domains.
pub(super) fn partition(
    domain: &Domain,
    arrangement: &Arrangement,
    tile_cells: i32,
    corner_deg: f64,
) -> Result<Partition, Error> {
    let walks = || {
        let tiles = partition::tiles(arrangement, tile_cells as u32);
        let walked = (tiles.into_par_iter().with_max_len(ONE))
            .map(|tile| partition::walk_tile(arrangement, tile))
            .collect();
        partition::join(walked)
    };
    let (faces, chains) = rayon::join(
        || partition::faces(domain, arrangement, walks()),
        || partition::chains(domain, arrangement, corner_deg),
    );
    Ok(partition::assemble(domain, faces?, chains))
}

/// Does all parts on all cores, and keeps their order. Small parts come last: then no core is left with a large one
/// when the others have none.
fn largest_first<P: Sync, R: Send>(
    parts: &[P],
    work: impl Fn(&P) -> i64,
    make: impl Fn(&P) -> R + Sync,
) -> Vec<R> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&it| Reverse(work(&parts[it])));
    let mut made: Vec<(usize, R)> = (order.into_iter().par_bridge())
        .map(|it| (it, make(&parts[it])))
        .collect();
    made.sort_unstable_by_key(|it| it.0);
    made.into_iter().map(|it| it.1).collect()
}
