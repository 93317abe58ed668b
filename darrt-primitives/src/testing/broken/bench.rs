//! What the actions do at the table, one instance at a time, and how to change it.

use std::fmt;

use darrt_core::laws::Broken;
use darrt_core::motion::{Instance, Motion};
use darrt_core::primitive::{Instances, PrimitiveId};
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Vector3};

use super::unusable;
use crate::action::{pick::pick, place::place, push::push};
use crate::laws::{TabletopClaims, check_tabletop_instance};
use crate::primitive;
use crate::testing::table::{Table, TableState, honest_table, object, start};

/// An honest instance, and where it starts.
pub(super) struct Scene {
    pub m: Table,
    pub from: TableState,
    pub instance: Instance<Table>,
}

/// Which of the honest instances.
#[derive(Clone, Copy)]
pub(super) enum Act {
    /// To a tin, with an empty hand.
    Transit,
    /// Straight down beside a tin.
    Approach,
    /// Along the table.
    Push,
    /// The box, closed and lifted.
    Pick,
    /// The box in the air.
    Carry,
    /// The box set down.
    Place,
    /// Up from the box.
    Retreat,
}

/// What is done to a state on the way at a parameter above 0.
pub(super) type Change = Box<dyn Fn(&Table, f64, &mut TableState) + Send + Sync>;

/// How often an action is tried.
const SEEDS: u64 = 20;

/// The object of pushes is a tin, of all else the box.
pub(super) fn object_of(act: Act) -> ObjectId {
    if matches!(act, Act::Push) { object(0) } else { object(2) }
}

fn first(act: impl Fn(u64) -> Option<Instances<Table>>) -> Result<Instances<Table>, Broken> {
    (0..SEEDS).find_map(act).ok_or_else(|| unusable("no seed succeeds"))
}

/// The honest instance of this kind.
pub(super) fn scene(act: Act) -> Result<Scene, Broken> {
    let m = honest_table().map_err(unusable)?;
    let from = start(&m);
    let rng = |seed| stream(seed, 0, 0, Purpose::Extend);
    let pushed = || {
        let target = Isometry3::translation(-0.6, 0.1, 0.74);
        first(|seed| push(&m, &from, object(0), &target, &mut rng(seed)).ok())
    };
    let picked = || first(|seed| pick(&m, &from, object(2), &mut rng(seed)).ok());
    let (instances, wanted) = match act {
        Act::Push => (pushed()?, primitive::PUSH),
        Act::Transit => (picked()?, primitive::BASE_TRANSIT),
        Act::Approach => (picked()?, primitive::STRAIGHT_LINE_ARM_TRANSIT),
        Act::Pick => (picked()?, primitive::PICK),
        Act::Carry | Act::Place | Act::Retreat => {
            let up = picked()?.into_iter().fold(from.clone(), |at, instance| instance.at(&m, 1.0, &at));
            let target = Isometry3::translation(0.5, 0.2, 0.73);
            let placed = first(|seed| place(&m, &up, &target, &mut rng(seed)).ok())?;
            let wanted = match act {
                Act::Carry => primitive::BASE_RIGID_TRANSFER,
                Act::Place => primitive::PLACE,
                _ => primitive::STRAIGHT_LINE_ARM_TRANSIT,
            };
            return one(m, up, placed, wanted);
        }
    };
    one(m, from, instances, wanted)
}

/// The first of `instances` of this primitive.
fn one(m: Table, from: TableState, instances: Instances<Table>, wanted: PrimitiveId) -> Result<Scene, Broken> {
    let mut here = from;
    for instance in instances {
        if instance.primitive == wanted {
            return Ok(Scene { m, from: here, instance });
        }
        here = instance.at(&m, 1.0, &here);
    }
    Err(unusable(format_args!("no instance {wanted}")))
}

impl Scene {
    /// All laws of the instance.
    pub(super) fn check(&self) -> Result<(), Broken> {
        let ts = [0.1, 0.3, 0.5, 0.7, 0.9, 0.999];
        check_tabletop_instance(&self.m, &self.instance, &self.from, &ts, &TabletopClaims::default())
    }

    /// The same motion, with this change on the way.
    pub(super) fn warped(self, change: Change) -> Self {
        let Self { m, from, instance } = self;
        let motion = Box::new(Warp { inner: instance.motion, change });
        Self { m, from, instance: Instance { motion, ..instance } }
    }
}

/// A motion with a change.
struct Warp {
    inner: Box<dyn Motion<Table>>,
    change: Change,
}

impl Motion<Table> for Warp {
    fn length(&self) -> f64 {
        self.inner.length()
    }

    fn knots(&self) -> &[f64] {
        self.inner.knots()
    }

    fn at_into(&self, m: &Table, t: f64, out: &mut TableState) {
        self.inner.at_into(m, t, out);
        if t > 0.0 {
            (self.change)(m, t.min(1.0), out);
        }
    }
}

impl fmt::Debug for Warp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Warp").field("inner", &self.inner).finish_non_exhaustive()
    }
}

/// The pose of one object, to be changed; `None` if there is no such object.
pub(super) fn pose_mut(state: &mut TableState, id: ObjectId) -> Option<&mut Isometry3<f64>> {
    state.objects.get_mut(id.index())
}

/// Moves an object by so many metres.
pub(super) fn shift(state: &mut TableState, id: ObjectId, by: Vector3<f64>) {
    if let Some(pose) = pose_mut(state, id) {
        pose.translation.vector += by;
    }
}

/// Brings what is held to where the hand holds it.
pub(super) fn regrip(m: &Table, state: &mut TableState, id: ObjectId, tool_from_object: &Isometry3<f64>) {
    use crate::manipulator::Manipulator;
    let pose = m.manipulator().world_from_tool(&state.robot) * tool_from_object;
    if let Some(slot) = pose_mut(state, id) {
        *slot = pose;
    }
}
