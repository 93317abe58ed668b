//! What is noticed along the way that is no fault: it makes the warnings of a proof.

use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Point2, Vector3};

use super::{Judge, Trial};
use crate::verify::edge;
use crate::verify::margins::{MarginKind, Placed};
use crate::verify::mode::Mode;
use crate::verify::motion::State;
use crate::verify::warning::{Warning, WarningKind};

/// A drive may be so many times as long as the straight way,
const DRIVE_TIMES: f64 = 2.0;
/// and so much longer, metres.
const DRIVE_MORE_M: f64 = 1.0;
/// In one plan the base may turn so far, radians.
const TURNING_RAD: f64 = std::f64::consts::TAU;
/// While the base drives the hand may be so far from its centre, metres: what finds room in a doorway with the arm folded.
const ARM_OUT_M: f64 = 0.8;
/// Nearer to the limit than this a lean is told, radians; where little is allowed, nearer than this share of it.
const TILT_NEAR_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
const TILT_NEAR_SHARE: f64 = 0.1;
/// How far what is pushed may be from where it is thought to be, metres: three standard deviations of what a camera sees, of
/// 10 mm each.
const POSITION_ERROR_M: f64 = 0.03;

/// What has been noticed so far.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    pub(super) warnings: Vec<Warning>,
    /// Where the base was when it last stood with the hand at work, the step in which it then drove first, and how far it
    /// has driven since, metres.
    drive: Option<([f64; 2], u32, f64)>,
    turned_rad: f64,
    /// How far what is held leaned most in this step, radians.
    leaned_rad: f64,
}

impl Remarks {
    /// What is held leans so far.
    pub(super) fn note_lean(&mut self, world_from_held: &Isometry3<f64>) {
        self.leaned_rad = self.leaned_rad.max((world_from_held.rotation * Vector3::z()).angle(&Vector3::z()));
    }

    /// The hand came down so far behind what it pushes, metres.
    pub(super) fn note_standoff(&mut self, step: u32, object: &str, gap_m: f64) {
        if gap_m < POSITION_ERROR_M {
            self.warnings.push(Warning::new(WarningKind::Standoff, Some(step), &[object], gap_m, POSITION_ERROR_M));
        }
    }

    /// What the problem itself puts near to each other.
    pub(super) fn note_near(&mut self, near: &[Placed], least_m: f64) {
        for Placed { bodies: (a, b), distance_m, is_at_goal } in near {
            let kind = if *is_at_goal { WarningKind::GoalNear } else { WarningKind::StartNear };
            let is_known = self.warnings.iter().any(|known| known.bodies == [a.as_str(), b.as_str()]);
            if !is_known {
                self.warnings.push(Warning::new(kind, None, &[a, b], *distance_m, least_m));
            }
        }
    }
}

