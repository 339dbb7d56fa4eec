//! A mesh on disk -> its report: what is drawn and tabled, from the output alone.

use crate::check;
use crate::check::quality::Histogram;
use crate::check::quality::Place;
use crate::check::quality::Quality;
use crate::check::verdict::Verdict;
use crate::chunk::moves;
use crate::chunk::reader::Mesh;
use crate::cleanup::changes::Reason;
use crate::export;
use crate::geometry::point::Xy;
use crate::meshing::patch::Method;
use crate::pipeline::counts;
use crate::pipeline::error::Error;
use crate::pipeline::log::Log;
use crate::report::html::html;
use crate::report::page;
use crate::report::page::Page;
use crate::report::page::Plate;
use crate::report::page::Table;
use crate::report::picture::Ink;
use crate::report::picture::Picture;
use std::path::Path;

/// Width and height of a picture, pixels.
const WIDE: u32 = 1160;
const TALL: u32 = 820;

/// How much a zoom shows, in sizes across.
const ZOOM_SIZES: f64 = 36.0;

/// Checks `mesh`, writes the page to `out` and its pictures to `picture`; true if every promise
/// holds.
pub fn report(mesh: &Mesh, out: &Path, picture: &Path) -> Result<bool, Error> {
    let verdict = check::check(mesh, &check::OPTIONS);
    let views = views(mesh, &verdict.quality);
    let pictures = draw(mesh, &views)?;
    let plates = (views.iter().zip(&pictures))
        .map(|(view, picture)| Plate {
            caption: view.caption.clone(),
            png: picture.png(),
        })
        .collect();
    let name = mesh
        .dir()
        .file_name()
        .map_or("mesh".into(), |it| it.to_string_lossy());
    let page = Page {
        title: name.into_owned(),
        verdict: verdict_line(&verdict),
        holds: verdict.holds(),
        plates,
        histograms: histograms(&verdict.quality),
        tables: tables(mesh, &verdict),
    };
    let refused = |path: &Path, it| Error::Write(path.to_path_buf(), it);
    std::fs::write(out, html(&page)).map_err(|it| refused(out, it))?;
    std::fs::write(picture, Picture::sheet_png(&pictures, 2)).map_err(|it| refused(picture, it))?;
    Ok(verdict.holds())
}

/// One picture to draw.
struct View {
    caption: String,
    /// Local metres.
    centre_m: Xy,
    span_m: Xy,
    /// A ring around the place in question.
    mark: bool,
}

/// The whole mesh, the worst cell, the smallest cell (the densest spot) and a random place.
fn views(mesh: &Mesh, quality: &Quality) -> Vec<View> {
    let index = mesh.index();
    let [x0, y0, x1, y1] = index.box_m;
    let whole = View {
        caption: format!(
            "The whole mesh: {} quads over {:.2} km x {:.2} km. Green: squares; red: scaled Jacobian below 0.3",
            index.quads,
            (x1 - x0) / 1e3,
            (y1 - y0) / 1e3
        ),
        centre_m: [0.5 * (x0 + x1), 0.5 * (y0 + y1)],
        span_m: [1.02 * (x1 - x0).max(1e-3), 1.02 * (y1 - y0).max(1e-3)],
        mark: false,
    };
    let span = ZOOM_SIZES * index.size_m;
    let origin = index.grid.origin_m;
    let zoom = |caption: String, at_m: Xy, mark: bool| View {
        caption: format!("{caption} at {:.2} {:.2}", at_m[0], at_m[1]),
        centre_m: [at_m[0] - origin[0], at_m[1] - origin[1]],
        span_m: [span, span * f64::from(TALL) / f64::from(WIDE)],
        mark,
    };
    let mut views = vec![whole];
    if let Some(worst) = quality.worst.first() {
        let caption = format!(
            "The worst cell, scaled Jacobian {:.3},",
            worst.scaled_jacobian
        );
        views.push(zoom(caption, worst.centre_m(), true));
    }
    if let Some(least) = quality.smallest.first() {
        let caption = format!("The densest spot, least cell {:.3} m,", least.hydraulic_m);
        views.push(zoom(caption, least.centre_m(), true));
    }
    // "Random" but the same every time: a node on a line, picked by the input's digest.
    let nodes = mesh.frame().nodes;
    let pick = nodes[(index.input_digest % nodes.len().max(1) as u64) as usize];
    let at_m = [pick[0] + origin[0], pick[1] + origin[1]];
    views.push(zoom("A random place".into(), at_m, false));
    views
}

