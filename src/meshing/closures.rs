//! Loops of four and six nodes: where Looping ends.
//!
//! | nodes | closure | inner nodes | quads | made for |
//! |---|---|---|---|---|
//! | 4 | one | 0 | 1 | anything convex |
//! | 4 | ring | 4 | 5 | a straight or reflex corner |
//! | 6 | diagonal (3 places) | 0 | 2 | a reflex corner; no straight one, one, or two opposite |
//! | 6 | fan (2) | 1 | 3 | two straight corners one apart; three alternating |
//! | 6 | two corners (3) | 2 | 4 | two straight corners side by side |
//! | 6 | flat (6) | 3 | 5 | three straight corners on one side of a triangle |
//! | 6 | ring (3) | 6 | 8 | several reflex corners |
//!
//! The table of Talbert and Parkinson 1990 chooses by number and place of the straight corners.
//! Here all closures are compared and the best shape wins, which finds the same ones and more.
//!
//! Inner nodes lie where each is the mean of its neighbours. That is a linear system whose answer
//! depends on the closure alone: a weighted mean of the loop's nodes, with the weights below.

use crate::geometry::point::Xy;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::sheet::Shape;
use crate::meshing::sheet::Sheet;

/// Quads between the nodes of a loop, numbered from 0, and inner nodes, numbered on from there.
struct Closure {
    /// For each inner node the weights of the loop's nodes, in parts of `whole`.
    inner: &'static [[u8; 6]],
    whole: u8,
    /// It repeats itself when turned by so many nodes.
    turns: usize,
    quads: &'static [[u8; 4]],
}

const FOUR: [Closure; 2] = [
    Closure {
        inner: &[],
        whole: 1,
        turns: 1,
        quads: &[[0, 1, 2, 3]],
    },
    Closure {
        inner: &[
            [7, 3, 2, 3, 0, 0],
            [3, 7, 3, 2, 0, 0],
            [2, 3, 7, 3, 0, 0],
            [3, 2, 3, 7, 0, 0],
        ],
        whole: 15,
        turns: 1,
        quads: &[
            [0, 1, 5, 4],
            [1, 2, 6, 5],
            [2, 3, 7, 6],
            [3, 0, 4, 7],
            [4, 5, 6, 7],
        ],
    },
];

const SIX: [Closure; 5] = [
    Closure {
        inner: &[],
        whole: 1,
        turns: 3,
        quads: &[[0, 1, 2, 3], [0, 3, 4, 5]],
    },
    Closure {
        inner: &[[1, 0, 1, 0, 1, 0]],
        whole: 3,
        turns: 2,
        quads: &[[0, 1, 2, 6], [2, 3, 4, 6], [4, 5, 0, 6]],
    },
    Closure {
        inner: &[[0, 3, 1, 0, 1, 3], [0, 1, 3, 0, 3, 1]],
        whole: 8,
        turns: 3,
        quads: &[[0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 4, 7], [6, 7, 4, 5]],
    },
    Closure {
        inner: &[[0, 8, 3, 1, 0, 9], [0, 3, 9, 3, 0, 6], [0, 1, 3, 8, 0, 9]],
        whole: 21,
        turns: 6,
        quads: &[
            [0, 1, 6, 5],
            [1, 2, 7, 6],
            [2, 3, 8, 7],
            [3, 4, 5, 8],
            [6, 7, 8, 5],
        ],
    },
    Closure {
        inner: &[
            [26, 11, 7, 10, 7, 11],
            [11, 32, 13, 7, 4, 5],
            [7, 13, 32, 11, 5, 4],
            [10, 7, 11, 26, 11, 7],
            [7, 4, 5, 11, 32, 13],
            [11, 5, 4, 7, 13, 32],
        ],
        whole: 72,
        turns: 3,
        quads: &[
            [0, 1, 7, 6],
            [1, 2, 8, 7],
            [2, 3, 9, 8],
            [3, 4, 10, 9],
            [4, 5, 11, 10],
            [5, 0, 6, 11],
            [6, 7, 8, 9],
            [6, 9, 10, 11],
        ],
    },
];

