//! Why a plan is refused: the step, the time, the bodies, the place.

use std::fmt;

use nalgebra::Point3;

use darrt_primitives::contract::Contract;

use crate::problem_file::PrimitiveName;

/// The kind of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum RefusalKind {
    /// The problem inside the plan is not valid, or its robot or scene cannot be built.
    Problem,
    /// A waypoint is malformed: unknown or missing joints or objects, numbers that are none, no unit quaternion.
    Malformed,
    /// The plan does not start where the problem does.
    Start,
    /// A step does not start where the one before ended.
    Chain,
    /// The primitive is not among those that the problem allows.
    Primitive,
    /// A step and what is held, resting or pushed do not fit together.
    Mode,
    /// A joint is beyond a limit, or its way is ambiguous.
    Joints,
    /// The base or an object is outside the problem's bounds.
    Bounds,
    /// Something moves that the step does not move.
    Stray,
    /// The gripper moves when it may not, or not the way it must.
    Gripper,
    /// A contact is allowed that no step may need.
    AllowedContact,
    /// Two bodies collide.
    Collision,
    /// What is held is not rigid to the tool, or not between the fingers.
    Grasp,
    /// The tool leaves the straight line that the primitive promises.
    StraightLine,
    /// A step does what a rule of the problem forbids.
    Steer,
    /// A push that does not go as pushes go.
    Push,
    /// An object does not stand on a surface where it must.
    Support,
    /// A grasp that cannot hold its object.
    Hold,
    /// A held object leans farther than it may.
    Tilt,
    /// Two bodies that need not be near are nearer than the least margin.
    Margin,
    /// An object is set down or pushed nearer to an edge than it may.
    Edge,
    /// The goal does not hold at the end.
    Goal,
    /// The clock is none for this plan.
    Clock,
    /// A joint or the base is faster than it may be.
    Velocity,
    /// A joint or the base accelerates harder than it may.
    Acceleration,
    /// The acceleration of a joint or of the base changes faster than it may.
    Jerk,
    /// The hand is faster, or accelerates harder, than what it is doing allows.
    Pace,
    /// The robot does not stand as long as it must around a grasp or a contact.
    Wait,
    /// Nothing is known to be wrong: the judgement was given up.
    Cancelled,
}

/// The first fault found in a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Number of the step, from 1; `None` when the plan as a whole is at fault.
    pub step: Option<u32>,
    /// What the step claims to be.
    pub primitive: Option<PrimitiveName>,
    /// Fraction of the step, 0 to 1, its waypoints taken as equally spaced.
    pub time: f64,
    /// What kind of fault it is.
    pub kind: RefusalKind,
    /// The two bodies concerned, where it is about two.
    pub bodies: Option<Box<(String, String)>>,
    /// Where in the world, where it is about a place.
    pub place: Option<[f64; 3]>,
    /// What is wrong, with names, values and bounds.
    pub message: Box<str>,
}

impl Refusal {
    /// A fault of the plan as a whole.
    pub(super) fn whole(kind: RefusalKind, message: impl Into<Box<str>>) -> Self {
        Self { step: None, primitive: None, time: 0.0, kind, bodies: None, place: None, message: message.into() }
    }

    /// The same about two bodies.
    pub(super) fn about(mut self, a: &str, b: &str) -> Self {
        self.bodies = Some(Box::new((a.to_owned(), b.to_owned())));
        self
    }

    /// The same at a place.
    pub(super) fn at(mut self, place: &Point3<f64>) -> Self {
        self.place = Some([place.x, place.y, place.z]);
        self
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(step) = self.step {
            write!(f, "step {step}")?;
            if let Some(primitive) = &self.primitive {
                write!(f, " ({primitive})")?;
            }
            write!(f, " at {:.3}: ", self.time)?;
        }
        f.write_str(&self.message)?;
        if let Some([x, y, z]) = self.place {
            write!(f, " at ({x:.4}, {y:.4}, {z:.4})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Refusal {}

/// Which step is being judged: makes its refusals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site<'a> {
    /// From 1.
    pub(super) step: u32,
    pub(super) primitive: &'a PrimitiveName,
    /// What its instances keep to, as the plan says.
    pub(super) contract: Contract,
}

impl Site<'_> {
    /// A fault of this step at a fraction of it.
    pub(super) fn refusal(self, time: f64, kind: RefusalKind, message: impl Into<Box<str>>) -> Refusal {
        Refusal {
            step: Some(self.step),
            primitive: Some(self.primitive.clone()),
            time,
            ..Refusal::whole(kind, message)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_primitives::primitive::STANDARD;

    #[test]
    fn the_words_name_step_time_bodies_and_place() {
        let site = Site { step: 4, primitive: &PrimitiveName::PUSH, contract: STANDARD[7].1 };
        let refusal = site
            .refusal(0.37, RefusalKind::Collision, "r_forearm_link and big bowl collide")
            .about("r_forearm_link", "big bowl")
            .at(&Point3::new(0.1, -0.25, 0.8));
        let text = "step 4 (Push) at 0.370: r_forearm_link and big bowl collide at (0.1000, -0.2500, 0.8000)";
        assert_eq!(refusal.to_string(), text);
        assert_eq!(Refusal::whole(RefusalKind::Goal, "no goal").to_string(), "no goal");
    }
}
