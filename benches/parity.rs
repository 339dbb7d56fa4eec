//! Parity of synthetic networks and of real ones: proof, gap, CPU, memory; beside it HiGHS on the
//! plain form, in the same run.
//!
//! `cargo bench --bench parity [-- LARGEST] [--million] [FOLDER.polder | CASE.geojson:SIZE_M]...`: synthetic
//! networks with up to LARGEST sub-domains (default 100 000; `--smoke`: 1000; 0: none), with `--million` those
//! of a million, parity alone; and the networks of meshes, finished or made here: parity with wishes scaled to 1
//! to 20 intervals a curve (not with `--built`), patterns as built, where weights fit the wishes. Prints
//! the tables of `benches/README.md`.

use highs::HighsSolutionStatus;
use highs::RowProblem;
use highs::Sense;
use polder::chunk::reader::Mesh;
use polder::intervals::goals::Block;
use polder::intervals::goals::Goals;
use polder::parity;
use polder::parity::Options;
use polder::parity::balance::Balance;
use polder::parity::balance::Solved;
use polder::parity::check::check;
use polder::parity::check::fits;
use polder::partition::subdomains::Curve;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Partition;
use polder::partition::subdomains::Subdomain;
use polder::pipeline::build;
use polder::pipeline::job::Job;
use polder::pipeline::job::MATCH_SIDES;
use polder::pipeline::plan::parity_options;
use spade::DelaunayTriangulation;
use spade::Point2;
use spade::Triangulation;
use std::path::Path;
use std::path::PathBuf;

/// Sub-domains up to which the plain form is tried, and the seconds that HiGHS has for it: of a
/// synthetic network, of a real one at each scale.
const PLAIN_MAX: usize = 10_500;
const PLAIN_S: [f64; 2] = [10.0, 4.0];

/// Sub-domains up to which patterns are tried.
const PATTERNS_MAX: usize = 150_000;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let smoke = words.iter().any(|word| word == "--smoke");
    let default = if smoke { 1000 } else { 100_000 };
    let largest = words
        .iter()
        .find_map(|word| word.parse().ok())
        .unwrap_or(default);
    let mut sizes = vec![1_000, 10_000, 100_000];
    sizes.retain(|&size| size <= largest);
    if words.iter().any(|word| word == "--million") {
        sizes = vec![1_000_000];
    }
    println!(
        "| network | sub-domains | curves | odd share | rows | HiGHS: parts, left, rows, added, branched | events a curve | objective | bound | gap % | CPU s | bytes a curve | plain form: gap %, CPU s | patterns: blocks | all fit before, after % | four-sided before, after % | gap % | CPU s | bytes a curve |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for family in ["grid", "voronoi", "long"] {
        for &subdomains in &sizes {
            let (partition, goals) = network(family, subdomains);
            row(family, &partition, &goals, PLAIN_S[0]);
        }
    }
    let folder = std::env::temp_dir().join(format!("polder-parity-{}", std::process::id()));
    for word in &words {
        let made = match word.rsplit_once(':') {
            Some((case, size)) if case.contains(".geojson") => {
                let size_m = size.parse().expect("a size in metres");
                build_case(Path::new(case), size_m, &folder)
            }
            _ if word.ends_with(".polder") => PathBuf::from(word),
            _ => continue,
        };
        let name = made
            .file_stem()
            .map_or("?".into(), |it| it.to_string_lossy());
        let is_built = words.iter().any(|word| word == "--built");
        for intervals in [1.0, 2.0, 5.0, 10.0, 20.0] {
            let (partition, mut goals) = network_of(&made, Some(intervals));
            goals.blocks.clear();
            let name = format!("{name}, {intervals} a curve");
            if !is_built {
                row(&name, &partition, &goals, PLAIN_S[1]);
            }
        }
        let (partition, goals) = network_of(&made, None);
        row(&format!("{name} as built"), &partition, &goals, PLAIN_S[1]);
    }
    let _ = std::fs::remove_dir_all(folder);
}

