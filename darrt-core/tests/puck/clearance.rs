//! The planner's validity check against the judge's, on random motions.

use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::sample::Full;
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::puck::clearance::CLEARANCE_M;
use darrt_core::testing::puck::transit::drive;
use darrt_core::testing::puck::{Clearance, Obstacle, Oracle, Outline, PuckWorld, problems};
use darrt_core::validity::{BlockKind, Validity};

use super::support::{World, id, random_pair, rng};

fn obstacles() -> Vec<Obstacle> {
    vec![
        Obstacle { name: "wall".into(), outline: Outline::Rectangle { lower: [1.8, 0.0], upper: [2.0, 1.4] } },
        Obstacle { name: "pillar".into(), outline: Outline::Disc { centre: [2.0, 2.4], radius_m: 0.3 } },
    ]
}

fn world() -> PuckWorld {
    problems::four_pucks().unwrap().domain().clone()
}

/// Random transits that start in the clear.
fn transits(m: &World, count: u64) -> Vec<(State<World>, Instance<World>)> {
    let clear = Clearance::new(obstacles());
    let states = (0..count).map(|seed| (seed, random_pair(m, &Full, seed).0));
    states
        .filter(|(_, s)| clear.check(m, s, &ComponentSet::EMPTY).is_ok())
        .filter_map(|(seed, s)| {
            let target = m.robot().sample(&mut rng(seed + 10_000));
            let (instance, _) = drive(m, &s, &[], target, None)?;
            Some((s, instance))
        })
        .collect()
}

#[test]
fn a_free_prefix_is_free_everywhere_and_ends_where_the_room_ends() {
    let m = world();
    let (clear, oracle) = (Clearance::new(obstacles()), Oracle::new(obstacles()));
    let cases = transits(&m, 1500);
    let mut blocked = 0;
    for (start, instance) in &cases {
        let free = clear.free_prefix(&m, instance, start);
        for i in 0..=500_u16 {
            let t = free.fraction * f64::from(i) / 500.0;
            let state = instance.at(&m, t, start);
            assert_eq!(oracle.check(&m, &state, &instance.contacts), Ok(()), "t = {t}");
        }
        assert_eq!(free.blame.is_none(), free.fraction >= 1.0);
        if let Some(blame) = &free.blame {
            blocked += 1;
            // A little further on, the two bodies of the blame do come too near.
            let t = free.fraction + CLEARANCE_M / instance.motion.length();
            let beyond = clear.check(&m, &instance.at(&m, t, start), &instance.contacts).unwrap_err();
            assert_eq!((blame.kind, &blame.first, &blame.second), (beyond.kind, &beyond.first, &beyond.second));
        }
        let judged = oracle.free_prefix(&m, instance, start);
        assert!(judged.fraction >= free.fraction - 1e-12, "{judged:?} {free:?}");
    }
    assert!(cases.len() > 50 && blocked > 20, "{} cases, {blocked} blocked", cases.len());
}

#[test]
fn whatever_the_planner_allows_the_judge_allows_too() {
    let m = world();
    let (clear, oracle) = (Clearance::new(obstacles()), Oracle::new(obstacles()));
    let mut differ = 0;
    for seed in 0..3000 {
        let (state, _) = random_pair(&m, &Full, seed);
        let planner = clear.check(&m, &state, &ComponentSet::EMPTY);
        let judge = oracle.check(&m, &state, &ComponentSet::EMPTY);
        assert!(planner.is_err() || judge.is_ok(), "{state:?}");
        differ += u32::from(planner.is_err() && judge.is_ok());
    }
    assert!(differ < 60, "a millimetre decides seldom, not {differ} times");
}

#[test]
fn held_and_touched_pucks_must_be_where_the_mode_says() {
    use darrt_core::testing::puck::Grip;
    let problem = problems::open().unwrap();
    let (m, clear) = (problem.domain(), Clearance::default());
    let touching = State { robot: [1.5 - 0.27, 1.0], ..problem.start().clone() };
    let kind = |s: &State<World>| clear.check(m, s, &ComponentSet::EMPTY).map_err(|blame| blame.kind);
    assert_eq!(kind(&touching), Err(BlockKind::RobotObject), "too near without a reason");
    let reason = State { mode: touching.mode.touching(Some(id(0))), ..touching.clone() };
    assert_eq!(kind(&reason), Ok(()));
    let pierced = State { robot: [1.5 - 0.26, 1.0], ..reason };
    assert_eq!(kind(&pierced), Err(BlockKind::RobotObject), "a contact is no licence to overlap");
    let grip = |offset| State { mode: touching.mode.with_grip(id(0), Grip::Held { offset }), ..touching.clone() };
    assert_eq!(kind(&grip([0.27, 0.0])), Ok(()));
    assert_eq!(kind(&grip([0.30, 0.0])), Err(BlockKind::Other), "the puck is not in the grip");
}

#[test]
fn not_a_number_is_never_valid() {
    let problem = problems::open().unwrap();
    let m = problem.domain();
    for validity in [&Clearance::default() as &dyn Validity<World>, &Oracle::new(Vec::new())] {
        let lost = State { robot: [f64::NAN, 1.0], ..problem.start().clone() };
        assert!(validity.check(m, &lost, &ComponentSet::EMPTY).is_err());
        let mut lost = problem.start().clone();
        lost.objects[0] = [1.0, f64::NAN];
        assert!(validity.check(m, &lost, &ComponentSet::EMPTY).is_err());
    }
}
