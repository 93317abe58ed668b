//! The five primitives of the puck world keep what they promise.

use darrt_core::domain::Domain;
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_core::sample::{RandomSubset, Sampler};
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ComponentId, State};
use darrt_core::testing::puck::{Carry, Grip, Pick, Place, Push, Setup, Transit};

use super::support::{World, id, random_pair, rng};

const ALL: [&dyn Primitive<World>; 5] = [&Transit, &Push, &Pick, &Carry, &Place];

/// Two pucks, of which the first can be grabbed.
fn setup() -> Setup {
    let setup = Setup::new([4.0, 3.0], 0.15).robot_at([1.0, 1.5]);
    setup.graspable_puck("red", 0.12, [2.0, 1.5]).puck("blue", 0.1, [3.0, 1.5])
}

fn holding(offset: [f64; 2]) -> (World, State<World>) {
    let parts = setup().parts().unwrap();
    let mut state = parts.start;
    state.robot = [state.objects[0][0] - offset[0], state.objects[0][1] - offset[1]];
    state.mode = state.mode.with_grip(id(0), Grip::Held { offset });
    (parts.domain, state)
}

/// The states between the instances, from the start of the first to the end of the last.
fn chain(m: &World, from: &State<World>, instances: &Instances<World>) -> Vec<State<World>> {
    let mut states = vec![from.clone()];
    for instance in instances {
        let before = states.last().unwrap().clone();
        assert_eq!(instance.at(m, 0.0, from), before, "{} starts elsewhere", instance.primitive);
        let after = instance.at(m, 1.0, from);
        for object in m.ids().filter(|o| !instance.moves.contains(ComponentId::Object(*o))) {
            assert_eq!(after.object(object), before.object(object), "{} moves {object:?}", instance.primitive);
        }
        states.push(after);
    }
    states
}

#[test]
fn instances_join_bit_for_bit_and_lead_nearer() {
    let m = setup().parts().unwrap().domain;
    let (mut tried, mut done) = (0, 0);
    for seed in 0..400 {
        let (mut state, target) = random_pair(&m, &RandomSubset, seed);
        if seed % 3 == 0 {
            let offset = [0.27, 0.0];
            state.objects[0] = [state.robot[0] + offset[0], state.robot[1] + offset[1]];
            state.mode = state.mode.with_grip(id(0), Grip::Held { offset });
        }
        for primitive in ALL.iter().filter(|p| p.useful(&m, &state, &target)) {
            tried += 1;
            let Ok(instances) = primitive.propagate(&m, &state, &target, &mut rng(seed)) else { continue };
            done += 1;
            let states = chain(&m, &state, &instances);
            let end = states.last().unwrap();
            let open = |s: &State<World>| target.objects().filter(|(o, _)| !target.is_object_met(&m, s, *o)).count();
            match primitive.name() {
                "Push" => assert_eq!(open(end), open(&state) - 1),
                "Carry" => assert!(target.is_object_met(&m, end, id(0))),
                "Transit" => assert!(target.is_met(&m, end)),
                _ => assert_ne!(end.mode, state.mode),
            }
        }
    }
    assert!(tried > 400 && done > tried / 2, "{done} of {tried}");
}

#[test]
fn a_push_keeps_the_contact_and_the_ray() {
    let parts = setup().parts().unwrap();
    let (m, from) = (&parts.domain, &parts.start);
    let target = PartialState::anywhere(m).with_object(id(0), [2.6, 2.3]);
    let instances = Push.propagate(m, from, &target, &mut rng(0)).unwrap();
    let labels: Vec<_> = instances.iter().map(|i| i.primitive.name()).collect();
    assert_eq!(labels, ["Transit", "Push"]);
    for i in 0..=50_u8 {
        let state = instances[1].at(m, f64::from(i) / 50.0, from);
        assert!(m.gap(&state, id(0)).abs() < 1e-12);
        let [x, y] = [state.objects[0][0] - state.robot[0], state.objects[0][1] - state.robot[1]];
        assert!((x * 0.8 - y * 0.6).abs() < 1e-12, "contact, centre and target lie on one ray");
        assert_eq!(state.mode.touching, Some(id(0)));
    }
    assert_eq!(chain(m, from, &instances).last().unwrap().objects[0], [2.6, 2.3]);
    assert!(!instances[1].reversible);
}

