//! Phases A and B: from a file to the plan of its mesh, all that the sub-domains share.

use crate::boundary;
use crate::boundary::walks::Site;
use crate::chunk::reader::Mesh;
use crate::cleanup;
use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::Tally;
use crate::cleanup::rules::Rule;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::domain::size::SizeWish;
use crate::geometry::point::Xy;
use crate::ingest;
use crate::intervals;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::parity;
use crate::parity::balance::Balance;
use crate::parity::cuts::Cuts;
use crate::partition::subdomains::Partition;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use crate::pipeline::previous;
use crate::pipeline::progress::Stopwatch;
use crate::pipeline::refusal;
use crate::pipeline::settle::Unsettled;
use crate::pipeline::tiles;
use crate::rungs;
use crate::seams;
use crate::spill;
use crate::spill::Parked;
use std::path::Path;

/// The whole city before its sub-domains are meshed. Its size follows the input and the number of
/// nodes on curves, never the number of quads.
pub struct Plan {
    /// The line work as read.
    pub domain: Domain,
    /// Wished sizes.
    pub sizes: SizeWish,
    /// What clean-up was allowed.
    pub cleaning: cleanup::Options,
    /// What became of it: arrangement, partition, goals, counts, changes, findings.
    pub city: Parked,
    /// First global ids of nodes on curves.
    pub first: Vec<u64>,
    /// How wide each sub-domain is, metres; empty until nodes have their places ([`Plan::look_across`]).
    pub width_m: Vec<f64>,
    /// Set while nodes may still move to better places.
    pub unsettled: Option<Unsettled>,
}

impl Plan {
    /// What the walks of a sub-domain are made from.
    pub fn site(&self) -> Site<'_> {
        Site {
            domain: &self.domain,
            sizes: &self.sizes,
            arrangement: &self.city.arrangement,
            partition: &self.city.partition,
            counts: &self.city.balance.counts,
            first: &self.first,
            width_m: &self.width_m,
        }
    }

    /// Measures how wide sub-domains are, for those beside them. Trial meshes do without.
    pub fn look_across(&mut self) {
        let city = &self.city;
        self.width_m = boundary::widths_m(&self.domain, &city.arrangement, &city.partition);
    }

    /// Frees what only meshing and writing need. What is told of the build stays: counts, figures,
    /// findings.
    pub fn shed(&mut self) {
        self.domain.lines = Vec::new();
        (self.first, self.width_m) = (Vec::new(), Vec::new());
        self.city.arrangement = Arrangement::default();
        self.city.goals = Goals::default();
        (self.city.balance.counts, self.city.balance.cuts) = (Vec::new(), Cuts::default());
        self.city.changes = Vec::new();
        for curve in &mut self.city.partition.curves {
            (curve.nodes, curve.edges) = (Vec::new(), Vec::new());
        }
        for subdomain in &mut self.city.partition.subdomains {
            subdomain.walks = Vec::new();
        }
    }

    /// Quads that the areas and sizes ask for: an estimate, made before any exists.
    pub fn quads_expected(&self) -> u64 {
        let cell_m2 = self.sizes.default_m * self.sizes.default_m;
        let of = |area_m2: f64| (area_m2 / cell_m2).ceil() as u64;
        (self.city.partition.subdomains.iter())
            .map(|it| of(it.area_m2))
            .sum()
    }
}

/// The line work after phase A and clean-up.
struct Cleaned {
    arrangement: Arrangement,
    dropped: Vec<Dropped>,
    changes: Vec<Change>,
    tally: Tally,
    unsettled: Unsettled,
}

/// Makes the plan of `job`, or goes on with the one that is parked in `resume_from`.
pub(super) fn plan(
    job: &Job,
    watch: &Stopwatch,
    resume_from: Option<&Path>,
) -> Result<Plan, Error> {
    let mut findings = Vec::new();
    let (domain, left) = read(job, watch, &mut findings)?;
    let sizes = sizes(job, &domain)?;
    let cleaning = cleanup::Options {
        left,
        ..cleaning(job, &domain)?
    };
    let parked = resume_from.and_then(|folder| spill::fetch(folder, &key(job, &domain)));
    let (city, unsettled) = match parked {
        Some(city) => (city, None),
        None => {
            let (city, unsettled) = city(job, &domain, &sizes, &cleaning, watch, findings)?;
            (city, Some(unsettled))
        }
    };
    let points = city.arrangement.points.len();
    let first = boundary::numbering(&city.partition, &city.balance.counts, points);
    let nodes = first[first.len() - 1];
    if nodes >= u64::from(u32::MAX) {
        return Err(Error::Job(format!(
            "{nodes} nodes on lines do not fit 32 bits: choose a larger size or split the domain"
        )));
    }
    Ok(Plan {
        domain,
        sizes,
        cleaning,
        city,
        first,
        width_m: Vec::new(),
        unsettled,
    })
}

