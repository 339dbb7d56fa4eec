//! Private mirrors of the core types, for bincode alone: a serialisable type is a promise, and
//! core types make none.

use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::Tally;
use crate::domain::finding::Finding;
use crate::geometry::point::Point;
use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::parity::balance::Balance;
use crate::parity::balance::Solved;
use crate::parity::balance::Structure;
use crate::parity::cuts::Cuts;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;
use crate::spill::Parked;
use bincode::Decode;
use bincode::Encode;

/// Nodes, edges, start and end of chain, left, right, seam.
type CurveRow = (Vec<u32>, Vec<u32>, u32, u32, bool);

/// Line, from, to.
type Stretch = (u32, f64, f64);

/// Rows of word, count, displacement; then the figures.
type TallyRow = (Vec<(String, u64, f64)>, [f64; 6], [u64; 2]);

/// Word, sentence, feature, place.
type FindingRow = (String, String, Option<u32>, Option<[f64; 2]>);

#[derive(Encode, Decode)]
pub(super) struct Plan {
    points: Vec<(i32, i32)>,
    edges: Vec<[u32; 2]>,
    piece_start: Vec<u32>,
    pieces: Vec<Stretch>,
    curves: Vec<CurveRow>,
    subdomains: Vec<(Vec<Vec<u32>>, f64)>,
    goals: (Vec<f64>, Vec<u32>, Vec<u32>, Vec<f64>),
    blocks: Vec<(u32, Vec<Vec<u32>>)>,
    balance: BalanceRow,
    dropped: Vec<(Stretch, u8)>,
    changes: Vec<(String, i32, i32, f64)>,
    tally: TallyRow,
    findings: Vec<FindingRow>,
}

#[derive(Encode, Decode)]
struct StructureRow {
    /// Blocks, mapped before, mapped; rounds, improved.
    numbers: [u32; 5],
    /// Worth, price, bound.
    costs: [f64; 3],
    solved: SolvedRow,
    multipliers: Vec<i64>,
    parent: Vec<u32>,
    value2: Vec<i64>,
    set_of: Vec<u32>,
}

/// Parts, left, rows, columns, added, branched; claimed.
#[derive(Encode, Decode)]
struct SolvedRow([u32; 6], Option<f64>);

#[derive(Encode, Decode)]
struct BalanceRow {
    counts: Vec<u32>,
    costs: [f64; 4],
    structure: StructureRow,
    proven: bool,
    odd_share: f64,
    odd_subdomains: u32,
    solved: SolvedRow,
    events: u64,
    parent: Vec<u32>,
    value2: Vec<i64>,
    set_of: Vec<u32>,
}

/// Reasons by number; the order of `Reason`.
const REASONS: [Reason; 5] = [
    Reason::Clipped,
    Reason::ShortEnd,
    Reason::SmallLoop,
    Reason::BeyondTolerance,
    Reason::Shrunk,
];

impl Plan {
    pub(super) fn of(plan: &Parked) -> Plan {
        let arrangement = &plan.arrangement;
        let curve = |it: &Curve| {
            (
                it.nodes.clone(),
                it.edges.clone(),
                it.left,
                it.right,
                it.is_seam,
            )
        };
        let goals = plan.goals.clone();
        Plan {
            points: arrangement.points.iter().map(|p| (p.x, p.y)).collect(),
            edges: arrangement.edges.clone(),
            piece_start: arrangement.piece_start.clone(),
            pieces: arrangement
                .pieces
                .iter()
                .map(|p| (p.line, p.from_m, p.to_m))
                .collect(),
            curves: plan.partition.curves.iter().map(curve).collect(),
            subdomains: (plan.partition.subdomains.iter())
                .map(|it| (it.walks.clone(), it.area_m2))
                .collect(),
            goals: (goals.goal, goals.lower, goals.upper, goals.weight),
            blocks: (goals.blocks.into_iter())
                .map(|it| (it.subdomain, it.sides))
                .collect(),
            balance: BalanceRow::of(&plan.balance),
            dropped: (plan.dropped.iter())
                .map(|it| ((it.line, it.from_m, it.to_m), it.reason as u8))
                .collect(),
            changes: (plan.changes.iter())
                .map(|it| (it.what.into(), it.at.x, it.at.y, it.moved_m))
                .collect(),
            tally: tally_row(&plan.tally),
            findings: (plan.findings.iter())
                .map(|it| (it.what.into(), it.text.clone(), it.feature, it.at_m))
                .collect(),
        }
    }

    /// The plan, or nothing if a number in it has no meaning.
    pub(super) fn into_parked(self) -> Option<Parked> {
        let mut words = Words::default();
        let stretch = |(line, from_m, to_m): Stretch| Piece { line, from_m, to_m };
        let dropped = (self.dropped.into_iter())
            .map(|((line, from_m, to_m), reason)| {
                let reason = *REASONS.get(usize::from(reason))?;
                Some(Dropped {
                    line,
                    reason,
                    from_m,
                    to_m,
                })
            })
            .collect::<Option<Vec<_>>>()?;
        Some(Parked {
            arrangement: Arrangement {
                points: self
                    .points
                    .into_iter()
                    .map(|(x, y)| Point::new(x, y))
                    .collect(),
                edges: self.edges,
                piece_start: self.piece_start,
                pieces: self.pieces.into_iter().map(stretch).collect(),
            },
            partition: partition(self.curves, self.subdomains),
            goals: Goals {
                goal: self.goals.0,
                lower: self.goals.1,
                upper: self.goals.2,
                weight: self.goals.3,
                blocks: (self.blocks.into_iter())
                    .map(|(subdomain, sides)| Block { subdomain, sides })
                    .collect(),
            },
            balance: self.balance.into_balance(),
            dropped,
            changes: (self.changes.into_iter())
                .map(|(what, x, y, moved_m)| Change {
                    what: words.lasting(&what),
                    at: Point::new(x, y),
                    moved_m,
                })
                .collect(),
            tally: tally(self.tally, &mut words),
            findings: (self.findings.into_iter())
                .map(|(what, text, feature, at_m)| Finding {
                    what: words.lasting(&what),
                    text,
                    feature,
                    at_m,
                })
                .collect(),
        })
    }
}

