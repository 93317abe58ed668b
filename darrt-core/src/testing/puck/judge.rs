//! The judge: separate, slower and more obvious code than what plans.

use super::clearance::{Obstacle, Outline};
use super::world::{Point, PuckWorld};
use crate::domain::Domain;
use crate::goal::Goal;
use crate::motion::Instance;
use crate::plan::Plan;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, State};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};
use crate::verify::{Refusal, Replay, Verified, Verifier};

/// Metres between the states that the judge looks at.
pub const SPACING_M: f64 = 1e-3;
/// How deep a touched puck may overlap with the robot, metres: a contact is not a collision.
pub const CONTACT_M: f64 = 1e-3;

/// No two bodies overlap; those that may touch, by no more than [`CONTACT_M`]. What is held is where the hand is.
#[derive(Debug, Clone)]
pub struct Oracle {
    obstacles: Vec<Obstacle>,
}

impl Oracle {
    /// The rule for these obstacles.
    pub fn new(obstacles: Vec<Obstacle>) -> Self {
        Self { obstacles }
    }
}

impl Validity<PuckWorld> for Oracle {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        let refuse = |kind, first: &str, second: &str, p: &Point| {
            Err(Blame { kind, first: first.into(), second: second.into(), place: [p[0], p[1], 0.0] })
        };
        if !m.robot().contains(&state.robot) {
            return refuse(BlockKind::Limits, "robot", "edge of the floor", &state.robot);
        }
        for obstacle in &self.obstacles {
            if overlap(&state.robot, m.robot_radius(), &obstacle.outline) {
                return refuse(BlockKind::RobotFixed, "robot", &obstacle.name, &state.robot);
            }
        }
        for ((id, at), puck) in m.ids().zip(&state.objects).zip(m.pucks()) {
            if !m.objects().get(id.index()).is_some_and(|space| space.contains(at)) {
                return refuse(BlockKind::Limits, &puck.name, "edge of the floor", at);
            }
            if let Some((held, offset)) = state.mode.held()
                && held == id
                && separation(at, &[state.robot[0] + offset[0], state.robot[1] + offset[1]]) > CONTACT_M
            {
                return refuse(BlockKind::Other, &puck.name, "grip of the robot", at);
            }
            for obstacle in &self.obstacles {
                if overlap(at, puck.radius_m, &obstacle.outline) {
                    return refuse(BlockKind::ObjectFixed, &puck.name, &obstacle.name, at);
                }
            }
            let held = state.mode.held().is_some_and(|(held, _)| held == id);
            let touched = held || state.mode.touching == Some(id) || contacts.contains(ComponentId::Object(id));
            if m.gap(state, id) < if touched { -CONTACT_M } else { 0.0 } {
                return refuse(BlockKind::RobotObject, "robot", &puck.name, at);
            }
            for ((other_at, other), _) in state.objects.iter().zip(m.pucks()).zip(0..id.index()) {
                if separation(at, other_at) < puck.radius_m + other.radius_m {
                    return refuse(BlockKind::ObjectObject, &other.name, &puck.name, at);
                }
            }
        }
        Ok(())
    }

    fn free_prefix(&self, m: &PuckWorld, instance: &Instance<PuckWorld>, from: &State<PuckWorld>) -> FreePrefix {
        let steps = (instance.motion.length() / SPACING_M).ceil().clamp(1.0, 1e7);
        let mut free = 0.0;
        let mut i = 0.0;
        while i <= steps {
            let t = i / steps;
            if let Err(blame) = self.check(m, &instance.at(m, t, from), &instance.contacts) {
                return FreePrefix::blocked(free, blame);
            }
            free = t;
            i += 1.0;
        }
        FreePrefix::FREE
    }
}

fn separation(a: &Point, b: &Point) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// Does a disc overlap with an obstacle?
fn overlap(at: &Point, radius_m: f64, outline: &Outline) -> bool {
    match outline {
        Outline::Disc { centre, radius_m: other } => separation(at, centre) < radius_m + other,
        Outline::Rectangle { lower, upper } => {
            let nearest = [at[0].max(lower[0]).min(upper[0]), at[1].max(lower[1]).min(upper[1])];
            separation(at, &nearest) < radius_m
        }
    }
}

/// Replays the plan before the [`Oracle`] and checks that pucks move only when pushed or held.
#[derive(Debug, Clone)]
pub struct Judge {
    replay: Replay<Oracle>,
}

impl Judge {
    /// A judge who knows these obstacles.
    pub fn new(obstacles: Vec<Obstacle>) -> Self {
        Self { replay: Replay::new(Oracle::new(obstacles), SPACING_M) }
    }
}

impl Verifier<PuckWorld> for Judge {
    fn verify(
        &self,
        m: &PuckWorld,
        start: &State<PuckWorld>,
        goal: &dyn Goal<PuckWorld>,
        plan: &Plan<PuckWorld>,
    ) -> Result<Verified, Refusal> {
        let verified = self.replay.verify(m, start, goal, plan)?;
        for (index, _) in plan.steps().iter().enumerate() {
            let states = [0.0, 0.5, 1.0].map(|s| plan.at(m, index, s));
            let [Some(before), Some(during), Some(after)] = states else { continue };
            for (id, puck) in m.ids().zip(m.pucks()) {
                let is_moved = before.object(id) != after.object(id);
                let is_held = during.mode.held().is_some_and(|(held, _)| held == id);
                if is_moved && !is_held && m.gap(&during, id).abs() > CONTACT_M {
                    let reason = format!("{} moves without being touched by the robot", puck.name);
                    return Err(Refusal { step: Some(index), at: 0.5, reason });
                }
            }
        }
        Ok(verified)
    }
}
