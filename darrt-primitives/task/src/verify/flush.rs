//! Which surfaces lie flush, by a rule of the verifier's own: it walks along the edge of one and looks how near the other is.

use darrt_geom::SupportSurface;
use nalgebra::Point2;

/// Heights that differ by no more than this are one, metres.
const STEP_M: f64 = 1e-4;
/// The widest gap over which an object may be pushed, metres.
const GAP_M: f64 = 2e-3;
/// The least length of a seam, metres; what is walked is this much finer.
const SEAM_M: f64 = 0.01;
const STRIDE_M: f64 = 5e-4;
/// Slack of these lengths, metres: what rounding may do.
const SLACK_M: f64 = 1e-6;

/// The surfaces that lie flush with each surface.
#[derive(Debug)]
pub(super) struct Flush {
    /// By surface, ascending, without itself.
    neighbours: Vec<Vec<usize>>,
}

impl Flush {
    pub(super) fn new(surfaces: &[SupportSurface]) -> Self {
        let of_one = |i: usize| -> Vec<usize> {
            let is_flush = |j: &usize| *j != i && lie_flush(&surfaces[i], &surfaces[*j]);
            (0..surfaces.len()).filter(is_flush).collect()
        };
        Self { neighbours: (0..surfaces.len()).map(of_one).collect() }
    }

    /// The surfaces among `allowed` on which an object can be pushed from `surface` without meeting an edge; that one first.
    pub(super) fn group(&self, surface: usize, allowed: &[usize]) -> Vec<usize> {
        let mut group = vec![surface];
        let mut seen = 0;
        while let Some(&next) = group.get(seen) {
            seen += 1;
            for &other in self.neighbours.get(next).into_iter().flatten() {
                if allowed.contains(&other) && !group.contains(&other) {
                    group.push(other);
                }
            }
        }
        group
    }

    /// The surface of the group that the point is over, the one with the farthest edge; of a point in a seam between two the
    /// nearer.
    pub(super) fn under(&self, surfaces: &[SupportSurface], group: &[usize], p: &Point2<f64>) -> Option<usize> {
        let depths = || group.iter().filter_map(|&i| Some((i, surfaces.get(i)?.depth(p))));
        let (deepest, depth) = depths().max_by(|a, b| a.1.total_cmp(&b.1))?;
        if depth >= 0.0 {
            return Some(deepest);
        }
        let flush = self.neighbours.get(deepest)?;
        let is_across = |(other, beside): (usize, f64)| flush.contains(&other) && -(depth + beside) <= GAP_M + SLACK_M;
        depths().any(is_across).then_some(deepest)
    }
}

/// At one height, and along a seam over each other or hardly apart.
fn lie_flush(a: &SupportSurface, b: &SupportSurface) -> bool {
    let is_level = (a.height() - b.height()).abs() <= STEP_M + SLACK_M;
    is_level && (seam_m(a, b) >= SEAM_M - 2.0 * STRIDE_M || seam_m(b, a) >= SEAM_M - 2.0 * STRIDE_M)
}