fn tally_row(tally: &Tally) -> TallyRow {
    let row = |it: &(&'static str, u64, f64)| (it.0.into(), it.1, it.2);
    (
        tally.rows.iter().map(row).collect(),
        [
            tally.displacement_max_m,
            tally.displacement_p99_m,
            tally.displacement_max_over_size,
            tally.displacement_p99_over_size,
            tally.length_m,
            tally.length_dropped_m,
        ],
        tally.sharp_angles,
    )
}

fn tally((rows, figures, sharp_angles): TallyRow, words: &mut Words) -> Tally {
    let row = |(what, count, moved_m): (String, u64, f64)| (words.lasting(&what), count, moved_m);
    let [
        displacement_max_m,
        displacement_p99_m,
        displacement_max_over_size,
        displacement_p99_over_size,
        length_m,
        length_dropped_m,
    ] = figures;
    Tally {
        rows: rows.into_iter().map(row).collect(),
        displacement_max_m,
        displacement_p99_m,
        displacement_max_over_size,
        displacement_p99_over_size,
        length_m,
        length_dropped_m,
        sharp_angles,
    }
}

fn partition(curves: Vec<CurveRow>, subdomains: Vec<(Vec<Vec<u32>>, f64)>) -> Partition {
    let curve = |(nodes, edges, left, right, is_seam): CurveRow| Curve {
        nodes,
        edges,
        left,
        right,
        is_seam,
    };
    let subdomain = |(walks, area_m2)| Subdomain { walks, area_m2 };
    Partition {
        curves: curves.into_iter().map(curve).collect(),
        subdomains: subdomains.into_iter().map(subdomain).collect(),
    }
}

impl SolvedRow {
    fn of(it: &Solved) -> SolvedRow {
        let numbers = [
            it.parts,
            it.left,
            it.rows,
            it.columns,
            it.added,
            it.branched,
        ];
        SolvedRow(numbers, it.claimed)
    }

    fn into_solved(self) -> Solved {
        let [parts, left, rows, columns, added, branched] = self.0;
        Solved {
            parts,
            left,
            rows,
            columns,
            added,
            branched,
            claimed: self.1,
        }
    }
}

impl StructureRow {
    fn of(it: &Structure) -> StructureRow {
        StructureRow {
            numbers: [
                it.blocks,
                it.mapped_before,
                it.mapped,
                it.rounds,
                it.improved,
            ],
            costs: [it.worth, it.price, it.bound],
            solved: SolvedRow::of(&it.solved),
            multipliers: it.multipliers.clone(),
            parent: it.cuts.parent.clone(),
            value2: it.cuts.value2.clone(),
            set_of: it.cuts.set_of.clone(),
        }
    }

    fn into_structure(self) -> Structure {
        let [blocks, mapped_before, mapped, rounds, improved] = self.numbers;
        let [worth, price, bound] = self.costs;
        Structure {
            blocks,
            mapped_before,
            mapped,
            worth,
            price,
            bound,
            rounds,
            improved,
            solved: self.solved.into_solved(),
            multipliers: self.multipliers,
            cuts: Cuts {
                parent: self.parent,
                value2: self.value2,
                set_of: self.set_of,
            },
        }
    }
}

impl BalanceRow {
    fn of(it: &Balance) -> BalanceRow {
        BalanceRow {
            counts: it.counts.clone(),
            costs: [it.base, it.objective, it.optimum, it.bound],
            structure: StructureRow::of(&it.structure),
            proven: it.proven,
            odd_share: it.odd_share,
            odd_subdomains: it.odd_subdomains,
            solved: SolvedRow::of(&it.solved),
            events: it.events,
            parent: it.cuts.parent.clone(),
            value2: it.cuts.value2.clone(),
            set_of: it.cuts.set_of.clone(),
        }
    }

    fn into_balance(self) -> Balance {
        let [base, objective, optimum, bound] = self.costs;
        Balance {
            counts: self.counts,
            base,
            objective,
            optimum,
            bound,
            proven: self.proven,
            structure: self.structure.into_structure(),
            odd_share: self.odd_share,
            odd_subdomains: self.odd_subdomains,
            solved: self.solved.into_solved(),
            events: self.events,
            cuts: Cuts {
                parent: self.parent,
                value2: self.value2,
                set_of: self.set_of,
            },
        }
    }
}

/// Words that live as long as the process: the few dozen kinds of findings and changes.
#[derive(Default)]
struct Words(Vec<&'static str>);

impl Words {
    fn lasting(&mut self, word: &str) -> &'static str {
        if let Some(known) = self.0.iter().find(|it| **it == word) {
            return known;
        }
        let lasting: &'static str = Box::leak(word.to_string().into_boxed_str());
        self.0.push(lasting);
        lasting
    }
}
