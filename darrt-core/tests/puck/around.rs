//! A blocked transit goes another way, if the rest of the chain makes that worth while.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use darrt_core::extend::{ExtendOptions, Extender, Extension};
use darrt_core::local_repair::{LocalRepair, NoWay};
use darrt_core::motion::Instance;
use darrt_core::observe::accounts::Bucket;
use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use darrt_core::problem::Problem;
use darrt_core::state::{ComponentId, ComponentSet, State};
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use rand::Rng;

use super::support::{World, called, id, rng, robot_instance, small};

/// One instance of a chain: its primitive, where it leads, and how much of it is free.
#[derive(Clone, Copy)]
struct Link(&'static str, [f64; 2], f64);

const BLOCKED_GO: Link = Link("go", [0.5, 0.5], 0.5);
const PUSH: Link = Link("push", [0.7, 0.5], 1.0);

fn blame() -> Blame {
    Blame { kind: BlockKind::RobotFixed, first: "robot".into(), second: "wall".into(), place: [0.0; 3] }
}

/// Propagates the whole chain at once. A push takes the puck along.
struct Chain(Vec<Link>);

impl Primitive<World> for Chain {
    fn id(&self) -> PrimitiveId {
        called("Chain")
    }

    fn useful(&self, _: &World, _: &State<World>, _: &PartialState<World>) -> bool {
        true
    }

    fn propagate(
        &self,
        _: &World,
        from: &State<World>,
        _: &PartialState<World>,
        _: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let mut here = from.clone();
        let mut instances = Vec::new();
        for Link(primitive, to, _) in &self.0 {
            let mut there = State { robot: *to, ..here.clone() };
            let mut moves = ComponentSet::ROBOT;
            if *primitive == "push" {
                there.objects[0][0] += 0.1;
                moves = moves.with(ComponentId::Object(id(0)));
            }
            instances.push(Instance { primitive: called(primitive), moves, ..robot_instance(&here, &there) });
            here = there;
        }
        Ok(instances)
    }
}

/// Knows how free each link is; a state with the robot at `taken` is not valid. Notes what it is asked.
struct Known {
    links: Vec<Link>,
    taken: [f64; 2],
    asked: Arc<Mutex<Vec<&'static str>>>,
}

impl Validity<World> for Known {
    fn check(&self, _: &World, state: &State<World>, _: &ComponentSet) -> Result<(), Blame> {
        if state.robot == self.taken { Err(blame()) } else { Ok(()) }
    }

    fn free_prefix(&self, m: &World, instance: &Instance<World>, from: &State<World>) -> FreePrefix {
        self.asked.lock().unwrap().push(instance.primitive.name());
        let end = instance.at(m, 1.0, from).robot;
        let is_it = |link: &&Link| link.0 == instance.primitive.name() && link.1 == end;
        match self.links.iter().find(is_it).map_or(1.0, |link| link.2) {
            1.0 => FreePrefix::FREE,
            fraction => FreePrefix::blocked(fraction, blame()),
        }
    }
}

/// Turns every "go" into an "around", or finds none. Counts how often it is asked.
struct Around {
    finds: bool,
    calls: AtomicUsize,
}

impl LocalRepair<World> for Around {
    fn is_free_to_turn(&self, _: &World, instance: &Instance<World>) -> bool {
        instance.primitive.name() == "go"
    }

    fn repair(
        &self,
        m: &World,
        _: &dyn Validity<World>,
        _: usize,
        instance: &Instance<World>,
        from: &State<World>,
        _: &mut dyn Rng,
    ) -> Result<Instance<World>, NoWay> {
        self.calls.fetch_add(1, Ordering::SeqCst);
        let there = instance.at(m, 1.0, from);
        if self.finds {
            Ok(Instance { primitive: called("around"), ..robot_instance(from, &there) })
        } else {
            Err(NoWay::WithAnyCare)
        }
    }
}

struct Seen {
    extension: Extension<World>,
    /// How often a way around was looked for.
    calls: usize,
    /// The labels of the motions whose free prefix was asked for.
    asked: Vec<&'static str>,
}

impl Seen {
    fn labels(&self) -> Vec<&'static str> {
        let mut labels: Vec<_> = self.extension.reached.iter().map(|r| r.instance.primitive.name()).collect();
        labels.dedup();
        labels
    }
}

