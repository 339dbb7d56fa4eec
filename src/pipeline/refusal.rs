//! What parity refuses, in words of the input: parity knows numbers only, the user places and lines.

use crate::domain::line::Domain;
use crate::noding::arrangement::Arrangement;
use crate::parity;
use crate::partition::subdomains::Partition;
use crate::pipeline::error::Error;

/// Lines that are named; the first ones tell where to look.
const NAMED: usize = 8;

/// `refused` with the place and the lines that it is about, and what to do.
pub fn explain(
    refused: parity::error::Error,
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> Error {
    let (curves, of_what) = match &refused {
        parity::error::Error::Infeasible { subdomains, fixed } => {
            let walk = (subdomains.first())
                .and_then(|&id| partition.subdomains[id as usize].walks.first())
                .map_or(&[][..], Vec::as_slice);
            let curves = match fixed.is_empty() {
                true => walk.iter().map(|half| half >> 1).collect(),
                false => fixed.clone(),
            };
            (curves, "around it")
        }
        parity::error::Error::Bounds { curve, .. } => (vec![*curve], "on it"),
    };
    let at = (curves.first()).map_or("nowhere".to_string(), |&curve| {
        let node = partition.curves[curve as usize].nodes[0];
        let [x, y] = domain.grid.projected_m(arrangement.points[node as usize]);
        format!("({x:.3}, {y:.3})")
    });
    Error::Parity(format!(
        "{refused}; at {at}; lines {of_what}: {}; another size along one of them, or a line less, frees it",
        names(&curves, domain, arrangement, partition)
    ))
}

/// The lines on `curves` by name, kind and feature, each once in the order of the input.
fn names(
    curves: &[u32],
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> String {
    let mut lines: Vec<u32> = (curves.iter())
        .flat_map(|&curve| &partition.curves[curve as usize].edges)
        .flat_map(|&edge| arrangement.pieces_of(edge))
        .map(|piece| piece.line)
        .collect();
    lines.sort_unstable();
    lines.dedup();
    let more = lines.len().saturating_sub(NAMED);
    let mut names: Vec<String> = (lines.iter().take(NAMED))
        .map(|&id| {
            let line = &domain.lines[id as usize];
            let kind = &domain.kinds[usize::from(line.kind)];
            match line.name.is_empty() {
                true => format!("feature {} ({kind})", line.source),
                false => format!("feature {} ({kind} \"{}\")", line.source, line.name),
            }
        })
        .collect();
    if more > 0 {
        names.push(format!("{more} more"));
    }
    match names.is_empty() {
        true => "none, only seams".to_string(),
        false => names.join(", "),
    }
}
