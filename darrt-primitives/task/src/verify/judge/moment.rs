//! One moment of a step: where the objects are, and everything that must hold then.

use darrt_primitives::contract::ObjectRule;
use nalgebra::{Isometry3, Point2, Vector3};

use super::{Judge, SlideDirection, Trial};
use crate::verify::drag::Drag;
use crate::verify::mode::Mode;
use crate::verify::motion::{Segment, State};
use crate::verify::refusal::{Refusal, RefusalKind, Site};

impl<'a> Judge<'a> {
    pub(super) fn world_from_tool(&self) -> Isometry3<f64> {
        self.world_from_robot * self.links[self.robot.tool]
    }

    /// Where gravity pulls, in the axes of the tool.
    fn down_in_tool(&self) -> Vector3<f64> {
        self.world_from_tool().rotation.inverse() * -Vector3::z()
    }

    /// Puts the objects where they are at `s`: held ones by the hand, pushed ones along their way.
    pub(super) fn move_objects(&self, trial: &Trial<'a>, segment: &Segment<'_>, s: f64, now: &mut State) {
        if let Some(holding) = trial.act.holding
            && let Some(pose) = now.objects.get_mut(holding.object)
        {
            *pose = self.world_from_tool() * holding.tool_from_object;
        }
        if let Some(object) = trial.act.pushed
            && let (Some(pose), Some(slid)) = (now.objects.get_mut(object), segment.slid(object, s))
        {
            *pose = slid;
        }
    }

    /// At a waypoint the file must put a held object where the hand has it.
    pub(super) fn check_rigid(
        &self,
        trial: &Trial<'a>,
        time: f64,
        now: &State,
        waypoint: &State,
    ) -> Result<(), Refusal> {
        let Some(holding) = trial.act.holding else { return Ok(()) };
        let (Some(here), Some(written)) = (now.objects.get(holding.object), waypoint.objects.get(holding.object))
        else {
            return Ok(());
        };
        let distance = (here.translation.vector - written.translation.vector).norm();
        let angle = here.rotation.angle_to(&written.rotation);
        if distance <= self.options.rigid_m && angle <= self.options.rigid_rad {
            return Ok(());
        }
        let name = self.world.object_name(holding.object);
        let text = format!("{name} is {distance:.6} m and {angle:.6} rad from where the hand holds it");
        Err(trial.site.refusal(time, RefusalKind::Grasp, text).at(&written.translation.vector.into()))
    }

    /// A pushed object has turned with the hand.
    pub(super) fn check_turned_along(&self, trial: &Trial<'a>, time: f64, now: &State) -> Result<(), Refusal> {
        let (Some(before), Some(object)) = (trial.object_from_tool, trial.act.pushed) else { return Ok(()) };
        let Some(pose) = now.objects.get(object) else { return Ok(()) };
        let here = pose.rotation.inverse() * self.world_from_tool().rotation;
        let turned = here.angle_to(&before.rotation);
        if turned <= self.options.line_rad {
            return Ok(());
        }
        let (name, bound) = (self.world.object_name(object), self.options.line_rad);
        let text = format!("the hand turns by {turned:.4} rad against {name} that it pushes, at most {bound:.4}");
        Err(trial.site.refusal(time, RefusalKind::Push, text).at(&pose.translation.vector.into()))
    }

    /// Everything about one state of a step.
    pub(super) fn check_state(
        &mut self,
        trial: &Trial<'a>,
        time: f64,
        now: &State,
        way: Option<SlideDirection>,
    ) -> Result<(), Refusal> {
        let site = trial.site;
        if let (Some(core), Some(object)) = (&trial.core, trial.act.pushed) {
            let tips = core.check_depth(site, time, &self.robot, &self.stage, object)?;
            if time <= 0.0 {
                let nearest_m = tips.iter().flatten().map(|tip| tip.distance).fold(f64::INFINITY, f64::min);
                let name = self.world.object_name(object);
                self.remarks.note_standoff(site.step, name, nearest_m - self.options.push_contact_m);
            }
            self.check_on_surface(site, time, object, now)?;
            if let (ObjectRule::Dragged, Some(before), Some(pose)) =
                (site.contract.object, trial.object_from_tool, now.objects.get(object))
            {
                let drag = Drag {
                    name: self.world.object_name(object),
                    tool_from_object: before.inverse(),
                    world_from_tool: self.world_from_tool(),
                    world_from_object: *pose,
                    tips,
                };
                drag.check(site, time, self.options)?;
            } else if let Some(way) = way {
                core.check_contact(site, time, &self.robot, &self.stage, object, tips, &way, self.options)?;
            }
        }
        if let Some(holding) = trial.act.holding {
            self.check_object_bounds(holding.object, now)
                .map_err(|text| site.refusal(time, RefusalKind::Bounds, text))?;
            if let Some(pose) = now.objects.get(holding.object) {
                self.remarks.note_lean(pose);
            }
            self.check_tilt(holding.object, now).map_err(|text| {
                site.refusal(time, RefusalKind::Tilt, text)
                    .about(self.world.object_name(holding.object), "the vertical")
            })?;
            let name = self.world.object_name(holding.object);
            self.hold.as_ref().map_or(Ok(()), |hold| hold.check(&self.down_in_tool())).map_err(|text| {
                site.refusal(time, RefusalKind::Hold, format!("the hand cannot hold {name}: it {text}"))
            })?;
        }
        if let Some([start, end]) = &trial.line {
            self.check_line(site, time, start, end)?;
        }
        self.look(site.step, time).map_err(|hit| {
            let (a, b) = &hit.names;
            site.refusal(time, RefusalKind::Collision, hit.words()).about(a, b).at(&hit.place)
        })
    }