/// Whose plan it is: the version, the input's bytes, the options that change the result, the mesh before.
pub(super) fn key(job: &Job, domain: &Domain) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let of = |mesh: Mesh| {
        mesh.index()
            .files
            .iter()
            .map(|it| it.2)
            .collect::<Vec<u32>>()
    };
    let before = (job.previous.as_ref()).and_then(|mesh| Mesh::open(mesh).ok().map(of));
    format!("{version} {:016x} {} {before:?}", domain.digest, job.echo())
}

/// Phases A and B.
fn city(
    job: &Job,
    domain: &Domain,
    sizes: &SizeWish,
    cleaning: &cleanup::Options,
    watch: &Stopwatch,
    mut findings: Vec<Finding>,
) -> Result<(Parked, Unsettled), Error> {
    let cleaned = clean(job, domain, sizes, cleaning, watch, &mut findings)?;
    let (arrangement, partition) = cut(
        job,
        domain,
        sizes,
        cleaned.arrangement,
        watch,
        &mut findings,
    )?;
    let (goals, balance) = balance(job, domain, sizes, &arrangement, &partition, watch)?;
    let city = Parked {
        arrangement,
        partition,
        goals,
        balance,
        dropped: cleaned.dropped,
        changes: cleaned.changes,
        tally: cleaned.tally,
        findings,
    };
    Ok((city, cleaned.unsettled))
}

/// The line work, and the places that an earlier clean-up had to leave, if there was one.
fn read(
    job: &Job,
    watch: &Stopwatch,
    findings: &mut Vec<Finding>,
) -> Result<(Domain, Option<Vec<Xy>>), Error> {
    watch.stage("ingest", 1, |_| {
        let options = ingest::Options {
            cell_m: job.cell_m,
            crs: job.crs,
        };
        let read = ingest::read(&job.input, &options)?;
        let note = format!(
            "{} lines, {} points",
            read.domain.lines.len(),
            read.points_read
        );
        findings.extend(read.findings);
        Ok(((read.domain, read.left), note))
    })
}

/// The row of a kind that the job's `table` names.
fn row_of_kind(domain: &Domain, table: &str, kind: &str) -> Result<usize, Error> {
    let known = domain.kinds.iter().position(|it| it == kind);
    known.ok_or_else(|| {
        let named = domain.kinds.iter().filter(|it| !it.is_empty());
        let named: Vec<&str> = named.map(String::as_str).collect();
        Error::Job(format!(
            "{table}.{kind}: the input has no lines of this kind; it has {}",
            named.join(", ")
        ))
    })
}

/// What clean-up may do, by the kinds that the input has.
fn cleaning(job: &Job, domain: &Domain) -> Result<cleanup::Options, Error> {
    let mut by_kind = vec![Rule::FREE; domain.kinds.len()];
    for (kind, rule) in &job.rules {
        by_kind[row_of_kind(domain, "kinds", kind)?] = *rule;
    }
    Ok(cleanup::Options {
        tolerance: job.tolerance(),
        by_kind,
        min_edge: job.min_edge(),
        left: None,
        corner_deg: job.corner_deg,
        without: job.without.clone(),
    })
}

/// The sizes of the job, by the kinds that the input has.
fn sizes(job: &Job, domain: &Domain) -> Result<SizeWish, Error> {
    let mut sizes = SizeWish::uniform(job.size_m, domain.kinds.len());
    for (kind, size_m) in &job.sizes_m {
        sizes.by_kind_m[row_of_kind(domain, "sizes", kind)?] = *size_m;
    }
    for (kind, rows) in &job.rows {
        sizes.rows_by_kind[row_of_kind(domain, "kinds", kind)?] = *rows;
    }
    let rim = (domain.lines.iter()).filter(|it| it.role == Role::Boundary);
    let points = || rim.clone().flat_map(|it| &it.points);
    let span = |low: Option<i32>, high: Option<i32>| {
        (f64::from(high.unwrap_or(0)) - f64::from(low.unwrap_or(0))) * domain.grid.cell_m
    };
    let width_m = span(points().map(|p| p.x).min(), points().map(|p| p.x).max());
    let height_m = span(points().map(|p| p.y).min(), points().map(|p| p.y).max());
    let side_m = width_m.min(height_m);
    if 2.0 * job.size_m > side_m {
        return Err(Error::Job(format!(
            "size {} m is too large for a domain of {width_m:.3} m x {height_m:.3} m: at least two elements must fit, so at most {:.3}",
            job.size_m,
            side_m / 2.0
        )));
    }
    Ok(sizes)
}

