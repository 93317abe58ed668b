//! The configuration space of base and arm: a bounded plane with heading, times the joints.

use darrt_core::error::Error;
use darrt_core::space::so2::turn;
use darrt_core::space::{ComponentSpace, GroupSet, Se2};
use rand::{Rng, RngExt};

use crate::kinematics::JointLimit;
use crate::kinematics::limit::wrap_to_pi;
use crate::manipulator::{Configuration, JointVector};

/// Group 0 of the robot: the base.
pub const BASE: GroupSet = GroupSet::only(0);
/// Group 1 of the robot: the arm.
pub const ARM: GroupSet = GroupSet::only(1);

/// Base and arm. Continuous joints take the shorter way round.
#[derive(Debug, Clone)]
pub struct MobileArmSpace<J> {
    base: Se2,
    limits: Vec<JointLimit>,
    weights_m: Vec<f64>,
    /// All joints at zero.
    zeros: J,
}

impl<J: JointVector> MobileArmSpace<J> {
    /// Base positions in `[lower, upper]` (metres), joints within `limits`, hand travel per joint unit `weights_m`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for bounds that are not finite or inverted, or a wrong number of limits or weights.
    pub fn new(lower: [f64; 2], upper: [f64; 2], limits: &[JointLimit], weights_m: &[f64]) -> Result<Self, Error> {
        let wrong = |name: &str, found: usize| {
            let bound = "the number of joints of the arm";
            Error::Parameter { name: name.to_owned(), value: found as f64, bound }
        };
        let zeros = J::zeros(limits.len()).ok_or_else(|| wrong("number of joint limits", limits.len()))?;
        if weights_m.len() != limits.len() {
            return Err(wrong("number of joint weights", weights_m.len()));
        }
        // A turn of the base moves the hand, which is about half a metre away from the axis.
        let base = Se2::new(lower, upper, 0.5)?;
        Ok(Self { base, limits: limits.to_vec(), weights_m: weights_m.to_vec(), zeros })
    }

    /// The base's part.
    pub fn base(&self) -> &Se2 {
        &self.base
    }

    /// The joint limits.
    pub fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    /// The arm with all joints at zero, which may be outside the limits.
    pub fn zeros(&self) -> &J {
        &self.zeros
    }

    /// Is one arm configuration within the limits?
    pub fn contains_arm(&self, arm: &J) -> bool {
        arm.as_ref().iter().zip(&self.limits).all(|(q, limit)| q.is_finite() && limit.contains(*q))
    }

    /// The first joint outside its limits: its index and value.
    pub fn first_outside(&self, arm: &J) -> Option<(usize, f64)> {
        let mut joints = arm.as_ref().iter().zip(&self.limits).enumerate();
        joints.find_map(|(i, (q, limit))| (!q.is_finite() || !limit.contains(*q)).then_some((i, *q)))
    }

    fn arm_distance(&self, a: &J, b: &J) -> f64 {
        let joints = a.as_ref().iter().zip(b.as_ref()).zip(self.limits.iter().zip(&self.weights_m));
        joints.map(|((p, q), (limit, w))| (w * difference(*p, *q, limit)).powi(2)).sum::<f64>().sqrt()
    }

    fn interpolate_arm(&self, a: &J, b: &J, t: f64) -> J {
        // Whichever hand is at work at the end is so all the way.
        let mut out = a.with_hand_at_work(b.hand_at_work());
        for ((slot, q), limit) in out.as_mut().iter_mut().zip(b.as_ref()).zip(&self.limits) {
            let d = difference(*slot, *q, limit);
            let value = *slot + d * t;
            *slot = if limit.is_unlimited() { wrap_to_pi(value) } else { value.clamp(slot.min(*q), slot.max(*q)) };
        }
        out
    }
}

/// Signed travel of one joint from `from` to `to`: the shorter way for a continuous joint.
pub fn difference(from: f64, to: f64, limit: &JointLimit) -> f64 {
    if limit.is_unlimited() { turn(from, to) } else { to - from }
}

impl<J: JointVector> ComponentSpace for MobileArmSpace<J> {
    type Config = Configuration<J>;

    fn dimension(&self) -> usize {
        3 + self.limits.len()
    }

    fn contains(&self, q: &Configuration<J>) -> bool {
        self.base.contains(&q.base) && self.contains_arm(&q.arm)
    }

    fn distance(&self, a: &Configuration<J>, b: &Configuration<J>) -> f64 {
        self.base.distance(&a.base, &b.base) + self.arm_distance(&a.arm, &b.arm)
    }

    fn interpolate(&self, a: &Configuration<J>, b: &Configuration<J>, t: f64) -> Configuration<J> {
        if t <= 0.0 {
            return *a;
        }
        if t >= 1.0 {
            return *b;
        }
        Configuration { base: self.base.interpolate(&a.base, &b.base, t), arm: self.interpolate_arm(&a.arm, &b.arm, t) }
    }

    fn sample(&self, rng: &mut dyn Rng) -> Configuration<J> {
        let base = self.base.sample(rng);
        let mut arm = self.zeros;
        for (slot, limit) in arm.as_mut().iter_mut().zip(&self.limits) {
            let (lower, upper) = if limit.is_unlimited() {
                (-std::f64::consts::PI, std::f64::consts::PI)
            } else {
                (limit.lower, limit.upper)
            };
            *slot = rng.random_range(lower..=upper);
        }
        Configuration { base, arm }
    }

    fn tolerance(&self) -> f64 {
        1e-6
    }

    fn groups(&self) -> GroupSet {
        BASE.union(ARM)
    }

    fn index_coordinates(&self, q: &Configuration<J>, mark: &mut dyn FnMut(u32, f64)) {
        self.base.index_coordinates(&q.base, mark);
        for (q, (limit, w)) in q.arm.as_ref().iter().zip(self.limits.iter().zip(&self.weights_m)) {
            if limit.is_unlimited() {
                // No chord is longer than its arc.
                mark(1, w * q.cos());
                mark(1, w * q.sin());
            } else {
                mark(1, w * q);
            }
        }
    }

    fn numbers(&self, q: &mut Configuration<J>, visit: &mut dyn FnMut(&mut f64)) {
        q.base.iter_mut().chain(q.arm.as_mut()).for_each(visit);
    }

    fn overlay(&self, from: &Configuration<J>, target: &Configuration<J>, groups: GroupSet) -> Configuration<J> {
        Configuration {
            base: if groups.covers(BASE) { target.base } else { from.base },
            arm: if groups.covers(ARM) { target.arm } else { from.arm },
        }
    }
}
