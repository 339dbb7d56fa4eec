//! Parts in metres -> lines on the integer grid.

use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::line::Line;
use crate::domain::line::Role;
use crate::geometry::grid::Grid;
use crate::geometry::point::LIMIT;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::ingest::NO_FEATURE;
use crate::ingest::error::Error;
use crate::ingest::feature::Content;
use crate::ingest::feature::Part;
use crate::ingest::feature::Shape;
use crate::ingest::rings::doubled_area;
use crate::ingest::rings::self_crossing;
use std::path::Path;

/// The domain that `content` describes, without EPSG code and digest.
pub fn place(
    path: &Path,
    cell_m: f64,
    mut content: Content,
    findings: &mut Vec<Finding>,
) -> Result<Domain, Error> {
    let Some(bounds_m) = bounds(&content.parts) else {
        return Err(Error::NoLines {
            file: path.to_path_buf(),
        });
    };
    let grid = grid_around(path, bounds_m, cell_m)?;
    findings.append(&mut content.findings);
    if !content.parts.iter().any(|part| part.role == Role::Boundary) {
        content.parts.push(frame(path, bounds_m)?);
        findings.push(Finding {
            what: "no-boundary",
            text: "No boundary polygon was given: the bounding box of all lines is meshed.".into(),
            feature: None,
            at_m: Some(bounds_m[0]),
        });
    }
    let mut kinds: Vec<String> = content.parts.iter().map(|part| part.kind.clone()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.len() > usize::from(u16::MAX) {
        return Err(Error::TooManyKinds {
            file: path.to_path_buf(),
            kinds: kinds.len(),
        });
    }
    let mut lines = Vec::with_capacity(content.parts.len());
    for part in content.parts {
        let kind = kinds.binary_search(&part.kind).unwrap_or_default() as u16;
        if let Some(points) = on_grid(path, &grid, &part, findings)? {
            lines.push(Line {
                source: part.feature,
                role: part.role,
                kind,
                name: part.name,
                points,
            });
        }
    }
    Ok(Domain {
        grid,
        epsg: None,
        kinds,
        lines,
        digest: 0,
    })
}

/// Lowest and highest coordinates, or `None` if there are none.
fn bounds(parts: &[Part]) -> Option<[Xy; 2]> {
    let mut points = parts.iter().flat_map(|part| &part.points);
    let first = *points.next()?;
    Some(points.fold([first, first], |[low, high], p| {
        [
            [low[0].min(p[0]), low[1].min(p[1])],
            [high[0].max(p[0]), high[1].max(p[1])],
        ]
    }))
}

/// A grid whose origin is the centre of the bounds, in whole metres.
fn grid_around(path: &Path, bounds_m: [Xy; 2], cell_m: f64) -> Result<Grid, Error> {
    let [low, high] = bounds_m;
    let grid = Grid {
        origin_m: [0, 1].map(|axis| ((low[axis] + high[axis]) / 2.0).round()),
        cell_m,
    };
    if grid.cell(low).is_some() && grid.cell(high).is_some() {
        return Ok(grid);
    }
    let half_m = 0.5 * (high[0] - low[0]).max(high[1] - low[1]) + 1.0;
    let cell_needed_m = 10_f64.powf((half_m / f64::from(LIMIT)).log10().ceil());
    Err(Error::TooWide {
        file: path.to_path_buf(),
        bounds_m,
        cell_needed_m,
    })
}

/// The bounding box as a boundary.
fn frame(path: &Path, [low, high]: [Xy; 2]) -> Result<Part, Error> {
    if low[0] >= high[0] || low[1] >= high[1] {
        return Err(Error::NoLines {
            file: path.to_path_buf(),
        });
    }
    Ok(Part {
        feature: NO_FEATURE,
        role: Role::Boundary,
        shape: Shape::Exterior,
        kind: String::new(),
        name: String::new(),
        points: vec![low, [high[0], low[1]], high, [low[0], high[1]], low],
    })
}

/// The points of one part, or `None` and a finding if nothing is left of it.
fn on_grid(
    path: &Path,
    grid: &Grid,
    part: &Part,
    findings: &mut Vec<Finding>,
) -> Result<Option<Vec<Point>>, Error> {
    let mut find = |what, text: String, at_m| {
        findings.push(Finding {
            what,
            text,
            feature: Some(part.feature),
            at_m: Some(at_m),
        });
    };
    let mut points: Vec<Point> = Vec::with_capacity(part.points.len());
    let mut repeated = Vec::new();
    for &at_m in &part.points {
        let p = grid
            .cell(at_m)
            .expect("within the bounds that the grid was made for");
        if points.last() == Some(&p) {
            repeated.push(at_m);
        } else {
            points.push(p);
        }
    }
    let first_m = part.points[0];
    let is_ring = part.role != Role::Constraint;
    if is_ring && (points.len() < 4 || doubled_area(&points) == 0) {
        if part.role == Role::Boundary && part.shape == Shape::Exterior {
            return Err(Error::Feature {
                file: path.to_path_buf(),
                feature: part.feature,
                at: Some(first_m),
                reason: "the boundary polygon has no area".to_string(),
                advice: "remove it, or use a smaller cell",
            });
        }
        let text = "A ring without area was left out.".to_string();
        find("ring-without-area", text, first_m);
        return Ok(None);
    }
    if points.len() < 2 {
        let text = "A line without length was left out.".to_string();
        find("zero-length-line", text, first_m);
        return Ok(None);
    }
    if let Some(&at_m) = repeated.first() {
        let text = format!(
            "{} repeated points of a line were left out.",
            repeated.len()
        );
        find("repeated-point", text, at_m);
    }
    if is_ring {
        orient_ring(&mut points, part.shape);
        check_ring(path, grid, part, &points, findings)?;
    }
    Ok(Some(points))
}

/// Turns a ring so that the polygon lies on its left.
fn orient_ring(points: &mut [Point], shape: Shape) {
    if (doubled_area(points) > 0) != (shape == Shape::Exterior) {
        points.reverse();
    }
}

/// A boundary ring that crosses itself is an error, any other a finding.
fn check_ring(
    path: &Path,
    grid: &Grid,
    part: &Part,
    points: &[Point],
    findings: &mut Vec<Finding>,
) -> Result<(), Error> {
    let Some(at) = self_crossing(points) else {
        return Ok(());
    };
    let at_m = grid.projected_m(at);
    if part.role == Role::Boundary {
        return Err(Error::Feature {
            file: path.to_path_buf(),
            feature: part.feature,
            at: Some(at_m),
            reason: "a ring of the boundary polygon crosses or overlaps itself".to_string(),
            advice: "mend the polygon (QGIS: Fix geometries), or use a smaller cell",
        });
    }
    findings.push(Finding {
        what: "self-crossing-hole",
        text: "A ring of a hole crosses itself; what it winds around counter-clockwise is cut out."
            .to_string(),
        feature: Some(part.feature),
        at_m: Some(at_m),
    });
    Ok(())
}
