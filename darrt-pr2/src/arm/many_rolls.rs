//! The closed-form inverse for eight upper arm rolls at once, with the vector unit of the processor.
//!
//! The formulas are those of `closed_form`; each branch (root of the quadratic, bend of the elbow,
//! side of the wrist) is gone through for all lanes, with a mask of the lanes in which it is a solution.

#![expect(clippy::inline_always, reason = "only what is inlined is compiled for the processor at hand")]

use std::f64::consts::{PI, TAU};

use arrayvec::ArrayVec;
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::kinematics::lanes::{Lanes, Mask, Row, registers};
use nalgebra::Isometry3;
use pulp::{Arch, Simd, WithSimd};

use super::closed_form::{SLACK, Target};
use super::{Arm, ArmConfiguration, Solutions};
use crate::forward::{FOREARM, UPPER_ARM, UPPER_ARM_OFFSET};

/// Two roots, two bends of the elbow, two sides of the wrist.
const BRANCHES: usize = 8;

/// One branch for all lanes.
#[derive(Debug, Clone, Copy)]
struct Branch {
    /// Joint values, rad; of lanes without a solution anything.
    joints: [Row; 7],
    /// 1 where this is a solution, 0 elsewhere.
    is_solution: Row,
}

impl Branch {
    const EMPTY: Self = Self { joints: [Row::splat(0.0); 7], is_solution: Row::splat(0.0) };
}

/// Solutions of one pose for [`LANES`](darrt_primitives::kinematics::lanes::LANES) upper arm rolls; reused from call to call.
#[derive(Debug, Clone)]
pub struct RollSolutions {
    /// Those that have a solution in some lane. OPTIMIZATION: room for all, so none is written that nobody reads.
    branches: ArrayVec<Branch, BRANCHES>,
    /// Where in there each branch is.
    places: [Option<usize>; BRANCHES],
}

impl Default for RollSolutions {
    fn default() -> Self {
        Self { branches: ArrayVec::new(), places: [None; BRANCHES] }
    }
}

impl RollSolutions {
    /// Has no roll a solution?
    pub fn is_empty(&self) -> bool {
        self.branches.is_empty()
    }

    /// Writes the solutions for the roll of one lane into `out`, which is cleared first.
    pub fn of_lane(&self, lane: usize, out: &mut Solutions) {
        out.clear();
        for place in self.places.into_iter().flatten() {
            if let Some(branch) = self.branches.get(place)
                && branch.is_solution.0.get(lane) == Some(&1.0)
            {
                let q: ArmConfiguration = branch.joints.each_ref().map(|row| row.0[lane]);
                // Merged branches give one configuration twice; there are no more branches than places.
                if !out.contains(&q) {
                    let _ = out.try_push(q);
                }
            }
        }
    }
}

impl Arm {
    /// [`inverse`](Self::inverse) for [`LANES`](darrt_primitives::kinematics::lanes::LANES) upper arm rolls (rad) at once; a roll that is no number has no solution.
    ///
    /// # Laws
    /// Lane by lane the solutions are those of [`inverse`](Self::inverse) up to rounding, which can decide otherwise only
    /// at the very end of a joint's range or where two roots meet. The bits are the same on every processor.
    pub fn inverse_for_rolls(&self, base_from_tool: &Isometry3<f64>, rolls: &Row, out: &mut RollSolutions) {
        Arch::new().dispatch(self.run(base_from_tool, rolls, out));
    }

    fn run<'a>(&'a self, base_from_tool: &Isometry3<f64>, rolls: &Row, out: &'a mut RollSolutions) -> Run<'a> {
        let limit = self.limits[2];
        let inside = |roll| if limit.contains(roll) { roll } else { limit.wrap(roll, SLACK).unwrap_or(f64::NAN) };
        let rolls = Row(rolls.0.map(inside));
        Run { limits: &self.limits, target: self.target(base_from_tool), rolls, out }
    }
}

/// One call of [`Arm::inverse_for_rolls`], compiled for every kind of processor.
struct Run<'a> {
    limits: &'a [JointLimit; 7],
    target: Target,
    /// Inside the limits; NaN has no solution.
    rolls: Row,
    out: &'a mut RollSolutions,
}

impl WithSimd for Run<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { limits, target, rolls, out } = self;
        out.branches.clear();
        out.places = [None; BRANCHES];
        for register in 0..registers::<S>() {
            solve(limits, &target, Lanes::load(simd, &rolls, register), register, out);
        }
    }
}