fn draw(mesh: &Mesh, views: &[View]) -> Result<Vec<Picture>, Error> {
    let mut pictures: Vec<Picture> = (views.iter())
        .map(|view| Picture::new(view.centre_m, view.span_m, WIDE, TALL))
        .collect();
    let frame = mesh.frame();
    let mut places = Vec::new();
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        for patch in chunk.view().patches() {
            patch.place_into(frame.nodes, &mut places);
            for quad in patch.quads {
                let corners = quad.map(|node| places[node as usize]);
                for picture in &mut pictures {
                    picture.cell(&corners);
                }
            }
        }
    }
    for curve in 0..frame.curves() {
        let nodes = frame.nodes_of(curve).iter();
        let points: Vec<Xy> = nodes.map(|&node| frame.nodes[node as usize]).collect();
        let ink = match (frame.is_rim(curve), frame.is_seam(curve)) {
            (true, _) => Ink::Rim,
            (_, true) => Ink::Seam,
            _ => Ink::Line,
        };
        for picture in &mut pictures {
            picture.line(&points, ink);
        }
    }
    for (view, picture) in views.iter().zip(&mut pictures) {
        if view.mark {
            picture.ring(view.centre_m, 26.0);
        }
    }
    Ok(pictures)
}

fn verdict_line(verdict: &Verdict) -> String {
    let broken: Vec<&str> = verdict.broken().map(|it| it.name).collect();
    match broken.is_empty() {
        true => format!(
            "Every promise holds ({} checked from the output alone).",
            verdict.promises.len()
        ),
        false => format!("Broken promises: {}.", broken.join(", ")),
    }
}

fn histograms(quality: &Quality) -> Vec<page::Histogram> {
    let shown = |title: &str, of: &Histogram, from: f64, to: f64, bins: usize| {
        let width = (of.high - of.low) / of.bins.len() as f64;
        let mut counts = vec![0; bins];
        for (n, &count) in of.bins.iter().enumerate() {
            let at = (of.low + (n as f64 + 0.5) * width - from) / (to - from) * bins as f64;
            counts[(at.max(0.0) as usize).min(bins - 1)] += count;
        }
        page::Histogram {
            title: title.into(),
            from,
            to,
            counts,
        }
    };
    vec![
        shown(
            "Scaled Jacobian of each cell",
            &quality.scaled_jacobian,
            0.0,
            1.0,
            50,
        ),
        shown("Corner angles, degrees", &quality.angle_deg, 0.0, 180.0, 60),
        shown(
            "Edge length over size",
            &quality.edge_over_size,
            0.0,
            3.0,
            60,
        ),
        shown(
            "4 area / perimeter over size",
            &quality.hydraulic_over_size,
            0.0,
            2.0,
            50,
        ),
    ]
}

fn tables(mesh: &Mesh, verdict: &Verdict) -> Vec<Table> {
    let mut tables = vec![
        figures(mesh, verdict),
        promises(verdict),
        methods(&verdict.quality),
    ];
    let counts = counts::rows(mesh);
    if !counts.is_empty() {
        tables.push(table(
            "Interval counts",
            "Costs in relative deviations from the wish; each bound is recomputed from its proof (promises).",
            &["figure", "value"],
            counts.into_iter().map(Vec::from).collect(),
        ));
    }
    if let Some(log) = Log::read(mesh.dir()) {
        let rows = (log.stages.into_iter())
            .map(|it| vec![it.stage, format!("{:.2}", it.seconds), it.note])
            .collect();
        tables.push(table("Stages", "", &["stage", "seconds", "made"], rows));
    }
    tables.push(places(
        "The 20 worst cells",
        "By scaled Jacobian.",
        &verdict.quality.worst,
    ));
    tables.push(places(
        "The 20 smallest cells",
        "They set an explicit time step.",
        &verdict.quality.smallest,
    ));
    tables.push(changes(mesh));
    tables.push(findings(mesh));
    tables
}