#[test]
fn pick_carry_and_place_in_order() {
    let parts = setup().parts().unwrap();
    let (m, from) = (&parts.domain, &parts.start);
    let target = PartialState::anywhere(m).with_object(id(0), [2.5, 0.8]);
    assert!(Pick.useful(m, from, &target) && !Carry.useful(m, from, &target) && !Place.useful(m, from, &target));
    let picked = chain(m, from, &Pick.propagate(m, from, &target, &mut rng(0)).unwrap()).pop().unwrap();
    let (held, offset) = picked.mode.held().unwrap();
    assert_eq!(held, id(0));
    assert!((offset[0].hypot(offset[1]) - 0.27).abs() < 1e-12);
    for primitive in [&Transit as &dyn Primitive<World>, &Push, &Pick, &Place] {
        assert!(!primitive.useful(m, &picked, &target), "{}", primitive.name());
    }
    let states = chain(m, &picked, &Carry.propagate(m, &picked, &target, &mut rng(0)).unwrap());
    assert_eq!(states[1].objects[0], [2.5, 0.8]);
    assert!(states[1].mode.held().is_some() && states[2].mode.held().is_none());
    assert_eq!(states[2].mode.touching, Some(id(0)));
}

#[test]
fn a_robot_that_holds_a_puck_carries_it_or_lets_go() {
    let (m, state) = holding([0.27, 0.0]);
    let robot = PartialState::anywhere(&m).with_robot(&m, [1.0, 2.0]);
    assert!(Carry.useful(&m, &state, &robot) && Place.useful(&m, &state, &robot));
    let carried = chain(&m, &state, &Carry.propagate(&m, &state, &robot, &mut rng(0)).unwrap());
    assert_eq!((carried.len(), carried[1].robot, carried[1].objects[0]), (2, [1.0, 2.0], [1.27, 2.0]));
    let other = PartialState::anywhere(&m).with_object(id(1), [3.0, 2.0]);
    assert!(!Carry.useful(&m, &state, &other) && Place.useful(&m, &state, &other));
    let met = PartialState::anywhere(&m).with_object(id(0), state.objects[0]);
    assert!(ALL.iter().all(|p| !p.useful(&m, &state, &met)));
    let off_the_floor = PartialState::anywhere(&m).with_object(id(0), [0.2, 1.0]);
    let why = Carry.propagate(&m, &state, &off_the_floor, &mut rng(0)).unwrap_err();
    assert_eq!(why, Infeasible::Limits);
}

#[test]
fn transit_is_useful_only_when_the_named_pucks_are_where_they_should_be() {
    let parts = setup().parts().unwrap();
    let (m, from) = (&parts.domain, &parts.start);
    let robot = PartialState::anywhere(m).with_robot(m, [1.0, 2.0]);
    assert!(Transit.useful(m, from, &robot));
    assert!(Transit.useful(m, from, &robot.clone().with_object(id(0), from.objects[0])));
    assert!(!Transit.useful(m, from, &robot.clone().with_object(id(0), [2.5, 0.8])));
    assert!(!Transit.useful(m, from, &PartialState::anywhere(m)));
    assert!(!Transit.useful(m, from, &PartialState::anywhere(m).with_robot(m, from.robot)));
}

#[test]
fn the_approach_of_a_push_is_a_lower_bound_of_its_travel() {
    let m = setup().parts().unwrap().domain;
    for seed in 0..200 {
        let (state, target) = random_pair(&m, &RandomSubset as &dyn Sampler<World>, seed);
        let Ok(instances) = Push.propagate(&m, &state, &target, &mut rng(seed)) else { continue };
        let bound = Push.approach(&m, &state, &target).unwrap();
        assert!(instances[0].motion.length() >= bound - 1e-9);
        assert!(m.robot().contains(&instances[0].at(&m, 1.0, &state).robot));
    }
}
