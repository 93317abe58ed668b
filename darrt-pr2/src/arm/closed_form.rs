//! The closed-form inverse of the arm, for a given upper arm roll or a given shoulder pan.
//!
//! The wrist centre depends on the first four joints only. Seen from the pan axis it is `Rz(q1) (a + X, B, wz)` with
//! `X = A cos q2 + C sin q2`, `A = L1 + L2 cos q4`, `B = L2 sin q4 sin q3`, `C = -L2 sin q4 cos q3`. Its distance gives
//! `X` as a linear function of `cos q4`; putting that into `X^2 + wz^2 = A^2 + C^2` leaves one quadratic. The hand's
//! rotation then gives the three wrist joints.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::{Arm, ArmConfiguration, Solutions};
use crate::forward::{FOREARM, SHOULDER_X, SHOULDER_Y, SHOULDER_Z, TOOL, UPPER_ARM, UPPER_ARM_OFFSET};

/// How far outside a limit, or beyond one for a cosine, rounding may carry a value.
pub(super) const SLACK: f64 = 1e-12;

/// What the inverse needs of a pose.
pub(super) struct Target {
    /// Wrist centre seen from the pan axis at shoulder height, base axes, m.
    pub(super) wrist: Vector3<f64>,
    /// Rotation of the tool in the base frame.
    pub(super) rotation: Matrix3<f64>,
}

impl Arm {
    /// Writes every configuration inside the limits that puts the tool at `base_from_tool` with the given upper arm
    /// roll (rad; whole turns are removed).
    ///
    /// `out` is cleared first; joints without limits come in `(-pi, pi]`. With the limits of the PR2 there are at most
    /// two solutions, mostly one. A pose that is not finite has none.
    ///
    /// # Laws
    /// `base_from_tool(q)` equals the pose to 1e-12 for every `q` written.
    ///
    /// # Source
    /// Own derivation; see the head of this file.
    pub fn inverse(&self, base_from_tool: &Isometry3<f64>, upper_arm_roll: f64, out: &mut Solutions) {
        out.clear();
        let Some(q3) = self.limits[2].wrap(upper_arm_roll, SLACK) else {
            return;
        };
        let target = self.target(base_from_tool);
        let w = &target.wrist;
        let (s3, c3) = q3.sin_cos();
        let (a, l1, l2) = (UPPER_ARM_OFFSET, UPPER_ARM, FOREARM);
        let k = w.norm_squared() - a * a - l1 * l1 - l2 * l2;
        let qa = (l1 * l2 / a).powi(2) - (l2 * s3).powi(2);
        let qb = -k * l1 * l2 / (a * a) - 2.0 * l1 * l2;
        let qc = (k / (2.0 * a)).powi(2) - l1 * l1 - (l2 * c3).powi(2) + w.z * w.z;
        for c4 in quadratic_roots(qa, qb, qc).into_iter().flatten() {
            let Some(c4) = cosine(c4) else { continue };
            let x = (k - 2.0 * l1 * l2 * c4) / (2.0 * a);
            for s4 in self.elbow_sines(c4).into_iter().flatten() {
                let fourth = Turn::of(s4, c4);
                if self.limits[3].wrap(fourth.angle, SLACK).is_none() {
                    continue;
                }
                let (big_a, b, c) = (l1 + l2 * c4, l2 * s4 * s3, -l2 * s4 * c3);
                let second = Turn::towards(c * x - big_a * w.z, big_a * x + c * w.z);
                // The difference of the directions of (wx, wy) and of (a + x, b).
                let first = Turn::towards(w.y * (a + x) - w.x * b, w.x * (a + x) + w.y * b);
                self.wrist([first, second, Turn { angle: q3, sin: s3, cos: c3 }, fourth], &target, out);
            }
        }
    }

    /// Writes every configuration inside the limits that puts the tool at `base_from_tool` with the given shoulder pan
    /// (rad; whole turns are removed). Otherwise as [`inverse`](Self::inverse).
    pub fn inverse_with_pan(&self, base_from_tool: &Isometry3<f64>, shoulder_pan: f64, out: &mut Solutions) {
        out.clear();
        let Some(q1) = self.limits[0].wrap(shoulder_pan, SLACK) else {
            return;
        };
        let target = self.target(base_from_tool);
        let w = &target.wrist;
        let (s1, c1) = q1.sin_cos();
        let (l1, l2) = (UPPER_ARM, FOREARM);
        // The wrist centre seen from the shoulder lift axis, pan removed.
        let v = Vector3::new(c1 * w.x + s1 * w.y - UPPER_ARM_OFFSET, c1 * w.y - s1 * w.x, w.z);
        let Some(c4) = cosine((v.norm_squared() - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)) else {
            return;
        };
        for s4 in self.elbow_sines(c4).into_iter().flatten() {
            let Some(s3) = upper_roll_sine(v.y, l2 * s4) else { continue };
            let c3 = ((1.0 - s3) * (1.0 + s3)).sqrt();
            for third in [Turn::of(s3, c3), Turn::of(s3, -c3)] {
                let (big_a, c) = (l1 + l2 * c4, -l2 * s4 * third.cos);
                let second = Turn::towards(c * v.x - big_a * v.z, big_a * v.x + c * v.z);
                let first = Turn { angle: q1, sin: s1, cos: c1 };
                self.wrist([first, second, third, Turn::of(s4, c4)], &target, out);
            }
        }
    }

