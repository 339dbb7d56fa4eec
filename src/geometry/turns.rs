//! Quarter turns of closed walks: where a walk that bends anyhow would turn if it ran on a square
//! lattice.
//!
//! A walk of a lattice turns by a quarter to the left (a corner, one cell), goes straight (two cells),
//! turns right (three) or back (the end of a slit, four); the quarters of an outer walk sum to 4, those
//! of an inner one to -4. Each place takes the nearest; where the sum is not right, those that
//! are nearest to the other choice change. Vertex classification of submapping (Whiteley, White,
//! Benzley, Blacker 1996; the sum after Ruiz-Girones and Sarrate 2010, there a linear programme).
//!
//! Cost: O(n) and O(n) a change.

/// A quarter that is more than this off the turn is not taken, degrees. (A corner from 22 degrees on, as
/// in the patterns.)
const FARTHEST_DEG: f64 = 68.0;

/// So many places may change for the sake of the sum: with more, the walk is no polygon.
const MOST_CHANGES: i32 = 2;

/// The quarter turns at places that turn by `turn_deg` (left positive, the end of a slit -180), one of
/// 1, 0, -1, -2 each, with this `sum`; `None` if that would bend the walk too much.
pub fn quarter_turns(turn_deg: &[f64], sum: i32) -> Option<Vec<i8>> {
    let nearest = |turn: &f64| (turn / 90.0).round().clamp(-2.0, 1.0) as i8;
    let mut quarters: Vec<i8> = turn_deg.iter().map(nearest).collect();
    let lacks = sum - quarters.iter().map(|&it| i32::from(it)).sum::<i32>();
    if lacks.abs() > MOST_CHANGES {
        return None;
    }
    let by = lacks.signum() as i8;
    for _ in 0..lacks.abs() {
        let off = |k: usize, quarter: i8| (turn_deg[k] - 90.0 * f64::from(quarter)).abs();
        let (at, _) = (0..turn_deg.len())
            .filter(|&k| (-2..=1).contains(&(quarters[k] + by)))
            .filter(|&k| off(k, quarters[k] + by) < FARTHEST_DEG)
            .map(|k| (k, off(k, quarters[k] + by) - off(k, quarters[k])))
            .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))?;
        quarters[at] += by;
    }
    Some(quarters)
}
