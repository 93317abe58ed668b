//! The closed loop: look, compare with the plan, and put the arm where the next contact meets what was seen.
//!
//! The plan stays what it is. A hand at work goes its way moved with the object as it was seen; a push leads the object from there
//! to where the plan wants it, and what is carried is set down so that it, not the hand, is where it should be. So every contact
//! takes the errors before it away, as far as they were seen, and the rest of the plan still fits.

use darrt_primitives::contract::HandUse;
use nalgebra::{Isometry3, Point2, Point3};

use crate::arm::Arm;
use crate::belief::{Belief, Sight, carried, level_change};
use crate::course::Course;
use crate::noise::{NoiseModel, PlanarError};
use crate::progress::Posture;
use crate::run::Execution;
use crate::timeline::TimedStep;

/// Corrections of a step are computed so often, s, and interpolated between.
const EVERY_S: f64 = 0.05;
/// An object farther from its plan than this is no matter of correcting, m: the way there has not been judged.
pub(crate) const MOST_CORRECTED_M: f64 = 0.06;
/// A push goes aside by this much of its length at most: half of the angle that two fingers 8 cm apart hold a plate in.
const MOST_ASLANT: f64 = 0.15;
/// Furniture is seen from where something is put down on it if it is no farther beside than this, m.
const BESIDE_M: f64 = 0.3;

/// What a robot knows and does about it during one run.
#[derive(Debug)]
pub(crate) struct Feedback {
    pub(crate) belief: Belief,
    /// By joint of the arm: what is added to the plan.
    pub(crate) offset: Vec<f64>,
    /// The robot at the end of the last step.
    pub(crate) now: Posture,
    /// The last change of a hand at work: it withdraws with it.
    last: Change,
    pub(crate) looks: usize,
    pub(crate) corrections: usize,
    /// Corrections that no joints of the arm could do, and whether the last one was such.
    pub(crate) out_of_reach: usize,
    pub(crate) is_out_of_reach: bool,
}

/// How a hand's way is moved: level, about a point.
#[derive(Debug, Clone, Copy)]
struct Change {
    about: Point3<f64>,
    by: PlanarError,
    /// For a push: which object, and how much of the change is left at its end.
    fades: Option<(usize, f64)>,
}

impl Change {
    const NONE: Self = Self { about: Point3::new(0.0, 0.0, 0.0), by: [0.0; 3], fades: None };

    fn scaled(&self, part: f64) -> PlanarError {
        self.by.map(|by| part * by)
    }
}

/// What is added to the joints of the arm during a step.
#[derive(Debug)]
pub(crate) enum Offsets {
    /// From one to another as the step goes on.
    Blend(Vec<f64>, Vec<f64>),
    /// Every [`EVERY_S`] from the beginning.
    Table(Vec<Vec<f64>>),
}

impl Offsets {
    /// At a time of the step of which `done` is done.
    pub(crate) fn at(&self, seconds: f64, done: f64) -> Vec<f64> {
        let between = |a: &[f64], b: &[f64], part: f64| a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect();
        match self {
            Self::Blend(from, to) => between(from, to, done),
            Self::Table(rows) => {
                let place = (seconds / EVERY_S).max(0.0);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index, not negative")]
                let index = (place as usize).min(rows.len().saturating_sub(1));
                let Some(from) = rows.get(index) else { return Vec::new() };
                between(from, rows.get(index + 1).unwrap_or(from), (place - index as f64).min(1.0))
            }
        }
    }

    /// At the beginning of the step.
    pub(crate) fn first(&self) -> Vec<f64> {
        self.at(0.0, 0.0)
    }
}

impl Feedback {
    pub(crate) fn new(of: &Execution<'_>, course: &Course, noise: &NoiseModel) -> Self {
        let (base, joints) = course.timeline.start();
        let is_round = (0..of.problem.objects.len()).map(|object| of.is_round(object)).collect();
        let belief = Belief::new(noise, base, of.robot.arm.len(), course.before(0), is_round);
        let offset = vec![0.0; of.robot.arm.len()];
        let now = Posture::new(of, &belief, (&base, &joints), &offset);
        Self {
            belief,
            offset,
            now,
            last: Change::NONE,
            looks: 0,
            corrections: 0,
            out_of_reach: 0,
            is_out_of_reach: false,
        }
    }

