//! Each primitive.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rand::RngExt;

use super::{Plan, Tally, rng_of_case};
use crate::domain::Domain;
use crate::laws::everything::report::Row;
use crate::laws::everything::world::World;
use crate::laws::primitive::{ENDS, Excuse, FEASIBLE, FREE, NOT_EMPTY, PANICS, PrimitiveClaims, Tried};
use crate::laws::watch::{asking, bounded, entering, guarded};
use crate::laws::{Broken, MotionClaims, check_contacts, ensure, motion, primitive, try_primitive};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::primitive::Primitive;
use crate::random::{Purpose, Stream, stream};
use crate::state::{ComponentId, ObjectId, State};
use crate::validity::Validity;

/// Parameters of an instance at which the contact with its object must be allowed.
const TS: [f64; 4] = [0.2, 0.5, 0.8, 0.95];
/// How many other states and targets are tried for a primitive that is of no use.
const RETRIES: usize = 4;
/// A primitive that found so many ways of which none was free finds none that is.
const MOST_BLOCKED: u64 = 100;
/// Of so many ways at most for each kind of what is to be done it is seen whether they are free.
const MOST_WALKS: u64 = 300;
/// And if none of so many is, that is worth a word.
const ENOUGH_WALKS: u64 = 60;
/// A primitive that was useful so often and never found a way finds none at all.
const MOST_IN_VAIN: u64 = 1000;

pub(super) fn plans<D: Domain>(world: &World<D>) -> Vec<Plan<D>> {
    (0..world.subjects.primitives.len()).filter_map(|index| plan(world, index)).collect()
}

