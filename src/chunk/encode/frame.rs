//! Frame -> the bytes of its file.

use crate::chunk::SCHEMA;
use crate::chunk::encode::Builder;
use crate::chunk::encode::Encoded;
use crate::chunk::encode::builder_for;
use crate::chunk::encode::offsets;
use crate::chunk::error::Error;
use crate::chunk::frame::Certificate;
use crate::chunk::frame::Frame;
use crate::chunk::frame::Patterns;
use crate::chunk::generated::frame as frame_file;
use crate::chunk::writer::Place;
use crate::intervals::goals::Block;
use crate::parity::balance::Solved;
use crate::partition::subdomains::OUTSIDE;
use flatbuffers::WIPOffset;
use std::path::Path;

/// Flag of a curve that was added to cut a large sub-domain.
const SEAM: u8 = 1;
/// Flag of a curve with the outside on one side.
const RIM: u8 = 2;

fn solved(given: &Solved) -> frame_file::Solved {
    frame_file::Solved::new(
        given.parts,
        given.left,
        given.rows,
        given.columns,
        given.added,
        given.branched,
    )
}

fn certificate<'a>(
    builder: &mut Builder<'a>,
    given: &Certificate,
) -> WIPOffset<frame_file::Certificate<'a>> {
    let args = frame_file::CertificateArgs {
        cost_unit: given.cost_unit,
        objective: given.objective,
        base: given.base,
        bound: given.bound,
        claimed: given.solved.claimed.unwrap_or(f64::NAN),
        set_parent: Some(builder.create_vector(&given.set_parent)),
        set_dual2: Some(builder.create_vector(&given.set_dual2)),
        set_of: Some(builder.create_vector(&given.set_of)),
        solved: Some(&solved(&given.solved)),
    };
    frame_file::Certificate::create(builder, &args)
}

fn patterns<'a>(
    builder: &mut Builder<'a>,
    given: &Patterns,
    blocks: &[Block],
) -> WIPOffset<frame_file::Patterns<'a>> {
    let sides = || blocks.iter().flat_map(|it| &it.sides);
    let subdomains: Vec<u32> = blocks.iter().map(|it| it.subdomain).collect();
    let curves: Vec<u32> = sides().flatten().copied().collect();
    let block_start = offsets(blocks.iter().map(|it| it.sides.len()));
    let args = frame_file::PatternsArgs {
        worth: given.worth,
        price: given.price,
        bound: given.bound,
        block_subdomain: Some(builder.create_vector(&subdomains)),
        block_start: Some(builder.create_vector(&block_start)),
        side_start: Some(builder.create_vector(&offsets(sides().map(Vec::len)))),
        side_curves: Some(builder.create_vector(&curves)),
        multiplier: Some(builder.create_vector(&given.multipliers)),
        set_parent: Some(builder.create_vector(&given.set_parent)),
        set_dual2: Some(builder.create_vector(&given.set_dual2)),
        set_of: Some(builder.create_vector(&given.set_of)),
        solved: Some(&solved(&given.solved)),
        claimed: given.solved.claimed.unwrap_or(f64::NAN),
        rounds: given.rounds,
        improved: given.improved,
    };
    frame_file::Patterns::create(builder, &args)
}

/// What a frame takes, bytes.
fn frame_bytes(frame: &Frame) -> usize {
    let walks = frame
        .subdomains
        .iter()
        .map(|s| s.walks.len())
        .sum::<usize>();
    let curves = frame.left.len();
    let sets = (frame.certificate.as_ref()).map_or(0, |it| 12 * it.set_parent.len());
    16 * frame.nodes.len()
        + 4 * (frame.curve_nodes.len() + frame.piece_start.len())
        + 20 * frame.pieces.len()
        // flags, sides, start, goal, bounds, weight, two half-curves
        + 45 * curves
        + 16 * frame.subdomains.len()
        + 4 * walks
        + sets
        + (frame.patterns.as_ref()).map_or(0, |it| {
            12 * it.set_parent.len() + 4 * it.set_of.len() + 20 * it.multipliers.len()
        })
}

/// The bytes of the frame file.
pub(crate) fn frame(frame: &Frame, place: &Place, path: &Path) -> Result<Encoded, Error> {
    let mut b = builder_for(frame_bytes(frame), path)?;
    let flags: Vec<u8> = (0..frame.left.len())
        .map(|c| {
            let rim = frame.left[c] == OUTSIDE || frame.right[c] == OUTSIDE;
            SEAM * u8::from(frame.is_seam[c]) + RIM * u8::from(rim)
        })
        .collect();
    let walks = || frame.subdomains.iter().flat_map(|s| &s.walks);
    let halves: Vec<u32> = walks().flatten().copied().collect();
    let lines: Vec<u32> = frame.pieces.iter().map(|p| p.line).collect();
    let from_m: Vec<f64> = frame.pieces.iter().map(|p| p.from_m).collect();
    let to_m: Vec<f64> = frame.pieces.iter().map(|p| p.to_m).collect();
    let proof = (frame.certificate.as_ref()).map(|given| certificate(&mut b, given));
    let fit = (frame.patterns.as_ref()).map(|it| patterns(&mut b, it, &frame.goals.blocks));
    let args = frame_file::FrameArgs {
        schema: SCHEMA,
        origin_x_m: place.grid.origin_m[0],
        origin_y_m: place.grid.origin_m[1],
        fixed_nodes: frame.fixed_nodes,
        node_xy_m: Some(b.create_vector(frame.nodes.as_flattened())),
        curve_start: Some(b.create_vector(&frame.curve_start)),
        curve_nodes: Some(b.create_vector(&frame.curve_nodes)),
        curve_left: Some(b.create_vector(&frame.left)),
        curve_right: Some(b.create_vector(&frame.right)),
        curve_flags: Some(b.create_vector(&flags)),
        piece_start: Some(b.create_vector(&frame.piece_start)),
        piece_line: Some(b.create_vector(&lines)),
        piece_from_m: Some(b.create_vector(&from_m)),
        piece_to_m: Some(b.create_vector(&to_m)),
        subdomain_start: Some(
            b.create_vector(&offsets(frame.subdomains.iter().map(|s| s.walks.len()))),
        ),
        walk_start: Some(b.create_vector(&offsets(walks().map(Vec::len)))),
        walk_halves: Some(b.create_vector(&halves)),
        subdomain_size_m: Some(b.create_vector(&frame.size_m)),
        goal: Some(b.create_vector(&frame.goals.goal)),
        lower: Some(b.create_vector(&frame.goals.lower)),
        upper: Some(b.create_vector(&frame.goals.upper)),
        weight: Some(b.create_vector(&frame.goals.weight)),
        certificate: proof,
        patterns: fit,
    };
    let root = frame_file::Frame::create(&mut b, &args);
    frame_file::finish_frame_buffer(&mut b, root);
    Ok(Encoded::from(b))
}