    /// Another plan begins, with the robot at `command` (base and joints).
    pub(crate) fn begin_anew(&mut self, of: &Execution<'_>, command: (&[f64; 3], &[f64])) {
        self.offset.fill(0.0);
        self.now = Posture::new(of, &self.belief, command, &self.offset);
        (self.last, self.is_out_of_reach) = (Change::NONE, false);
    }

    /// The robot at a time of a step.
    pub(crate) fn posture(&self, of: &Execution<'_>, course: &Course, step: &TimedStep, time_s: f64) -> Posture {
        Posture::at(of, course, &self.belief, (step, time_s), &self.offset)
    }

    /// Looks at every object, and at the furniture where the next contact is: `base` and `objects` are where they truly are.
    pub(crate) fn look(
        &mut self,
        of: &Execution<'_>,
        course: &Course,
        index: usize,
        (base, objects): (PlanarError, &[Isometry3<f64>]),
        error: &mut dyn FnMut() -> PlanarError,
    ) {
        self.looks += 1;
        let world_from_base = darrt_primitives::manipulator::world_from_base(&base);
        let mut sight = |object: Option<usize>, world_from_body: &Isometry3<f64>, error: PlanarError| {
            let seen = world_from_base.inverse() * world_from_body;
            let at = [seen.translation.x, seen.translation.y, crate::belief::yaw_of(world_from_body) - base[2]];
            let world_from_room = Point2::from(world_from_body.translation.vector.xy());
            let base_from_body = [0, 1, 2].map(|i| at[i] + error[i]);
            self.belief.see(&Sight { object, world_from_room, base_from_body });
        };
        // The same draws whatever there is to see.
        let of_room = error();
        if let Some(room) = furniture(of, course, index) {
            sight(None, &Isometry3::from(room.coords), of_room);
        }
        for (object, pose) in objects.iter().enumerate() {
            sight(Some(object), pose, error());
        }
    }

    /// How far the object of the next contact is believed to be from where the plan has it then, m; with the object.
    pub(crate) fn off_m(&self, course: &Course, index: usize) -> Option<(usize, f64)> {
        let (at, object) = course.next_grip(index)?;
        let planned = course.before(at).get(object)?;
        let off = self.belief.objects.get(object)?.translation.vector - planned.translation.vector;
        Some((object, off.norm()))
    }

    /// How the way of the hand in a step at work is moved.
    fn change(&self, of: &Execution<'_>, course: &Course, index: usize) -> Option<Change> {
        let step = course.step(index)?;
        let seen = |object: usize| {
            let (planned, believed) = (course.before(index).get(object)?, self.belief.objects.get(object)?);
            let by = level_change(planned, believed, of.is_round(object));
            Some(Change { about: planned.translation.vector.into(), by, fades: None })
        };
        if let Some(object) = step.pushes {
            let change = seen(object)?;
            let way = step.ends.get(object)?.translation.vector - change.about.coords;
            let size = change.by[0].hypot(change.by[1]);
            let left = if size > 0.0 { (1.0 - MOST_ASLANT * way.norm() / size).max(0.0) } else { 0.0 };
            return Some(Change { fades: Some((object, left)), ..change });
        }
        match step.contract.hand {
            HandUse::Takes => seen(step.holds?.0),
            HandUse::Carries | HandUse::LetsGo => self.setting_down(of, course, index),
            HandUse::Empty => {
                let before = index.checked_sub(1).and_then(|before| course.step(before));
                let withdraws = before.is_some_and(|before| before.contract.manipulates());
                if withdraws { Some(self.last) } else { seen(step.object?) }
            }
        }
    }

    /// So that what is held, which may be off in the hand, ends where it should.
    fn setting_down(&self, of: &Execution<'_>, course: &Course, index: usize) -> Option<Change> {
        let step = course.step(index)?;
        let (object, planned) = step.holds?;
        let in_hand = self.now.believed.inverse() * self.belief.objects.get(object)?;
        let end = step.ends.get(object)?;
        let by = level_change(&(end * planned.inverse() * in_hand), end, of.is_round(object));
        Some(Change { about: end.translation.vector.into(), by, fades: None })
    }

