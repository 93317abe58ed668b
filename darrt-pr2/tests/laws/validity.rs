//! What is in the way.

use std::cell::Cell;
use std::sync::Arc;

use darrt_core::laws::{ValidityClaims, check_against_oracle, check_enlarged, check_validity};
use darrt_core::random::{Purpose, stream};
use darrt_core::testing::strategies::{config, tasks_from};
use darrt_core::validity::Validity as _;
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::scene_oracle::SceneOracle;
use darrt_primitives::testing::strategies::any_mode;
use darrt_primitives::validity::SceneValidity;
use darrt_task::planning::prepare;
use darrt_task::problem_file::{ProblemFile, ShapeSpec};
use darrt_task::world;
use proptest::prelude::*;

use crate::laws::support::{PROBLEMS, file, obstacles, problem, valid_states};

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_validity.txt");

/// Motions that the primitives really propose, from valid states.
#[test]
fn the_fast_check_keeps_its_laws_and_is_never_laxer_than_the_oracle() {
    let (tried, blocked) = (Cell::new(0), Cell::new(0));
    for name in PROBLEMS {
        let problem = problem(name);
        let oracle = SceneOracle::new(&obstacles(name));
        let (m, validity) = (problem.domain(), problem.validity());
        proptest!(config(48, REGRESSIONS), |((from, to, seed) in tasks_from(m, valid_states(&problem)))| {
            for primitive in problem.primitives() {
                if !primitive.useful(m, &from, &to) {
                    continue;
                }
                let mut rng = stream(seed, 0, 0, Purpose::Extend);
                let Ok(instances) = primitive.propagate(m, &from, &to, &mut rng) else { continue };
                let mut at = from.clone();
                for instance in instances {
                    let of = |broken: darrt_core::laws::Broken| broken.of(name);
                    check_against_oracle(m, validity, &oracle, &instance, &at, 24).map_err(of)?;
                    let end = instance.at(m, 1.0, &at);
                    let instance = Arc::new(instance);
                    check_validity(m, validity, &instance, &at, &CLAIMS, seed).map_err(of)?;
                    tried.set(tried.get() + 1);
                    // What comes after a blocked motion is never asked: it begins in a state that is not valid.
                    if validity.free_prefix(m, &instance, &at).blame.is_some() {
                        blocked.set(blocked.get() + 1);
                        break;
                    }
                    at = end;
                }
            }
        });
    }
    assert!(blocked.get() >= 5 && tried.get() > blocked.get(), "{} of {}", blocked.get(), tried.get());
}

/// The same with the margins: what the hand works at may be near, all else keeps its distance, all along every motion.
#[test]
fn what_is_called_free_keeps_the_margins() {
    let tried = Cell::new(0);
    for name in PROBLEMS {
        let problem = problem(name);
        let oracle = SceneOracle::with_margins(&obstacles(name));
        let (m, validity) = (problem.domain(), problem.validity());
        proptest!(config(12, REGRESSIONS), |((from, to, seed) in tasks_from(m, valid_states(&problem)))| {
            for primitive in problem.primitives() {
                if !primitive.useful(m, &from, &to) {
                    continue;
                }
                let mut rng = stream(seed, 0, 0, Purpose::Extend);
                let Ok(instances) = primitive.propagate(m, &from, &to, &mut rng) else { continue };
                let mut at = from.clone();
                for instance in instances {
                    check_against_oracle(m, validity, &oracle, &instance, &at, 6)
                        .map_err(|broken: darrt_core::laws::Broken| broken.of(name))?;
                    tried.set(tried.get() + 1);
                    if validity.free_prefix(m, &instance, &at).blame.is_some() {
                        break;
                    }
                    at = instance.at(m, 1.0, &at);
                }
            }
        });
    }
    assert!(tried.get() > 20, "{}", tried.get());
}

/// A step of the conservative advancement that ends in a collision is not made, and a step is up to 0.2 m long (the cap of
/// the distances): so early may the free prefix end.
const CLAIMS: ValidityClaims = ValidityClaims { tight_m: 0.21, same_names: false, between: 8, anywhere: 2 };

/// Whatever the oracle rejects, the fast check rejects, in any state.
#[test]
fn what_the_oracle_rejects_is_rejected() {
    for name in PROBLEMS {
        let problem = problem(name);
        let (m, oracle) = (problem.domain(), SceneOracle::new(&obstacles(name)));
        proptest!(config(96, REGRESSIONS), |(state in any_mode(m))| {
            check_enlarged(m, &oracle, problem.validity(), &state, &Contacts::default())?;
        });
    }
}

/// One more box in the room.
fn with_another_obstacle(name: &str) -> ProblemFile {
    let mut file = file(name);
    let mut another = file.obstacles.first().cloned().unwrap();
    "another".clone_into(&mut another.name);
    another.at = vec![1.5, 1.5, 1.0];
    file.obstacles.push(another);
    file
}

#[test]
fn more_obstacles_forbid_more() {
    let (with, without) =
        (prepare(&darrt_pr2::registry(), &with_another_obstacle("plate1")).unwrap().problem, problem("plate1"));
    let differ = Cell::new(0);
    let m = without.domain();
    proptest!(config(192, REGRESSIONS), |(state in valid_states(&without))| {
        let none = Contacts::default();
        check_enlarged(m, without.validity(), with.validity(), &state, &none)?;
        let is_valid = |p: &darrt_core::problem::Problem<_>| p.validity().check(m, &state, &none).is_ok();
        differ.set(differ.get() + u32::from(is_valid(&without) && !is_valid(&with)));
    });
    assert!(differ.get() >= 1, "the obstacle is in nobody's way");
}

/// The same room, in which what stands about is larger by `by` metres on every side.
fn with_larger_obstacles(name: &str, by: f64) -> ProblemFile {
    let mut file = file(name);
    // What carries something keeps its height.
    let carries = |name: &str| file.surfaces.iter().any(|surface| surface.carrying_body() == Some(name));
    let grown: Vec<bool> = file.obstacles.iter().map(|obstacle| !carries(&obstacle.name)).collect();
    for (obstacle, _) in file.obstacles.iter_mut().zip(grown).filter(|(_, is_grown)| *is_grown) {
        match &mut obstacle.shape {
            ShapeSpec::Box { size } => size.iter_mut().for_each(|edge| *edge += 2.0 * by),
            ShapeSpec::Sphere { radius } => *radius += by,
            ShapeSpec::Cylinder { radius, height } | ShapeSpec::Capsule { radius, height } => {
                *radius += by;
                *height += 2.0 * by;
            }
            _ => {}
        }
    }
    file
}

#[test]
fn larger_obstacles_forbid_more() {
    for name in PROBLEMS {
        let (larger, given) =
            (world::build(&darrt_pr2::registry(), &with_larger_obstacles(name, 0.04)).unwrap(), problem(name));
        let larger = SceneValidity::new(&larger.world);
        let differ = Cell::new(0);
        let m = given.domain();
        proptest!(config(192, REGRESSIONS), |(state in valid_states(&given))| {
            let none = Contacts::default();
            check_enlarged(m, given.validity(), &larger, &state, &none)?;
            differ.set(differ.get() + u32::from(larger.check(m, &state, &none).is_err()));
        });
        assert!(differ.get() >= 1, "{name}: the obstacles are in nobody's way");
    }
}
