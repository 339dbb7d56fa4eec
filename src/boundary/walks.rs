//! The discretised walks of one sub-domain.

use crate::boundary::part_of;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::intervals::apportion::apportion;
use crate::intervals::wish::EdgeWish;
use crate::intervals::wish::edge_wish;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::SubdomainId;
use crate::seams::pitch_cells;
use rustc_hash::FxHashMap;

/// All that the walks of a sub-domain are made from: the city's topology and its counts.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// For the grid and the kinds.
    pub domain: &'a Domain,
    /// Sizes, the same as `intervals` had.
    pub sizes: &'a SizeWish,
    /// Points and edges.
    pub arrangement: &'a Arrangement,
    /// Curves and sub-domains.
    pub partition: &'a Partition,
    /// Intervals of each curve.
    pub counts: &'a [u32],
    /// First global ids ([`numbering`](crate::boundary::numbering)).
    pub first: &'a [u64],
    /// How wide each sub-domain is, metres ([`widths_m`](crate::boundary::widths_m)); may be empty: unknown.
    pub width_m: &'a [f64],
}

/// The walks of one sub-domain as nodes and closed index sequences, in the order of
/// `Subdomain::walks`. A free line is walked on both sides, so its nodes occur twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walks {
    /// The distinct nodes, metres, in the order in which the walks first meet them.
    pub nodes: Vec<Xy>,
    /// Global id of each node.
    pub ids: Vec<u64>,
    /// Closed walks, indices into `nodes`; the first is not repeated at the end.
    pub walks: Vec<Vec<u32>>,
    /// For each walk, for each of its edges `walk[k] -> walk[k + 1]`: true on a lattice seam.
    pub on_seam: Vec<Vec<bool>>,
    /// The same: how deep the quads on its other side are likely to be, metres, if that is a narrow sub-domain; else 0.
    pub across_m: Vec<Vec<f64>>,
}

/// The walks of `subdomain`.
pub fn walks(site: &Site, subdomain: SubdomainId) -> Walks {
    let mut made = Walks::default();
    let mut local: FxHashMap<u64, u32> = FxHashMap::default();
    for walk in &site.partition.subdomains[subdomain as usize].walks {
        let (mut nodes, mut on_seam, mut across_m) = (Vec::new(), Vec::new(), Vec::new());
        for &half in walk {
            let (ids, at) = curve_nodes(site, half >> 1);
            let n = ids.len();
            let depth_m = depth_across_m(site, half, subdomain);
            // The last node of a half-curve is the first of the next one.
            for step in 0..n - 1 {
                let k = if half & 1 == 0 { step } else { n - 1 - step };
                let index = *local.entry(ids[k]).or_insert_with(|| {
                    made.nodes.push(at[k]);
                    made.ids.push(ids[k]);
                    made.nodes.len() as u32 - 1
                });
                nodes.push(index);
                on_seam.push(is_on_lattice(site, half >> 1));
                across_m.push(depth_m);
            }
        }
        made.walks.push(nodes);
        made.on_seam.push(on_seam);
        made.across_m.push(across_m);
    }
    made
}

/// Sub-domains wider than this, in sizes, have quads of any depth; narrower ones are strips, about as deep as one quad.
const STRIP: f64 = 0.7;

/// How deep the quads on the right of `half` are likely to be, metres; 0 if that cannot be said.
fn depth_across_m(site: &Site, half: u32, subdomain: SubdomainId) -> f64 {
    let curve = &site.partition.curves[(half >> 1) as usize];
    let other = match half & 1 == 0 {
        true => curve.right,
        false => curve.left,
    };
    let width_m = site.width_m.get(other as usize).copied().unwrap_or(0.0);
    let is_strip = other != subdomain && width_m <= STRIP * site.sizes.default_m;
    if is_strip { width_m } else { 0.0 }
}

/// True on lattice seams and their ends. A rung touches no lattice point (or by chance, which does
/// no harm): to the mesher it is a wall like any other.
fn is_on_lattice(site: &Site, curve: u32) -> bool {
    let curve = &site.partition.curves[curve as usize];
    let pitch = pitch_cells(site.domain, site.sizes);
    let mut places = curve
        .nodes
        .iter()
        .map(|&node| site.arrangement.points[node as usize]);
    curve.is_seam && places.any(|p| p.x % pitch == 0 && p.y % pitch == 0)
}

/// Global ids and positions of the nodes of `curve`, both ends included, in its own direction.
pub fn curve_nodes(site: &Site, curve: u32) -> (Vec<u64>, Vec<Xy>) {
    let chain = &site.partition.curves[curve as usize];
    let count = site.counts[curve as usize];
    let wishes: Vec<EdgeWish> = (chain.edges.iter())
        .map(|&edge| edge_wish(site.domain, site.sizes, site.arrangement, edge))
        .collect();
    let shares = apportion(&wishes, count);
    let point = |node: u32| -> Point { site.arrangement.points[node as usize] };
    let mut next = site.first[curve as usize];
    let (mut ids, mut at) = (Vec::new(), Vec::new());
    for (ends, &share) in chain.nodes.windows(2).zip(&shares) {
        ids.push(u64::from(ends[0]));
        ids.extend(next..next + u64::from(share) - 1);
        next += u64::from(share) - 1;
        let [a, b] = [point(ends[0]), point(ends[1])];
        at.extend((0..share).map(|k| part_of(&site.domain.grid, a, b, k, share)));
    }
    let last = chain.nodes[chain.nodes.len() - 1];
    ids.push(u64::from(last));
    at.push(site.domain.grid.local_m(point(last)));
    (ids, at)
}
