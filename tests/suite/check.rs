//! The check: it passes what is whole, and names what is broken, one thing at a time.

use crate::chunk::DYKE;
use crate::chunk::Tiny;
use crate::chunk::tiny;
use polder::check::Options;
use polder::check::check;
use polder::check::verdict::Verdict;
use polder::chunk::reader::Mesh;
use polder::domain::finding::Finding;
use polder::geometry::point::Point;
use polder::noding::arrangement::Piece;
use polder::partition::subdomains::OUTSIDE;
use std::fs;

const OPTIONS: Options = Options { slack_m: 0.002 };

fn verdict(tiny: &Tiny) -> Verdict {
    let (_dir, mesh) = tiny.mesh();
    check(&mesh, &OPTIONS)
}

/// The names of the promises that do not hold after `breaks` had its way.
fn broken(breaks: impl FnOnce(&mut Tiny)) -> Vec<&'static str> {
    let mut tiny = tiny();
    breaks(&mut tiny);
    let verdict = verdict(&tiny);
    for promise in verdict.broken() {
        assert!(!promise.defects.is_empty() && !promise.defects[0].text.is_empty());
    }
    verdict.broken().map(|it| it.name).collect()
}

#[test]
fn a_whole_mesh_keeps_every_promise() {
    let verdict = verdict(&tiny());
    for promise in &verdict.promises {
        assert!(promise.holds(), "{}: {:?}", promise.name, promise.defects);
        assert!(!promise.found.is_empty(), "{}", promise.name);
    }
    let names: Vec<&str> = verdict.promises.iter().map(|it| it.name).collect();
    let page = fs::read_to_string("src/check/mod.rs").unwrap();
    let order: Vec<usize> = (names.iter())
        .map(|name| {
            page.find(&format!(". `{name}`: "))
                .expect("it is on the contract page")
        })
        .collect();
    assert!(order.is_sorted() && names.len() == 14, "{names:?}");
}

#[test]
fn quality_of_perfect_squares() {
    let quality = verdict(&tiny()).quality;
    assert_eq!(quality.scaled_jacobian.count, 8);
    assert_eq!(
        (quality.scaled_jacobian.min, quality.scaled_jacobian.mean()),
        (1.0, 1.0)
    );
    assert_eq!((quality.angle_deg.min, quality.angle_deg.max), (90.0, 90.0));
    // 8 cells have 32 sides; the outline's 12 come once more.
    assert_eq!(quality.edge_over_size.count, 44);
    assert_eq!(
        (quality.edge_over_size.min, quality.edge_over_size.max),
        (1.0, 1.0)
    );
    assert_eq!((quality.hydraulic_min_m, quality.area_m2), (10.0, 800.0));
    assert_eq!(quality.quads_wished, 8.0);
    // Interior nodes: x, 4 and 13, each with four cells.
    assert_eq!((quality.valence[4], quality.valence_free[4]), (3, 1));
    assert_eq!(quality.irregular(), 0.0);
    assert_eq!(
        (quality.methods[0].quads, quality.methods[1].subdomains),
        (4, 1)
    );
    assert_eq!(quality.worst.len(), 8);
    assert_eq!(quality.largest_patch.0, 4);
}

#[test]
fn the_worst_cell_is_named_with_its_place() {
    let mut tiny = tiny();
    tiny.patches[0].interior[0] = [4.0, 12.0];
    let verdict = verdict(&tiny);
    assert!(verdict.holds());
    let worst = verdict.quality.worst[0];
    assert!(worst.scaled_jacobian < 0.9 && worst.subdomain == 0);
    assert!(worst.centre_m()[0] > 250_000.0 && worst.centre_m()[1] > 4_000_000.0);
    assert_eq!(worst.scaled_jacobian, verdict.quality.scaled_jacobian.min);
    assert!(verdict.quality.smallest[0].hydraulic_m < 10.0);
}

#[test]
fn a_flipped_quad_is_found() {
    assert_eq!(
        broken(|it| it.patches[0].quads[1].reverse())[..2],
        ["jacobians", "conforming"]
    );
}

#[test]
fn a_short_edge_is_found_unless_it_is_listed() {
    assert_eq!(broken(|it| it.min_edge_m = 9.0), [""; 0]);
    assert_eq!(broken(|it| it.min_edge_m = 10.5), ["edges"]);
    let mut tiny = tiny();
    tiny.min_edge_m = 10.5;
    let first = verdict(&tiny).broken().next().unwrap().clone();
    // Listed, this place is none any more.
    tiny.findings.push(Finding {
        what: "short-interval",
        text: first.defects[0].text.clone(),
        feature: None,
        at_m: first.defects[0].at_m,
    });
    let second = verdict(&tiny).broken().next().unwrap().clone();
    assert!(second.broken < first.broken);
    assert!(
        second
            .defects
            .iter()
            .all(|it| it.at_m != first.defects[0].at_m)
    );
}

