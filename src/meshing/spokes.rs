//! Stars of 3, 5 and 6 sides: one irregular node, and a grid at each corner.
//!
//! Spoke i joins the centre to a foot on side i. The grid at corner i lies between the spokes of
//! the two sides that meet there, so the part of side i past its foot has as many edges as spoke
//! i + 1, and the part before it as many as spoke i - 1:
//!
//! `count[i] = spoke[i-1] + spoke[i+1]`
//!
//! For 3 and 5 sides there is one solution, in halves: the counts allow a star if it is whole and
//! positive. For 6 sides the equations fall into two independent triples, each with one. (Takayama
//! and others 2014; Tarini 2021.)
//!
//! Cost: the equations in constant time, the quads in time proportional to their number.

use crate::geometry::point::Xy;
use crate::meshing::sheet::Sheet;

/// Solves `count[i] = spoke[i-1] + spoke[i+1]` for whole spokes of at least 1, for 3, 5 or 6 sides;
/// entries past the last side are 0.
pub(crate) fn spokes(counts: &[usize]) -> Option<[usize; 6]> {
    let spokes = loose_spokes(counts)?;
    (spokes[..counts.len()].iter().all(|&spoke| spoke > 0)).then_some(spokes)
}

/// The same for spokes of at least 0.
pub(crate) fn loose_spokes(counts: &[usize]) -> Option<[usize; 6]> {
    let spokes = signed_spokes(counts)?;
    (spokes.iter().all(|&spoke| spoke >= 0)).then(|| spokes.map(|spoke| spoke as usize))
}

/// The same for spokes of any sign: one side farther out makes its spoke longer by one, and changes
/// no other.
pub(crate) fn signed_spokes(counts: &[usize]) -> Option<[i64; 6]> {
    let n = counts.len();
    // Following steps of two from spoke i, the counts between them come with alternating sign.
    let terms = match n {
        3 | 6 => 3,
        5 => 5,
        _ => return None,
    };
    let mut spokes = [0; 6];
    for i in 0..n {
        let mut twice = 0;
        let mut at = i + 1;
        for k in 0..terms {
            at -= if at >= n { n } else { 0 };
            let count = counts[at] as i64;
            twice += if k % 2 == 0 { count } else { -count };
            at += 2;
        }
        if twice % 2 != 0 {
            return None;
        }
        spokes[i] = twice / 2;
    }
    Some(spokes)
}

/// A star over sides whose counts have spokes.
pub(crate) fn lay_star(sheet: &mut Sheet, sides: &[Vec<u32>]) {
    let n = sides.len();
    let counts: Vec<usize> = sides.iter().map(|side| side.len() - 1).collect();
    let spokes = spokes(&counts).expect("a plan is made only if the counts fit");
    // Side i: spoke[i - 1] edges up to its foot, spoke[i + 1] after it.
    let split = |i: usize| spokes[(i + n - 1) % n];
    let feet: Vec<Xy> = (0..n)
        .map(|i| sheet.nodes[sides[i][split(i)] as usize])
        .collect();
    let centre = sheet.node(centroid(&feet));
    let lines: Vec<Vec<u32>> = (0..n)
        .map(|i| sheet.line(sides[i][split(i)], centre, spokes[i]))
        .collect();
    for i in 0..n {
        let before = (i + n - 1) % n;
        // The grid at corner i: along side i, up its spoke, and back along that of the side before.
        let south = &sides[i][..=split(i)];
        let west: Vec<u32> = sides[before][split(before)..]
            .iter()
            .rev()
            .copied()
            .collect();
        sheet.grid(south, &lines[i], &lines[before], &west);
    }
}

/// The mean of some points.
pub(crate) fn centroid(points: &[Xy]) -> Xy {
    let n = points.len() as f64;
    std::array::from_fn(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n)
}
