//! Candidates compete: in which order the methods try, who leads, and when it is over.

use crate::meshing::Options;
use crate::meshing::catalogue;
use crate::meshing::draft::Draft;
use crate::meshing::finish::Effort;
use crate::meshing::finish::finish;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::patch::Patch;
use crate::meshing::score::Score;
use crate::meshing::visits::Visits;

/// A patch of more quads than this ends the competition: the strip made it, mostly of perfect
/// cells, and the other methods would be slower and worse there.
const LARGE_QUADS: usize = 2000;

/// A sheared lattice without irregular nodes ranks high, but looping may rank higher: a mapped patch
/// with a poorer mean shape has to compete with it. Measured on synthetic cities: .94 for .92 gains .0009 of
/// the mean shape and .007 of the 5 % quantile at 3 m, for .05 to .1 % irregular nodes.
const FAIR: f64 = 0.93;
/// The same in sub-domains of more than 700 quads, where the strip's mean is .98. (Measured at 3 m: .975 for it
/// leaves .07 % irregular nodes more, and gains .0010 of the mean shape.)
const FAIR_LARGE: f64 = 0.965;
/// Larger sub-domains are not mapped: all their quads would have to be smoothed, where the strip leaves
/// most of them as they are. Measured on a city of 10 000 segments at 3 m: 4000 leaves .03 % irregular
/// nodes fewer, for .0008 of the mean shape and a tenth of the time.
const MAPPED_QUADS: f64 = 2000.0;

/// So many plans of the catalogue are made. Measured on three cities: 5, 8 or 20 give the same 1 %
/// quantile of shapes.
const PLANS: usize = 4;

/// The competition for one sub-domain.
pub(crate) struct Contest<'a> {
    visits: &'a Visits,
    loops: &'a Loops,
    /// The rank that ends it.
    enough: f64,
    /// The mean shape without which what is mapped does not.
    fair: f64,
    /// Who leads, by its draft and its patch.
    pub best: Option<(Draft, Patch, Score)>,
}

impl<'a> Contest<'a> {
    /// Lets the methods try in order until one is good enough; `draft` makes one method's draft.
    pub fn run(
        visits: &'a Visits,
        loops: &'a Loops,
        options: &Options,
        draft: impl Fn(Method) -> Option<Draft>,
    ) -> Contest<'a> {
        let quads = visits.area_m2() / (loops.size_m * loops.size_m);
        let (order, most) = order(quads);
        let is_small = catalogue::holds(visits) && options.methods.contains(&Method::Mapping);
        let mut contest = Contest {
            visits,
            loops,
            enough: options.good_enough.min(most),
            fair: match is_small {
                true => 0.0,
                false if quads > 700.0 => FAIR_LARGE,
                false => FAIR,
            },
            best: None,
        };
        for method in order.into_iter().filter(|it| options.methods.contains(it)) {
            if let Some(draft) = draft(method) {
                contest.enter(draft, Effort::Clean);
            }
            if method == Method::Mapping && is_small && !contest.is_over(method) {
                for draft in catalogue::drafts(visits, PLANS) {
                    contest.enter(draft, Effort::Smooth);
                }
            }
            // What catalogue and looping do not find in a small loop, the others do not either.
            let enough_tried = is_small && method == Method::Looping && contest.best.is_some();
            if contest.is_over(method) || enough_tried {
                break;
            }
        }
        contest
    }

    /// Finishes a draft; if it ranks above who leads, it leads.
    fn enter(&mut self, draft: Draft, effort: Effort) {
        let Some((draft, patch)) = finish(draft, self.visits, self.loops, effort) else {
            return;
        };
        let score = Score::of(&patch, self.visits, self.loops);
        let leader = self.best.as_ref().map(|(_, _, score)| score.rank());
        if leader.is_none_or(|rank| score.rank() > rank) {
            self.best = Some((draft, patch, score));
        }
    }

    /// True if nobody else need try after `method`.
    fn is_over(&self, method: Method) -> bool {
        let over = |(_, patch, score): &(Draft, Patch, Score)| match method {
            Method::Mapping => score.rank() >= self.enough && score.mean >= self.fair,
            _ => score.rank() >= self.enough || patch.quads.len() > LARGE_QUADS,
        };
        self.best.as_ref().is_some_and(over)
    }
}

/// Which methods to try, in which order, in a sub-domain that asks for so many quads, and the most
/// that is asked of a rank to end the contest.
///
/// The larger the sub-domain, the less a second draft is worth: its least Jacobian is decided by a
/// few narrow places that every method finds equally hard, and it costs as much as the first.
/// Measured on two cities: looping ranks above the strip below about 700 quads (.924 to .885), the
/// same above, where the strip takes half the time and a tenth fewer quads.
fn order(quads: f64) -> ([Method; 4], f64) {
    use Method::Indirect;
    use Method::Looping;
    use Method::Mapping;
    use Method::Strip;
    if quads > 700.0 && quads < MAPPED_QUADS {
        ([Mapping, Strip, Looping, Indirect], 0.63)
    } else if quads > 700.0 {
        ([Strip, Looping, Indirect, Mapping], 0.63)
    } else if quads > 100.0 {
        ([Mapping, Looping, Strip, Indirect], 0.76)
    } else {
        ([Mapping, Looping, Indirect, Strip], 1.0)
    }
}