/// The mesh of a case, in `folder`.
fn build_case(case: &Path, size_m: f64, folder: &Path) -> PathBuf {
    std::fs::create_dir_all(folder).expect("the temporary folder can be made");
    let name = case.file_name().expect("a file").to_string_lossy();
    let name = name.split(".geojson").next().unwrap_or("case");
    let output = folder.join(format!("{name}.polder"));
    let job = Job {
        force: true,
        ..Job::usual(case.to_path_buf(), output.clone(), size_m)
    };
    build(&job, &|_| {}).expect("a case can be built");
    output
}

fn row(name: &str, partition: &Partition, goals: &Goals, plain_s: f64) {
    let (made, seconds, bytes) = measured(partition, goals, &parity_options(0.0));
    let plain = match partition.subdomains.len() <= PLAIN_MAX {
        true => plain_form(partition, goals, &made, plain_s),
        false => "".to_string(),
    };
    let curves = partition.curves.len() as f64;
    println!(
        "| {name} | {} | {} | {:.2} | {} | {} | {:.1} | {:.3} | {:.3} | {:.4} | {seconds:.2} | {:.0} | {plain} | {} |",
        partition.subdomains.len(),
        partition.curves.len(),
        made.odd_share,
        made.cuts.value2.len(),
        said(&made.solved),
        made.events as f64 / curves,
        made.objective,
        made.bound,
        100.0 * made.gap(),
        bytes / curves,
        patterns(partition, goals, &made),
    );
}

/// What HiGHS solved, in numbers.
fn said(it: &Solved) -> String {
    let numbers = [it.parts, it.left, it.rows, it.added, it.branched];
    numbers.map(|it| it.to_string()).join(", ")
}

/// What patterns do beyond parity alone.
fn patterns(partition: &Partition, goals: &Goals, alone: &Balance) -> String {
    if goals.blocks.is_empty() || partition.subdomains.len() > PATTERNS_MAX {
        return "| | | | |".to_string();
    }
    let (both, seconds, bytes) = measured(partition, goals, &parity_options(MATCH_SIDES));
    let fits = [alone, &both].map(|it| fits(partition, goals, &it.counts));
    let share = |is_such: fn(&Block) -> bool| {
        let such: Vec<usize> = (0..goals.blocks.len())
            .filter(|&k| is_such(&goals.blocks[k]))
            .collect();
        let of = |fits: &[bool]| {
            let fit = such.iter().filter(|&&k| fits[k]).count();
            100.0 * fit as f64 / such.len().max(1) as f64
        };
        format!("{:.1}, {:.1}", of(&fits[0]), of(&fits[1]))
    };
    format!(
        "{} | {} | {} | {:.2} | {seconds:.2} | {:.0}",
        goals.blocks.len(),
        share(|_| true),
        share(|block| block.sides.len() == 4),
        100.0 * both.structure_gap(),
        bytes / partition.curves.len() as f64,
    )
}

/// The balance, the CPU seconds that it took and how much memory grew, bytes; checked.
fn measured(partition: &Partition, goals: &Goals, options: &Options) -> (Balance, f64, f64) {
    // Resets the peak of resident memory.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    let (start, memory) = (cpu_seconds(), peak_bytes());
    let made = parity::balance(partition, goals, options).expect("a feasible network");
    let (seconds, bytes) = (cpu_seconds() - start, peak_bytes() - memory);
    check(partition, goals, &made).expect("a sound balance");
    (made, seconds, bytes)
}

/// User and system time of this process so far, seconds; ticks are hundredths.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or("");
    let ticks = after_name.split_whitespace().skip(11).take(2);
    ticks.filter_map(|it| it.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn peak_bytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|it| it.strip_prefix("VmHWM:"));
    let kib = line.and_then(|it| it.trim().trim_end_matches("kB").trim().parse::<f64>().ok());
    kib.unwrap_or(0.0) * 1024.0
}

