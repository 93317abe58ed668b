//! Does a grasp hold? Two parallel pads against the weight of what is between them.
//!
//! Each pad presses with the grip force F along the tool's y axis; mu is the coefficient of friction with the object, W
//! its weight. In the tool frame gravity acts on the object with a force f and, about the middle of the patches on which
//! the pads lie, with a moment t. A grasp holds when
//!
//! | condition | reason |
//! |---|---|
//! | the pads are flush with what they close on to within [`FLUSH_RAD`] and atan mu | else the object turns until they are; beyond the friction cones it is squeezed out |
//! | the mass is at most the payload | |
//! | W <= 2 mu F, however the hand is turned | Coulomb friction at two pads |
//! | (fx, fz) and ty: (f / 2 mu F)^2 + (t / 2 mu F c)^2 <= 1 | slip of two soft fingers in their plane: limit surface as an ellipsoid |
//! | abs(fy) <= 2 F | the pad on one side would lift off |
//! | abs(tz) / (F l / 2) + abs(tx) / (F w / 2) <= 1 | the pressure shifts within the l by w patch until a quarter of a pad has lifted off |
//!
//! all with [`SAFETY`] times the weight, and with the object leaning by up to [`FLUSH_RAD`]. The last condition allows half of the couple F l of two pads that touch at opposite
//! ends only. The mean distance c of the pressure from its middle is
//! [`PressureConstant`].
//!
//! # Source
//! Force closure of two contacts: Nguyen, Constructing force-closure grasps, IJRR 7(3), 1988. Soft fingers: Howe and
//! Cutkosky, Practical force-motion models for sliding manipulation, IJRR 15(6), 1996. The couple: own derivation, for pads
//! on an elastic foundation, whose pressure falls linearly from one end; a couple F l / 2 leaves three quarters of the
//! length pressed. A plate that two pads hold askew was seen to turn by its whole tilt, whatever the force and the friction.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Vector3};

use crate::push::GRAVITY;
use crate::push::limit_surface::PressureConstant;

/// Weight that a grasp must bear, in weights of the object.
///
/// A mass 10 % above and a friction 15 % below what is said ask for 1.29; what is left, 1.16, lets the hand accelerate by
/// 1.6 m/s^2.
pub const SAFETY: f64 = 1.5;

/// How far pads may be from flush with what they close on, radians (1 degree): as much as calibrated arms are off.
pub const FLUSH_RAD: f64 = PI / 180.0;

/// Width of the patch where a flat pad lies along a line, metres: of soft pads no less.
pub const LINE_WIDTH_M: f64 = 0.002;

/// How the pads of a closed hand lie on the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PadContact {
    /// Middle of the patches in the tool frame, along x and z, metres; midway between the pads.
    pub middle_m: [f64; 2],
    /// How far the pressure can shift along x and z, metres: the size of the patches, or, where the two differ, the mean.
    pub size_m: [f64; 2],
    /// Mean distance of the pressure from the middle, metres.
    pub spin_arm_m: f64,
    /// Angle between the pads and the surfaces that they close on, radians.
    pub askew_rad: f64,
}

impl PadContact {
    /// Flush patches, `from` and `to` being their corners along x and z, metres; there is no contact where `to` is not
    /// above `from`.
    pub fn flat(from: [f64; 2], to: [f64; 2]) -> Self {
        let [length, width] = [(to[0] - from[0]).max(0.0), (to[1] - from[1]).max(0.0)];
        Self {
            middle_m: [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])],
            size_m: [length, width],
            spin_arm_m: PressureConstant::rectangle(length, width).map_or(0.0, PressureConstant::meters),
            askew_rad: 0.0,
        }
    }
}

/// What is held, and how hard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Mass of the object, kilograms.
    pub mass_kg: f64,
    /// Coefficient of friction between the object and the pads.
    pub friction: f64,
    /// Force of each pad, newton; may be infinite.
    pub grip_force_n: f64,
    /// The heaviest object that the arm carries, kilograms; may be infinite.
    pub payload_kg: f64,
}

/// A grasp that holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// How far the object's z axis may lean from the vertical, in any direction, radians in `[0, pi]`.
    pub max_tilt_rad: f64,
}

/// What an object does in a hand that does not press hard enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Yield {
    /// It slides along the pads.
    Slips,
    /// It turns about the normal of the pads.
    Spins,
    /// It lifts one pad, or one end of both.
    Tips,
}

/// Why a grasp does not hold.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoHold {
    /// No part of the pads lies on the object.
    #[error("the pads do not lie on it")]
    NoContact,
    /// The object would turn in the hand.
    #[error(
        "the pads are {:.1} degrees from flush with it, at most {:.1} hold",
        askew_rad.to_degrees(),
        most_rad.to_degrees()
    )]
    Askew {
        /// Angle between the pads and what they close on.
        askew_rad: f64,
        /// The largest that holds.
        most_rad: f64,
    },
    /// The arm cannot carry it.
    #[error("it weighs {mass_kg} kg, the arm carries {payload_kg}")]
    TooHeavy {
        /// Mass of the object.
        mass_kg: f64,
        /// What the arm carries.
        payload_kg: f64,
    },
    /// No force would do.
    #[error("the fingers have no friction with it")]
    NoFriction,
    /// The hand cannot press hard enough.
    #[error("{} it needs {:.1} N of grip, the gripper has {has_n}", against(*cause), (needs_n * 10.0).ceil() / 10.0)]
    Weak {
        /// What the object would do.
        cause: Yield,
        /// Force that would hold it, newton.
        needs_n: f64,
        /// Force of the gripper, newton.
        has_n: f64,
    },
}