/// With a least scaled Jacobian above this, closures with more inner nodes are not tried.
const GOOD: f64 = 0.5;
/// What an inner node must gain in the least scaled Jacobian.
const INNER_COST: f64 = 0.04;

/// Closes a loop of four or six nodes. The quads may be badly shaped, even inverted, if the loop
/// leaves nothing better.
pub(crate) fn close(sheet: &mut Sheet, ids: &[u32]) -> Shape {
    debug_assert!(ids.len() == 4 || ids.len() == 6);
    let n = ids.len();
    let closures: &[Closure] = if n == 4 { &FOUR } else { &SIX };
    let mut corners = [[0.0; 2]; 6];
    for (corner, &id) in corners.iter_mut().zip(ids) {
        *corner = sheet.nodes[id as usize];
    }
    let mut best: Option<(f64, &Closure, usize)> = None;
    for closure in closures {
        if best.is_some_and(|(worth, ..)| worth > GOOD) {
            break;
        }
        for turn in 0..closure.turns {
            let least = least(&places(&corners[..n], closure, turn), closure);
            let worth = least - INNER_COST * closure.inner.len() as f64;
            if best.is_none_or(|(most, ..)| worth > most) {
                best = Some((worth, closure, turn));
            }
        }
    }
    let (_, closure, turn) = best.expect("every loop has a first closure");
    let mark = sheet.mark();
    let first = sheet.nodes.len() as u32;
    let places = places(&corners[..n], closure, turn);
    sheet.nodes.extend(&places[n..n + closure.inner.len()]);
    for quad in closure.quads {
        sheet.quads.push(quad.map(|k| match k as usize {
            k if k < n => ids[(k + turn) % n],
            k => first + (k - n) as u32,
        }));
    }
    sheet.shape(mark)
}

/// The loop's nodes, turned, and the inner ones.
fn places(corners: &[Xy], closure: &Closure, turn: usize) -> [Xy; 12] {
    let n = corners.len();
    let mut places = [[0.0; 2]; 12];
    for (k, place) in places[..n].iter_mut().enumerate() {
        *place = corners[(k + turn) % n];
    }
    let share = 1.0 / f64::from(closure.whole);
    for (k, weights) in closure.inner.iter().enumerate() {
        let mut sum = [0.0; 2];
        for (place, &weight) in places[..n].iter().zip(weights) {
            sum[0] += f64::from(weight) * place[0];
            sum[1] += f64::from(weight) * place[1];
        }
        places[n + k] = [share * sum[0], share * sum[1]];
    }
    places
}

/// The least scaled Jacobian.
fn least(places: &[Xy; 12], closure: &Closure) -> f64 {
    let quality = |quad: &[u8; 4]| scaled_jacobian(&quad.map(|k| places[k as usize]));
    closure.quads.iter().map(quality).fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slow twin of the weights: sweep until every inner node is the mean of its neighbours.
    #[test]
    fn inner_nodes_are_the_means_of_their_neighbours() {
        let corners = [
            [0.0, 0.1],
            [2.0, -0.3],
            [3.1, 1.0],
            [2.2, 2.4],
            [0.3, 2.0],
            [-1.0, 1.1],
        ];
        for (n, closure) in (FOUR.iter().map(|it| (4, it))).chain(SIX.iter().map(|it| (6, it))) {
            let laid = places(&corners[..n], closure, 0);
            let mut sheet = Sheet {
                nodes: corners[..n].to_vec(),
                quads: Vec::new(),
            };
            let mark = sheet.mark();
            closure.inner.iter().for_each(|_| _ = sheet.node([0.0; 2]));
            sheet
                .quads
                .extend(closure.quads.iter().map(|quad| quad.map(u32::from)));
            sheet.relax(mark, 500);
            for (a, b) in sheet.nodes.iter().zip(&laid) {
                assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
            }
        }
    }
}