/// The form that everyone writes first: whole counts, whole halves of totals.
fn plain_form(partition: &Partition, goals: &Goals, made: &Balance, limit_s: f64) -> String {
    let mut problem = RowProblem::default();
    let mut around = vec![Vec::new(); partition.subdomains.len()];
    for (id, curve) in partition.curves.iter().enumerate() {
        let (lower, upper) = (goals.lower[id], goals.upper[id]);
        let count = problem.add_integer_column(0.0, f64::from(lower)..=f64::from(upper));
        let cost = problem.add_column(1.0, 0..);
        // Convex costs: above the chord through each two neighbouring counts.
        let near = (goals.goal[id] as u32).clamp(lower, upper);
        for n in near.saturating_sub(3).max(lower)..(near + 3).min(upper) {
            let slope = goals.cost(id, n + 1) - goals.cost(id, n);
            let at_zero = goals.cost(id, n) - slope * f64::from(n);
            problem.add_row(at_zero.., [(cost, 1.0), (count, -slope)]);
        }
        // A free line counts twice and never matters.
        for side in [curve.left, curve.right] {
            if side != OUTSIDE && curve.left != curve.right {
                around[side as usize].push((count, 1.0));
            }
        }
    }
    for mut row in around {
        row.push((problem.add_integer_column(0.0, 0..), -2.0));
        problem.add_row(0..=0, row);
    }
    let start = cpu_seconds();
    let mut model = problem.optimise(Sense::Minimise);
    model.make_quiet();
    model.set_option("threads", 1);
    model.set_option("parallel", "off");
    model.set_option("time_limit", limit_s);
    let solved = model.solve();
    let seconds = cpu_seconds() - start;
    if solved.primal_solution_status() != HighsSolutionStatus::Feasible {
        return format!("nothing found, {seconds:.1}");
    }
    let above = 100.0 * (solved.objective_value() - made.bound) / (made.objective - made.base);
    format!("{above:.2}, {seconds:.1}")
}

/// A deterministic stream of numbers in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// grid: square blocks; voronoi: cells of a jittered grid; long: ten blocks wide, streets far longer
/// one way than the other.
fn network(family: &str, subdomains: usize) -> (Partition, Goals) {
    let side = (subdomains as f64).sqrt().round() as usize;
    match family {
        "voronoi" => cells(side),
        "long" => blocks(10, subdomains / 10, [12.0, 1.5]),
        _ => blocks(side, side, [4.0, 4.0]),
    }
}

/// Curves in the making.
#[derive(Default)]
struct Network {
    partition: Partition,
    goals: Goals,
}

impl Network {
    fn push(&mut self, left: u32, right: u32, goal: f64) -> u32 {
        let id = self.partition.curves.len() as u32;
        self.partition.curves.push(Curve {
            nodes: vec![0, 1],
            edges: vec![id],
            left,
            right,
            is_seam: false,
        });
        self.goals.goal.push(goal);
        self.goals.lower.push(1);
        self.goals.upper.push((2.5 * goal).ceil() as u32 + 3);
        self.goals.weight.push(1.0);
        id
    }
}

fn blocks(wide: usize, high: usize, [east, north]: [f64; 2]) -> (Partition, Goals) {
    let mut dice = Dice((wide * high) as u64);
    let mut made = Network::default();
    let at = |x: usize, y: usize| match (1..=wide).contains(&x) && (1..=high).contains(&y) {
        true => ((y - 1) * wide + x - 1) as u32,
        false => OUTSIDE,
    };
    // The streets east and north of each cell, those of the margin included.
    let mut streets = vec![[0_u32; 2]; (wide + 1) * (high + 1)];
    for y in 0..=high {
        for x in 0..=wide {
            let (here, there) = (at(x, y), [at(x + 1, y), at(x, y + 1)]);
            for (k, long) in [north, east].into_iter().enumerate() {
                if here != OUTSIDE || there[k] != OUTSIDE {
                    let goal = long * (0.3 + 1.7 * dice.roll());
                    streets[y * (wide + 1) + x][k] = made.push(here, there[k], goal);
                }
            }
        }
    }
    for y in 1..=high {
        for x in 1..=wide {
            let [east, north] = streets[y * (wide + 1) + x];
            let west = streets[y * (wide + 1) + x - 1][0];
            let south = streets[(y - 1) * (wide + 1) + x][1];
            made.goals.blocks.push(Block {
                subdomain: at(x, y),
                sides: vec![vec![south], vec![east], vec![north], vec![west]],
            });
        }
    }
    made.partition.subdomains = vec![Subdomain::default(); wide * high];
    (made.partition, made.goals)
}

