//! Promises `walks` and `even`: the frame by itself.

use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::geometry::point::Xy;
use crate::partition::subdomains::OUTSIDE;

pub(crate) fn check(mesh: &Mesh) -> [Promise; 2] {
    let frame = mesh.frame();
    let origin_m = mesh.index().grid.origin_m;
    let mut walks = Promise::new("walks");
    let mut even = Promise::new("even");
    sides(&frame, origin_m, &mut walks);
    closed(&frame, origin_m, &mut walks);
    edges_once(&frame, origin_m, &mut walks);
    places_once(&frame, origin_m, &mut walks);
    walks.says(format!(
        "{} curves, {} edges",
        frame.curves(),
        frame.edges()
    ));
    let mut free = 0;
    for subdomain in 0..frame.subdomains() {
        let halves = (frame.walks_of(subdomain)).flat_map(|walk| frame.halves_of(walk));
        let edges: u64 = halves
            .map(|&half| u64::from(frame.count((half >> 1) as usize)))
            .sum();
        if edges < 4 || !edges.is_multiple_of(2) {
            let at_m = somewhere(&frame, subdomain, origin_m);
            even.broken(at_m, || {
                format!("sub-domain {subdomain} has {edges} boundary edges")
            });
        }
    }
    for curve in 0..frame.curves() {
        free += u64::from(frame.left[curve] == frame.right[curve]);
    }
    even.says(format!(
        "{} sub-domains, {free} free curves",
        frame.subdomains()
    ));
    [walks, even]
}

fn somewhere(frame: &FrameView, subdomain: usize, origin_m: Xy) -> Option<Xy> {
    let walk = frame.walks_of(subdomain).next()?;
    let half = *frame.halves_of(walk).first()?;
    place(frame, frame.node_along(half, 0), origin_m)
}

fn place(frame: &FrameView, node: u32, origin_m: Xy) -> Option<Xy> {
    projected(frame.nodes[node as usize], origin_m)
}

/// Each half-curve belongs to one walk, of the sub-domain on its side.
fn sides(frame: &FrameView, origin_m: Xy, promise: &mut Promise) {
    let mut walked = vec![false; 2 * frame.curves()];
    let side = |half: u32| {
        let curve = (half >> 1) as usize;
        if half & 1 == 0 {
            frame.left[curve]
        } else {
            frame.right[curve]
        }
    };
    for subdomain in 0..frame.subdomains() {
        for walk in frame.walks_of(subdomain) {
            for &half in frame.halves_of(walk) {
                let twice = std::mem::replace(&mut walked[half as usize], true);
                if twice || side(half) != subdomain as u32 {
                    let at_m = place(frame, frame.node_along(half, 0), origin_m);
                    promise.broken(at_m, || {
                        let curve = half >> 1;
                        format!("curve {curve}: walked twice on a side, or by a stranger")
                    });
                }
            }
        }
    }
    for half in 0..2 * frame.curves() as u32 {
        if !walked[half as usize] && side(half) != OUTSIDE {
            let at_m = place(frame, frame.node_along(half, 0), origin_m);
            promise.broken(at_m, || {
                format!("curve {}: no walk has this side", half >> 1)
            });
        }
    }
    for curve in 0..frame.curves() {
        let rim = (frame.left[curve] == OUTSIDE) != (frame.right[curve] == OUTSIDE);
        if rim != frame.is_rim(curve) {
            let at_m = place(frame, frame.nodes_of(curve)[0], origin_m);
            promise.broken(at_m, || {
                format!("curve {curve}: its sides and its flag disagree")
            });
        }
    }
}

/// Each half-curve begins where the one before ends.
fn closed(frame: &FrameView, origin_m: Xy, promise: &mut Promise) {
    for walk in 0..frame.walk_start.len() - 1 {
        let halves = frame.halves_of(walk);
        for (k, &half) in halves.iter().enumerate() {
            let next = halves[(k + 1) % halves.len()];
            let end = frame.node_along(half, frame.count((half >> 1) as usize) as usize);
            if end != frame.node_along(next, 0) {
                let at_m = place(frame, end, origin_m);
                promise.broken(at_m, || {
                    format!("walk {walk} is torn after curve {}", half >> 1)
                });
            }
        }
    }
}

/// No edge is in the frame twice, and each has two ends.
fn edges_once(frame: &FrameView, origin_m: Xy, promise: &mut Promise) {
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(frame.edges());
    for curve in 0..frame.curves() {
        for pair in frame.nodes_of(curve).windows(2) {
            edges.push([pair[0].min(pair[1]), pair[0].max(pair[1])]);
        }
    }
    edges.sort_unstable();
    for (k, &[a, b]) in edges.iter().enumerate() {
        if a == b || (k > 0 && edges[k - 1] == [a, b]) {
            let at_m = place(frame, a, origin_m);
            promise.broken(at_m, || {
                format!("edge {a} - {b} is there twice or has no length")
            });
        }
    }
}

/// No two boundary nodes have the same position: that would be a crack. Each lies on a curve.
fn places_once(frame: &FrameView, origin_m: Xy, promise: &mut Promise) {
    let mut on_curve = vec![false; frame.nodes.len()];
    for &node in frame.curve_nodes {
        on_curve[node as usize] = true;
    }
    if let Some(node) = on_curve.iter().position(|&it| !it) {
        let at_m = place(frame, node as u32, origin_m);
        promise.broken(at_m, || format!("boundary node {node} is on no curve"));
    }
    drop(on_curve);
    let at = |node: u32| frame.nodes[node as usize];
    let mut order: Vec<u32> = (0..frame.nodes.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| {
        (at(a)[0].total_cmp(&at(b)[0])).then(at(a)[1].total_cmp(&at(b)[1]))
    });
    for pair in order.windows(2) {
        if at(pair[0]) == at(pair[1]) {
            let at_m = place(frame, pair[0], origin_m);
            promise.broken(at_m, || {
                format!(
                    "boundary nodes {} and {} are at one place",
                    pair[0], pair[1]
                )
            });
        }
    }
}
