//! A straight drive with the arm at rest, looked at here and there: is something in the way of the arm or of what it holds?
//!
//! A guess, to choose between arms: whether a drive is clear is for the validity to say.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::turn;

use super::stance::Probe;
use crate::collision_scene::Load;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::Contacts;
use crate::tabletop::{Tabletop, TabletopState};

/// How often a straight drive is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Looks {
    /// So far it goes between two looks at what is in the way, metres and radians, but for
    every_m: f64,
    /// so many parts at most.
    parts: f64,
}

impl Looks {
    /// Enough to tell what is mostly in the way of a folded arm.
    pub(super) const FEW: Self = Self { every_m: 0.15, parts: 12.0 };
    /// A hand above a table passes things that are thinner than few looks are apart.
    pub(super) const MANY: Self = Self { every_m: 0.04, parts: 48.0 };
}

/// The straight drive of a robot whose base is clear at both ends.
pub(super) struct Drive<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    probe: Probe<'a, M>,
    from: [f64; 3],
    to: [f64; 3],
    /// Where it is looked between the ends. What was found in the way is looked at first the next time.
    looks: Vec<[f64; 3]>,
    /// Is it known that the base alone passes there?
    is_base_known: bool,
    /// The arm that was looked at last, and what it holds.
    load: Load,
}

impl<'a, M: Manipulator> Drive<'a, M> {
    /// From where the robot stands in `from` to `to`.
    pub(super) fn new(m: &'a Tabletop<M>, from: &TabletopState<M>, to: &[f64; 3], looks: Looks) -> Self {
        let here = from.robot.base;
        let travel_m = (to[0] - here[0]).hypot(to[1] - here[1]) + turn(here[2], to[2]).abs();
        let parts = (travel_m / looks.every_m).ceil().clamp(1.0, looks.parts);
        let shares = (1..).map(|i| f64::from(i) / parts).take_while(|share| *share < 1.0);
        let looks = shares.map(|share| m.robot().base().interpolate(&here, to, share)).collect();
        let probe = Probe::new(m, from, from.mode.clone());
        Self { m, probe, from: here, to: *to, looks, is_base_known: false, load: Load::default() }
    }

    /// Is nothing in the way of the robot with this arm at either end?
    pub(super) fn fits(&mut self, arm: &M::Joints, care: usize) -> bool {
        let here = Configuration { base: self.from, arm: *arm };
        if !self.probe.is_clear(&here, &Contacts::default(), care) {
            return false;
        }
        // OPTIMIZATION: how the arm stands to the base does not change on the way.
        let around = self.m.collision_scene();
        around.load(self.m.manipulator(), self.probe.state(), &mut self.load);
        around.load_blocked(&self.load, self.probe.state(), [&self.to], care).is_none()
    }

    /// Is nothing in the way on the straight drive either, of what [`Drive::fits`] was asked about, as far as a few looks
    /// tell? So it is, too, if the base alone cannot go straight: then no arm can.
    pub(super) fn is_straight(&mut self, care: usize) -> bool {
        let around = self.m.collision_scene();
        let Some(blocked) = around.load_blocked(&self.load, self.probe.state(), &self.looks, care) else { return true };
        if !self.is_base_known {
            let (robot, arm) = (self.m.manipulator(), self.probe.state().robot.arm);
            if !self.looks.iter().all(|base| around.is_base_clear(robot, &Configuration { base: *base, arm })) {
                self.looks.clear();
                return true;
            }
            self.is_base_known = true;
        }
        if let Some(first) = self.looks.get_mut(..=blocked) {
            first.rotate_right(1);
        }
        false
    }
}