/// Extends along `chain`; `known` adds what is known about ways around.
fn extend(chain: &[Link], known: &[Link], taken: [f64; 2], finds: bool) -> Seen {
    let asked = Arc::default();
    let links = [chain, known].concat();
    let mut parts = small().puck_goal(0, [1.5, 1.5]).parts().unwrap();
    parts.primitives = vec![Box::new(Chain(chain.to_vec()))];
    parts.validity = Box::new(Known { links, taken, asked: Arc::clone(&asked) });
    let problem = Problem::new(parts).unwrap();
    let around = Around { finds, calls: AtomicUsize::new(0) };
    let options = ExtendOptions::default();
    let interrupt = darrt_core::budget::Interrupt::NEVER;
    let extender = Extender { problem: &problem, options: &options, local_repair: Some(&around), interrupt };
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), chain.last().unwrap().1);
    let extension = extender.extend(problem.start(), &target, &mut rng(0));
    let asked = asked.lock().unwrap().clone();
    Seen { extension, calls: around.calls.into_inner(), asked }
}

const NOWHERE: [f64; 2] = [9.0, 9.0];

#[test]
fn a_blocked_transit_before_a_push_goes_around() {
    let seen = extend(&[BLOCKED_GO, PUSH], &[], NOWHERE, true);
    assert!(seen.extension.is_met && seen.extension.blame.is_none());
    assert_eq!((seen.labels(), seen.calls), (vec!["around", "push"], 1));
    assert_eq!(seen.asked, ["go", "push", "around"], "each motion is judged once");
    assert_eq!(seen.extension.buckets[..], [Bucket::Accepted]);
}

#[test]
fn a_way_around_is_judged_like_any_other() {
    let seen = extend(&[BLOCKED_GO, PUSH], &[Link("around", [0.5, 0.5], 0.75)], NOWHERE, true);
    assert_eq!((seen.labels(), seen.extension.is_met), (vec!["around"], false));
    assert_eq!(seen.extension.reached.last().unwrap().t, 0.75);
    assert_eq!(seen.extension.blame, Some(blame()));
}

#[test]
fn without_a_way_around_the_free_part_stays() {
    let seen = extend(&[BLOCKED_GO, PUSH], &[], NOWHERE, false);
    assert_eq!((seen.labels(), seen.calls, seen.extension.is_met), (vec!["go"], 1, false));
    assert_eq!(seen.extension.reached.last().unwrap().t, 0.5);
}

#[test]
fn a_way_around_is_looked_for_only_where_it_matters() {
    let go_on = Link("go", [0.6, 0.5], 1.0);
    let push_on = |free| Link("push", [0.8, 0.5], free);
    let free = Link("go", [0.5, 0.5], 1.0);
    for (what, chain, taken, calls) in [
        ("the push can just begin", vec![BLOCKED_GO, Link("push", [0.7, 0.5], 0.25)], NOWHERE, 1),
        ("the push can hardly begin", vec![BLOCKED_GO, Link("push", [0.7, 0.5], 0.2)], NOWHERE, 0),
        ("one of two pushes can hardly begin", vec![BLOCKED_GO, PUSH, push_on(0.2)], NOWHERE, 0),
        ("both pushes can begin", vec![BLOCKED_GO, PUSH, push_on(0.5)], NOWHERE, 1),
        ("nothing is moved", vec![BLOCKED_GO, go_on], NOWHERE, 0),
        ("the transit must not end where it does", vec![BLOCKED_GO, PUSH], BLOCKED_GO.1, 0),
        ("one of two transits must not end where it does", vec![BLOCKED_GO, go_on, PUSH], go_on.1, 0),
        ("both transits may end where they do", vec![BLOCKED_GO, go_on, PUSH], NOWHERE, 1),
        ("a transit behind the blocked push is no reason", vec![free, Link("push", [0.7, 0.5], 0.5)], NOWHERE, 0),
        ("nothing is in the way", vec![free, PUSH], NOWHERE, 0),
    ] {
        assert_eq!(extend(&chain, &[], taken, true).calls, calls, "{what}");
    }
}