/// Metres of the edge of `a` along which `b` is no farther than a gap.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an edge has at most 2e4 m")]
fn seam_m(a: &SupportSurface, b: &SupportSurface) -> f64 {
    let (low, high) = b.bounds();
    let is_far = |p: &Point2<f64>, q: &Point2<f64>| {
        let (least, most) = (p.inf(q), p.sup(q));
        least.x > high.x + 2.0 * GAP_M
            || least.y > high.y + 2.0 * GAP_M
            || most.x < low.x - 2.0 * GAP_M
            || most.y < low.y - 2.0 * GAP_M
    };
    let mut seam_m = 0.0;
    for edge in a.edges().iter().filter(|edge| !is_far(&edge.start, &edge.end)) {
        let way = edge.end - edge.start;
        let strides = (way.norm() / STRIDE_M).ceil().max(1.0) as usize;
        let is_near =
            |i: &usize| b.depth(&(edge.start + way * ((*i as f64 + 0.5) / strides as f64))) >= -GAP_M - SLACK_M;
        seam_m += (0..strides).filter(is_near).count() as f64 * way.norm() / strides as f64;
    }
    seam_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn board([x, y]: [f64; 2], [u, v]: [f64; 2], yaw: f64, z: f64) -> SupportSurface {
        let turn = nalgebra::Rotation2::new(yaw);
        let corners = [[x, y], [u, y], [u, v], [x, v]].map(|p| turn * Point2::from(p));
        SupportSurface::new("board", &corners, z).unwrap()
    }

    #[test]
    fn two_tables_are_one_group_for_who_may_stand_on_both() {
        let surfaces = [
            board([0.0, 0.0], [1.0, 1.0], 0.3, 0.75),
            board([1.001, 0.2], [2.0, 0.8], 0.3, 0.75),
            board([2.0, 0.2], [3.0, 0.8], 0.3, 0.75),
            board([1.0, 1.0], [2.0, 2.0], 0.3, 0.75),
            board([-1.0, 0.0], [0.0, 1.0], 0.3, 0.7502),
        ];
        let flush = Flush::new(&surfaces);
        assert_eq!(flush.neighbours, [vec![1], vec![0, 2], vec![1], vec![], vec![]]);
        assert_eq!(flush.group(0, &[0, 1, 2, 3, 4]), [0, 1, 2]);
        assert_eq!(flush.group(0, &[0, 2]), [0]);
        let at = |x: f64, y: f64| nalgebra::Rotation2::new(0.3) * Point2::new(x, y);
        assert_eq!(flush.under(&surfaces, &[0, 1], &at(0.9, 0.5)), Some(0));
        assert_eq!(flush.under(&surfaces, &[0, 1], &at(1.0003, 0.5)), Some(0), "in the seam");
        assert_eq!(flush.under(&surfaces, &[0, 1], &at(1.0007, 0.5)), Some(1), "in the seam");
        assert_eq!(flush.under(&surfaces, &[0], &at(1.0007, 0.5)), None);
        assert_eq!(flush.under(&surfaces, &[0, 1], &at(1.0007, 0.1)), None, "beside the seam");
        assert_eq!(flush.under(&surfaces, &[0, 1], &at(2.5, 0.5)), None);
    }

    proptest! {
        /// Two rules of two authors: what the planner joins the verifier lets pass, and it lets no edge pass.
        #[test]
        fn what_the_planner_joins_is_flush_here(
            x in 0.9_f64..1.1, shift in -1.1_f64..1.1, gap in -0.003_f64..0.006, lift in -2e-4_f64..2e-4, yaw in -3.0_f64..3.0,
            u in 0.0_f64..1.0, v in 0.0_f64..1.0,
        ) {
            let surfaces = [board([0.0, 0.0], [x, 1.0], yaw, 0.75), board([x + gap, shift], [2.0, shift + 1.0], yaw, 0.75 + lift)];
            let flush = Flush::new(&surfaces);
            let joins = surfaces[0].is_flush_with(&surfaces[1]);
            if joins {
                prop_assert_eq!(flush.group(0, &[0, 1]), [0, 1]);
                let union = SupportSurface::joined("both", &[&surfaces[0], &surfaces[1]]).unwrap();
                let p = nalgebra::Rotation2::new(yaw) * Point2::new(x - 0.05 + 0.1 * u, shift.max(0.0) - 0.02 + 0.1 * v);
                let depth = union.depth(&p);
                prop_assert!(depth < 0.0 || flush.under(&surfaces, &[0, 1], &p).is_some(), "{depth}");
                prop_assert!(depth > -GAP_M || flush.under(&surfaces, &[0, 1], &p).is_none(), "{depth}");
            }
            if gap > GAP_M + 1e-5 || lift.abs() > STEP_M + 1e-5 {
                prop_assert_eq!(flush.group(0, &[0, 1]), [0]);
            }
        }
    }
}