fn plan<D: Domain>(world: &World<D>, index: usize) -> Option<Plan<D>> {
    let name = world.subjects.primitives.get(index)?.name();
    // Calls, those in which it was useful, those in which it was propagated.
    let tally = Arc::new(Tally::default());
    let counted = Arc::clone(&tally);
    let case = move |world: &World<D>, number: u64, level: u8| {
        let Some(primitive) = world.subjects.primitives.get(index) else { return Ok(()) };
        let (m, subjects) = (&*world.m, &world.subjects);
        let mut rng = rng_of_case(number);
        let mut from = world.state(&mut rng, level);
        let mut to = world.target(&from, &mut rng, level);
        // What is useful rarely, with something in the hand say, is looked for.
        for _ in 0..RETRIES {
            let about = || format!("useful of {}, from &{from:?} to &{to:?}", primitive.name());
            entering("useful");
            if asking(about, || guarded(PANICS, || primitive.useful(m, &from, &to)))? {
                break;
            }
            from = world.state(&mut rng, level);
            to = world.target(&from, &mut rng, level);
        }
        let excuse = subjects.excuse.as_deref();
        let excuse = excuse.map(|excuse| move |m: &D, a: &_, to: &_, b: &_| excuse(m, a, to, b));
        let travel = |m: &D, a: &_, b: &_| match &subjects.travel {
            Some(travel) => travel(m, a, b),
            None => motion::component_travel(m, a, b),
        };
        let claims = PrimitiveClaims {
            motion: MotionClaims { travel: &travel, ..MotionClaims::default() },
            max_instances: subjects.max_instances,
            excuse: excuse.as_ref().map(|excuse| excuse as Excuse<'_, D>),
            ..PrimitiveClaims::default()
        };
        Tally::count(&counted.tried);
        match try_primitive(m, &**primitive, &from, &to, number, &claims)? {
            Tried::NotUseful => {}
            Tried::Infeasible(_) => Tally::count(&counted.hit),
            Tried::Propagated(instances) => {
                Tally::count(&counted.hit);
                Tally::count(&counted.reached);
                let is_known = |instance: &Instance<D>| {
                    subjects.primitives.iter().any(|primitive| primitive.id() == instance.primitive)
                };
                for instance in &instances {
                    let mut all = subjects.primitives.iter();
                    all.try_for_each(|one| primitive::is_whole(instance.primitive, one.id()))?;
                }
                if !instances.iter().all(is_known) {
                    Tally::count(&counted.unknown);
                }
                if let Some(validity) = &subjects.validity {
                    let (mut here, mut is_free) = (from.clone(), true);
                    for instance in instances {
                        entering("free_prefix");
                        is_free = is_free && validity.free_prefix(m, &instance, &here).blame.is_none();
                        let one = [instance];
                        allows_contact(m, &**validity, &one, &here)?;
                        let [instance] = one;
                        here = instance.at(m, 1.0, &here);
                    }
                    if is_free {
                        Tally::count(&counted.free);
                    }
                }
            }
        }
        Ok(())
    };
    let once = move |world: &World<D>, row: &mut Row| verdict(world, index, name, &tally, row);
    let laws = primitive::LAWS.len() + motion::LAWS.len();
    Some(Plan::new(name, laws, world.subjects.effort.cases, case).finally(once))
}

/// What all cases and calls together say.
fn verdict<D: Domain>(
    world: &World<D>,
    index: usize,
    name: &'static str,
    tally: &Tally,
    row: &mut Row,
) -> Result<(), Broken> {
    let found_in_cases = Tally::get(&tally.reached);
    let calls = many_calls(world, index, tally)?;
    let [tried, hit, reached] = [&tally.tried, &tally.hit, &tally.reached].map(Tally::get);
    row.cases = calls;
    let unknown = Tally::get(&tally.unknown);
    if unknown > 0 {
        row.warn(format!("{unknown} propagations had instances of primitives that were not given"));
    }
    if hit == 0 {
        row.warn(format!("`useful` was false in {tried} of {tried} calls"));
    } else if reached == 0 {
        row.warn(format!("`propagate` found no way in {hit} of {hit} calls in which it was useful"));
    }
    if hit >= MOST_IN_VAIN && reached == 0 {
        let found = format!("no way in {hit} of {hit} calls");
        return Err(Broken::new(FEASIBLE, found, "a way now and then, where it is useful").of(name));
    }
    for (kind, [useful, found]) in tally.kinds.iter().enumerate() {
        let [useful, found] = [useful, found].map(Tally::get);
        let text = || format!("no way in {useful} of {useful} calls {}", open(kind));
        ensure(FEASIBLE, useful < MOST_IN_VAIN || found > 0, text, "a way now and then, where it is useful")
            .map_err(|broken| broken.of(name))?;
    }
    let (mut walked, mut free) = (found_in_cases, Tally::get(&tally.free));
    for (kind, [tried, kept]) in tally.walks.iter().enumerate() {
        let [tried, kept] = [tried, kept].map(Tally::get);
        (walked, free) = (walked + tried, free + kept);
        if tried >= ENOUGH_WALKS && kept == 0 {
            row.warn(format!("blocked in {tried} of {tried} ways {}", open(kind)));
        }
    }
    for (i, [useful, found]) in tally.objects.iter().enumerate() {
        let useful = Tally::get(useful);
        if useful >= MOST_IN_VAIN && reached > 0 && Tally::get(found) == 0 {
            let object = world.m.component_name(ComponentId::Object(ObjectId::new(i)));
            row.warn(format!("no way in {useful} of {useful} calls in which only {object} was to be moved"));
        }
    }
    let [moved, arrived] = tally.arrived.each_ref().map(Tally::get);
    if moved >= MOST_IN_VAIN && arrived == 0 {
        row.warn(format!("what its target names moved on {moved} ways, and none of them ended there"));
    }
    let text = || format!("blocked in {walked} of {walked} propagations");
    let is_known = world.subjects.validity.is_some() && walked >= MOST_BLOCKED;
    ensure(FREE, !is_known || free > 0, text, "free now and then").map_err(|broken| broken.of(name))
}

/// What is forgotten shows all along. For a moment the object may well be in the way: in the hand, of the robot's own base.
fn allows_contact<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    one: &[Instance<D>; 1],
    from: &State<D>,
) -> Result<(), Broken> {
    let is_forgotten = TS.iter().all(|t| check_contacts(m, validity, one, from, &[*t]).is_err());
    if is_forgotten { check_contacts(m, validity, one, from, &TS) } else { Ok(()) }
}

/// What is still to be done, in words.
fn open(kind: usize) -> String {
    let says = |bit: usize, what: &'static str| if kind & bit == 0 { "" } else { what };
    format!(
        "with {} to be moved{}",
        [says(1, "the robot"), says(2, "an object")].join(" "),
        says(4, ", in another mode")
    )
}