fn against(cause: Yield) -> &'static str {
    match cause {
        Yield::Slips => "against slipping out",
        Yield::Spins => "against turning between the pads",
        Yield::Tips => "against tipping out of the pads",
    }
}

/// Do pads that touch an upright object at `tool_from_object` in this way hold it?
///
/// The centre of mass is taken to be at the origin of the object frame, whose z axis is vertical.
///
/// # Errors
/// [`NoHold`] with the first condition of this module that fails.
///
/// # Laws
/// More mass never makes a grasp hold, more friction and more force never make it fail; nor do they change the largest tilt
/// the other way.
pub fn hold(tool_from_object: &Isometry3<f64>, contact: &PadContact, load: &Load) -> Result<Hold, NoHold> {
    let Load { mass_kg, friction, grip_force_n: has_n, payload_kg } = *load;
    if contact.size_m.iter().any(|size| *size <= 0.0) {
        return Err(NoHold::NoContact);
    }
    if friction <= 0.0 {
        return Err(NoHold::NoFriction);
    }
    let most_rad = FLUSH_RAD.min(friction.atan());
    if contact.askew_rad > most_rad {
        return Err(NoHold::Askew { askew_rad: contact.askew_rad, most_rad });
    }
    if mass_kg > payload_kg {
        return Err(NoHold::TooHeavy { mass_kg, payload_kg });
    }
    let weak = |cause, needs_n: f64| if needs_n > has_n { Err(NoHold::Weak { cause, needs_n, has_n }) } else { Ok(()) };
    weak(Yield::Slips, SAFETY * mass_kg * GRAVITY / (2.0 * friction))?;
    let [x, z] = contact.middle_m;
    let pull =
        Pull { lever: tool_from_object.translation.vector - Vector3::new(x, 0.0, z), contact: *contact, load: *load };
    let down = tool_from_object.rotation * -Vector3::z();
    let sideways = across(&down);
    let mut max_tilt_rad = PI;
    for (cause, needs_n) in Pull::NEEDS {
        let upright_n = needs_n(&pull, &down);
        let [a, b] = sideways.map(|direction| needs_n(&pull, &direction));
        let sideways_n = a.hypot(b);
        weak(cause, upright_n)?;
        // A hand that is off by a degree must hold it too.
        weak(cause, FLUSH_RAD.cos() * upright_n + FLUSH_RAD.sin() * sideways_n)?;
        max_tilt_rad = max_tilt_rad.min(largest_tilt(upright_n, sideways_n, has_n));
    }
    Ok(Hold { max_tilt_rad })
}

/// Two unit vectors across `down` and across each other.
fn across(down: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = down.iamin();
    let mut axis = Vector3::zeros();
    axis[least] = 1.0;
    let first = (axis - down * down[least]).normalize();
    [first, down.cross(&first)]
}

/// The tilt up to which `|cos| upright + |sin| sideways` stays within `has_n`. This bounds the need for a lean in any
/// direction, because every need is a seminorm of the direction of gravity.
fn largest_tilt(upright_n: f64, sideways_n: f64, has_n: f64) -> f64 {
    let most_n = upright_n.hypot(sideways_n);
    if most_n <= has_n {
        return PI;
    }
    (sideways_n.atan2(upright_n) - (has_n / most_n).min(1.0).acos()).max(0.0)
}

/// The pull of gravity on what is held.
struct Pull {
    /// From the middle of the patches to the centre of mass, tool frame, metres.
    lever: Vector3<f64>,
    contact: PadContact,
    load: Load,
}

/// The grip force, newton, that gravity along a unit vector of the tool frame asks for, with [`SAFETY`].
type Need = fn(&Pull, &Vector3<f64>) -> f64;

impl Pull {
    const NEEDS: [(Yield, Need); 3] =
        [(Yield::Spins, Self::against_slip), (Yield::Tips, Self::against_lift), (Yield::Tips, Self::against_tip)];

    fn weight_n(&self) -> f64 {
        SAFETY * self.load.mass_kg * GRAVITY
    }

    /// Against sliding and turning in the plane of the pads.
    fn against_slip(&self, gravity: &Vector3<f64>) -> f64 {
        let spin = self.lever.cross(gravity).y / self.contact.spin_arm_m;
        self.weight_n() * gravity.x.hypot(gravity.z).hypot(spin) / (2.0 * self.load.friction)
    }

    /// Against lifting one pad.
    fn against_lift(&self, gravity: &Vector3<f64>) -> f64 {
        self.weight_n() * gravity.y.abs() / 2.0
    }

    /// Against lifting one end of both.
    fn against_tip(&self, gravity: &Vector3<f64>) -> f64 {
        let moment = self.lever.cross(gravity);
        let [length, width] = self.contact.size_m;
        2.0 * self.weight_n() * (moment.z.abs() / length + moment.x.abs() / width)
    }
}

#[cfg(test)]
mod tests;