fn table(title: &str, note: &str, head: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table {
        title: title.into(),
        note: note.into(),
        head: head.iter().map(|it| it.to_string()).collect(),
        rows,
    }
}

/// Speed of a long wave on 2 m of water plus a current of 1 m/s, m/s: for the time step.
const WAVE_M_S: f64 = 5.43;

fn figures(mesh: &Mesh, verdict: &Verdict) -> Table {
    let (index, q) = (mesh.index(), &verdict.quality);
    let step_s = 0.5 * q.hydraulic_min_m / WAVE_M_S;
    let ideal_s = 0.5 * index.size_m / WAVE_M_S;
    let row = |name: &str, value: String| vec![name.to_string(), value];
    let epsg = index.epsg.map_or("none".into(), |it| it.to_string());
    let rows = vec![
        row("EPSG code", epsg),
        row("size wished, m", format!("{}", index.size_m)),
        row("tolerance, m", format!("{}", index.tolerance_m)),
        row("quads", format!("{}", index.quads)),
        row(
            "quads over area / size²",
            format!("{:.3}", index.quads as f64 / q.quads_wished),
        ),
        row(
            "scaled Jacobian: mean, 5 %, 1 %, least",
            format!(
                "{:.3}, {:.3}, {:.3}, {:.3}",
                q.scaled_jacobian.mean(),
                q.scaled_jacobian.quantile(0.05),
                q.scaled_jacobian.quantile(0.01),
                q.scaled_jacobian.min
            ),
        ),
        row(
            "irregular interior nodes",
            format!("{:.2} %", 100.0 * q.irregular()),
        ),
        row(
            "0.1 % quantile of edge / size",
            format!("{:.3}", q.edge_over_size.quantile(0.001)),
        ),
        row(
            "0.1 % quantile of 4 area / perimeter / size",
            format!("{:.3}", q.hydraulic_over_size.quantile(0.001)),
        ),
        row(
            "explicit time step, s (Courant 0.5, 2 m of water, 1 m/s)",
            format!("{step_s:.3} (of {ideal_s:.3} if all were squares)"),
        ),
        row(
            "lines moved at most, m (99 % below)",
            format!(
                "{:.3} ({:.3})",
                mesh.lines().displacement_max_m,
                mesh.lines().displacement_p99_m
            ),
        ),
        row(
            "the same over the size",
            format!(
                "{:.3} ({:.3})",
                mesh.lines().displacement_max_over_size,
                mesh.lines().displacement_p99_over_size
            ),
        ),
        row(
            "length dropped, m",
            format!(
                "{:.1} of {:.0}",
                mesh.lines().length_dropped_m,
                mesh.lines().length_m
            ),
        ),
    ];
    table("Figures", "", &["figure", "value"], rows)
}

fn promises(verdict: &Verdict) -> Table {
    let rows = (verdict.promises.iter())
        .map(|it| {
            let word = if it.holds() {
                "holds".to_string()
            } else {
                format!("BROKEN x {}", it.broken)
            };
            let first = it.defects.first().map_or(String::new(), |d| d.text.clone());
            vec![it.name.to_string(), word, it.found.clone(), first]
        })
        .collect();
    table(
        "Promises",
        "Verified from the output alone.",
        &["promise", "", "found", "first defect"],
        rows,
    )
}

fn methods(quality: &Quality) -> Table {
    let all: u64 = quality.methods.iter().map(|it| it.quads).sum();
    let rows = (Method::NAMES.iter().zip(&quality.methods))
        .filter(|(_, it)| it.subdomains > 0)
        .map(|(name, it)| {
            vec![
                name.replace('_', " "),
                it.subdomains.to_string(),
                it.quads.to_string(),
                format!("{:.2} %", 100.0 * it.quads as f64 / all.max(1) as f64),
                format!("{:.3}", it.scaled_jacobian_sum / it.quads.max(1) as f64),
                format!("{:.3}", it.scaled_jacobian_min),
            ]
        })
        .collect();
    let head = [
        "method",
        "sub-domains",
        "quads",
        "share",
        "mean scaled Jacobian",
        "least",
    ];
    let last = quality.last_resort;
    let note = format!(
        "The last resort made {} quads ({:.3} %) in {} sub-domains, holes in patches of other \
         methods included.",
        last.quads,
        100.0 * last.quads as f64 / all.max(1) as f64,
        last.subdomains
    );
    table("Methods", &note, &head, rows)
}

