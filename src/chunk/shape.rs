//! Do the vectors of a file fit together? After this no accessor of a view can fail.
//!
//! The checksum already says that the file is as it was written; this says that what was written is
//! a mesh in form. Whether it is a good one is for `check`.

use crate::chunk::views::ChunkView;
use crate::chunk::views::FrameView;
use crate::chunk::views::IndexView;
use crate::chunk::views::LinesView;
use crate::partition::subdomains::OUTSIDE;

type Shape = Result<(), String>;

/// `rows` offsets and one more, from 0 to `end`, never falling.
fn offsets(name: &str, starts: &[u32], rows: usize, end: usize) -> Shape {
    let fits = starts.len() == rows + 1
        && starts[0] == 0
        && starts[rows] as usize == end
        && starts.is_sorted();
    expect(fits, || format!("offsets {name} do not fit"))
}

fn expect(holds: bool, what: impl FnOnce() -> String) -> Shape {
    if holds { Ok(()) } else { Err(what()) }
}

fn length(name: &str, found: usize, expected: usize) -> Shape {
    expect(found == expected, || {
        format!("{name} has {found} rows where {expected} belong")
    })
}

fn below(name: &str, values: &[u32], limit: usize) -> Shape {
    expect(values.iter().all(|&v| (v as usize) < limit), || {
        format!("an entry of {name} is not below {limit}")
    })
}

pub(crate) fn index(view: &IndexView) -> Shape {
    let patches = view.patch_subdomain.len();
    expect(!view.chunk_start.is_empty(), || "no chunk_start".into())?;
    offsets("chunk_start", view.chunk_start, view.chunks(), patches)?;
    length("patch_method", view.patch_method.len(), patches)?;
    length("patch_node_base", view.patch_node_base.len(), patches + 1)?;
    length("patch_quad_base", view.patch_quad_base.len(), patches + 1)?;
    let rises = |v: &[u64]| v.is_sorted();
    expect(
        rises(view.patch_node_base) && rises(view.patch_quad_base),
        || "number bases fall".into(),
    )
}

pub(crate) fn frame(view: &FrameView) -> Shape {
    let (curves, nodes) = (view.left.len(), view.nodes.len());
    offsets(
        "curve_start",
        view.curve_start,
        curves,
        view.curve_nodes.len(),
    )?;
    expect(
        view.curve_start.windows(2).all(|w| w[1] - w[0] >= 2),
        || "a curve has fewer than two nodes".into(),
    )?;
    below("curve_nodes", view.curve_nodes, nodes)?;
    for (name, rows) in [
        ("curve_right", view.right.len()),
        ("curve_flags", view.flags.len()),
        ("goal", view.goal.len()),
        ("lower", view.lower.len()),
        ("upper", view.upper.len()),
        ("weight", view.weight.len()),
    ] {
        length(name, rows, curves)?;
    }
    let edges = view.curve_nodes.len() - curves;
    let pieces = view.piece_line.len();
    offsets("piece_start", view.piece_start, edges, pieces)?;
    length("piece_from_m", view.piece_from_m.len(), pieces)?;
    length("piece_to_m", view.piece_to_m.len(), pieces)?;
    subdomains(view)?;
    patterns(view)?;
    match &view.certificate {
        None => Ok(()),
        Some(it) => {
            let sets = it.set_parent.len();
            length("set_dual2", it.set_dual2.len(), sets)?;
            length("set_of", it.set_of.len(), view.size_m.len())?;
            let known = |&set: &u32| set == u32::MAX || (set as usize) < sets;
            expect(it.set_of.iter().all(known), || {
                "an entry of set_of names no set".into()
            })?;
            // Parents first: then walking outwards ends.
            let nested = (0..).zip(it.set_parent);
            let mut rises = nested.map(|(set, &parent)| parent == u32::MAX || parent < set);
            expect(rises.all(|it: bool| it), || "sets are not nested".into())
        }
    }
}

fn patterns(view: &FrameView) -> Shape {
    let Some(it) = &view.patterns else {
        return Ok(());
    };
    let blocks = it.block_subdomain.len();
    let sides = it.side_start.len().saturating_sub(1);
    below("block_subdomain", it.block_subdomain, view.size_m.len())?;
    offsets("block_start", it.block_start, blocks, sides)?;
    offsets("side_start", it.side_start, sides, it.side_curves.len())?;
    below("side_curves", it.side_curves, view.left.len())?;
    length("multiplier", it.multiplier.len(), sides)?;
    let known = |w: &[u32]| (3..=6).contains(&(w[1] - w[0]));
    expect(it.block_start.windows(2).all(known), || {
        "a block has fewer than three or more than six sides".into()
    })
}

fn subdomains(view: &FrameView) -> Shape {
    let count = view.size_m.len();
    let walks = view.walk_start.len().saturating_sub(1);
    offsets("subdomain_start", view.subdomain_start, count, walks)?;
    offsets("walk_start", view.walk_start, walks, view.walk_halves.len())?;
    below("walk_halves", view.walk_halves, 2 * view.left.len())?;
    let known = |&s: &u32| s == OUTSIDE || (s as usize) < count;
    expect(view.left.iter().chain(view.right).all(known), || {
        "a curve has a side that is no sub-domain".into()
    })
}

pub(crate) fn lines(view: &LinesView) -> Shape {
    let lines = view.source.len();
    offsets("point_start", view.point_start, lines, view.points.len())?;
    expect(
        view.point_start.windows(2).all(|w| w[1] - w[0] >= 2),
        || "a line has fewer than two points".into(),
    )?;
    length("line_role", view.role.len(), lines)?;
    length("line_kind", view.kind_row.len(), lines)?;
    length("line_name", view.name_row.len(), lines)?;
    below("line_name", view.name_row, view.names.len())?;
    rows_of_words("line_kind", view.kind_row, view.kinds.len())?;
    let kinds = view.kinds.len();
    length("kind_tolerance_m", view.kind_tolerance_m.len(), kinds)?;
    length("kind_min_edge_m", view.kind_min_edge_m.len(), kinds)?;
    let dropped = view.dropped_line.len();
    below("dropped_line", view.dropped_line, lines)?;
    length("dropped_reason", view.dropped_reason.len(), dropped)?;
    length("dropped_from_m", view.dropped_from_m.len(), dropped)?;
    length("dropped_to_m", view.dropped_to_m.len(), dropped)?;
    let changes = view.change_word.len();
    rows_of_words("change_word", view.change_word, view.words.len())?;
    length("change_at", view.change_at.len(), changes)?;
    length("change_moved_m", view.change_moved_m.len(), changes)?;
    let tally = view.tally_word.len();
    rows_of_words("tally_word", view.tally_word, view.words.len())?;
    length("tally_count", view.tally_count.len(), tally)?;
    length("tally_moved_max_m", view.tally_moved_max_m.len(), tally)
}

fn rows_of_words(name: &str, rows: &[u16], words: usize) -> Shape {
    expect(rows.iter().all(|&row| (row as usize) < words), || {
        format!("an entry of {name} names no word")
    })
}

pub(crate) fn chunk(view: &ChunkView) -> Shape {
    let patches = view.subdomain.len();
    length("patch_method", view.method.len(), patches)?;
    length(
        "patch_last_resort_quads",
        view.last_resort_quads.len(),
        patches,
    )?;
    offsets(
        "boundary_start",
        view.boundary_start,
        patches,
        view.boundary.len(),
    )?;
    offsets(
        "interior_start",
        view.interior_start,
        patches,
        view.interior.len(),
    )?;
    offsets("quad_start", view.quad_start, patches, view.quads.len())
}