#[test]
fn a_moved_node_is_found() {
    assert_eq!(
        broken(|it| it.patches[0].interior[0] = [21.0, 10.0]),
        ["jacobians"]
    );
    assert_eq!(
        broken(|it| it.patches[0].interior[0] = [f64::NAN, 10.0])[0],
        "jacobians"
    );
}

/// A cell that is convex in local coordinates, by less than projected ones can tell.
#[test]
fn a_cell_that_folds_when_projected_is_found() {
    let found = broken(|it| it.patches[0].interior[0] = [1e-11, 10.0]);
    assert_eq!(found, ["jacobians"]);
}

#[test]
fn a_cell_with_a_node_twice_is_found() {
    let found = broken(|it| it.patches[0].quads[0][1] = 0);
    assert!(found.contains(&"quads"), "{found:?}");
}

#[test]
fn a_cell_that_names_no_node_is_found() {
    assert_eq!(broken(|it| it.patches[0].quads[0][1] = 77)[0], "quads");
}

#[test]
fn a_missing_cell_is_a_crack() {
    let found = broken(|it| {
        it.patches[0].quads.pop();
    });
    assert!(
        ["conforming", "areas", "outline"]
            .iter()
            .all(|it| found.contains(it)),
        "{found:?}"
    );
}

#[test]
fn a_slit_that_is_not_opened_on_both_sides_is_found() {
    // The wall's edge is torn from the sub-domain's walk: cells on both sides, walked by none.
    let found = broken(|it| {
        it.frame.subdomains[1].walks[0].retain(|&half| half >> 1 != 8);
        it.frame.left[8] = OUTSIDE;
        it.frame.right[8] = OUTSIDE;
    });
    assert!(
        found.contains(&"walks") && found.contains(&"conforming"),
        "{found:?}"
    );
}

#[test]
fn a_hanging_node_is_found() {
    // The west does not know node 13 on the dyke, the east does.
    let found = broken(|it| {
        it.patches[0].boundary[3] = 8;
    });
    assert!(found.contains(&"conforming"), "{found:?}");
}

#[test]
fn a_torn_walk_is_found() {
    let found = broken(|it| it.frame.subdomains[0].walks[0].swap(1, 2));
    assert!(found.contains(&"walks"), "{found:?}");
    let found = broken(|it| it.frame.right[DYKE] = 0);
    assert!(found.contains(&"walks"), "{found:?}");
}

#[test]
fn an_odd_subdomain_is_found() {
    // Curve 0 without its middle node.
    let found = broken(|it| {
        it.frame.curve_nodes.remove(1);
        it.frame.curve_start[1..]
            .iter_mut()
            .for_each(|start| *start -= 1);
        it.frame.piece_start.remove(1);
        it.frame.pieces.remove(1);
        it.frame.piece_start[1..]
            .iter_mut()
            .for_each(|start| *start -= 1);
    });
    assert!(
        found.contains(&"even") && found.contains(&"conforming"),
        "{found:?}"
    );
}

#[test]
fn an_outline_that_is_not_the_domains_is_found() {
    let stretched = |by: i32| {
        move |it: &mut Tiny| {
            let ring = &mut it.domain.lines[0].points;
            ring[1].x += by;
            ring[2].x += by;
        }
    };
    assert_eq!(broken(stretched(900)), [""; 0]);
    assert_eq!(broken(stretched(1100)), ["outline"]);
    // A part of the domain without any mesh.
    let found = broken(|it| {
        let mut island = it.domain.lines[0].clone();
        island.points.iter_mut().for_each(|p| p.x += 100_000);
        it.domain.lines.push(island);
    });
    assert_eq!(found, ["outline"]);
}