/// The dual of a Delaunay triangulation: a cell a point, a curve an edge.
fn cells(side: usize) -> (Partition, Goals) {
    let mut dice = Dice(side as u64);
    let points = (0..side * side)
        .map(|k| {
            let mut near = |at: usize| at as f64 + 0.8 * dice.roll();
            let x = near(k % side);
            Point2::new(x, near(k / side))
        })
        .collect();
    let mesh =
        DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points).expect("finite points");
    let mut made = Network::default();
    let mut curve_of = vec![0; mesh.num_undirected_edges()];
    for edge in mesh.undirected_edges() {
        let [a, b] = edge.vertices().map(|it| it.fix().index() as u32);
        let [f, g] = [edge.as_directed(), edge.as_directed().rev()].map(|it| it.face().as_inner());
        let apart = match (f, g) {
            (Some(f), Some(g)) => f.circumcenter().distance_2(g.circumcenter()).sqrt(),
            _ => 1.0,
        };
        curve_of[edge.fix().index()] = made.push(a, b, (8.0 * apart).clamp(1.0, 20.0));
    }
    let mut on_rim = vec![false; side * side];
    for edge in mesh.convex_hull() {
        on_rim[edge.from().fix().index()] = true;
        made.push(
            edge.from().fix().index() as u32,
            OUTSIDE,
            6.0 * (0.5 + dice.roll()),
        );
    }
    for cell in mesh.vertices().filter(|cell| !on_rim[cell.fix().index()]) {
        let sides: Vec<Vec<u32>> = (cell.out_edges())
            .map(|edge| vec![curve_of[edge.as_undirected().fix().index()]])
            .collect();
        let nearly_fit = |side: &Vec<u32>| made.goals.goal[side[0] as usize] > 1.5;
        if (3..=6).contains(&sides.len()) && sides.iter().all(nearly_fit) {
            let subdomain = cell.fix().index() as u32;
            made.goals.blocks.push(Block { subdomain, sides });
        }
    }
    made.partition.subdomains = vec![Subdomain::default(); side * side];
    (made.partition, made.goals)
}

/// The network of a finished mesh, its wishes scaled to so many intervals a curve on average if asked.
fn network_of(folder: &Path, intervals: Option<f64>) -> (Partition, Goals) {
    let mesh = Mesh::open(folder).expect("a finished mesh");
    let frame = mesh.frame();
    let curves = frame.left.len();
    let scale = intervals.map(|it| it * curves as f64 / frame.goal.iter().sum::<f64>());
    let mut made = Network::default();
    for curve in 0..curves {
        let goal = scale.map_or(frame.goal[curve], |it| (it * frame.goal[curve]).max(0.5));
        made.push(frame.left[curve], frame.right[curve], goal);
        if scale.is_none() || frame.lower[curve] == frame.upper[curve] {
            // A seam on the lattice stays fixed at any scale, at the count that keeps its parity.
            made.goals.goal[curve] = frame.goal[curve];
            made.goals.lower[curve] = frame.lower[curve];
            made.goals.upper[curve] = frame.upper[curve];
        }
        made.goals.weight[curve] = frame.weight[curve];
    }
    for (block, &subdomain) in
        (frame.patterns.iter()).flat_map(|it| it.block_subdomain.iter().enumerate())
    {
        let it = frame.patterns.as_ref().expect("it has a block");
        let curves = |side: u32| {
            let side = side as usize;
            let rows = it.side_start[side] as usize..it.side_start[side + 1] as usize;
            it.side_curves[rows].to_vec()
        };
        let sides = (it.block_start[block]..it.block_start[block + 1])
            .map(curves)
            .collect();
        made.goals.blocks.push(Block { subdomain, sides });
    }
    made.partition.subdomains = vec![Subdomain::default(); frame.subdomains()];
    (made.partition, made.goals)
}
