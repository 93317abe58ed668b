//! A primitive of one's own: Pull, for pucks that stand too near a wall to be pushed away from it.
//!
//! `cargo run -p darrt-core --example own_primitive --features testing`

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use darrt_core::budget::Budget;
use darrt_core::error::Error;
use darrt_core::motion::Waypoints;
use darrt_core::observe::Silent;
use darrt_core::prelude::*;
use darrt_core::problem::Problem;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::approach::approach;
use darrt_core::testing::puck::{PuckWorld, Setup, paper_strategy};
use rand::Rng;

/// The robot touches a puck on the side of the target, holds it by suction and drives ahead of it.
struct Pull;

impl Primitive<PuckWorld> for Pull {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(8, "Pull")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_none() && !to.are_objects_met(m, from)
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        // The first puck that is not where it should be, and the unit vector to its target.
        let open = to.objects().find(|(id, _)| !to.is_object_met(m, from, *id));
        let (id, target) = open.ok_or(Infeasible::NoProgress)?;
        let at = from.object(id).ok_or(Infeasible::NoContact)?;
        let way = (target[0] - at[0]).hypot(target[1] - at[1]);
        let ahead = |p: &[f64; 2]| [0, 1].map(|i| p[i] + m.touch_distance(id) * (target[i] - at[i]) / way);
        let end = State { robot: ahead(target), ..from.clone() };
        if !m.robot().contains(&ahead(at)) || !m.robot().contains(&end.robot) {
            return Err(Infeasible::Limits);
        }
        // The transit to the contact, around the puck; and the pull, both on straight lines.
        let (transit, touching) = approach(m, from, id, ahead(at)).ok_or(Infeasible::NoContact)?;
        let mut end = State { mode: touching.mode.clone(), ..end };
        *end.objects.get_mut(id.index()).ok_or(Infeasible::NoContact)? = *target;
        let mode = touching.mode.clone();
        let motion = Waypoints::new(vec![touching, end], &[way], mode).ok_or(Infeasible::NoProgress)?;
        let pull = Instance {
            primitive: PrimitiveId::new(8, "Pull"),
            motion: Box::new(motion),
            contacts: ComponentSet::EMPTY.with(ComponentId::Object(id)),
            moves: ComponentSet::ROBOT.with(ComponentId::Object(id)),
            object: Some(id),
            reversible: false,
        };
        Ok(vec![transit, pull])
    }
}

fn main() -> Result<(), Error> {
    let setup =
        Setup::new([4.0, 3.0], 0.15).robot_at([3.0, 0.5]).puck("red", 0.12, [0.15, 0.15]).puck_goal(0, [2.5, 2.0]);
    for with_pull in [false, true] {
        let mut parts = setup.clone().parts()?;
        if with_pull {
            parts.primitives.push(Box::new(Pull));
        }
        let problem = Problem::new(parts)?;
        let budget = Budget { iterations: Some(1000), ..Budget::default() };
        let options = SolveOptions { budget, ..SolveOptions::default() };
        let outcome = solve(&problem, &paper_strategy()?, &options, &mut Silent);
        let names: Vec<_> = problem.primitives().iter().map(|p| p.name()).collect();
        println!("with {}: {} after {} iterations", names.join(", "), outcome.stop, outcome.iterations);
        if let Some(solution) = outcome.solution {
            let names: Vec<_> = solution.plan().steps().iter().map(|s| s.instance.primitive.name()).collect();
            println!("  {}", names.join(", "));
        }
    }
    Ok(())
}
