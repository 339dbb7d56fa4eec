//! The promises of `boundary` as code, on the walks of one sub-domain.

use crate::boundary::walks::Site;
use crate::boundary::walks::Walks;
use crate::boundary::walks::curve_nodes;
use crate::geometry::point::Xy;
use crate::partition::subdomains::SubdomainId;

/// Checks that `made` are sound walks of `subdomain`: an even total of at least four, distinct
/// nodes and ids, and every curve's nodes in order along its straight edges. Planarity follows
/// from these and from the arrangement's.
pub fn check(site: &Site, subdomain: SubdomainId, made: &Walks) -> Result<(), String> {
    let place = |text: String| Err(format!("sub-domain {subdomain}: {text}"));
    let total: usize = made.walks.iter().map(Vec::len).sum();
    if total % 2 == 1 || total < 4 {
        return place(format!("{total} mesh edges"));
    }
    let mut at: Vec<[u64; 2]> = made
        .nodes
        .iter()
        .map(|xy| xy.map(|v| (v + 0.0).to_bits()))
        .collect();
    at.sort_unstable();
    if at.windows(2).any(|pair| pair[0] == pair[1]) {
        return place("two nodes at one position".into());
    }
    let mut ids = made.ids.clone();
    ids.sort_unstable();
    if ids.windows(2).any(|pair| pair[0] == pair[1]) {
        return place("two nodes with one id".into());
    }
    for half in site.partition.subdomains[subdomain as usize]
        .walks
        .iter()
        .flatten()
    {
        if let Err(text) = check_curve(site, half >> 1) {
            return place(text);
        }
    }
    Ok(())
}

/// Every point of the arrangement is met, in order, and nodes between two advance from the first
/// to the second.
fn check_curve(site: &Site, curve: u32) -> Result<(), String> {
    let (ids, at) = curve_nodes(site, curve);
    let chain = &site.partition.curves[curve as usize];
    if ids.len() != site.counts[curve as usize] as usize + 1 {
        return Err(format!("curve {curve}: {} nodes", ids.len()));
    }
    let fixed: Vec<usize> = (0..ids.len())
        .filter(|&k| ids[k] < site.arrangement.points.len() as u64)
        .collect();
    if !fixed
        .iter()
        .map(|&k| ids[k])
        .eq(chain.nodes.iter().map(|&node| u64::from(node)))
    {
        return Err(format!("curve {curve}: does not pass its points in order"));
    }
    for ends in fixed.windows(2) {
        let (a, b) = (at[ends[0]], at[ends[1]]);
        let along = |p: Xy| (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1]);
        let ordered = (ends[0]..ends[1]).all(|k| along(at[k]) < along(at[k + 1]));
        if !ordered {
            return Err(format!("curve {curve}: nodes out of order"));
        }
    }
    Ok(())
}
