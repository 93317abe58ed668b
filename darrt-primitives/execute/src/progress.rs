//! What a step makes of what is known: where base and objects are believed to be after it, and how far off they may be.

use darrt_primitives::contract::HandUse;
use darrt_primitives::push::Friction;
use darrt_primitives::push::limit_surface::PressureConstant;
use darrt_primitives::push::settling::Funnel;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation2, Vector2, Vector3};

use crate::arm::Arm;
use crate::belief::{Belief, left_by_closing, left_by_push, level_change, moved, yaw_of};
use crate::course::Course;
use crate::run::Execution;
use crate::timeline::TimedStep;

/// The robot at one end of a step, as it is told to be and as it believes to be.
#[derive(Debug, Clone)]
pub(crate) struct Posture {
    pub(crate) base: [f64; 3],
    /// By variable, with what the errors of the joints are believed to be.
    pub(crate) joints: Vec<f64>,
    /// Where the plan has the tool.
    pub(crate) planned: Isometry3<f64>,
    /// Where the tool is believed to be.
    pub(crate) believed: Isometry3<f64>,
}

impl Posture {
    /// At a time of a step, the joints of the arm `offset` from the plan.
    pub(crate) fn at(
        of: &Execution<'_>,
        course: &Course,
        belief: &Belief,
        (step, time_s): (&TimedStep, f64),
        offset: &[f64],
    ) -> Self {
        let command = course.timeline.at(step, time_s, &of.robot);
        Self::new(of, belief, (&command.base, &command.joints), offset)
    }

    /// As it is told to stand, the joints of the arm `offset` from that.
    pub(crate) fn new(of: &Execution<'_>, belief: &Belief, command: (&[f64; 3], &[f64]), offset: &[f64]) -> Self {
        let (planned_base, planned) = command;
        let mut joints = planned.to_vec();
        for (variable, by) in of.robot.arm.iter().zip(offset.iter().zip(&belief.biases).map(|(a, b)| a + b)) {
            if let Some(joint) = joints.get_mut(*variable) {
                *joint += by;
            }
        }
        Self {
            base: belief.base,
            planned: Arm::world_from_tool(&of.robot, *planned_base, planned),
            believed: Arm::world_from_tool(&of.robot, belief.base, &joints),
            joints,
        }
    }
}

/// What is at stake in a contact: how far an object may be off against the hand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    pub(crate) object: usize,
    /// Covariance of x, y, yaw of the object against the hand before the contact.
    pub(crate) off: Matrix3<f64>,
    /// For a push: where it goes.
    pub(crate) direction: Option<Vector2<f64>>,
    /// For a push: the fingers stand so far apart, m.
    pub(crate) gap_m: f64,
}

/// Takes a step into account that went as it should, begun by the robot as `begin` says, the joints of the arm `offset` from the
/// plan at its end; the base of `belief` is still where it was.
pub(crate) fn advance(
    of: &Execution<'_>,
    course: &Course,
    belief: &mut Belief,
    (index, step): (usize, &TimedStep),
    begin: &Posture,
    offset: &[f64],
) -> Option<Contact> {
    let planned = course.before(index);
    let handled = step.pushes.or(step.holds.map(|(object, _)| object));
    let Some((object, before)) = handled.and_then(|object| Some((object, *belief.objects.get(object)?))) else {
        if step.contract.drives() {
            belief.drive(course.timeline.at(step, step.end_s, &of.robot).base);
        }
        return None;
    };
    let point = Point3::from(before.translation.vector);
    let hand = of.arm.error_of_hand(&of.robot, begin.base, &begin.joints, &point);
    let off = belief.to_hand(object, &hand);
    let is_round = of.is_round(object);
    let mut contact = Contact { object, off, direction: None, gap_m: 0.0 };
    // Where the object is if it is to the hand as in the plan.
    let tool_from_object = step.holds.map_or_else(
        || begin.planned.inverse() * planned.get(object).copied().unwrap_or_default(),
        |(_, tool_from_object)| tool_from_object,
    );
    let by_hand = begin.believed * tool_from_object;
    let keep = if step.pushes.is_some() {
        let way = step.ends.get(object).copied().unwrap_or_default().translation.vector
            - planned.get(object).copied().unwrap_or_default().translation.vector;
        let direction = way.xy().try_normalize(0.0).unwrap_or_else(Vector2::x);
        let across = Vector3::new(-direction.y, direction.x, 0.0);
        let sigma = (across.transpose() * off * across)[(0, 0)].max(0.0).sqrt();
        let funnel = funnel(of, object, &begin.joints);
        (contact.direction, contact.gap_m) = (Some(direction), gap_m(of, &begin.joints));
        left_by_push(direction, sigma, way.norm(), funnel.as_ref())
    } else if step.contract.hand == HandUse::Takes {
        let radius = of.problem.objects.get(object).and_then(|object| object.shape.round_radius());
        let is_wall = radius.is_some_and(|radius| tool_from_object.translation.y.abs() > radius / 2.0);
        left_by_closing(&(begin.believed.rotation * Vector3::y()), is_wall)
    } else {
        Matrix3::identity()
    };
    belief.grip(object, &hand, &keep);
    if step.contract.drives() {
        belief.drive(course.timeline.at(step, step.end_s, &of.robot).base);
    }
    let end = Posture::at(of, course, belief, (step, step.end_s), offset);
    let kept = keep * Vector3::from(level_change(&by_hand, &before, is_round));
    let tool_from_end = if step.pushes.is_some() {
        end.planned.inverse() * step.ends.get(object).copied().unwrap_or_default()
    } else {
        tool_from_object
    };
    let turned = yaw_of(&end.believed) - yaw_of(&begin.believed);
    let after = end.believed * tool_from_end;
    let about = Point3::from(after.translation.vector);
    // What is off turns with the hand.
    let kept = Rotation2::new(turned) * kept.xy();
    let kept = [kept.x, kept.y, 0.0];
    if let Some(pose) = belief.objects.get_mut(object) {
        *pose = moved(&after, kept);
    }
    let hand = of.arm.error_of_hand(&of.robot, end.base, &end.joints, &about);
    belief.release(object, &hand, turned);
    if step.contract.manipulates() {
        belief.contact(object);
    }
    Some(contact)
}

/// How far the fingers stand apart.
fn gap_m(of: &Execution<'_>, joints: &[f64]) -> f64 {
    let hand = &of.robot.hand;
    let joint = joints.get(of.robot.finger).copied().unwrap_or_default();
    2.0 * (hand.at_joint(joint).half_width() - hand.at_joint(hand.closed()).half_width())
}

/// What two fingers so far apart do to a round object.
fn funnel(of: &Execution<'_>, object: usize, joints: &[f64]) -> Option<Funnel> {
    let spec = of.problem.objects.get(object)?;
    let radius = spec.shape.round_radius()?;
    let pressure = PressureConstant::uniform_disc(radius).ok()?;
    Funnel::new(radius, gap_m(of, joints), pressure, Friction::new(spec.friction.fingers).ok()?).ok()
}