impl Judge<'_> {
    /// What there is to be said about a step that went through `states`; the mode is that after it.
    pub(super) fn remark(&mut self, trial: &Trial<'_>, states: &[State]) {
        let (Some(first), Some(last)) = (states.first(), states.last()) else { return };
        let step = trial.site.step;
        self.remark_margins(step);
        self.remark_drive(step, trial.site.contract, states);
        let leaned_rad = std::mem::take(&mut self.remarks.leaned_rad);
        if let Some(holding) = trial.act.holding
            && let Some(movable) = self.world.movables.get(holding.object)
        {
            let limit = movable.spec.max_tilt_deg();
            if limit < 180.0
                && leaned_rad > limit.to_radians() - TILT_NEAR_RAD.min(TILT_NEAR_SHARE * limit.to_radians())
            {
                let name = &movable.spec.name;
                let warning = Warning::new(WarningKind::Tilt, Some(step), &[name], leaned_rad.to_degrees(), limit);
                self.remarks.warnings.push(warning);
            }
        }
        let moved = trial.act.pushed.or_else(|| {
            let is_place = trial.site.contract.hand == HandUse::LetsGo;
            trial.act.holding.filter(|_| is_place).map(|holding| holding.object)
        });
        if let Some(object) = moved
            && first.objects.get(object) != last.objects.get(object)
        {
            self.remark_edge(step, object, last);
        }
    }

    fn remark_margins(&mut self, step: u32) {
        let kinds = [
            (MarginKind::Robot, WarningKind::RobotMargin),
            (MarginKind::Held, WarningKind::HeldMargin),
            (MarginKind::Object, WarningKind::ObjectMargin),
        ];
        for (kind, warning) in kinds {
            let wanted_m = self.margins.wanted_m[kind.index()];
            if let Some(found) = &self.stage.smallest_of_step[kind.index()]
                && self.margins.least_m[kind.index()] < wanted_m
            {
                let (a, b) = &found.bodies;
                self.remarks.warnings.push(Warning::new(warning, Some(step), &[a, b], found.distance_m, wanted_m));
            }
        }
    }

    /// All drives between two times at which the hand is at work are one.
    fn remark_drive(&mut self, step: u32, contract: Contract, states: &[State]) {
        let Some(first) = states.first() else { return };
        if !contract.drives() {
            if !contract.is_free() {
                self.end_drive(first);
            }
            return;
        }
        let [x, y, _] = first.base;
        let way: (f64, f64) = states.windows(2).fold((0.0, 0.0), |(length, turn), pair| {
            let [from, to] = pair else { return (length, turn) };
            let [dx, dy, dyaw] = [0, 1, 2].map(|i| to.base[i] - from.base[i]);
            (length + dx.hypot(dy), turn + wrap_to_pi(dyaw).abs())
        });
        let (_, _, driven_m) = self.remarks.drive.get_or_insert(([x, y], step, 0.0));
        *driven_m += way.0;
        self.remarks.turned_rad += way.1;
        let tools = self.hands.all().map(|robot| self.links[robot.tool].translation.vector);
        let out_m = tools.map(|tool| tool.x.hypot(tool.y)).fold(0.0, f64::max);
        if out_m > ARM_OUT_M && way.0 > 0.0 {
            self.remarks.warnings.push(Warning::new(WarningKind::ArmOut, Some(step), &[], out_m, ARM_OUT_M));
        }
    }

    /// The base now stands where it is in `here`.
    fn end_drive(&mut self, here: &State) {
        let Some(([x, y], step, driven_m)) = self.remarks.drive.take() else { return };
        let straight_m = (here.base[0] - x).hypot(here.base[1] - y);
        let enough_m = DRIVE_TIMES * straight_m + DRIVE_MORE_M;
        if driven_m > enough_m {
            self.remarks.warnings.push(Warning::new(WarningKind::Drive, Some(step), &[], driven_m, enough_m));
        }
    }

    fn remark_edge(&mut self, step: u32, object: usize, end: &State) {
        let (Some(Mode::Resting { surface }), Some(pose)) = (self.modes.get(object), end.objects.get(object)) else {
            return;
        };
        let (centre, wanted_m) = (Point2::from(pose.translation.vector.xy()), self.plan.problem.safety.edge_margin_m);
        let depth_m = edge::inside_m(&self.world, object, *surface, &centre, wanted_m, self.options);
        let (Some(depth_m), Some(surface)) = (depth_m, self.world.surface(*surface)) else { return };
        if depth_m < wanted_m - self.options.rounding {
            let bodies = [self.world.object_name(object), surface.name()];
            self.remarks.warnings.push(Warning::new(WarningKind::Edge, Some(step), &bodies, depth_m, wanted_m));
        }
    }

    /// The warnings about the whole plan, which ends at `end`; in the order of the steps.
    pub(super) fn warnings(&mut self, end: &State) -> Vec<Warning> {
        self.end_drive(end);
        if self.remarks.turned_rad > TURNING_RAD {
            let [found, most] = [self.remarks.turned_rad, TURNING_RAD].map(f64::to_degrees);
            self.remarks.warnings.push(Warning::new(WarningKind::Turning, None, &[], found, most));
        }
        let mut warnings = std::mem::take(&mut self.remarks.warnings);
        warnings.sort_by_key(|warning| warning.step);
        warnings
    }
}
