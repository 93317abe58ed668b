//! Its spaces, its states and its targets.

use darrt_core::domain::Domain;
use darrt_core::laws::{SpaceClaims, check_component_space, check_covering, check_domain, check_partial};
use darrt_core::testing::strategies::{config, configs, parameters, seeds, targets};
use darrt_primitives::mobile_arm_space::MobileArmSpace;
use darrt_primitives::testing::strategies::any_mode;
use proptest::prelude::*;

use crate::laws::support::{PROBLEMS, problem};

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_spaces.txt");

#[test]
fn base_and_arm_keep_the_laws_of_a_space() {
    let problem = problem("plate1");
    let space: &MobileArmSpace<_> = problem.domain().robot();
    let q = configs(space);
    proptest!(config(64, REGRESSIONS), |(a in q.clone(), b in q.clone(), c in q, t in parameters(), u in parameters(), seed in seeds())| {
        check_component_space(space, &SpaceClaims::default(), [&a, &b, &c], [t, u], seed)?;
        check_component_space(space, &SpaceClaims::default(), [&a, &a, &b], [t, u], seed)?;
    });
}

#[test]
fn objects_keep_the_laws_of_a_space() {
    for name in PROBLEMS {
        let problem = problem(name);
        for space in problem.domain().objects() {
            let p = configs(space);
            proptest!(config(64, REGRESSIONS), |(a in p.clone(), b in p.clone(), c in p, t in parameters(), u in parameters(), seed in seeds())| {
                check_component_space(space, &SpaceClaims::default(), [&a, &b, &c], [t, u], seed)?;
                check_component_space(space, &SpaceClaims::default(), [&a, &a, &b], [t, u], seed)?;
            });
        }
    }
}

/// What stands on a table and what floats, all over the room.
#[test]
fn samples_of_an_object_reach_every_surface() {
    for name in PROBLEMS {
        let problem = problem(name);
        let m = problem.domain();
        for (space, movable) in m.objects().iter().zip(m.movables()) {
            for id in &movable.surfaces {
                let surface = m.surface(*id).unwrap();
                for corner in surface.vertices() {
                    let (low, high) = surface.bounds();
                    let inside = corner + ((low + (high - low) / 2.0) - corner) * 0.1;
                    check_covering(space, &space.standing(surface, &inside, 1.0), 0.35, 4000, 3)
                        .unwrap_or_else(|broken| panic!("{broken}"));
                }
            }
        }
    }
}

#[test]
fn states_and_targets_keep_the_laws_of_the_domain() {
    for name in PROBLEMS {
        let problem = problem(name);
        let m = problem.domain();
        let s = any_mode(m);
        let both = (targets(m), targets(m));
        let all = (s.clone(), s.clone(), s, parameters(), parameters(), seeds());
        proptest!(config(16, REGRESSIONS), |((a, b, c, t, u, seed) in all, (p, q) in both)| {
            check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [t, u], seed)?;
            check_partial(m, [&p, &q], &a, &b)?;
        });
    }
}