    /// What is added to the joints in a step.
    pub(crate) fn offsets(&mut self, of: &Execution<'_>, course: &Course, index: usize) -> Offsets {
        let rest = vec![0.0; self.offset.len()];
        self.is_out_of_reach = false;
        let Some(step) = course.step(index) else { return Offsets::Blend(rest.clone(), rest) };
        if step.contract.drives() {
            return Offsets::Blend(rest.clone(), rest);
        }
        if step.contract.is_free() {
            let to = self.wanted_after(of, course, index).unwrap_or(rest);
            return Offsets::Blend(self.offset.clone(), to);
        }
        let Some(change) = self.change(of, course, index) else {
            return Offsets::Blend(self.offset.clone(), self.offset.clone());
        };
        self.last = Change { by: change.scaled(change.fades.map_or(1.0, |(_, left)| left)), fades: None, ..change };
        if change.by.iter().any(|by| by.abs() > 1e-6) && step.contract.manipulates() {
            self.corrections += 1;
        }
        let (mut rows, mut seed) = (Vec::new(), self.offset.clone());
        let mut time_s = step.begin_s;
        loop {
            let Some(row) = self.reach(of, course, step, time_s, &change, &seed) else {
                (self.out_of_reach, self.is_out_of_reach) = (self.out_of_reach + 1, true);
                return Offsets::Blend(self.offset.clone(), self.offset.clone());
            };
            seed.clone_from(&row);
            rows.push(row);
            if time_s >= step.end_s {
                return Offsets::Table(rows);
            }
            time_s += EVERY_S;
        }
    }

    /// The offset with which a free way of the arm should end.
    pub(crate) fn wanted_after(&mut self, of: &Execution<'_>, course: &Course, index: usize) -> Option<Vec<f64>> {
        let step = course.step(index)?;
        let mut next = index + 1;
        while course.step(next).is_some_and(|step| step.contract.is_free() && !step.contract.drives()) {
            next += 1;
        }
        let change = match course.step(next) {
            Some(next) if next.contract.drives() => None,
            Some(_) => self.change(of, course, next),
            // The plan ends with something in the hand.
            None => step.holds.and_then(|_| self.setting_down(of, course, index)),
        }?;
        let wanted = self.reach(of, course, step, step.end_s, &change, &self.offset);
        if wanted.is_none() {
            (self.out_of_reach, self.is_out_of_reach) = (self.out_of_reach + 1, true);
        }
        Some(wanted.unwrap_or_else(|| self.offset.clone()))
    }

    fn reach(
        &self,
        of: &Execution<'_>,
        course: &Course,
        step: &TimedStep,
        time_s: f64,
        change: &Change,
        seed: &[f64],
    ) -> Option<Vec<f64>> {
        let command = course.timeline.at(step, time_s, &of.robot);
        let part = change.fades.map_or(1.0, |(object, left)| {
            let gone = course.part_pushed(of, step, object, time_s);
            1.0 - gone * (1.0 - left)
        });
        let planned = Arm::world_from_tool(&of.robot, command.base, &command.joints);
        let target = carried(&planned, &change.about, change.scaled(part));
        let mut joints = command.joints;
        for (variable, bias) in of.robot.arm.iter().zip(&self.belief.biases) {
            *joints.get_mut(*variable)? += bias;
        }
        of.arm.reach(&of.robot, self.belief.base, &joints, &target, seed)
    }
}

/// Where furniture is looked at for the contacts to come: where the object goes or stands, if there is a surface there.
fn furniture(of: &Execution<'_>, course: &Course, index: usize) -> Option<Point3<f64>> {
    let (at, object) = course.next_contact(index)?;
    let goes = course.step(at)?.ends.get(object)?.translation.vector;
    let from = course.before(at).get(object)?.translation.vector;
    let lifts = course.step(at)?.contract.hand == HandUse::Takes;
    let at = Point3::from(if lifts { from } else { goes });
    let is_there = of
        .scene
        .surfaces()
        .iter()
        .any(|surface| surface.depth(&at.xy()) >= -BESIDE_M && (at.z - surface.height()).abs() <= BESIDE_M);
    is_there.then_some(at)
}
