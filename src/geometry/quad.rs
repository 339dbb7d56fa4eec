//! Shape measures of a quadrilateral.
//!
//! Definitions after Verdict (Knupp and others), as the independent checker uses them: corners are
//! counter-clockwise, `e_k = p_{k+1} - p_k`, corner Jacobian `J_k = e_k x (p_{k-1} - p_k)`.

use crate::geometry::point::Xy;

/// Twice the signed area of the triangle `a b c`, m².
pub fn cross(a: Xy, b: Xy, c: Xy) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Distance between `a` and `b`, metres. A plain root: `hypot` guards against overflow that metres
/// cannot reach, at ten times the cost.
pub fn distance(a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    (dx * dx + dy * dy).sqrt()
}

/// The four corner Jacobians, m²; all positive if and only if the quad is strictly convex.
pub fn corner_jacobians(p: &[Xy; 4]) -> [f64; 4] {
    std::array::from_fn(|k| cross(p[k], p[(k + 1) % 4], p[(k + 3) % 4]))
}

/// From each corner to the next.
#[inline]
fn sides(p: &[Xy; 4]) -> [Xy; 4] {
    [0, 1, 2, 3].map(|k| {
        let (a, b) = (p[k], p[(k + 1) & 3]);
        [b[0] - a[0], b[1] - a[1]]
    })
}

/// Scaled Jacobian: the least sine of a corner, in [-1, 1]; 1 for a rectangle, 0 if an edge has no
/// length.
///
/// Asked for more often than anything else: each side is measured once.
pub fn scaled_jacobian(p: &[Xy; 4]) -> f64 {
    let sides = sides(p);
    let squares = sides.map(|it| it[0] * it[0] + it[1] * it[1]);
    let mut least = 1.0_f64;
    for k in 0..4 {
        let last = (k + 3) & 3;
        let jacobian = sides[last][0] * sides[k][1] - sides[last][1] * sides[k][0];
        let scale = (squares[k] * squares[last]).sqrt();
        least = least.min(if scale > 0.0 { jacobian / scale } else { 0.0 });
    }
    least
}

/// True if the scaled Jacobian is surely below `least`, which is positive: most trial places are told apart by this,
/// without roots and divisions. It may be below if this is false, by a share of 1e-9 or less.
pub fn is_surely_below(p: &[Xy; 4], least: f64) -> bool {
    let sides = sides(p);
    let squares = sides.map(|it| it[0] * it[0] + it[1] * it[1]);
    // more than what rounding can do
    let least2 = least * least * (1.0 - 1e-9);
    // all four at once: to stop at the first one costs more
    (0..4).fold(false, |is_below, k| {
        let last = (k + 3) & 3;
        let jacobian = sides[last][0] * sides[k][1] - sides[last][1] * sides[k][0];
        is_below | (jacobian * jacobian.abs() < least2 * squares[k] * squares[last])
    })
}

/// Signed area, m².
pub fn area(p: &[Xy; 4]) -> f64 {
    0.5 * ((p[2][0] - p[0][0]) * (p[3][1] - p[1][1]) - (p[2][1] - p[0][1]) * (p[3][0] - p[1][0]))
}

/// 4 x area / perimeter, metres: the side of a square, and what bounds an explicit time step.
pub fn hydraulic_size_m(p: &[Xy; 4]) -> f64 {
    let perimeter: f64 = (0..4).map(|k| distance(p[k], p[(k + 1) % 4])).sum();
    if perimeter > 0.0 {
        4.0 * area(p).abs() / perimeter
    } else {
        0.0
    }
}

/// Several measures of one quad.
pub struct Measured {
    /// See [`scaled_jacobian`].
    pub scaled_jacobian: f64,
    /// See [`hydraulic_size_m`].
    pub hydraulic_size_m: f64,
    /// Lengths of the sides, from each corner to the next, metres.
    pub sides_m: [f64; 4],
}

/// Measures a quad for the price of its four sides.
pub fn measure(p: &[Xy; 4]) -> Measured {
    let sides = sides(p);
    let sides_m = sides.map(|it| (it[0] * it[0] + it[1] * it[1]).sqrt());
    let mut least = 1.0_f64;
    for k in 0..4 {
        let last = (k + 3) & 3;
        let jacobian = sides[last][0] * sides[k][1] - sides[last][1] * sides[k][0];
        let scale = sides_m[k] * sides_m[last];
        least = least.min(if scale > 0.0 { jacobian / scale } else { 0.0 });
    }
    let perimeter: f64 = sides_m.iter().sum();
    Measured {
        scaled_jacobian: least,
        hydraulic_size_m: match perimeter > 0.0 {
            true => 4.0 * area(p).abs() / perimeter,
            false => 0.0,
        },
        sides_m,
    }
}

/// The interior corner angles, degrees; above 180 at a concave corner.
pub fn corner_angles_deg(p: &[Xy; 4]) -> [f64; 4] {
    std::array::from_fn(|k| {
        let (a, b, c) = (p[k], p[(k + 1) % 4], p[(k + 3) % 4]);
        let dot = (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
        let angle = cross(a, b, c).atan2(dot).to_degrees();
        if angle < 0.0 { angle + 360.0 } else { angle }
    })
}
