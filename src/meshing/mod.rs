//! One sub-domain with its boundary nodes -> Patch: an all-quad mesh that keeps those nodes.
//!
//! # Promises
//!
//! 1. Every quad is counter-clockwise and has four positive corner Jacobians, computed in f64 from
//!    the very coordinates that are stored.
//! 2. The boundary nodes stay where they are, and no other node lies on a walk: neighbours fit
//!    without knowing each other.
//! 3. Edges used once are exactly the walk edges; both sides of a free line are meshed.
//! 4. The same loops give the same bits.
//!
//! # Needs
//!
//! What [`Loops`] says, promised by `boundary`: planar walks, an even number of edges in total (by
//! `parity`), no two boundary nodes at one place.
//!
//! # Method
//!
//! Candidates compete. `visits` makes slits ordinary boundaries; then, in the order of likely
//! quality, each method makes a draft, `finish` cleans it up, smooths it and checks the promises,
//! and `score` ranks it; an excellent patch ends the `contest` early.
//!
//! - `mapping`: one of the `patterns` (grid, stars of 3, 5 and 6 `spokes`, a 3-5 `pair`) over the
//!   whole of a sub-domain with few sides; else `submap`: where all walks close on a lattice (`course`), its
//!   `lattice_cells`, without irregular nodes (Whiteley and others 1996); else `turned_rows`: where the outer walk
//!   nearly closes, such cells and a few rows that turn (`turned_row`), with two irregular nodes each.
//! - `catalogue`: loops of up to twelve nodes that no pattern suits, by the best of all their
//!   quadrangulations.
//! - `looping`: `bridges` join all walks to one loop; `splitting` halves it by the best line again
//!   and again, until a half is a pattern, or one of the `closures` of four or six nodes. After
//!   Talbert and Parkinson (1990), Sarrate and Huerta (2000), Tarini (2021). `sheet`, `contour`: the
//!   mesh while it is laid, and one loop of it.
//! - `strip`: a lattice `core` with a strip of paired triangles to the walks; see its page.
//! - `scatter`, `triangulate`, `pairing`: lattice points, constrained Delaunay (spade), near-
//!   minimum-weight pairs.
//! - `last_resort`: any [`join`] of any triangulation with rings; its page says why it cannot fail.
//! - `cavity`: the last resort in the hole around a bad quad; such quads are counted.
//! - `kernel`, `edits`, `refill`, `improve`, `star`, `smooth`, `lift`: the finish, on the part of a draft
//!   that is not settled. Operations after Kinney (1997) and Canann, Muthukrishnan, Phillips (1998),
//!   each with undo; smoothing after Garanzha and others (2021).
//! - `level`, `mend`, `ring`: in it, too, neighbours of steep areas; the winner is polished, by lifting nearly all quads
//!   and levelling with what lies across the outline.
//! - `windows`, `regular`: in it, convex windows around irregular nodes filled again by a pattern
//!   with fewer, with undo like any operation. After Peng, Zhang, Kobayashi and Wonka (2011).
//!
//! # Cost
//!
//! About linear in the number of quads; per quad that is not settled see `finish`. Memory about
//! 200 bytes a quad of this sub-domain.
//!
//! # Not here
//!
//! Where boundary nodes lie is decided in `boundary`, how many in `parity`. Cutting a large
//! sub-domain into parts is done in `seams`.

mod bridges;
mod buckets;
mod catalogue;
mod cavity;
pub mod check;
mod clearance;
mod closures;
mod contest;
mod contour;
mod core;
mod core_quads;
mod corridor;
mod course;
mod draft;
mod edits;
mod finish;
mod improve;
mod join;
mod kernel;
mod last_resort;
mod lattice;
mod lattice_cells;
mod level;
mod lift;
mod looping;
mod mapping;
mod mend;
mod pair;
mod pairing;
pub mod patch;
mod patterns;
mod refill;
mod regular;
mod ring;
mod rows;
mod scatter;
pub mod score;
mod sheet;
mod smooth;
mod splitting;
mod spokes;
mod star;
mod strip;
mod strip_border;
mod submap;
mod triangulate;
mod turned_row;
mod turned_rows;
mod visits;
mod windows;

use crate::geometry::point::Xy;
use crate::meshing::check::Defect;
use crate::meshing::contest::Contest;
use crate::meshing::course::courses;
use crate::meshing::draft::Draft;
use crate::meshing::finish::Effort;
use crate::meshing::finish::finish;
use crate::meshing::finish::polish;
use crate::meshing::join::Join;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::patch::Patch;
use crate::meshing::score::Score;
use crate::meshing::triangulate::triangulate;
use crate::meshing::visits::Visits;

