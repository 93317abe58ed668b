//! Where the base may stand so that the tool reaches a pose: an inverse reachability model of one arm.
//!
//! The last joint turns the hand about its own x axis without end, so whether a pose is reached depends on five numbers
//! only: the height of the wrist over the shoulder, the tilt of the hand, the wrist's horizontal distance from the pan
//! axis, the direction of the hand against that of the wrist, and the bearing of the wrist before the robot. The last one
//! only shifts the shoulder pan, so a cell of the first four holds the bearings as bits. For a given tool pose height and
//! tilt are known: one slice of the model, computed from the closed-form inverse when it is first asked for.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::OnceLock;

use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::kinematics::lanes::{LANES, Row};
use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

use crate::arm::many_rolls::RollSolutions;
use crate::arm::{Arm, Solutions};
use crate::forward::{FOREARM, SHOULDER_X, SHOULDER_Y, SHOULDER_Z, TOOL, UPPER_ARM, UPPER_ARM_OFFSET};

/// Step of heights and distances, metres.
const STEP_M: f64 = 0.05;
/// Heights of the wrist over the shoulder: as many steps up as down.
const HEIGHTS_EACH_WAY: usize = 17;
/// Tilts of the hand, from straight down to straight up.
const TILTS: usize = 17;
/// Horizontal distances of the wrist from the pan axis; a cell holds those around its middle.
const DISTANCES: usize = 17;
/// Directions of the hand.
const DIRECTIONS: usize = 32;
/// Bearings of the wrist: one bit each.
const BEARINGS: u32 = u64::BITS;
/// Upper arm rolls looked at, in batches.
const ROLL_BATCHES: usize = 6;

const TILT_STEP: f64 = PI / (TILTS - 1) as f64;
const DIRECTION_STEP: f64 = TAU / DIRECTIONS as f64;
const BEARING_STEP: f64 = TAU / BEARINGS as f64;

/// The cells of one height and one tilt.
#[derive(Debug)]
struct Slice {
    /// `bearings[distance * DIRECTIONS + direction]`: a bit for each bearing from which a pose of the cell is reached.
    bearings: Vec<u64>,
    /// Areas of the cells of [`bearings`](Self::bearings) that bases are drawn from, summed up to each.
    area: Vec<f64>,
}

/// The model of one arm. What it says is a pure function of the arm.
///
/// # Laws
/// - A pose that the exact inverse reaches is one that the model [may reach](Self::may_reach), but for slivers narrower
///   than a cell (5 cm, 11 degrees) that none of its neighbours knows: fewer than one reachable pose in a thousand.
/// - From most of the bases [drawn](Self::base_for) the exact inverse reaches the pose.
#[derive(Debug)]
pub struct Reachability {
    /// The arm with a pan that turns without end.
    arm: Arm,
    /// Bearings reached when the arm reaches straight ahead: the range of the pan.
    ahead: u64,
    /// Nearest horizontal distance from the pan axis to the wrist that is drawn, metres.
    least_distance_m: f64,
    slices: Vec<OnceLock<Slice>>,
}

/// A tool pose as the model sees it.
struct Asked {
    /// The wrist's centre, world.
    wrist: Vector3<f64>,
    /// Number of the height.
    height: usize,
    /// Number of the tilt.
    tilt: usize,
    /// Heading of the hand in the world, rad.
    heading: f64,
}

impl Reachability {
    /// The model of an arm. Wrists nearer to the pan axis than `least_distance_m` (horizontally) are never drawn.
    ///
    /// Costs nothing yet: a slice takes a few milliseconds when it is first asked for, and 9 kB.
    pub fn new(arm: &Arm, least_distance_m: f64) -> Self {
        let mut free = arm.clone();
        free.limits[0] = JointLimit::UNLIMITED;
        let within = |bit: &u32| arm.limits[0].wrap(BEARING_STEP * f64::from(*bit), 0.0).is_some();
        let ahead = (0..BEARINGS).filter(within).fold(0, |bits, bit| bits | 1 << bit);
        let slices = (0..(2 * HEIGHTS_EACH_WAY + 1) * TILTS).map(|_| OnceLock::new()).collect();
        Self { arm: free, ahead, least_distance_m, slices }
    }

