//! Limits of the robot, and straight lines of its empty hand.

use darrt_core::domain::Domain;
use darrt_core::laws::{Broken, at_most, ensure};
use darrt_core::space::ComponentSpace;
use nalgebra::Vector3;

use super::{INSIDE, RETREAT, STRAIGHT, Trial};
use crate::manipulator::Manipulator;
use crate::primitive;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn inside(&self) -> Result<(), Broken> {
        let space = self.m.robot();
        if !space.contains(&self.from.robot) {
            return Ok(());
        }
        let looks = self.looks.iter().map(|look| (look.t, &look.state));
        for (t, state) in looks.chain([(1.0, &self.end)]) {
            let text = || format!("{:?}", state.robot);
            ensure(INSIDE, space.contains(&state.robot), text, "a configuration within the limits")
                .map_err(|broken| broken.at(t))?;
        }
        Ok(())
    }

    pub(super) fn hand(&self) -> Result<(), Broken> {
        if self.instance.primitive == primitive::STRAIGHT_LINE_ARM_TRANSIT {
            self.straight()?;
        }
        let leaves = self.during.mode.engaged().is_some() && self.end.mode.engaged().is_none();
        if leaves { self.retreat() } else { Ok(()) }
    }

    pub(super) fn straight(&self) -> Result<(), Broken> {
        let (start, end) = (self.tool(self.from), self.tool(&self.end));
        let way = end.translation.vector - start.translation.vector;
        let along = way.try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
        let looks = self.looks.iter().map(|look| (look.t, self.tolerance(look), &look.state));
        for (t, tolerance, state) in looks.chain([(1.0, self.claims.knot, &self.end)]) {
            let tool = self.tool(state);
            let off = tool.translation.vector - start.translation.vector;
            at_most(STRAIGHT, (off - along * off.dot(&along)).norm(), 0.0, tolerance)
                .map_err(|broken| broken.of("off the line").at(t))?;
            at_most(STRAIGHT, tool.rotation.angle_to(&start.rotation), 0.0, tolerance)
                .map_err(|broken| broken.of("turn").at(t))?;
        }
        Ok(())
    }

    fn retreat(&self) -> Result<(), Broken> {
        let start_from_end = self.tool(self.from).inverse() * self.tool(&self.end);
        let back = start_from_end.translation.vector;
        let text = || format!("{:?} in the tool frame", back.as_slice());
        ensure(RETREAT, back.x < 0.0, text, "backwards: x below 0").map_err(|broken| broken.at(1.0))?;
        at_most(RETREAT, back.y.hypot(back.z), 0.0, self.claims.knot).map_err(|broken| broken.of("aside").at(1.0))?;
        at_most(RETREAT, start_from_end.rotation.angle(), 0.0, self.claims.knot)
            .map_err(|broken| broken.of("turn").at(1.0))?;
        let stays = self.from.robot.base == self.end.robot.base && self.from.objects == self.end.objects;
        let text = || format!("base {:?}, objects {:?}", self.end.robot.base, self.end.objects);
        ensure(RETREAT, stays, text, "base and objects where they were").map_err(|broken| broken.at(1.0))
    }
}
