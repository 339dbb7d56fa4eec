//! The quads around one free node, gathered once: a search asks about a hundred places for it, and only one corner of
//! each quad changes.

use crate::geometry::point::Xy;
use crate::geometry::quad::area;
use crate::geometry::quad::distance;
use crate::geometry::quad::is_surely_below;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::lift::Wish;
use crate::meshing::triangulate::NONE;
use smallvec::SmallVec;

/// A free node and its quads.
pub(crate) struct Ring {
    /// Where the node is now.
    pub at: Xy,
    /// 1 / its wished edge length, 1 / m.
    pub per_m: f64,
    sectors: Few<Sector>,
}

/// One quad of a ring.
struct Sector {
    quad: u32,
    /// Which corner the node is.
    own: usize,
    corners: [Xy; 4],
    wish: Wish,
}

impl Ring {
    pub fn of(kernel: &Kernel, node: u32, size_m: f64) -> Ring {
        let spokes = kernel.spokes(node);
        let sectors = spokes.iter().map(|&side| Sector {
            quad: quad_of(side),
            own: (side & 3) as usize,
            corners: kernel.corners(quad_of(side)),
            wish: Wish::of(kernel, quad_of(side), size_m),
        });
        Ring {
            at: kernel.nodes[node as usize],
            per_m: kernel.scale[node as usize].sqrt(),
            sectors: sectors.collect(),
        }
    }

    /// How many quads there are.
    pub fn len(&self) -> usize {
        self.sectors.len()
    }

    /// Corners of quad `k` if the node were at `place`.
    fn corners(&self, k: usize, place: Xy) -> [Xy; 4] {
        let mut corners = self.sectors[k].corners;
        corners[self.sectors[k].own] = place;
        corners
    }

    /// The [`worth`](crate::meshing::lift::worth) of quad `k` if the node were at `place`.
    pub fn worth(&self, k: usize, place: Xy) -> f64 {
        self.sectors[k].wish.worth(&self.corners(k, place))
    }

    /// The same, if it is above `best`.
    pub fn worth_above(&self, k: usize, place: Xy, best: f64) -> Option<f64> {
        let corners = self.corners(k, place);
        if best > 0.0 && is_surely_below(&corners, best) {
            return None;
        }
        Some(self.sectors[k].wish.worth(&corners)).filter(|&it| it > best)
    }

    /// The shortest edge at the node if it were at `place`, metres.
    pub fn shortest_m(&self, place: Xy) -> f64 {
        let ends = self.sectors.iter().map(|it| it.corners[(it.own + 1) & 3]);
        let lengths = ends.map(|end| distance(place, end));
        lengths.fold(f64::INFINITY, f64::min)
    }
}

/// What lies beside the quads of a ring.
pub(crate) struct Beside {
    each: Few<SmallVec<[Neighbour; 4]>>,
}

#[derive(Clone, Copy)]
enum Neighbour {
    /// A quad of the ring.
    Sector(usize),
    /// One that stays as it is: its area, m2.
    Fixed(f64),
}

impl Beside {
    /// With what lies across the outline, if that counts.
    pub fn of(kernel: &Kernel, ring: &Ring, looks_across: bool) -> Beside {
        let each = ring.sectors.iter().map(|it| {
            let neighbour = |k: usize| match kernel.twins[it.quad as usize][k] {
                NONE if looks_across => kernel.across_m2(it.quad, k).map(Neighbour::Fixed),
                NONE => None,
                twin => {
                    let other = quad_of(twin);
                    let sector = ring.sectors.iter().position(|it| it.quad == other);
                    let fixed = || Neighbour::Fixed(area(&kernel.corners(other)));
                    Some(sector.map_or_else(fixed, Neighbour::Sector))
                }
            };
            (0..4).filter_map(neighbour).collect()
        });
        Beside {
            each: each.collect(),
        }
    }

    /// The least [`evenness`](crate::meshing::level::evenness) of the quads of the ring if the node were at `place`.
    pub fn least(&self, ring: &Ring, place: Xy) -> f64 {
        let all = 0..ring.len();
        let areas: Few<f64> = all.map(|k| area(&ring.corners(k, place))).collect();
        let mut least = 1.0_f64;
        for (&own, beside) in areas.iter().zip(&self.each) {
            for &it in beside {
                let other = match it {
                    Neighbour::Sector(k) => areas[k],
                    Neighbour::Fixed(area_m2) => area_m2,
                };
                least = least.min((own / other).min(other / own));
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::shaken;
    use crate::meshing::level::evenness;
    use crate::meshing::level::evenness_across;
    use crate::meshing::lift::worth;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_ring_knows_what_the_kernel_would_say(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.45,
            to in prop::array::uniform2(-0.5_f64..0.5),
            depth_m in prop::option::of(0.3_f64..1.0),
        ) {
            let mut kernel = shaken(&moves, by);
            kernel.across_m.fill(depth_m.unwrap_or(0.0));
            for node in 0..kernel.nodes.len() as u32 {
                if kernel.held[node as usize] {
                    continue;
                }
                let ring = Ring::of(&kernel, node, 1.0);
                let beside = [false, true].map(|across| Beside::of(&kernel, &ring, across));
                let at = ring.at;
                let place = [at[0] + to[0], at[1] + to[1]];
                kernel.nodes[node as usize] = place;
                let quads: Vec<u32> = kernel.spokes(node).iter().map(|&it| quad_of(it)).collect();
                for (k, &quad) in quads.iter().enumerate() {
                    prop_assert_eq!(ring.worth(k, place), worth(&kernel, quad, 1.0));
                }
                for (beside, slow) in beside.iter().zip([evenness, evenness_across]) {
                    let each = quads.iter().map(|&quad| slow(&kernel, quad));
                    prop_assert_eq!(beside.least(&ring, place), each.fold(1.0, f64::min));
                }
                kernel.nodes[node as usize] = at;
            }
        }
    }
}
