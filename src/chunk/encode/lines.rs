//! Line work -> the bytes of its file.

use crate::chunk::SCHEMA;
use crate::chunk::encode::Builder;
use crate::chunk::encode::Encoded;
use crate::chunk::encode::builder_for;
use crate::chunk::encode::offsets;
use crate::chunk::encode::strings;
use crate::chunk::error::Error;
use crate::chunk::generated::lines as lines_file;
use crate::chunk::linework::LineWork;
use crate::domain::line::Role;
use flatbuffers::WIPOffset;
use std::path::Path;

/// A sorted list of distinct texts, and the row of each text in it.
fn distinct<'a>(texts: impl Iterator<Item = &'a str> + Clone) -> (Vec<&'a str>, Vec<u32>) {
    let mut sorted: Vec<&str> = texts.clone().collect();
    sorted.sort_unstable();
    sorted.dedup();
    let rows = texts
        .map(|text| sorted.binary_search(&text).expect("it is one of them") as u32)
        .collect();
    (sorted, rows)
}

/// What the line work takes, bytes; names and findings only roughly.
fn lines_bytes(work: &LineWork) -> usize {
    let points: usize = work.domain.lines.iter().map(|line| line.points.len()).sum();
    let names: usize = work.domain.lines.iter().map(|line| line.name.len()).sum();
    8 * points
        + names
        + 27 * work.domain.lines.len()
        + 21 * work.dropped.len()
        + 18 * work.changes.len()
        + 256 * work.findings.len()
}

fn findings<'a>(b: &mut Builder<'a>, work: &LineWork) -> Vec<WIPOffset<lines_file::Finding<'a>>> {
    let mut made = Vec::with_capacity(work.findings.len());
    for finding in work.findings {
        let at = finding.at_m.unwrap_or([f64::NAN; 2]);
        let args = lines_file::FindingArgs {
            what: Some(b.create_string(finding.what)),
            text: Some(b.create_string(&finding.text)),
            feature: finding.feature.unwrap_or(u32::MAX),
            x_m: at[0],
            y_m: at[1],
        };
        made.push(lines_file::Finding::create(b, &args));
    }
    made
}

/// The bytes of the lines file.
pub(crate) fn lines(work: &LineWork, path: &Path) -> Result<Encoded, Error> {
    let mut b = builder_for(lines_bytes(work), path)?;
    let all = &work.domain.lines;
    let (names, name_of) = distinct(all.iter().map(|line| line.name.as_str()));
    let changed = work.changes.iter().map(|change| change.what);
    let (words, word_of) = distinct(changed.chain(work.tally.rows.iter().map(|row| row.0)));
    let word_of: Vec<u16> = word_of.iter().map(|&row| row as u16).collect();
    let (change_word, tally_word) = word_of.split_at(work.changes.len());
    let points: Vec<i32> = (all.iter())
        .flat_map(|line| line.points.iter().flat_map(|p| [p.x, p.y]))
        .collect();
    let change_at: Vec<i32> = (work.changes.iter().flat_map(|c| [c.at.x, c.at.y])).collect();
    let column = |pick: fn(&Role) -> u8| all.iter().map(|l| pick(&l.role)).collect::<Vec<u8>>();
    let role = column(|role| match role {
        Role::Constraint => 0,
        Role::Boundary => 1,
        Role::Hole => 2,
    });
    let source: Vec<u32> = all.iter().map(|line| line.source).collect();
    let kind: Vec<u16> = all.iter().map(|line| line.kind).collect();
    let dropped_line: Vec<u32> = work.dropped.iter().map(|it| it.line).collect();
    let dropped_reason: Vec<u8> = work.dropped.iter().map(|it| it.reason as u8).collect();
    let dropped_from: Vec<f64> = work.dropped.iter().map(|it| it.from_m).collect();
    let dropped_to: Vec<f64> = work.dropped.iter().map(|it| it.to_m).collect();
    let change_moved: Vec<f64> = work.changes.iter().map(|it| it.moved_m).collect();
    let tally_count: Vec<u64> = work.tally.rows.iter().map(|row| row.1).collect();
    let tally_moved: Vec<f64> = work.tally.rows.iter().map(|row| row.2).collect();
    let found = findings(&mut b, work);
    let args = lines_file::LinesArgs {
        schema: SCHEMA,
        origin_x_m: work.domain.grid.origin_m[0],
        origin_y_m: work.domain.grid.origin_m[1],
        cell_m: work.domain.grid.cell_m,
        kinds: Some(strings(&mut b, &work.domain.kinds)),
        kind_tolerance_m: Some(b.create_vector(&work.limits.tolerance_by_kind_m)),
        kind_min_edge_m: Some(b.create_vector(&work.limits.min_edge_by_kind_m)),
        min_edge_m: work.limits.min_edge_m,
        names: Some(strings(&mut b, &names)),
        line_source: Some(b.create_vector(&source)),
        line_role: Some(b.create_vector(&role)),
        line_kind: Some(b.create_vector(&kind)),
        line_name: Some(b.create_vector(&name_of)),
        point_start: Some(b.create_vector(&offsets(all.iter().map(|l| l.points.len())))),
        points: Some(b.create_vector(&points)),
        dropped_line: Some(b.create_vector(&dropped_line)),
        dropped_reason: Some(b.create_vector(&dropped_reason)),
        dropped_from_m: Some(b.create_vector(&dropped_from)),
        dropped_to_m: Some(b.create_vector(&dropped_to)),
        words: Some(strings(&mut b, &words)),
        change_word: Some(b.create_vector(change_word)),
        change_at: Some(b.create_vector(&change_at)),
        change_moved_m: Some(b.create_vector(&change_moved)),
        tally_word: Some(b.create_vector(tally_word)),
        tally_count: Some(b.create_vector(&tally_count)),
        tally_moved_max_m: Some(b.create_vector(&tally_moved)),
        displacement_max_m: work.tally.displacement_max_m,
        displacement_p99_m: work.tally.displacement_p99_m,
        displacement_max_over_size: work.tally.displacement_max_over_size,
        displacement_p99_over_size: work.tally.displacement_p99_over_size,
        length_m: work.tally.length_m,
        length_dropped_m: work.tally.length_dropped_m,
        findings: Some(b.create_vector(&found)),
    };
    let root = lines_file::Lines::create(&mut b, &args);
    lines_file::finish_lines_buffer(&mut b, root);
    Ok(Encoded::from(b))
}
