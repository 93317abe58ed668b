//! Laws of instances on a [`Tabletop`]: what pushing, picking, carrying, placing and retreating must look like whoever
//! propagated them.

use darrt_core::domain::Domain;
use darrt_core::laws::{Broken, MotionClaims, check_instance};
use darrt_core::motion::Instance;
use darrt_core::state::{ComponentId, ObjectId};
use darrt_geom::body::Body;
use nalgebra::{Isometry3, Point3};

use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};

mod claims;
mod contacts;
mod contract;
mod hand;
mod held;
mod modes;
mod pushed;

pub use contacts::check_finger_contacts;
pub use contract::check_contracts;

/// Held objects.
pub const HELD_RIGID: &str = "tabletop.held-rigid: while an object is held, its pose in the tool frame is the grasp";
/// Resting objects.
pub const STILL: &str = "tabletop.still: an object that rests moves only when the hand stands at it and pushes it";
/// Support of a pushed object.
pub const SUPPORT: &str = "tabletop.support: a pushed object stays on its surface and over it, and does not lean";
/// Ray of a push.
pub const RAY: &str = "tabletop.ray: a pushed object moves forwards on the straight line to where it ends, or on the arc that turns it so far";
/// Sharpness of a push.
pub const TURN: &str = "tabletop.turn: a pushed object turns no more sharply than two fingers hold it";
/// Contact of a push.
pub const CONTACT: &str =
    "tabletop.contact: from where a pushed object begins to move, the hand stays at the same place beside it";
/// Entry into contact.
pub const TOUCH: &str = "tabletop.touch: two finger links are at an object while it is pushed, and when it is attached";
/// Attaching.
pub const ATTACH: &str = "tabletop.attach: an object is attached where it stands: closing the hand does not move it";
/// Lifting.
pub const PICK_YAW: &str = "tabletop.pick-yaw: while an object is lifted from where it was attached, it does not turn";
/// Letting go.
pub const RELEASE: &str = "tabletop.release: where an object is let go, it stands upright on its surface and over it";
/// Modes.
pub const MODES: &str = "tabletop.modes: the mode changes only by legal transitions, at the ends of an instance";
/// Exemptions.
pub const EXEMPT: &str =
    "tabletop.exempt: an instance exempts only what the hand stands at or holds: exemptions end with the instance";
/// Straight lines.
pub const STRAIGHT: &str = "tabletop.straight: a Straight-Line-Arm-Transit, and what else has such a contract, moves the hand on a line and does not turn it";
/// Retreat.
pub const RETREAT: &str =
    "tabletop.retreat: the hand leaves what it stands at straight back along its own axis, and nothing else moves";
/// Forgotten exemptions.
pub const FINGERS: &str = "tabletop.fingers: the fingers may touch what they push, close on, hold and let go of";
/// Limits.
pub const INSIDE: &str = "tabletop.inside: base and arm stay within their limits all the way, if they begin there";

/// One way.
pub const ONE_WAY: &str = "tabletop.one-way: what pushes a resting object does not claim that it can be run backwards";
/// What is declared.
pub const DECLARED: &str =
    "tabletop.declared: an instance declares to move what it holds, and of the others only the object that it names";
/// The fingers.
pub const GAP: &str = "tabletop.gap: the fingers open between 0 and their widest gap";

/// Contracts.
pub const CONTRACT: &str = "tabletop.contract: an instance keeps the contract of its primitive: what of the robot moves, what is in the hand, whether objects at rest move, and whether the fingers may touch anything";
/// Contracts themselves.
pub const SOUND: &str = "tabletop.contract-sound: a contract does not contradict itself";
/// Lifts.
pub const TAKES: &str = "tabletop.takes: what is taken up moves, by a millimetre at least";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    ONE_WAY, DECLARED, GAP, INSIDE, FINGERS, HELD_RIGID, STILL, SUPPORT, RAY, TURN, CONTACT, TOUCH, ATTACH, PICK_YAW,
    RELEASE, MODES, EXEMPT, STRAIGHT, RETREAT, CONTRACT, SOUND, TAKES,
];

/// How exactly instances keep to their lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TabletopClaims {
    /// How far poses may be off at the knots of a motion, metres and radians: the accuracy of the inverse kinematics.
    pub knot: f64,
    /// How far the hand may be off a line between two knots, where joints are straight and the hand is not, metres and
    /// radians.
    pub bow: f64,
    /// How far from an object a finger may be that touches it, metres.
    pub touch_m: f64,
    /// Rounding that is forgiven in the length of motions, metres.
    pub slack_m: f64,
    /// At how many evenly spaced parameters motions are looked at besides the given ones, their knots and random ones.
    pub looks: u32,
}

impl Default for TabletopClaims {
    fn default() -> Self {
        Self { knot: 1e-6, bow: 0.01, touch_m: 0.005, slack_m: 1e-7, looks: 24 }
    }
}

/// All laws of `instances` that were propagated from `from`: those of this file and those of
/// [`darrt_core::laws::motion`], with the travel of every body's farthest point. They are looked at the parameters `ts`
/// in `[0, 1]`, at their ends and at their knots.
///
/// # Errors
/// The first law that is [`Broken`], with the instance and its parameter.
pub fn check_tabletop<M: Manipulator>(
    m: &Tabletop<M>,
    instances: &[Instance<Tabletop<M>>],
    from: &TabletopState<M>,
    ts: &[f64],
    claims: &TabletopClaims,
) -> Result<(), Broken> {
    let motion = MotionClaims { travel: &body_travel, slack_m: claims.slack_m, looks: claims.looks };
    let mut here = from.clone();
    for instance in instances {
        check_instance(m, instance, &here, ts, &motion)?;
        check_tabletop_instance(m, instance, &here, ts, claims)?;
        instance.motion.at_into(m, 1.0, &mut here);
    }
    Ok(())
}