/// Many calls that only look whether they come back, without panic: for what happens once in a thousand times.
fn many_calls<D: Domain>(world: &World<D>, index: usize, tally: &Tally) -> Result<u64, Broken> {
    let Some(primitive) = world.subjects.primitives.get(index) else { return Ok(0) };
    let calls = world.subjects.effort.calls;
    let began = AtomicU64::new(0);
    for i in 0..calls {
        let number = stream(world.seed, 24, i, Purpose::Attempt).random();
        let mut rng = rng_of_case(number);
        // The state is the expensive part: several targets for each.
        let from = world.state(&mut rng, 0);
        for attempt in 0..4 {
            let to = world.target(&from, &mut rng, 0);
            began.fetch_add(1, Relaxed);
            Tally::count(&tally.tried);
            let name = primitive.name();
            let about = || format!("check_primitive(&{name}, &{from:?}, &{to:?}, {number}), draw {attempt}");
            let draws = stream(number, attempt, 0, Purpose::Extend);
            asking(about, || one_call(world, &**primitive, (&from, &to), draws, tally))
                .map_err(|broken| broken.of(name).replayed_by(about))?;
        }
        if began.load(Relaxed) >= calls {
            break;
        }
    }
    Ok(began.into_inner())
}

/// Whether it comes back, without panic, and not with nothing.
fn one_call<D: Domain>(
    world: &World<D>,
    primitive: &dyn Primitive<D>,
    (from, to): (&State<D>, &PartialState<D>),
    draws: Stream,
    tally: &Tally,
) -> Result<(), Broken> {
    let m = &*world.m;
    entering("useful");
    if !guarded(PANICS, || primitive.useful(m, from, to))? {
        return Ok(());
    }
    Tally::count(&tally.hit);
    let is_elsewhere = from.mode != world.subjects.start.mode;
    let kind = usize::from(!to.is_robot_met(m, from))
        + 2 * usize::from(!to.are_objects_met(m, from))
        + 4 * usize::from(is_elsewhere);
    let [useful, ways] = tally.kinds.get(kind).map_or([&tally.hit; 2], |[useful, ways]| [useful, ways]);
    Tally::count(useful);
    let single = single(m, from, to);
    let of_object = single.and_then(|component| match component {
        ComponentId::Object(id) => tally.objects.get(id.index()),
        ComponentId::Robot => None,
    });
    if let Some([useful, _]) = of_object {
        Tally::count(useful);
    }
    entering("propagate");
    let most = PrimitiveClaims::<D>::default().max_draws;
    let found = bounded(PANICS, ENDS, most, draws, |rng| primitive.propagate(m, from, to, rng))?;
    if let Ok(instances) = found {
        Tally::count(&tally.reached);
        Tally::count(ways);
        ensure(NOT_EMPTY, !instances.is_empty(), || "no instances".to_owned(), "at least one")?;
        if let Some([_, found]) = of_object {
            Tally::count(found);
        }
        if let (Some(validity), Some([tried, kept])) = (&world.subjects.validity, tally.walks.get(kind))
            && Tally::get(tried) < MOST_WALKS
        {
            Tally::count(tried);
            let mut here = from.clone();
            let is_free = instances.iter().all(|instance| {
                entering("free_prefix");
                let is_free = validity.free_prefix(m, instance, &here).blame.is_none();
                here = instance.at(m, 1.0, &here);
                is_free
            });
            if is_free {
                Tally::count(kept);
            }
        }
        if let (Some(component), Some(last)) = (single, instances.last()) {
            let end = last.at(m, 1.0, from);
            let [moved, arrived] = &tally.arrived;
            let is_moved = match component {
                ComponentId::Robot => end.robot != from.robot,
                ComponentId::Object(id) => end.object(id) != from.object(id),
            };
            if is_moved {
                Tally::count(moved);
                if to.is_met(m, &end) {
                    Tally::count(arrived);
                }
            }
        }
    }
    Ok(())
}

/// The only component that a target names, if it is not there yet.
fn single<D: Domain>(m: &D, from: &State<D>, to: &PartialState<D>) -> Option<ComponentId> {
    let mut objects = to.objects().map(|(id, _)| id);
    let object = objects.next();
    let component = match (to.robot(), object, objects.next()) {
        (Some(_), None, _) => ComponentId::Robot,
        (None, Some(id), None) => ComponentId::Object(id),
        _ => return None,
    };
    (!to.is_met(m, from)).then_some(component)
}
