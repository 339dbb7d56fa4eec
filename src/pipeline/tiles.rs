//! Work that is done tile by tile on all cores: noding, clean-up, and the walks of the partition.

use crate::cleanup;
use crate::cleanup::Cleaned;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding;
use crate::noding::arrangement::Arrangement;
use crate::partition;
use crate::partition::subdomains::Partition;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use rayon::iter::IndexedParallelIterator;
use rayon::iter::IntoParallelIterator;
use rayon::iter::IntoParallelRefIterator;
use rayon::iter::ParallelIterator;

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

/// Nodes all tiles in parallel and stitches them; phase A.
pub(super) fn node(domain: &Domain, tile_cells: i32, count: &(dyn Fn(u64) + Sync)) -> Arrangement {
    let tiles = noding::tiles(domain, &noding::Options { tile_cells });
    let share = 1000 / tiles.len().max(1) as u64;
    let nodes = (tiles.par_iter().with_max_len(ONE))
        .map(|tile| {
            let nodes = noding::node_tile(domain, tile);
            count(share);
            nodes
        })
        .collect();
    noding::stitch(domain, nodes)
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
    let site = cleanup::site(domain, sizes, arrangement, options, &cleanup::GRAIN);
    let parts = site.districts().len() + site.bands().len();
    let share = 1000 / (parts + 1) as u64;
    let counted = |made| {
        count(share);
        made
    };
    let made = (site.districts().par_iter().with_max_len(ONE))
        .map(|it| counted(cleanup::clean_district(&site, it)))
        .collect();
    let met = cleanup::meet(&site, made);
    let bands = (site.bands().par_iter().with_max_len(ONE))
        .map(|it| counted(cleanup::clean_band(&site, &met, it)))
        .collect();
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
    let tiles = partition::tiles(arrangement, tile_cells as u32);
    let walked = (tiles.into_par_iter().with_max_len(ONE))
        .map(|tile| partition::walk_tile(arrangement, tile))
        .collect();
    let walks = partition::join(walked);
    Ok(partition::assemble(domain, arrangement, walks, corner_deg)?)
}