    /// How many of the next `parts` parts of a segment, each at most `travel_m` long, whose joints turn by `turn_rad` in all, may pass before
    /// [`Judge::check_state`] could find a fault that it does not find now. None in a push and on a straight line, of which
    /// every state is looked at.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a range that fits any usize"
    )]
    pub(super) fn idle_parts(
        &self,
        trial: &Trial<'a>,
        now: &State,
        (travel_m, turn_rad): (f64, f64),
        parts: usize,
    ) -> usize {
        if self.options.is_plain {
            return 0;
        }
        if !trial.skips() {
            return 0;
        }
        let held = trial.act.holding.and_then(|holding| Some((holding.object, now.objects.get(holding.object)?)));
        let inside = held.map_or(f64::INFINITY, |(object, pose)| {
            // What tilts it is the arm, and no faster than its joints turn.
            let upright = self.tilt_left(object, pose) / (turn_rad / parts.max(1) as f64);
            let held = self.hold.as_ref().map_or(f64::INFINITY, |hold| hold.turn_left(&self.down_in_tool()));
            let upright = upright.min(held / (turn_rad / parts.max(1) as f64));
            (self.inside_object_bounds(pose) / travel_m).min(if turn_rad > 0.0 { upright } else { f64::INFINITY })
        });
        self.stage.idle_parts().min(inside).clamp(0.0, parts as f64) as usize
    }

    /// A pushed object does not leave its surface and those flush with it.
    pub(super) fn check_on_surface(
        &self,
        site: Site<'_>,
        time: f64,
        object: usize,
        now: &State,
    ) -> Result<(), Refusal> {
        let (Some(Mode::Resting { surface }), Some(pose)) = (self.modes.get(object), now.objects.get(object)) else {
            return Ok(());
        };
        let centre = Point2::from(pose.translation.vector.xy());
        if self.world.under(object, *surface, &centre).is_some() {
            return Ok(());
        }
        let depths = self.world.across(object, *surface).iter().filter_map(|index| self.world.surface(*index));
        let nearest = depths.map(|surface| (surface.depth(&centre), surface)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((inside, surface)) = nearest else { return Ok(()) };
        let (name, plane) = (self.world.object_name(object), surface.name());
        let text = format!("the centre of {name} is {:.4} m beside `{plane}`", -inside);
        Err(site.refusal(time, RefusalKind::Support, text).about(name, plane).at(&pose.translation.vector.into()))
    }

    pub(super) fn check_line(
        &self,
        site: Site<'_>,
        time: f64,
        start: &Isometry3<f64>,
        end: &Isometry3<f64>,
    ) -> Result<(), Refusal> {
        let tool = self.world_from_tool();
        let (from, way) = (start.translation.vector, end.translation.vector - start.translation.vector);
        let gone = tool.translation.vector - from;
        let share = if way.norm() > 0.0 { (gone.dot(&way) / way.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        let beside = (gone - way * share).norm();
        let turned = tool.rotation.angle_to(&start.rotation);
        if beside <= self.options.line_m && turned <= self.options.line_rad {
            return Ok(());
        }
        let text = format!(
            "the tool is {beside:.4} m beside its straight line and turned by {turned:.4} rad, at most {} m and {:.4} rad \
             are straight",
            self.options.line_m, self.options.line_rad
        );
        Err(site.refusal(time, RefusalKind::StraightLine, text).at(&tool.translation.vector.into()))
    }
}
