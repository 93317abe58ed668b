//! From where the hand gets to a pose, learned from configurations drawn at random: what a ring around the pose does not know,
//! the limits of the joints.
//!
//! Where the base stands and how it is turned leaves of a hand pose its height, and which way is up in the hand. Configurations
//! that agree with a wanted pose in these two bring the hand there from one base each.

use std::f64::consts::TAU;

use darrt_core::random::{Purpose, stream};
use darrt_core::space::so2::wrap;
use darrt_primitives::hand_ties::up_in_tool;
use darrt_primitives::kinematics::JointLimit;
use nalgebra::{Isometry3, Vector3};
use rand::{Rng, RngExt};

use super::chain::ArmChain;

/// Configurations that are drawn.
const SAMPLES: usize = 20_000;
/// Heights that are kept apart, metres.
const HEIGHT_M: f64 = 0.1;
/// So many of them at most: a rail may be long, and may go up.
const MOST_LEVELS: u32 = 1000;
/// Parts of the sphere of directions: by how far up in the hand is along its x axis, and around it.
const PARTS: [usize; 2] = [8, 10];

/// Where the hand is from a base at the origin: x, y, and its rotation as far as it tells that of a base.
#[derive(Debug, Clone, Copy)]
struct Seen {
    at: [f64; 2],
    /// The x axis of the tool and its y axis, both along the floor.
    axes: [[f64; 2]; 2],
}

/// Hand poses by height and direction.
#[derive(Debug, Clone)]
pub(super) struct Reach {
    lowest: f64,
    levels: usize,
    cells: Vec<Vec<Seen>>,
}

/// Which way is up in the hand, as a part of the sphere.
fn part(pose: &Isometry3<f64>) -> usize {
    let up = up_in_tool(pose);
    let index =
        |share: f64, count: usize| (0..count - 1).take_while(|i| (*i as f64 + 1.0) / count as f64 <= share).count();
    let along = index(f64::midpoint(up.x, 1.0), PARTS[0]);
    let around = index(up.z.atan2(up.y) / TAU + 0.5, PARTS[1]);
    along * PARTS[1] + around
}

fn axes(pose: &Isometry3<f64>) -> [[f64; 2]; 2] {
    [Vector3::x(), Vector3::y()].map(|axis| (pose.rotation * axis).xy().into())
}

impl Reach {
    pub(super) fn new(chain: &ArmChain, limits: &[JointLimit]) -> Self {
        let mut rng = stream(0, 0, 0, Purpose::Extend);
        let mut joints = vec![0.0; limits.len()];
        let mut poses = Vec::with_capacity(SAMPLES);
        for _ in 0..SAMPLES {
            for (slot, limit) in joints.iter_mut().zip(limits) {
                let [low, high] =
                    if limit.is_unlimited() { [-TAU / 2.0, TAU / 2.0] } else { [limit.lower, limit.upper] };
                *slot = rng.random_range(low..=high);
            }
            poses.push(chain.world_from_tool(&[0.0; 3], &joints));
        }
        let heights = || poses.iter().map(|pose| pose.translation.z);
        let lowest = heights().fold(f64::INFINITY, f64::min);
        let highest = heights().fold(f64::NEG_INFINITY, f64::max);
        let levels = (0..MOST_LEVELS).take_while(|level| lowest + f64::from(*level) * HEIGHT_M <= highest).count();
        let mut reach = Self { lowest, levels, cells: vec![Vec::new(); levels * PARTS[0] * PARTS[1]] };
        for pose in &poses {
            let seen = Seen { at: [pose.translation.x, pose.translation.y], axes: axes(pose) };
            if let Some(cell) = reach.cell(pose).and_then(|index| reach.cells.get_mut(index)) {
                cell.push(seen);
            }
        }
        reach
    }

    fn cell(&self, pose: &Isometry3<f64>) -> Option<usize> {
        let above = (pose.translation.z - self.lowest) / HEIGHT_M;
        let level = (0..self.levels).find(|level| above >= *level as f64 && above < (level + 1) as f64)?;
        Some(level * PARTS[0] * PARTS[1] + part(pose))
    }

    /// A base from which a configuration much like the one wanted was seen; `None` if there is none.
    pub(super) fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<[f64; 3]> {
        let cell = self.cells.get(self.cell(world_from_tool)?)?;
        let seen = cell.get(rng.random_range(0..cell.len().max(1)))?;
        // The turn about the vertical that brings the axes that were seen nearest to those that are wanted.
        let pairs = || axes(world_from_tool).into_iter().zip(seen.axes);
        let cross: f64 = pairs().map(|([x, y], [u, v])| u * y - v * x).sum();
        let dot: f64 = pairs().map(|([x, y], [u, v])| u * x + v * y).sum();
        let yaw = wrap(cross.atan2(dot));
        let (sin, cos) = yaw.sin_cos();
        let [u, v] = seen.at;
        let at = world_from_tool.translation;
        Some([at.x - (cos * u - sin * v), at.y - (sin * u + cos * v), yaw])
    }
}