// In what follows no closure is called and no array mapped: they would not be compiled for the processor at hand.

/// All branches for the rolls of one register.
#[inline(always)]
fn solve<S: Simd>(limits: &[JointLimit; 7], target: &Target, roll: Lanes<S>, register: usize, out: &mut RollSolutions) {
    let (w, simd) = (&target.wrist, roll.simd());
    let third = Turn::at(roll);
    let (a, l1, l2) = (UPPER_ARM_OFFSET, UPPER_ARM, FOREARM);
    let k = w.norm_squared() - a * a - l1 * l1 - l2 * l2;
    let (across, along) = (third.sin * l2, third.cos * l2);
    let qa = -(across * across) + (l1 * l2 / a) * (l1 * l2 / a);
    let qb = Lanes::splat(simd, -k * l1 * l2 / (a * a) - 2.0 * l1 * l2);
    let qc = -(along * along) + ((k / (2.0 * a)) * (k / (2.0 * a)) - l1 * l1 + w.z * w.z);
    let discriminant = qb * qb - qa * qc * 4.0;
    let is_real = (qb * qb * -1e-14).at_most(discriminant);
    let half = (qb + discriminant.no_less_than(0.0).sqrt().copysign(qb)) * -0.5;
    // No division by zero counts: what is no number is no cosine.
    let (first, second) = (half / qa, qc / half);
    let differ = first.below(second).or(second.below(first));
    for (root, cos, is_root) in [(0, first, is_real), (1, second, is_real.and(differ))] {
        let is_root = is_root.and(cos.abs().at_most(Lanes::splat(simd, 1.0 + SLACK)));
        if is_root.is_none() {
            continue;
        }
        let cos = cos.no_more_than(1.0).no_less_than(-1.0);
        let x = (-cos * (2.0 * l1 * l2) + k) / (2.0 * a);
        let sin = ((-cos + 1.0) * (cos + 1.0)).no_less_than(0.0).sqrt();
        for (bend, sin) in [(0, -sin), (1, sin)] {
            if bend == 1 && limits[3].upper <= 0.0 {
                continue;
            }
            let fourth = Turn::of(sin, cos);
            let (q4, is_inside) = wrapped(&limits[3], fourth.angle);
            let is_inside = is_inside.and(is_root);
            if is_inside.is_none() {
                continue;
            }
            let (big_a, b, c) = (cos * l2 + l1, sin * across, -(sin * along));
            let second = Turn::towards(c * x - big_a * w.z, big_a * x + c * w.z);
            let first = Turn::towards((x + a) * w.y - b * w.x, (x + a) * w.x + b * w.y);
            let (q1, is_first_inside) = wrapped(&limits[0], first.angle);
            let (q2, is_second_inside) = wrapped(&limits[1], second.angle);
            let is_inside = is_inside.and(is_first_inside).and(is_second_inside);
            if is_inside.is_none() {
                continue;
            }
            let turns = [first, second, third, fourth];
            wrist(limits, target, &turns, ([q1, q2, roll, q4], is_inside), (register, 4 * root + 2 * bend), out);
        }
    }
}

