//! Blocks whose counts should fit a pattern: cost and price together, with a bound of their own.
//!
//! Lagrangian relaxation: multipliers make the rules of the patterns a part of the costs (`tilts`),
//! a T-join solves what is left exactly, and bounds cost and price of any counts. The multipliers
//! start at those that are best without parity (`relaxation`), then climb: in each round towards the rules
//! that the T-join's counts break. Its counts, mended by moves of two, are candidates. At the best multipliers
//! HiGHS solves the programme, whose optimum is the bound; and it may improve the best candidate neighbourhood
//! by neighbourhood.

use crate::intervals::goals::Goals;
use crate::parity::Join;
use crate::parity::Options;
use crate::parity::balance::Solved;
use crate::parity::balance::Structure;
use crate::parity::draft::Draft;
use crate::parity::draft::Places;
use crate::parity::draft::halves_are_odd;
use crate::parity::error::Error;
use crate::parity::minimum_join;
use crate::parity::neighbourhoods;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::Programme;
use crate::parity::programme::units;
use crate::parity::relaxation::Start;
use crate::parity::solve;
use crate::parity::tilts::Rules;
use crate::parity::tilts::Tilts;
use crate::partition::subdomains::Partition;

/// The climb ends when so many rounds in a row have not raised the bound at the least step.
const PATIENCE: u32 = 4;

/// First step, of what the best known counts suggest; halved whenever patience ends. From 0.3 to 1
/// the first eight rounds close about as much of the gap; beyond, large meshes overshoot.
const FIRST_STEP: f64 = 0.7;

/// Step at which the climb ends.
const LAST_STEP: f64 = 0.02;

/// After `climb_max` rounds twice the gap is enough, and so many times as many rounds may be made for it.
const LONGER: u32 = 5;

/// Rounds of moves that mend the counts of one round of the climb.
const MEND_ROUNDS: u32 = 3;

/// What the best multipliers prove.
struct Proof {
    bound: i64,
    multipliers: Vec<i64>,
    join: Join,
}

/// The counts that are best with the wishes of blocks, as far as this finds them, starting from the
/// counts `even` that are best for parity alone; `free` is what free rounding costs, units.
pub fn fit_patterns(
    partition: &Partition,
    goals: &Goals,
    free: i64,
    even: Vec<u32>,
    options: &Options,
) -> Result<(Structure, Vec<u32>), Error> {
    let worth = units(options.worth);
    let (rules, places) = (Rules::of(goals, worth), Places::of(partition, goals));
    let mut best = Draft::new(goals, &rules, &places, even);
    let mut made = Structure {
        blocks: goals.blocks.len() as u32,
        mapped_before: best.mapped(),
        worth: options.worth,
        ..Structure::default()
    };
    if worth > 0 && !goals.blocks.is_empty() {
        best.descend(options.rounds_max);
        let mut climb = Climb {
            partition,
            goals,
            rules: &rules,
            free,
            options,
            best,
            proof: None,
            rounds: 0,
        };
        climb.run()?;
        let proof = climb
            .proof
            .take()
            .expect("the first round proves something");
        let proof = climb.solve(proof, &mut made.solved)?;
        best = climb.best;
        made.rounds = climb.rounds;
        let enough =
            |total: i64| (total - proof.bound) as f64 <= options.gap_enough * (total - free) as f64;
        made.improved = neighbourhoods::improve(
            partition,
            goals,
            &rules,
            &mut best,
            &proof.multipliers,
            options.neighbourhoods_max,
            enough,
        );
        made.bound = proof.bound as f64 * COST_UNIT;
        made.multipliers = proof.multipliers;
        made.cuts = proof.join.cuts;
    }
    made.mapped = best.mapped();
    made.price = best.price() as f64 * COST_UNIT;
    Ok((made, best.counts))
}

/// The multipliers on their way up.
struct Climb<'a> {
    partition: &'a Partition,
    goals: &'a Goals,
    rules: &'a Rules,
    /// What free rounding costs, units.
    free: i64,
    options: &'a Options,
    best: Draft<'a>,
    proof: Option<Proof>,
    rounds: u32,
}

