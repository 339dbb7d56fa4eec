//! The promises of clean-up, as code.

use std::fmt;

use crate::cleanup::Cleaned;
use crate::cleanup::Options;
use crate::cleanup::audit::Stretch;
use crate::cleanup::audit::carriers;
use crate::cleanup::audit::stretches;
use crate::cleanup::audit::subtract;
use crate::cleanup::audit::uncovered;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::Measure;
use crate::cleanup::measure::distance;
use crate::domain::line::Domain;
use crate::domain::line::LineId;
use crate::domain::size::SizeWish;
use crate::noding;
use crate::noding::arrangement::Arrangement;
use crate::noding::rim::rim_side;

/// A broken promise of clean-up: our mistake, never the input's.
#[derive(Clone, Debug, PartialEq)]
pub enum Defect {
    /// The result is no arrangement.
    Arrangement(noding::check::Defect),
    /// This edge carries a stretch of this line that is farther away than its tolerance, metres.
    TooFar {
        /// Index into the result's edges.
        edge: u32,
        /// The line.
        line: LineId,
        /// How far.
        away_m: f64,
    },
    /// This line has a stretch, from and to in metres, that is neither covered nor dropped.
    Lost(LineId, f64, f64),
    /// At this node two lines meet that are everywhere farther apart there than their tolerances
    /// allow them to be moved.
    FarApart(u32, LineId, LineId),
    /// At this node the outline does not go on.
    OpenOutline(u32),
    /// This edge is too short and no finding says so.
    ShortEdge(u32),
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Defect::Arrangement(defect) => defect.fmt(f),
            Defect::TooFar { edge, line, away_m } => {
                write!(f, "line {line} is {away_m} m away from its edge {edge}")
            }
            Defect::Lost(line, from_m, to_m) => {
                write!(f, "line {line} is lost from {from_m} m to {to_m} m")
            }
            Defect::FarApart(node, one, other) => {
                write!(f, "lines {one} and {other} meet at node {node} from afar")
            }
            Defect::OpenOutline(node) => write!(f, "the outline ends at node {node}"),
            Defect::ShortEdge(edge) => write!(f, "edge {edge} is too short"),
        }
    }
}

/// Checks the promises of [`clean`](crate::cleanup::clean) for the arrangement `input`.
pub fn check(
    domain: &Domain,
    sizes: &SizeWish,
    options: &Options,
    input: &Arrangement,
    cleaned: &Cleaned,
) -> Result<(), Defect> {
    noding::check::check(&cleaned.arrangement).map_err(Defect::Arrangement)?;
    check_outline(domain, &cleaned.arrangement)?;
    let measure = Measure::new(domain, sizes, options);
    if !measure.allows_any() {
        return Ok(());
    }
    let graph = Graph::new(&cleaned.arrangement, &measure);
    check_distances(&graph)?;
    check_meetings(&graph)?;
    check_coverage(domain, &graph, input, cleaned)?;
    check_lengths(&graph, cleaned)
}

/// As many edges of the outline must arrive at a node as leave it, the domain on their left.
fn check_outline(domain: &Domain, arrangement: &Arrangement) -> Result<(), Defect> {
    let mut balance = vec![0; arrangement.points.len()];
    for (edge, [a, b]) in arrangement.edges.iter().enumerate() {
        let side = rim_side(domain, arrangement.pieces_of(edge as u32));
        balance[*a as usize] += side;
        balance[*b as usize] -= side;
    }
    match balance.iter().position(|&sum| sum != 0) {
        Some(node) => Err(Defect::OpenOutline(node as u32)),
        None => Ok(()),
    }
}

fn check_distances(graph: &Graph) -> Result<(), Defect> {
    let rounding = 2.0 * graph.measure.grid().cell_m;
    for edge in graph.live() {
        let (a, b) = graph.ends_m(edge);
        for piece in &graph.pieces[edge as usize] {
            let away_m = graph.measure.deviation_m(piece, a, b);
            let line = piece.line;
            if away_m > graph.measure.tolerance_m(line) + rounding {
                return Err(Defect::TooFar { edge, line, away_m });
            }
        }
    }
    Ok(())
}

/// Lines only meet where they come within the sum of their tolerances: those that are everywhere
/// farther apart keep their topology.
fn check_meetings(graph: &Graph) -> Result<(), Defect> {
    let rounding = 4.0 * graph.measure.grid().cell_m;
    for node in graph.all_nodes() {
        let edges = graph.star[node as usize].iter();
        let pieces = edges.flat_map(|&edge| graph.pieces_from(edge, node));
        let stretches: Vec<(LineId, f64)> = pieces.map(|it| (it.line, it.from_m)).collect();
        for (k, &(one, at_m)) in stretches.iter().enumerate() {
            for &(other, there_m) in stretches[..k].iter().filter(|it| it.0 != one) {
                let limits = [one, other].map(|line| graph.measure.tolerance_m(line));
                let [p, q] = [(one, at_m), (other, there_m)]
                    .map(|(line, station_m)| graph.measure.point(line, station_m));
                if distance(p, q) > limits[0] + limits[1] + rounding {
                    return Err(Defect::FarApart(node, one, other));
                }
            }
        }
    }
    Ok(())
}

fn check_coverage(
    domain: &Domain,
    graph: &Graph,
    input: &Arrangement,
    cleaned: &Cleaned,
) -> Result<(), Defect> {
    let wanted = stretches(graph.measure, input.pieces.iter());
    let there = stretches(graph.measure, cleaned.arrangement.pieces.iter());
    let dropped = cleaned.dropped.iter();
    let mut dropped: Vec<Stretch> = dropped.map(|it| (it.line, it.from_m, it.to_m)).collect();
    dropped.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let missing = subtract(&subtract(&wanted, &there), &dropped);
    let carriers = carriers(graph);
    let lost = missing
        .iter()
        // Positions are rounded to the grid once more after the audit.
        .flat_map(|it| uncovered(graph, &carriers, it, 2.0 * domain.grid.cell_m))
        .next();
    match lost {
        Some((line, from_m, to_m)) => Err(Defect::Lost(line, from_m, to_m)),
        None => Ok(()),
    }
}

fn check_lengths(graph: &Graph, cleaned: &Cleaned) -> Result<(), Defect> {
    let named = (cleaned.findings.iter())
        .filter(|it| it.what == "short-edge")
        .count();
    let mut short = graph.live();
    short.retain(|&edge| {
        let (a, b) = graph.ends_m(edge);
        distance(a, b) < graph.measure.min_edge * graph.edges[edge as usize].size_m
    });
    match short.first() {
        Some(&edge) if short.len() > named => Err(Defect::ShortEdge(edge)),
        _ => Ok(()),
    }
}