    /// A base pose (x, y in metres, yaw in rad) from which the arm mostly reaches `world_from_tool`, uniform over the
    /// bases that the model knows; obstacles are ignored. `None` when it knows none.
    pub fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<[f64; 3]> {
        let asked = self.asked(world_from_tool)?;
        let slice = self.slice(asked.height, asked.tilt)?;
        let total = slice.area.last().copied().filter(|total| *total > 0.0)?;
        let drawn = rng.random_range(0.0..total);
        let cell = slice.area.partition_point(|upto| *upto <= drawn);
        let mut bits = *slice.bearings.get(cell)?;
        for _ in 0..rng.random_range(0..bits.count_ones()) {
            bits &= bits - 1;
        }
        let mut within = |middle: f64| middle + rng.random_range(-0.5..0.5);
        let bearing = BEARING_STEP * within(f64::from(bits.trailing_zeros()));
        let direction = DIRECTION_STEP * within((cell % DIRECTIONS) as f64);
        let distance = (STEP_M * within(middle_of(cell / DIRECTIONS))).max(0.0);
        let yaw = wrap_to_pi(asked.heading - direction - bearing);
        let towards = yaw + bearing;
        let (sin, cos) = yaw.sin_cos();
        let [x, y] = [SHOULDER_X, self.arm.side.sign() * SHOULDER_Y];
        Some([
            asked.wrist.x - distance * towards.cos() - (cos * x - sin * y),
            asked.wrist.y - distance * towards.sin() - (sin * x + cos * y),
            yaw,
        ])
    }

