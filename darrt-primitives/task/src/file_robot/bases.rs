//! Where the robot may stand to bring its hand to a pose.

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use darrt_core::space::so2::wrap;
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::world_from_base;
use nalgebra::{Isometry3, Point3};
use rand::{Rng, RngExt};

use super::chain::ArmChain;
use super::reach::Reach;

/// Parts of the arm's length between shoulder and wrist when a base is drawn: least and most.
const DRAWN_PART: [f64; 2] = [0.3, 0.85];
/// The wrist is drawn no farther to either side of straight ahead, radians.
const DRAWN_ASIDE: f64 = 1.3;
/// Share of the draws from the ring: what was not seen is not out of reach.
const RING_SHARE: f64 = 0.2;
/// How far from the axis of a joint a point may be to be on it, metres.
const ON_AXIS_M: f64 = 1e-9;

/// Shoulder and wrist of an arm.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    /// The origin of the first joint's frame at value 0, in the frame of the base.
    shoulder: Point3<f64>,
    /// A point of the hand, in the tool frame, as near to the shoulder as one is.
    wrist: Point3<f64>,
    /// How far the wrist is from the shoulder at most, metres.
    length_m: f64,
    /// The base, if it is bolted down.
    fixed: Option<[f64; 3]>,
    /// Shared, because it is large; made when it is first asked.
    reach: Arc<OnceLock<Reach>>,
}

impl Ring {
    pub(super) fn new(chain: &ArmChain, limits: &[JointLimit], fixed: Option<[f64; 3]>) -> Self {
        // The wrist is the origin of the last joint's frame, or of one further in that the joints beyond it turn about.
        let mut wrist = chain.wrist_from_tool.inverse() * Point3::origin();
        let mut last = chain.joints.len();
        while let Some(joint) = last.checked_sub(1).filter(|index| *index > 0).and_then(|index| chain.joints.get(index))
        {
            let inner = (joint.before.inverse() * Point3::origin()).coords;
            let off_axis = inner - joint.axis.into_inner() * inner.dot(&joint.axis);
            // A point on the last axis stays where it is in the hand; further in only what is at the same place does.
            let is_last = last == chain.joints.len();
            let stays = if is_last { off_axis.norm() <= ON_AXIS_M } else { inner.norm() <= ON_AXIS_M };
            if joint.slides || !stays {
                break;
            }
            if is_last {
                wrist = chain.wrist_from_tool.inverse() * Point3::from(inner);
            }
            last -= 1;
        }
        let farthest = |limit: &JointLimit| limit.lower.abs().max(limit.upper.abs());
        let slides = chain.joints.iter().zip(limits).take(last).filter(|(joint, _)| joint.slides);
        let slides: f64 = slides.map(|(_, limit)| farthest(limit)).sum();
        let bones: f64 =
            chain.joints.iter().take(last).skip(1).map(|joint| joint.before.translation.vector.norm()).sum();
        let shoulder = chain.joints.first().map_or(Isometry3::identity(), |joint| joint.before) * Point3::origin();
        Self { shoulder, wrist, length_m: bones + slides, fixed, reach: Arc::default() }
    }

    /// Is the base bolted down?
    pub(super) fn is_fixed(&self) -> bool {
        self.fixed.is_some()
    }

    /// A base from which the arm was seen to get to such poses; for some draws, and for poses that were not seen, the shoulder in a
    /// ring around the wrist, uniform over its area, the robot roughly facing the wrist.
    pub(super) fn base_for(
        &self,
        (chain, limits): (&ArmChain, &[JointLimit]),
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> [f64; 3] {
        if let Some(base) = self.fixed {
            return base;
        }
        if !rng.random_bool(RING_SHARE)
            && let Some(base) = self.reach.get_or_init(|| Reach::new(chain, limits)).base_for(world_from_tool, rng)
        {
            return base;
        }
        let wrist = world_from_tool * self.wrist;
        let rise = wrist.z - self.shoulder.z;
        let [least, most] = DRAWN_PART.map(|part| (part * self.length_m).powi(2));
        let most = (most - rise * rise).max(least + 1e-6);
        let distance = rng.random_range(least..most).sqrt();
        let bearing = rng.random_range(-PI..PI);
        let yaw = wrap(bearing - rng.random_range(-DRAWN_ASIDE..DRAWN_ASIDE));
        let (sin, cos) = yaw.sin_cos();
        let shoulder = self.shoulder;
        [
            wrist.x - distance * bearing.cos() - (cos * shoulder.x - sin * shoulder.y),
            wrist.y - distance * bearing.sin() - (sin * shoulder.x + cos * shoulder.y),
            yaw,
        ]
    }

    /// A necessary condition.
    pub(super) fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        let shoulder = world_from_base(base) * self.shoulder;
        (world_from_tool * self.wrist - shoulder).norm() <= self.length_m + 1e-9
    }
}