fn places(title: &str, note: &str, places: &[Place]) -> Table {
    let rows = (places.iter())
        .map(|it| {
            let [x, y] = it.centre_m();
            vec![
                format!("{x:.2}"),
                format!("{y:.2}"),
                format!("{:.3}", it.scaled_jacobian),
                format!("{:.3}", it.hydraulic_m),
                it.subdomain.to_string(),
                Method::NAMES[usize::from(it.method).min(4)].replace('_', " "),
            ]
        })
        .collect();
    let head = [
        "x, m",
        "y, m",
        "scaled Jacobian",
        "4 area / perimeter, m",
        "sub-domain",
        "method",
    ];
    table(title, note, &head, rows)
}

/// Count, length and largest displacement of one kind of change.
#[derive(Default)]
struct Sum {
    count: u64,
    length_m: f64,
    moved_m: f64,
}

impl Sum {
    fn row(&self, what: &str) -> Vec<String> {
        let metres = |value: f64, digits: usize| match value > 0.0 {
            true => format!("{value:.digits$}"),
            false => String::new(),
        };
        vec![
            what.to_string(),
            self.count.to_string(),
            metres(self.length_m, 1),
            metres(self.moved_m, 3),
        ]
    }
}

fn changes(mesh: &Mesh) -> Table {
    let lines = mesh.lines();
    let [mut merged, mut moved] = [Sum::default(), Sum::default()];
    for it in moves::moves(mesh, export::MOVED_LEAST * mesh.index().size_m) {
        let sum = match it.merged_with.is_empty() {
            true => &mut moved,
            false => &mut merged,
        };
        sum.count += 1;
        sum.length_m += it.to_m - it.from_m;
        sum.moved_m = sum.moved_m.max(it.moved_m);
    }
    let mut rows = vec![
        merged.row("stretches merged with another line"),
        moved.row("other stretches moved by more than a tenth of the size"),
    ];
    for (reason, word) in (0..).zip(Reason::WORDS) {
        let mut sum = Sum::default();
        for row in (0..lines.dropped_line.len()).filter(|&it| lines.dropped_reason[it] == reason) {
            sum.count += 1;
            sum.length_m += lines.dropped_to_m[row] - lines.dropped_from_m[row];
        }
        if sum.count > 0 {
            rows.push(sum.row(&format!("dropped: {word}")));
        }
    }
    rows.extend(lines.tally().map(|(what, count, moved_m)| {
        let sum = Sum {
            count,
            moved_m,
            ..Sum::default()
        };
        sum.row(what)
    }));
    let note = "What clean-up did: stretches of lines first, then its operations. The layer of \
                `polder export --format changes` has each with its place, its lines and how far it \
                moved; what was merged or moved before and after.";
    table(
        "What was changed",
        note,
        &["change", "number", "length, m", "moved at most, m"],
        rows,
    )
}

/// Findings are many on real data: the first of each kind are shown, all are counted.
const FINDINGS_SHOWN: usize = 12;

fn findings(mesh: &Mesh) -> Table {
    let mut all: Vec<_> = mesh.lines().findings().collect();
    all.sort_by(|a, b| a.what.cmp(b.what));
    let mut rows = Vec::new();
    for kind in all.chunk_by(|a, b| a.what == b.what) {
        for it in kind.iter().take(FINDINGS_SHOWN) {
            let place = it
                .at_m
                .map_or(String::new(), |p| format!("{:.2} {:.2}", p[0], p[1]));
            let feature = it.feature.map_or(String::new(), |f| f.to_string());
            rows.push(vec![
                it.what.to_string(),
                it.text.to_string(),
                feature,
                place,
            ]);
        }
        if kind.len() > FINDINGS_SHOWN {
            let more = format!("and {} more", kind.len() - FINDINGS_SHOWN);
            rows.push(vec![
                kind[0].what.to_string(),
                more,
                String::new(),
                String::new(),
            ]);
        }
    }
    table("Findings", "", &["finding", "", "feature", "place"], rows)
}