/// The wrist joints for the first four, and both sides of the wrist stored.
#[inline(always)]
fn wrist<S: Simd>(
    limits: &[JointLimit; 7],
    target: &Target,
    turns: &[Turn<S>; 4],
    ([q1, q2, q3, q4], is_inside): ([Lanes<S>; 4], Mask<S>),
    (register, branch): (usize, usize),
    out: &mut RollSolutions,
) {
    let r = &target.rotation;
    let m0 = seen_after(turns, [r[(0, 0)], r[(1, 0)], r[(2, 0)]]);
    let m1 = seen_after(turns, [r[(0, 1)], r[(1, 1)], r[(2, 1)]]);
    let h = (m0[1] * m0[1] + m0[2] * m0[2]).sqrt();
    for (side, sign) in [(0, -1.0), (1, 1.0)] {
        if side == 1 && limits[5].upper <= 0.0 {
            continue;
        }
        let (q6, is_sixth_inside) = wrapped(&limits[5], h.atan2(m0[0]) * sign);
        let is_inside = is_inside.and(is_sixth_inside);
        if is_inside.is_none() {
            continue;
        }
        let fifth = Turn::towards(m0[1] * sign, m0[2] * -sign);
        let (q5, is_fifth_inside) = wrapped(&limits[4], fifth.angle);
        let q7 = (h * m1[0] * sign + m0[0] * (fifth.cos * m1[2] - fifth.sin * m1[1]))
            .atan2(fifth.cos * m1[1] + fifth.sin * m1[2]);
        let (q7, is_seventh_inside) = wrapped(&limits[6], q7);
        let is_inside = is_inside.and(is_fifth_inside).and(is_seventh_inside);
        if is_inside.is_none() {
            continue;
        }
        let RollSolutions { branches, places } = &mut *out;
        if places[branch + side].is_none() {
            places[branch + side] = Some(branches.len());
            branches.push(Branch::EMPTY);
        }
        let Some(branch) = places[branch + side].and_then(|place| branches.get_mut(place)) else { continue };
        is_inside.ones().store(&mut branch.is_solution, register);
        let [to1, to2, to3, to4, to5, to6, to7] = &mut branch.joints;
        for (joint, row) in [(q1, to1), (q2, to2), (q3, to3), (q4, to4), (q5, to5), (q6, to6), (q7, to7)] {
            joint.store(row, register);
        }
    }
}

/// [`JointLimit::wrap`] of angles in `[-pi, pi]`, and where it has a value.
#[inline(always)]
fn wrapped<S: Simd>(limit: &JointLimit, angle: Lanes<S>) -> (Lanes<S>, Mask<S>) {
    let simd = angle.simd();
    let half_turn = Lanes::splat(simd, PI);
    if limit.is_unlimited() {
        // Where the angle is no number, nothing is a solution.
        return ((angle + TAU).or_where_not(angle.at_most(-half_turn), angle), angle.at_most(half_turn));
    }
    let (lower, upper) = (Lanes::splat(simd, limit.lower - SLACK), Lanes::splat(simd, limit.upper + SLACK));
    let (mut value, mut is_inside) = (angle, lower.at_most(angle).and(angle.at_most(upper)));
    if limit.lower < -PI || limit.upper > PI {
        let turn = Lanes::splat(simd, -TAU).or_where_not(Lanes::splat(simd, 0.0).below(angle), Lanes::splat(simd, TAU));
        for other in [angle + turn, angle - turn] {
            value = value.or_where_not(is_inside, other);
            is_inside = is_inside.or(lower.at_most(other).and(other.at_most(upper)));
        }
    }
    (value.no_more_than(limit.upper).no_less_than(limit.lower), is_inside)
}

/// Angles, rad, with their sines and cosines.
#[derive(Debug, Clone, Copy)]
struct Turn<S: Simd> {
    angle: Lanes<S>,
    sin: Lanes<S>,
    cos: Lanes<S>,
}

impl<S: Simd> Turn<S> {
    #[inline(always)]
    fn at(angle: Lanes<S>) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { angle, sin, cos }
    }

    #[inline(always)]
    fn of(sin: Lanes<S>, cos: Lanes<S>) -> Self {
        Self { angle: sin.atan2(cos), sin, cos }
    }

    /// The angle of the direction `(x, y)` of any length; zero for none.
    #[inline(always)]
    fn towards(y: Lanes<S>, x: Lanes<S>) -> Self {
        let length = (x * x + y * y).sqrt();
        let (zero, one) = (Lanes::splat(x.simd(), 0.0), Lanes::splat(x.simd(), 1.0));
        let is_none = length.at_most(zero);
        let length = one.or_where_not(is_none, length);
        Self::of(y / length, one.or_where_not(is_none, x / length))
    }
}

/// `(Rz(q1) Ry(q2) Rx(q3) Ry(q4))^T v`.
#[inline(always)]
fn seen_after<S: Simd>([t1, t2, t3, t4]: &[Turn<S>; 4], [x, y, z]: [f64; 3]) -> [Lanes<S>; 3] {
    let (x, y) = (t1.cos * x + t1.sin * y, t1.cos * y - t1.sin * x);
    let (x, z) = (t2.cos * x - t2.sin * z, t2.sin * x + t2.cos * z);
    let (y, z) = (t3.cos * y + t3.sin * z, t3.cos * z - t3.sin * y);
    let (x, z) = (t4.cos * x - t4.sin * z, t4.sin * x + t4.cos * z);
    [x, y, z]
}

#[cfg(test)]
mod tests;