/// The laws of this file, for one instance.
///
/// # Errors
/// The first law that is [`Broken`], with its parameter.
pub fn check_tabletop_instance<M: Manipulator>(
    m: &Tabletop<M>,
    instance: &Instance<Tabletop<M>>,
    from: &TabletopState<M>,
    ts: &[f64],
    claims: &TabletopClaims,
) -> Result<(), Broken> {
    let trial = Trial::new(m, instance, from, ts, claims);
    let check = || {
        trial.modes()?;
        trial.inside()?;
        trial.exemptions()?;
        trial.held()?;
        trial.pushed()?;
        trial.claims()?;
        trial.hand()?;
        trial.contract()
    };
    check().map_err(|broken: Broken| {
        let broken = broken.of(format_args!("instance {:?}", instance.primitive));
        broken.replayed_by(|| format!("check_tabletop_instance(&m, &{instance:?}, &{from:?}, &{ts:?}, &{claims:?})"))
    })
}

/// One look at a motion.
struct Look<M: Manipulator> {
    t: f64,
    /// Is it a knot, where the hand is exactly where it was sent?
    is_knot: bool,
    state: TabletopState<M>,
}

struct Trial<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    instance: &'a Instance<Tabletop<M>>,
    from: &'a TabletopState<M>,
    claims: &'a TabletopClaims,
    /// In the interior, in ascending order; never empty: the first is as near to the start as can be.
    looks: Vec<Look<M>>,
    /// The state right behind the start, in the mode of the interior.
    during: TabletopState<M>,
    end: TabletopState<M>,
}

impl<'a, M: Manipulator> Trial<'a, M> {
    fn new(
        m: &'a Tabletop<M>,
        instance: &'a Instance<Tabletop<M>>,
        from: &'a TabletopState<M>,
        ts: &[f64],
        claims: &'a TabletopClaims,
    ) -> Self {
        let knots = instance.motion.knots().iter().map(|t| (*t, true));
        let mut all: Vec<_> = ts.iter().map(|t| (*t, false)).chain(knots).collect();
        all.extend((1..claims.looks).map(|i| (f64::from(i) / f64::from(claims.looks), false)));
        all.extend([1e-6, 1e-3, 1.0 - 1e-3, 1.0 - 1e-6].map(|t| (t, false)));
        all.retain(|(t, _)| 0.0 < *t && *t < 1.0);
        all.push((f64::MIN_POSITIVE, true));
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let looks = all.into_iter().map(|(t, is_knot)| Look { t, is_knot, state: instance.at(m, t, from) }).collect();
        let during = instance.at(m, f64::MIN_POSITIVE, from);
        Self { m, instance, from, claims, looks, during, end: instance.at(m, 1.0, from) }
    }

    /// What may be off at this look, metres and radians.
    fn tolerance(&self, look: &Look<M>) -> f64 {
        if look.is_knot { self.claims.knot } else { self.claims.bow }
    }

    fn tool(&self, state: &TabletopState<M>) -> Isometry3<f64> {
        self.m.manipulator().world_from_tool(&state.robot)
    }

    fn name(&self, object: ObjectId) -> String {
        self.m.component_name(ComponentId::Object(object)).into_owned()
    }
}

/// How far the farthest point of any body travels between two states, metres: every corner of the boxes around all
/// links and objects, for [`MotionClaims::travel`]. The fingers are taken at the opening of `b` in both: opening and
/// closing is a change of mode, which takes no time.
pub fn body_travel<M: Manipulator>(m: &Tabletop<M>, a: &TabletopState<M>, b: &TabletopState<M>) -> f64 {
    let links = m.manipulator().links();
    let poses = |state: &TabletopState<M>| {
        let mut poses = vec![Isometry3::identity(); links.len()];
        m.manipulator().link_poses(&state.robot, b.mode.gap_m(), &mut poses);
        poses
    };
    let of_links = links.iter().zip(poses(a)).zip(poses(b)).map(|((link, p), q)| body_moved(&link.body, &p, &q));
    let objects = m.movables().iter().zip(&a.objects).zip(&b.objects);
    let of_objects = objects.map(|((movable, p), q)| body_moved(&movable.body, p, q));
    of_links.chain(of_objects).fold(0.0, f64::max)
}

fn body_moved(body: &Body, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
    if from == to {
        return 0.0;
    }
    corners(body, from).zip(corners(body, to)).map(|(p, q)| (q - p).norm()).fold(0.0, f64::max)
}

/// Corners of the boxes around the parts of a body: nothing of it lies outside their hull.
pub(super) fn corners<'a>(
    body: &'a Body,
    world_from_body: &'a Isometry3<f64>,
) -> impl Iterator<Item = Point3<f64>> + 'a {
    body.parts.iter().flat_map(move |part| {
        let (low, high) = part.shape.local_aabb();
        let pose = world_from_body * part.body_from_shape;
        let side = move |bit: u8, axis: usize| if bit == 0 { low[axis] } else { high[axis] };
        (0..8_u8).map(move |c| pose * Point3::new(side(c & 1, 0), side(c & 2, 1), side(c & 4, 2)))
    })
}
