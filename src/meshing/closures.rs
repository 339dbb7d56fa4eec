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
//! Here all closures are laid and the best shape wins, which finds the same ones and more.

use crate::meshing::sheet::Shape;
use crate::meshing::sheet::Sheet;

/// Quads between the nodes of a loop, numbered from 0, and inner nodes, numbered on from there.
struct Closure {
    inner: usize,
    /// It repeats itself when turned by so many nodes.
    turns: usize,
    quads: &'static [[u8; 4]],
}

const FOUR: [Closure; 2] = [
    Closure {
        inner: 0,
        turns: 1,
        quads: &[[0, 1, 2, 3]],
    },
    Closure {
        inner: 4,
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
        inner: 0,
        turns: 3,
        quads: &[[0, 1, 2, 3], [0, 3, 4, 5]],
    },
    Closure {
        inner: 1,
        turns: 2,
        quads: &[[0, 1, 2, 6], [2, 3, 4, 6], [4, 5, 0, 6]],
    },
    Closure {
        inner: 2,
        turns: 3,
        quads: &[[0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 4, 7], [6, 7, 4, 5]],
    },
    Closure {
        inner: 3,
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
        inner: 6,
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
/// Smoothing sweeps for inner nodes.
const SWEEPS: usize = 8;

/// Closes a loop of four or six nodes. The quads may be badly shaped, even inverted, if the loop
/// leaves nothing better.
pub(crate) fn close(sheet: &mut Sheet, ids: &[u32]) -> Shape {
    debug_assert!(ids.len() == 4 || ids.len() == 6);
    let closures: &[Closure] = if ids.len() == 4 { &FOUR } else { &SIX };
    let mark = sheet.mark();
    let mut best: Option<(f64, &Closure, usize)> = None;
    for closure in closures {
        if best.is_some_and(|(worth, ..)| worth > GOOD) {
            break;
        }
        for turn in 0..closure.turns {
            let shape = lay(sheet, ids, closure, turn);
            sheet.undo(mark);
            let worth = shape.least - INNER_COST * closure.inner as f64;
            if best.is_none_or(|(most, ..)| worth > most) {
                best = Some((worth, closure, turn));
            }
        }
    }
    let (_, closure, turn) = best.expect("every loop has a first closure");
    lay(sheet, ids, closure, turn)
}

fn lay(sheet: &mut Sheet, ids: &[u32], closure: &Closure, turn: usize) -> Shape {
    let n = ids.len();
    let mark = sheet.mark();
    let share = 1.0 / n as f64;
    let centre = std::array::from_fn(|axis| {
        let sum: f64 = ids.iter().map(|&id| sheet.nodes[id as usize][axis]).sum();
        sum * share
    });
    let first = sheet.nodes.len() as u32;
    for _ in 0..closure.inner {
        sheet.node(centre);
    }
    for quad in closure.quads {
        let quad = quad.map(|k| match k as usize {
            k if k < n => ids[(k + turn) % n],
            k => first + (k - n) as u32,
        });
        sheet.quads.push(quad);
    }
    // One inner node goes straight to its place.
    sheet.relax(
        mark,
        if closure.inner > 1 {
            SWEEPS
        } else {
            closure.inner
        },
    );
    sheet.shape(mark)
}
