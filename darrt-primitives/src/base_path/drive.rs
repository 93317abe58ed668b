//! The exact check of a straight drive: conservative advancement with everything that hangs on the base, as a whole motion is
//! judged later.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;

use crate::collision_scene::{Strict, Worker};
use crate::heading_drive;
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::segment::Segment;
use crate::tabletop::{Tabletop, TabletopState};

/// Checks drives of one robot with its arm at rest.
pub(super) struct Drives<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    worker: &'a mut Worker,
    here: TabletopState<M>,
    next: TabletopState<M>,
}

impl<'a, M: Manipulator> Drives<'a, M> {
    /// With arm, objects and mode as in `state`.
    pub(super) fn new(m: &'a Tabletop<M>, state: &TabletopState<M>, worker: &'a mut Worker) -> Self {
        Self { m, worker, here: state.clone(), next: state.clone() }
    }

    /// Is nothing in the way between these poses of the base, with this
    /// [care](darrt_core::validity::Validity::most_care)?
    pub(super) fn is_clear(&mut self, care: usize, a: &[f64; 3], b: &[f64; 3]) -> bool {
        if !self.m.manipulator().drives_along_heading() {
            return self.is_straight_clear(care, a, b);
        }
        let mut here = *a;
        heading_drive::corners(a, b).into_iter().chain([*b]).all(|next| {
            let from = std::mem::replace(&mut here, next);
            self.is_straight_clear(care, &from, &next)
        })
    }

    fn is_straight_clear(&mut self, care: usize, a: &[f64; 3], b: &[f64; 3]) -> bool {
        let Self { m, worker, here, next } = self;
        let (m, around) = (*m, &**m.collision_scene());
        if a == b {
            return true;
        }
        put(m, here, a);
        put(m, next, b);
        around.pose_all(m.manipulator(), here, worker);
        around.set_rules(here, &Contacts::default(), Strict::with(care), worker);
        let segment = Segment::new(m, here, next, (0.0, 1.0), worker);
        let (cap, least) = (around.strictness().cap_m / segment.fastest, around.unseen_m() / segment.fastest);
        segment.watch(around, worker);
        let mut t = 0.0;
        loop {
            let Ok(until) = around.free_until(worker, t, cap) else { return false };
            if !is_in_bounds(m, here) {
                return false;
            }
            if t >= 1.0 {
                return true;
            }
            t = if until + least >= 1.0 { 1.0 } else { until + least };
            put(m, here, &m.robot().base().interpolate(a, b, t));
            around.pose(m.manipulator(), here, &segment.moved, worker);
        }
    }
}

/// Puts the base and what the hand holds.
fn put<M: Manipulator>(m: &Tabletop<M>, state: &mut TabletopState<M>, base: &[f64; 3]) {
    state.robot.base = *base;
    if let Some(held) = state.mode.held()
        && let Some(pose) = state.objects.get_mut(held.object.index())
    {
        *pose = m.manipulator().world_from_tool(&state.robot) * held.tool_from_object;
    }
}

/// Is what the hand holds within its bounds?
fn is_in_bounds<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>) -> bool {
    let Some(held) = state.mode.held().map(|held| held.object.index()) else { return true };
    match (m.objects().get(held), state.objects.get(held)) {
        (Some(space), Some(pose)) => space.contains(pose),
        _ => true,
    }
}