impl<'a> Climb<'a> {
    fn run(&mut self) -> Result<(), Error> {
        let rows = self.rules.start[self.goals.blocks.len()] as usize;
        let start = Start::of(self.goals, self.rules);
        let mut at = start.multipliers;
        let metric = self.metric(&start.stride);
        let mut direction = vec![0.0; rows];
        let (mut step, mut idle) = (FIRST_STEP, 0);
        let most_rounds = LONGER * self.options.climb_max.max(1);
        while step > LAST_STEP && self.rounds < most_rounds {
            self.rounds += 1;
            let (bound, raised, slope) = self.look(&at)?;
            let most = self.best.total();
            let top = self.proof.as_ref().map_or(bound, |proof| proof.bound);
            let enough = match self.rounds < self.options.climb_max {
                true => self.options.gap_enough,
                false => 2.0 * self.options.gap_enough,
            };
            if (most - top) as f64 <= enough * (most - self.free) as f64 {
                break;
            }
            idle = if raised { 0 } else { idle + 1 };
            if idle >= PATIENCE {
                (step, idle) = (step / 2.0, 0);
                let proof = self.proof.as_ref().expect("there was a round before");
                at = proof.multipliers.iter().map(|&u| u as f64).collect();
            }
            // Directions are averaged over rounds: they zigzag between neighbouring T-joins.
            for (direction, slope) in direction.iter_mut().zip(&slope) {
                *direction = 0.6 * *direction + 0.4 * slope;
            }
            // What cannot go down any more must not shorten the stride of the others.
            for (direction, _) in (direction.iter_mut().zip(&at)).filter(|it| *it.1 <= 0.0) {
                *direction = direction.max(0.0);
            }
            let length2: f64 = direction.iter().zip(&metric).map(|(d, s)| d * d * s).sum();
            if length2 == 0.0 {
                break;
            }
            let stride = step * (most - bound).max(1) as f64 / length2;
            for ((at, direction), scale) in at.iter_mut().zip(&direction).zip(&metric) {
                *at += stride * scale * direction;
            }
            self.feasible(&mut at);
        }
        Ok(())
    }

    /// One T-join at `at`: its bound, whether that is the best so far, and the way up.
    fn look(&mut self, at: &[f64]) -> Result<(i64, bool, Vec<f64>), Error> {
        let multipliers: Vec<i64> = at.iter().map(|&u| u as i64).collect();
        let tilts = Tilts::of(self.goals, self.rules, &multipliers);
        let programme = Programme::new(self.partition, self.goals, Some(&tilts))?;
        let join = minimum_join(&programme.graph, self.options.events_max);
        let bound = programme.base + (join.cuts.bound2() + 1) / 2;
        let counts = programme.counts(&join.chosen);
        let draft = self.best.with_counts(counts);
        let slope = self.slope(&draft);
        self.consider(draft);
        let raised = self.proof.as_ref().is_none_or(|proof| bound > proof.bound);
        if raised {
            self.proof = Some(Proof {
                bound,
                multipliers,
                join,
            });
        }
        Ok((bound, raised, slope))
    }

    /// HiGHS solves the programme at the multipliers of the proof; its counts are one more candidate.
    fn solve(&mut self, proof: Proof, solved: &mut Solved) -> Result<Proof, Error> {
        let tilts = Tilts::of(self.goals, self.rules, &proof.multipliers);
        let programme = Programme::new(self.partition, self.goals, Some(&tilts))?;
        let (join, said) = solve(&programme.graph, programme.base, proof.join, self.options);
        *solved = said;
        self.consider(self.best.with_counts(programme.counts(&join.chosen)));
        Ok(Proof { join, ..proof })
    }

    /// Takes what mended counts are the best.
    fn consider(&mut self, mut draft: Draft<'a>) {
        draft.descend(MEND_ROUNDS);
        if draft.total() < self.best.total() {
            self.best = draft;
        }
    }

    /// How the bound changes with each multiplier: the excess of its rule, less the bridge it saves.
    fn slope(&self, draft: &Draft) -> Vec<f64> {
        let mut slope = Vec::with_capacity(self.rules.start.len());
        for (k, block) in self.goals.blocks.iter().enumerate() {
            let totals = draft.totals(k);
            let odd = i64::from(halves_are_odd(block.sides.len(), totals));
            for rule in self.rules.with_sides(block.sides.len()) {
                slope.push((rule.excess(totals) - odd) as f64);
            }
        }
        slope
    }

    /// Strides of blocks, one a rule.
    fn metric(&self, of_block: &[f64]) -> Vec<f64> {
        let blocks = of_block.iter().enumerate();
        let rows = blocks.flat_map(|(k, &stride)| self.rules.rows(k).map(move |_| stride));
        rows.collect()
    }

    /// The nearest multipliers that prove something.
    fn feasible(&self, at: &mut [f64]) {
        for block in 0..self.goals.blocks.len() {
            let of_block = &mut at[self.rules.rows(block)];
            self.rules.project(block, of_block);
        }
    }
}

/// The bound that multipliers and cuts prove, units.
pub fn bound_units(
    partition: &Partition,
    goals: &Goals,
    worth: i64,
    made: &Structure,
) -> Result<i64, String> {
    let rules = Rules::of(goals, worth);
    if made.multipliers.len() != rules.start[goals.blocks.len()] as usize {
        return Err("not a multiplier a rule".into());
    }
    let tilts = Tilts::of(goals, &rules, &made.multipliers);
    if made.multipliers.iter().any(|&u| u < 0) || tilts.bridge.iter().any(|&left| left < 0) {
        return Err("multipliers that prove nothing".into());
    }
    let programme = Programme::new(partition, goals, Some(&tilts)).map_err(|it| it.to_string())?;
    Ok(programme.base + made.cuts.proven(&programme.graph)?)
}