#[test]
fn rings_inside_the_domain_do_not_matter() {
    // A second boundary polygon that overlaps the first, and a hole outside of all.
    let found = broken(|it| {
        let mut other = it.domain.lines[0].clone();
        other.points.iter_mut().for_each(|p| p.x = p.x / 2 + 5_000);
        it.domain.lines.push(other.clone());
        other.role = polder::domain::line::Role::Hole;
        other.points.iter_mut().for_each(|p| p.x += 500_000);
        it.domain.lines.push(other);
    });
    assert_eq!(found, [""; 0]);
    let found = broken(|it| {
        let mut hole = it.domain.lines[0].clone();
        hole.role = polder::domain::line::Role::Hole;
        hole.points
            .iter_mut()
            .for_each(|p| *p = Point::new(p.x / 4 + 5_000, p.y / 4 + 5_000));
        it.domain.lines.push(hole);
    });
    assert_eq!(found, ["outline"]);
}

#[test]
fn a_wrong_tag_is_found() {
    // One edge of the dyke is said to be the wall's.
    assert_eq!(broken(|it| it.frame.pieces[13].line = 2), ["lines"]);
}

#[test]
fn a_line_against_its_direction_is_found() {
    let found = broken(|it| {
        let [a, b] = [12, 13].map(|k| it.frame.pieces[k]);
        for (k, from_m, to_m) in [(12, b.to_m, a.to_m), (13, a.to_m, a.from_m)] {
            it.frame.pieces[k].from_m = from_m;
            it.frame.pieces[k].to_m = to_m;
        }
    });
    assert_eq!(found, ["lines"]);
}

/// The wall ends in a hook shorter than the tolerance, which clean-up folded onto its last edge in
/// the direction of that edge.
#[test]
fn a_hook_within_the_tolerance_is_no_tear() {
    let hook = |station_m: f64| {
        move |it: &mut Tiny| {
            it.domain.lines[2].points.push(Point::new(
                30_000 + (1000.0 * (station_m - 10.0)) as i32,
                10_000,
            ));
            let (from_m, to_m) = (station_m, 10.0);
            it.frame.pieces.push(Piece {
                line: 2,
                from_m,
                to_m,
            });
            *it.frame.piece_start.last_mut().unwrap() += 1;
        }
    };
    assert_eq!(broken(hook(10.8)), [""; 0]);
    assert_eq!(broken(hook(12.5)), ["lines"]);
}

#[test]
fn a_line_beside_its_mesh_edges_is_found() {
    assert_eq!(broken(|it| it.domain.lines[1].points[1].x += 900), [""; 0]);
    assert_eq!(
        broken(|it| it.domain.lines[1].points[1].x += 1100),
        ["lines"]
    );
}

#[test]
fn a_line_that_is_gone_without_a_word_is_found() {
    assert_eq!(broken(|it| it.dropped.clear()), ["lines"]);
    assert_eq!(
        broken(|it| it.domain.lines[2].points[1].x -= 2_000),
        ["lines"]
    );
}

#[test]
fn counts_outside_their_bounds_are_found() {
    assert_eq!(broken(|it| it.frame.goals.lower[1] = 3)[0], "bounds");
}

#[test]
fn a_certificate_that_proves_nothing_is_found() {
    let certificate = |breaks: fn(&mut polder::chunk::frame::Certificate)| {
        broken(|it| breaks(it.frame.certificate.as_mut().unwrap()))
    };
    assert_eq!(certificate(|it| it.objective -= 1), ["certificate"]);
    assert_eq!(certificate(|it| it.bound += 1), ["certificate"]);
    assert_eq!(certificate(|it| it.set_dual2[0] += 2), ["certificate"]);
    assert_eq!(
        certificate(|it| it.set_of = vec![u32::MAX, 0]),
        ["certificate"]
    );
    assert_eq!(certificate(|it| it.set_of = vec![0, 0]), [""; 0]);
}

#[test]
fn a_lost_or_cut_chunk_is_named() {
    let tiny = tiny();
    let (_dir, mesh) = tiny.mesh();
    let path = mesh.dir().join("chunk-00001");
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() - 20]).unwrap();
    for _ in 0..2 {
        let mesh = Mesh::open(mesh.dir()).unwrap();
        let verdict = check(&mesh, &OPTIONS);
        let files = verdict.broken().next().unwrap();
        assert_eq!(files.name, "files");
        assert!(files.defects[0].text.contains("chunk-00001"));
        let _ = fs::remove_file(&path);
    }
}

#[test]
fn an_index_of_other_counts_is_found() {
    let tiny = tiny();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    let writer = tiny.writer(&out);
    let mut receipts = tiny.write_parts(&writer);
    receipts[0].patches[0].quads += 1;
    writer.seal(receipts, &tiny.index()).unwrap();
    let verdict = check(&Mesh::open(&out).unwrap(), &OPTIONS);
    assert!(verdict.broken().any(|it| it.name == "files"));
}