    pub(super) fn target(&self, base_from_tool: &Isometry3<f64>) -> Target {
        let rotation = base_from_tool.rotation.to_rotation_matrix().into_inner();
        let shoulder = Vector3::new(SHOULDER_X, self.side.sign() * SHOULDER_Y, SHOULDER_Z + self.torso_m);
        Target { wrist: base_from_tool.translation.vector - TOOL * rotation.column(0) - shoulder, rotation }
    }

    /// The sines of the elbow for a cosine; a bend the limits exclude is not tried.
    fn elbow_sines(&self, c4: f64) -> [Option<f64>; 2] {
        let s4 = ((1.0 - c4) * (1.0 + c4)).max(0.0).sqrt();
        [Some(-s4), (self.limits[3].upper > 0.0 && s4 > 0.0).then_some(s4)]
    }

    /// Adds the wrist joints to the first four and stores what lies inside the limits.
    // OPTIMIZATION: limits are looked at as soon as a joint is known, and of a product of rotations only the two columns
    // that the angles need are computed, from sines and cosines that are known already.
    fn wrist(&self, first: [Turn; 4], target: &Target, out: &mut Solutions) {
        if first.iter().zip(&self.limits).any(|(turn, limit)| limit.wrap(turn.angle, SLACK).is_none()) {
            return;
        }
        // m = Rx(q5) Ry(q6) Rx(q7), the rotation of the hand seen from the forearm.
        let m0 = seen_after(&first, target.rotation.column(0).into());
        let h = (m0.y * m0.y + m0.z * m0.z).sqrt();
        for sign in [-1.0, 1.0] {
            if sign > 0.0 && self.limits[5].upper <= 0.0 {
                continue;
            }
            let q6 = sign * h.atan2(m0.x);
            if self.limits[5].wrap(q6, SLACK).is_none() {
                continue;
            }
            // With a straight wrist only q5 + q7 is given: q5 is zero then.
            let fifth = if h > 0.0 { Turn::of(sign * m0.y / h, -sign * m0.z / h) } else { Turn::of(0.0, 1.0) };
            let m1 = seen_after(&first, target.rotation.column(1).into());
            // What is left after q5 and q6: two independent arc tangents would lose all accuracy near a straight wrist.
            let q7 = (sign * h * m1.x + m0.x * (fifth.cos * m1.z - fifth.sin * m1.y))
                .atan2(fifth.cos * m1.y + fifth.sin * m1.z);
            let [q1, q2, q3, q4] = first.map(|turn| turn.angle);
            self.keep([q1, q2, q3, q4, fifth.angle, q6, q7], out);
        }
    }

    fn keep(&self, raw: ArmConfiguration, out: &mut Solutions) {
        let mut q = raw;
        for (value, limit) in q.iter_mut().zip(&self.limits) {
            match limit.wrap(*value, SLACK) {
                Some(inside) => *value = inside,
                None => return,
            }
        }
        // Merged branches (a double root, a straight elbow) give one configuration twice.
        if !out.contains(&q) {
            // At most eight branches reach this line, the capacity of `out`.
            let _ = out.try_push(q);
        }
    }
}

/// `value` as a cosine: inside `[-1, 1]` up to rounding.
fn cosine(value: f64) -> Option<f64> {
    (value.abs() <= 1.0 + SLACK).then(|| value.clamp(-1.0, 1.0))
}

/// Sine of the upper arm roll from the sideways offset of the wrist; zero when the elbow is straight and any roll fits.
fn upper_roll_sine(offset: f64, lever: f64) -> Option<f64> {
    if offset.abs() <= SLACK && lever.abs() <= SLACK { Some(0.0) } else { cosine(offset / lever) }
}

/// Real roots, without cancellation; a discriminant below zero by rounding counts as zero.
fn quadratic_roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant < -1e-14 * b * b {
        return [None, None];
    }
    let half = -0.5 * (b + discriminant.max(0.0).sqrt().copysign(b));
    if half == 0.0 {
        return [Some(0.0), None];
    }
    let (first, second) = (half / a, c / half);
    [Some(first), (first != second).then_some(second)]
}

/// An angle, rad, with its sine and cosine.
#[derive(Debug, Clone, Copy)]
struct Turn {
    angle: f64,
    sin: f64,
    cos: f64,
}

impl Turn {
    fn of(sin: f64, cos: f64) -> Self {
        Self { angle: sin.atan2(cos), sin, cos }
    }

    /// The angle of the direction `(x, y)` of any length; zero for none.
    fn towards(y: f64, x: f64) -> Self {
        let length = (x * x + y * y).sqrt();
        if length > 0.0 { Self::of(y / length, x / length) } else { Self::of(0.0, 1.0) }
    }
}

/// `(Rz(q1) Ry(q2) Rx(q3) Ry(q4))^T v`.
fn seen_after(turns: &[Turn; 4], v: Vector3<f64>) -> Vector3<f64> {
    let [t1, t2, t3, t4] = turns;
    let (x, y) = (t1.cos * v.x + t1.sin * v.y, t1.cos * v.y - t1.sin * v.x);
    let (x, z) = (t2.cos * x - t2.sin * v.z, t2.sin * x + t2.cos * v.z);
    let (y, z) = (t3.cos * y + t3.sin * z, t3.cos * z - t3.sin * y);
    let (x, z) = (t4.cos * x - t4.sin * z, t4.sin * x + t4.cos * z);
    Vector3::new(x, y, z)
}
