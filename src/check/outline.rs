//! Promise `outline`: where the mesh ends is where the domain ends.

use crate::check::conforming::AREA_REL;
use crate::check::rings::BOUNDARY;
use crate::check::rings::HOLE;
use crate::check::rings::Rings;
use crate::check::segments::Segments;
use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;
use crate::geometry::point::Xy;
use crate::partition::subdomains::OUTSIDE;

/// `cells_m2` is the area of all cells, if all could be read; `slack_m` what rounding adds to the
/// tolerance of each ring.
pub(crate) fn check(mesh: &Mesh, cells_m2: f64, all_read: bool, slack_m: f64) -> Promise {
    let mut promise = Promise::new("outline");
    let (frame, index) = (mesh.frame(), mesh.index());
    let origin_m = index.grid.origin_m;
    let outline = Segments::new(edges_of(&frame), index.size_m);
    if let Some([i, j]) = outline.crossing() {
        let at_m = projected(outline.all[i][0], origin_m);
        promise.broken(at_m, || format!("its edges {i} and {j} cross"));
    }
    let outline_m2 = enclosed_m2(&outline.all);
    let rel = (outline_m2 - cells_m2).abs() / cells_m2;
    if all_read && (rel.is_nan() || rel > AREA_REL) {
        promise.broken(None, || {
            format!("it encloses {outline_m2} m², the cells have {cells_m2} m²")
        });
    }
    let farthest = near_rings(mesh, &outline, slack_m, &mut promise);
    promise.says(format!(
        "{:.0} m², {} edges, farthest {farthest:.3} m from the rings",
        outline_m2,
        outline.all.len()
    ));
    promise
}

/// Rings that may move equally far.
struct Group {
    allowed_m: f64,
    rings: Segments,
}

/// Are outline and rings within the tolerance of each other? The largest distance that is.
fn near_rings(mesh: &Mesh, outline: &Segments, slack_m: f64, promise: &mut Promise) -> f64 {
    let (lines, size_m) = (mesh.lines(), mesh.index().size_m);
    let origin_m = mesh.index().grid.origin_m;
    let groups = groups(&lines, size_m, slack_m);
    let step_m = 0.5 * size_m;
    let mut farthest = 0.0_f64;
    for p in outline.all.iter().flat_map(|&edge| samples(edge, step_m)) {
        let mut near = (groups.iter()).filter_map(|it| it.rings.distance_within_m(p, it.allowed_m));
        match near.next() {
            Some(distance) => farthest = near.fold(distance, f64::min).max(farthest),
            None => promise.broken(projected(p, origin_m), || {
                "the outline leaves the domain's rings".to_string()
            }),
        }
    }
    let domain = Rings::of(&lines);
    let widest_m = groups.last().map_or(0.0, |it| it.allowed_m);
    for group in &groups {
        let allowed_m = group.allowed_m;
        for &segment in &group.rings.all {
            for p in samples(segment, step_m) {
                if !ends_domain(&domain, segment, p, widest_m) {
                    continue;
                }
                match outline.distance_within_m(p, allowed_m) {
                    Some(distance) => farthest = farthest.max(distance),
                    None => promise.broken(projected(p, origin_m), || {
                        format!(
                            "the outline misses a ring of the domain by more than {allowed_m:.3} m"
                        )
                    }),
                }
            }
        }
    }
    farthest
}

/// The edges between mesh and outside, the mesh on their left.
fn edges_of(frame: &FrameView) -> Vec<[Xy; 2]> {
    let mut edges = Vec::new();
    let at = |node: u32| frame.nodes[node as usize];
    for curve in (0..frame.curves()).filter(|&c| frame.is_rim(c)) {
        let mesh_is_left = frame.right[curve] == OUTSIDE;
        for pair in frame.nodes_of(curve).windows(2) {
            let [a, b] = [at(pair[0]), at(pair[1])];
            edges.push(if mesh_is_left { [a, b] } else { [b, a] });
        }
    }
    edges
}

fn enclosed_m2(edges: &[[Xy; 2]]) -> f64 {
    // Relative to one of its nodes, as for patches.
    let Some(&[o, _]) = edges.first() else {
        return 0.0;
    };
    let twice = |[a, b]: &[Xy; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    0.5 * edges.iter().map(twice).sum::<f64>()
}

/// The rings by what they are allowed, the strictest first.
fn groups(lines: &LinesView, size_m: f64, slack_m: f64) -> Vec<Group> {
    let is_ring = |&line: &usize| [BOUNDARY, HOLE].contains(&lines.role[line]);
    let rings: Vec<usize> = (0..lines.lines()).filter(is_ring).collect();
    let mut tolerances: Vec<f64> = rings.iter().map(|&it| lines.tolerance_m(it)).collect();
    tolerances.sort_by(f64::total_cmp);
    tolerances.dedup();
    let group = |tolerance_m: f64| {
        let mut segments = Vec::new();
        for &line in rings
            .iter()
            .filter(|&&it| lines.tolerance_m(it) == tolerance_m)
        {
            let places: Vec<Xy> = lines.local_m(line).collect();
            segments.extend(places.windows(2).map(|w| [w[0], w[1]]));
        }
        Group {
            allowed_m: tolerance_m + slack_m,
            rings: Segments::new(segments, size_m),
        }
    };
    tolerances.into_iter().map(group).collect()
}

/// The begin of a segment and points at most `step_m` apart along it; its end is the begin of the
/// next.
fn samples([a, b]: [Xy; 2], step_m: f64) -> impl Iterator<Item = Xy> {
    let parts = ((b[0] - a[0]).hypot(b[1] - a[1]) / step_m).ceil().max(1.0);
    (0..parts as usize).map(move |k| {
        let t = k as f64 / parts;
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    })
}

/// True if the domain ends at `p` on a ring's segment: inside on one side, outside on the other.
///
/// Rings may overlap each other (polygons touch, holes merge), so many a sample lies inside or
/// outside the domain. Asked at two distances: what is narrower than the largest tolerance (a
/// gap between two polygons, a thin hole) may have been closed, and is no end of the domain here.
fn ends_domain(domain: &Rings, [a, b]: [Xy; 2], p: Xy, widest_m: f64) -> bool {
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let normal = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
    let inside = |by_m: f64| domain.holds([p[0] + by_m * normal[0], p[1] + by_m * normal[1]]);
    [0.002, widest_m]
        .into_iter()
        .all(|by_m| inside(by_m) != inside(-by_m))
}