pub(crate) use crate::meshing::lift::worth_of;

/// What may be tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The methods that compete. The last resort need not be named: it comes last anyway.
    pub methods: Vec<Method>,
    /// A patch ends the competition if its [`Score::rank`] reaches this; in sub-domains of more
    /// than 100 quads less is enough (see `contest`).
    pub good_enough: f64,
    /// Shapes of the winner are lifted and its areas levelled, which moves nodes only.
    pub polish: bool,
}

impl Options {
    /// All methods, in the order of likely quality.
    pub fn all() -> Options {
        Options {
            methods: vec![
                Method::Mapping,
                Method::Strip,
                Method::Looping,
                Method::Indirect,
            ],
            good_enough: 0.85,
            polish: true,
        }
    }

    /// The same, but the winner is left as it is: what is to be seen is which one it is, and where it is poor.
    pub fn trial() -> Options {
        Options {
            polish: false,
            ..Options::all()
        }
    }
}

/// The mesh of one sub-domain and how good it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Meshed {
    /// The best patch.
    pub patch: Patch,
    /// Its score.
    pub score: Score,
    /// Centre of its worst quad, metres.
    pub worst_at_m: Xy,
}

/// Meshes one sub-domain. An error means that the walks break the needs of this page (they cross,
/// touch where they should not, or have an odd number of edges).
pub fn mesh(loops: &Loops, options: &Options) -> Result<Meshed, Defect> {
    let visits = Visits::of(loops);
    let contest = Contest::run(&visits, loops, options, |method| {
        draft(method, &visits, loops)
    });
    let (patch, score) = match contest.best {
        Some(best) if options.polish => polish(best, &visits, loops),
        Some((_, patch, score)) => (patch, score),
        None => {
            let patch = last_resort(&visits, loops)?;
            let score = Score::of(&patch, &visits, loops);
            (patch, score)
        }
    };
    let corners = patch.quads[score.worst_quad as usize].map(|node| patch.nodes[node as usize]);
    let centre = |x: usize| corners.iter().map(|corner| corner[x]).sum::<f64>() / 4.0;
    let worst_at_m = [centre(0), centre(1)];
    Ok(Meshed {
        patch,
        score,
        worst_at_m,
    })
}

fn draft(method: Method, visits: &Visits, loops: &Loops) -> Option<Draft> {
    match method {
        Method::Mapping => mapping::mesh(visits, loops).or_else(|| {
            let mut walks = courses(visits)?;
            submap::mesh(visits, &mut walks, loops.size_m)
                .or_else(|| turned_rows::mesh(visits, &walks, loops.size_m))
        }),
        Method::Looping => looping::mesh(visits, loops.size_m),
        Method::Strip => strip::mesh(visits, loops),
        Method::Indirect => {
            let inner = scatter::scatter(visits, loops.size_m);
            let triangles = triangulate(visits, &inner)?;
            Some(pairing::pair(&triangles, visits.len()))
        }
        Method::LastResort => {
            let inner = scatter::scatter(visits, loops.size_m);
            let triangles = triangulate(visits, &inner)?;
            Some(last_resort::mesh(&pairing::join(&triangles, visits.len())))
        }
    }
}

/// Plainer and plainer versions of the method that cannot fail: what each can still lose to
/// rounding (improvement, interior points, the choice of pairs), the next one does without.
fn last_resort(visits: &Visits, loops: &Loops) -> Result<Patch, Defect> {
    let scattered = scatter::scatter(visits, loops.size_m);
    for (inner, effort) in [
        (&scattered[..], Effort::Clean),
        (&scattered[..], Effort::Check),
        (&[], Effort::Clean),
        (&[], Effort::Check),
    ] {
        let Some(triangles) = triangulate(visits, inner) else {
            break;
        };
        let draft = last_resort::mesh(&pairing::join(&triangles, visits.len()));
        if let Some((_, patch)) = finish(draft, visits, loops, effort) {
            return Ok(patch);
        }
    }
    let along_tree = triangulate(visits, &[])
        .map(|triangles| last_resort::mesh(&Join::along_tree(&triangles)))
        .and_then(|draft| finish(draft, visits, loops, Effort::Check))
        .map(|it| it.1);
    along_tree.ok_or_else(|| Defect {
        what: "the walks are not planar, or too thin for f64".into(),
        at_m: loops.nodes.first().copied().unwrap_or([0.0; 2]),
    })
}