fn clean(
    job: &Job,
    domain: &Domain,
    sizes: &SizeWish,
    options: &cleanup::Options,
    watch: &Stopwatch,
    findings: &mut Vec<Finding>,
) -> Result<Cleaned, Error> {
    let tile_cells = tiles::tile_cells(job, domain);
    let (noded, clipped) = watch.stage("noding", 1000, |count| -> Result<_, Error> {
        let (noded, clipped) = tiles::node(domain, tile_cells, count);
        let note = format!("{} nodes, {} edges", noded.points.len(), noded.edges.len());
        Ok(((noded, clipped), note))
    })?;
    let before = noded.clone();
    let cleaned = watch.stage("cleanup", 1000, |count| -> Result<_, Error> {
        let made = tiles::clean(domain, sizes, noded, options, count);
        let mut dropped: Vec<Dropped> = clipped.iter().map(clipped_stretch).collect();
        dropped.extend(made.dropped);
        let cleaned = Cleaned {
            arrangement: made.arrangement,
            dropped,
            changes: made.changes,
            tally: made.tally,
            unsettled: Unsettled {
                left: made.findings,
                may_move: made.was_on,
            },
        };
        let note = format!(
            "{} nodes, {} edges; moved at most {:.2} m",
            cleaned.arrangement.points.len(),
            cleaned.arrangement.edges.len(),
            cleaned.tally.displacement_max_m
        );
        Ok((cleaned, note))
    })?;
    watch.stage("rooms", 1, |_| -> Result<_, Error> {
        let lost = cleanup::rooms::lost(domain, sizes, options, &before, &cleaned.arrangement);
        let note = format!("{} sub-domains with room for elements lost", lost.len());
        findings.extend(lost);
        Ok(((), note))
    })?;
    Ok(cleaned)
}

fn clipped_stretch(piece: &Piece) -> Dropped {
    Dropped {
        line: piece.line,
        reason: Reason::Clipped,
        from_m: piece.from_m.min(piece.to_m),
        to_m: piece.from_m.max(piece.to_m),
    }
}

/// Partition, seams through what is too large, and the partition with them.
fn cut(
    job: &Job,
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    watch: &Stopwatch,
    findings: &mut Vec<Finding>,
) -> Result<(Arrangement, Partition), Error> {
    let tile_cells = tiles::tile_cells(job, domain);
    let partition = watch.stage("partition", 1, |_| -> Result<_, Error> {
        let made = tiles::partition(domain, &arrangement, tile_cells, job.corner_deg)?;
        let note = format!(
            "{} sub-domains, {} curves",
            made.subdomains.len(),
            made.curves.len()
        );
        Ok((made, note))
    })?;
    let recut = |given, laid: u64, what: &str, with: Arrangement| -> Result<_, Error> {
        if laid == 0 {
            return Ok((given, "none needed".to_string()));
        }
        let parts = tiles::partition(domain, &with, tile_cells, job.corner_deg)?;
        let note = format!("{laid} {what}, {} sub-domains", parts.subdomains.len());
        Ok(((with, parts), note))
    };
    let (arrangement, partition) = watch.stage("seams", 1, |_| {
        let options = seams::Options {
            budget_quads: f64::from(job.seam_budget_quads),
        };
        let seamed = seams::cut(domain, sizes, &arrangement, &partition, &options);
        findings.extend(seamed.findings);
        let given = (arrangement, partition);
        recut(given, seamed.cuts, "seam edges", seamed.arrangement)
    })?;
    watch.stage("rungs", 1, |_| {
        let options = rungs::Options {
            longest: job.longest_rung,
            corner_deg: job.corner_deg,
        };
        let runged = rungs::lay(domain, sizes, &arrangement, &partition, &options);
        let given = (arrangement, partition);
        recut(given, runged.rungs, "rungs", runged.arrangement)
    })
}

fn balance(
    job: &Job,
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    partition: &Partition,
    watch: &Stopwatch,
) -> Result<(Goals, Balance), Error> {
    watch.stage("parity", 1, |_| {
        let options = intervals::Options {
            corner_deg: job.corner_deg,
            upper_ratio: 2.5,
            block_ratio: 2.2,
            least_edge: job.min_edge(),
        };
        let goals = intervals::plan(domain, sizes, arrangement, partition, &options);
        let before = match &job.previous {
            Some(mesh) => {
                let mesh = Mesh::open(mesh).map_err(|it| Error::Job(format!("previous: {it}")))?;
                previous::counts(&mesh, domain, arrangement, partition)
            }
            None => Vec::new(),
        };
        let balance =
            parity::balance_near(partition, &goals, &before, &parity_options(job.match_sides))
                .map_err(|it| refusal::explain(it, domain, arrangement, partition))?;
        let fit = &balance.structure;
        let note = format!(
            "gap {:.4} %; {} of {} blocks fit a pattern ({} without the wish), gap {:.2} %",
            100.0 * balance.gap(),
            fit.mapped,
            fit.blocks,
            fit.mapped_before,
            100.0 * balance.structure_gap()
        );
        Ok(((goals, balance), note))
    })
}

/// What the integer programme may do: enough for a gap of one per cent, in up to two fifths of a build (on one
/// core: 19 of 48 s at 350 000 segments, 17 of 53 s at 10M quads).
/// Where the climb ends above that, HiGHS improves so many neighbourhoods, the worst first, until it is enough: a
/// hundred are ten times as dear as four rounds more of the climb.
pub fn parity_options(match_sides: f64) -> parity::Options {
    parity::Options {
        events_max: 1 << 31,
        nodes_max: 1000,
        rows_max: 60_000,
        worth: match_sides,
        rounds_max: 20,
        climb_max: 20,
        gap_enough: 0.01,
        neighbourhoods_max: 250,
    }
}