    /// Can the arm reach `world_from_tool` from this base (x, y in metres, yaw in rad), as far as the model knows? Looks
    /// at the cell and its neighbours.
    pub fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        let Some(asked) = self.asked(world_from_tool) else { return false };
        let [x, y, yaw] = *base;
        let (sin, cos) = yaw.sin_cos();
        let side = self.arm.side.sign() * SHOULDER_Y;
        let dx = asked.wrist.x - (x + cos * SHOULDER_X - sin * side);
        let dy = asked.wrist.y - (y + sin * SHOULDER_X + cos * side);
        let distance = (dx.hypot(dy) / STEP_M).floor();
        if distance > DISTANCES as f64 {
            return false;
        }
        let towards = dy.atan2(dx);
        let bearing = bearing(towards - yaw);
        let direction = around(asked.heading - towards, DIRECTION_STEP, DIRECTIONS);
        // Not negative and below a bound: no sign and no digit is lost.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small whole number")]
        let distance = distance as usize;
        let bits = 0b111_u64.rotate_right(1).rotate_left(bearing);
        let near = |at: usize| at.saturating_sub(1)..=at + 1;
        near(asked.height).any(|height| {
            near(asked.tilt).filter_map(|tilt| self.slice(height, tilt)).any(|slice| {
                near(distance).filter(|distance| *distance < DISTANCES).any(|distance| {
                    (direction + DIRECTIONS - 1..=direction + DIRECTIONS + 1)
                        .any(|direction| slice.bearings[distance * DIRECTIONS + direction % DIRECTIONS] & bits != 0)
                })
            })
        })
    }

    /// `None` for a pose that is too high, too low or no number.
    fn asked(&self, world_from_tool: &Isometry3<f64>) -> Option<Asked> {
        let axis = world_from_tool.rotation * Vector3::x();
        let wrist = world_from_tool.translation.vector - TOOL * axis;
        let over = wrist.z - (SHOULDER_Z + self.arm.torso_m);
        let height = (over / STEP_M).round() + HEIGHTS_EACH_WAY as f64;
        if !(0.0..=2.0 * HEIGHTS_EACH_WAY as f64).contains(&height) || !wrist.x.is_finite() || !wrist.y.is_finite() {
            return None;
        }
        let tilt = ((axis.z.clamp(-1.0, 1.0).asin() + FRAC_PI_2) / TILT_STEP).round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small whole numbers, not negative"
        )]
        let (height, tilt) = (height as usize, tilt as usize);
        Some(Asked { wrist, height, tilt, heading: axis.y.atan2(axis.x) })
    }

    /// `None` beyond the last height or tilt.
    fn slice(&self, height: usize, tilt: usize) -> Option<&Slice> {
        let slot = self.slices.get(height * TILTS + tilt).filter(|_| tilt < TILTS)?;
        Some(slot.get_or_init(|| self.compute(height, tilt)))
    }

    fn compute(&self, height: usize, tilt: usize) -> Slice {
        let height = STEP_M * (height as f64 - HEIGHTS_EACH_WAY as f64);
        let tilt = TILT_STEP * tilt as f64 - FRAC_PI_2;
        let mut bearings = Vec::with_capacity(DISTANCES * DIRECTIONS);
        let mut area = Vec::with_capacity(DISTANCES * DIRECTIONS);
        let mut sum = 0.0;
        for distance in 0..DISTANCES {
            let distance = STEP_M * middle_of(distance);
            for direction in 0..DIRECTIONS {
                let bits = self.cell(height, tilt, distance, DIRECTION_STEP * direction as f64);
                bearings.push(bits);
                if distance >= self.least_distance_m {
                    sum += distance * f64::from(bits.count_ones());
                }
                area.push(sum);
            }
        }
        Slice { bearings, area }
    }

    /// The bearings from which the arm reaches the middle of a cell.
    fn cell(&self, height: f64, tilt: f64, distance: f64, direction: f64) -> u64 {
        if height.hypot(distance) > UPPER_ARM_OFFSET + UPPER_ARM + FOREARM {
            return 0;
        }
        let axis = Vector3::new(tilt.cos() * direction.cos(), tilt.cos() * direction.sin(), tilt.sin());
        let shoulder = Vector3::new(SHOULDER_X, self.arm.side.sign() * SHOULDER_Y, SHOULDER_Z + self.arm.torso_m);
        let tool = shoulder + Vector3::new(distance, 0.0, height) + TOOL * axis;
        let turn = UnitQuaternion::rotation_between(&Vector3::x(), &axis)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI));
        let base_from_tool = Isometry3::from_parts(Translation3::from(tool), turn);
        let (mut many, mut solutions) = (RollSolutions::default(), Solutions::new());
        let mut bits = 0_u64;
        for rolls in self.rolls() {
            self.arm.inverse_for_rolls(&base_from_tool, &rolls, &mut many);
            for lane in (0..LANES).filter(|_| !many.is_empty()) {
                many.of_lane(lane, &mut solutions);
                for [pan, ..] in &solutions {
                    // The wrist stands at the bearing b when the pan is that much more; b = pan - this pan.
                    bits |= self.ahead.rotate_right(bearing(*pan));
                }
            }
        }
        bits
    }

    /// Upper arm rolls all over the range.
    fn rolls(&self) -> [Row; ROLL_BATCHES] {
        let roll = self.arm.limits[2];
        let (lower, upper) = if roll.is_unlimited() { (-PI, PI) } else { (roll.lower, roll.upper) };
        let step = (upper - lower) / (ROLL_BATCHES * LANES) as f64;
        std::array::from_fn(|batch| {
            Row(std::array::from_fn(|lane| lower + step * ((batch * LANES + lane) as f64 + 0.5)))
        })
    }
}

fn middle_of(cell: usize) -> f64 {
    cell as f64 + 0.5
}

/// The bit of a bearing.
fn bearing(angle: f64) -> u32 {
    // Below BEARINGS, so it fits.
    u32::try_from(around(angle, BEARING_STEP, BEARINGS as usize)).unwrap_or(0)
}

/// The number of the step nearest to an angle, of `count` all around.
fn around(angle: f64, step: f64, count: usize) -> usize {
    let nearest = (angle / step).round().rem_euclid(count as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number in 0..=count")]
    let nearest = nearest as usize;
    nearest % count
}

#[cfg(test)]
mod tests;
