//! The outline of the mesh as polygons: what `lines --cleaned` needs to be line work again.

use crate::chunk::views::FrameView;
use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::partition::subdomains::OUTSIDE;
use rustc_hash::FxHashMap;

/// A polygon: its outer ring, then those of its gaps; nodes, the first repeated at the end.
pub(crate) type Polygon = Vec<Vec<u32>>;

/// The polygons of the domain in the order of their first curve.
pub(crate) fn polygons(frame: &FrameView) -> Vec<Polygon> {
    let (outer, gaps): (Vec<_>, Vec<_>) = (rings(frame).into_iter())
        .map(|ring| (doubled_area(frame, &ring), ring))
        .partition(|(area, _)| *area > 0.0);
    let mut polygons: Vec<Polygon> = outer.iter().map(|(_, ring)| vec![ring.clone()]).collect();
    for (_, gap) in gaps {
        // The smallest ring around it; some ring is, where the mesh is sound.
        let around = (0..outer.len())
            .filter(|&k| is_around(frame, &outer[k].1, &gap))
            .min_by(|&j, &k| outer[j].0.total_cmp(&outer[k].0));
        if let Some(k) = around {
            polygons[k].push(gap);
        }
    }
    polygons
}

/// The ways along the outline, the mesh on their left, cut where they come back to a node.
fn rings(frame: &FrameView) -> Vec<Vec<u32>> {
    let mut leaving: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    let mut starts = Vec::new();
    for curve in (0..frame.curves()).filter(|&it| frame.is_rim(it)) {
        let mut nodes = frame.nodes_of(curve).to_vec();
        if frame.right[curve] != OUTSIDE {
            nodes.reverse();
        }
        for pair in nodes.windows(2) {
            leaving.entry(pair[0]).or_default().push(pair[1]);
            starts.push(pair[0]);
        }
    }
    let mut rings = Vec::new();
    for start in starts {
        let mut way = vec![start];
        let mut place: FxHashMap<u32, usize> = FxHashMap::from_iter([(start, 0)]);
        while let Some(next) = leaving.get_mut(&way[way.len() - 1]).and_then(Vec::pop) {
            way.push(next);
            if let Some(&back) = place.get(&next) {
                let ring = way.split_off(back);
                ring.iter().for_each(|node| {
                    place.remove(node);
                });
                rings.push(ring);
                way.push(next);
            }
            place.insert(next, way.len() - 1);
        }
    }
    rings
}

fn doubled_area(frame: &FrameView, ring: &[u32]) -> f64 {
    let at = |node: u32| frame.nodes[node as usize];
    let origin = at(ring[0]);
    let parts = ring
        .windows(2)
        .map(|it| cross(origin, at(it[0]), at(it[1])));
    parts.sum()
}

/// True if `ring` is around `gap`: around some node of it that is not its own.
fn is_around(frame: &FrameView, ring: &[u32], gap: &[u32]) -> bool {
    let node = gap.iter().find(|it| !ring.contains(it)).unwrap_or(&gap[0]);
    let [x, y] = frame.nodes[*node as usize];
    let mut inside = false;
    for pair in ring.windows(2) {
        let [a, b]: [Xy; 2] = [pair[0], pair[1]].map(|it| frame.nodes[it as usize]);
        if (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}
