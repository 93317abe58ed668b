//! Laws of [`Domain`], and those of its component spaces by name.

use crate::domain::Domain;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

use super::feed::{cornered, rng_of};

use super::space::{SpaceClaims, check_component_space};
use super::watch::{entering, watched};
use super::{Broken, alike, at_most, ensure, equal, measure};

mod metres;

/// As many objects in every state as in the domain.
pub const COUNT: &str = "domain.count: a state has one configuration per object of the domain";
/// Reach is a measure.
pub const REACH: &str = "domain.reach: reach is finite and not negative";
/// Reach from a known working point.
pub const REACH_FROM: &str = "domain.reach-from: reach_from at the robot's working point is reach, bit for bit";
/// The point of an object moves no farther than the object.
pub const POINT: &str = "domain.point: two points of an object lie no farther apart than its two configurations";
/// A lower bound on reach.
pub const REACH_AT_LEAST: &str =
    "domain.reach-at-least: reach_at_least of the gap between working point and object is at most reach, and grows";
/// Travel between objects is a measure.
pub const TRAVEL_BETWEEN: &str = "domain.travel-between: the travel between two objects is finite and not negative";
/// What goes on from where it was made for.
pub const MAY_GO_ON: &str = "domain.may-go-on: a motion may begin in the mode that it was made for, and in no other in which other objects are carried";
/// What is carried.
pub const CARRIED: &str = "domain.carried: what is carried are objects of the domain; whoever moves the robot moves them as well, and only whoever names one takes it up or lets it go";
/// The domain without the robot.
pub const WITHOUT_ROBOT: &str =
    "domain.without-robot: for a robot that passes through everything, spaces, names and distances are the same";
/// Names tell the components apart.
pub const NAMES: &str = "domain.names: every component has a name of its own";

/// Pure.
pub const PURE: &str = "domain.pure: the same question has the same answer, bit for bit, whenever it is asked";
/// Travel between objects there and back.
pub const TRAVEL_BETWEEN_SYMMETRIC: &str =
    "domain.travel-between-symmetric: the travel from one object to another is as long as the travel back";
/// Travel between objects over a third.
pub const TRAVEL_BETWEEN_TRIANGLE: &str = "domain.travel-between-triangle: the travel to an object is at most as long as that over a third object, and the way around that";

/// Unit of reach.
pub const REACH_METRES: &str =
    "domain.reach-metres: reach is in metres: an object that travels one changes it by at most three";
/// Reach is no constant.
pub const REACH_DEAF: &str = "domain.reach-deaf: reach depends on where the robot is, and on where the object is";
/// Unit of the travel between objects.
pub const TRAVEL_BETWEEN_METRES: &str = "domain.travel-between-metres: there is no travel from an object to itself, and an object that travels a metre changes it by at most three";
/// Travel between objects is no constant.
pub const TRAVEL_BETWEEN_DEAF: &str =
    "domain.travel-between-deaf: the travel between two objects depends on where they are";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    COUNT,
    REACH,
    REACH_FROM,
    POINT,
    REACH_AT_LEAST,
    TRAVEL_BETWEEN,
    MAY_GO_ON,
    CARRIED,
    WITHOUT_ROBOT,
    NAMES,
    PURE,
    TRAVEL_BETWEEN_SYMMETRIC,
    TRAVEL_BETWEEN_TRIANGLE,
    REACH_METRES,
    REACH_DEAF,
    TRAVEL_BETWEEN_METRES,
    TRAVEL_BETWEEN_DEAF,
];

/// The laws of a domain and of all its component spaces, for three states, two parameters in `[0, 1]` and
/// a seed.
///
/// # Errors
/// The first law that is [`Broken`], with the name of the component.
pub fn check_domain<D: Domain>(
    m: &D,
    claims: &SpaceClaims,
    states: [&State<D>; 3],
    ts: [f64; 2],
    seed: u64,
) -> Result<(), Broken> {
    let [a, b, c] = states;
    let about = || format!("check_domain({claims:?}, [&{a:?}, &{b:?}, &{c:?}], {ts:?}, {seed})");
    let check = || {
        for state in states {
            equal(COUNT, &state.objects.len(), &m.objects().len())?;
            modes(m, &state.mode, &state.mode)?;
        }
        modes(m, &a.mode, &b.mode)?;
        let before = answers(m, a, b);
        let robot = check_component_space(m.robot(), claims, [&a.robot, &b.robot, &c.robot], ts, seed);
        robot.map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))?;
        for (i, space) in m.objects().iter().enumerate() {
            let id = ObjectId::new(i);
            let (Some(p), Some(q), Some(r)) = (a.object(id), b.object(id), c.object(id)) else { continue };
            check_component_space(space, claims, [p, q, r], ts, seed)
                .map_err(|broken| broken.of(m.component_name(ComponentId::Object(id))))?;
        }
        names(m)?;
        travel(m, a, b)?;
        travels_between(m, [a, b, c])?;
        let mut rng = rng_of(&(a, b, seed));
        let [x, y] = [a, b].map(|state| cornered(m, state, &mut rng));
        let corner = travel(m, &x, &y).and_then(|()| travels_between(m, [&x, &y, c]));
        corner.map_err(|broken| broken.of("in a corner"))?;
        metres::check(m, a, &mut rng)?;
        for ((call, was), (_, is)) in before.iter().zip(answers(m, a, b)) {
            alike(PURE, &is, was).map_err(|broken| broken.of(call))?;
            ensure(PURE, !is.contains(AGAIN), || is.clone(), "the same").map_err(|broken| broken.of(call))?;
        }
        without_robot(m, a, &before)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// What stands between two answers to one question.
const AGAIN: &str = ", asked again ";

/// Answers to questions about two states, to be asked again later.
pub(super) fn answers<D: Domain>(m: &D, a: &State<D>, b: &State<D>) -> Vec<(&'static str, String)> {
    let mut all = Vec::new();
    let mut say = |call: &'static str, answer: &dyn Fn() -> String| {
        entering(call);
        // Twice: what changes with every question may be back where it was when all has been asked.
        let (first, second) = (answer(), answer());
        let said = if first == second { first } else { format!("{first}{AGAIN}{second}") };
        all.push((call, said));
    };
    say("objects", &|| format!("{:?}", m.objects().len()));
    say("working_point", &|| format!("{:?}", m.working_point(&a.robot)));
    say("component_name", &|| m.component_name(ComponentId::Robot).into_owned());
    for (mode, next) in [(&a.mode, &b.mode), (&b.mode, &a.mode)] {
        say("may_go_on", &|| format!("{:?}", m.may_go_on(mode, next)));
        say("carried", &|| format!("{:?}", m.carried(mode)));
    }
    for (i, (p, q)) in a.objects.iter().zip(&b.objects).enumerate() {
        let id = ObjectId::new(i);
        say("component_name", &|| m.component_name(ComponentId::Object(id)).into_owned());
        say("reach", &|| format!("{:?}", m.reach(&a.robot, id, q)));
        say("object_point", &|| format!("{:?}", m.object_point(id, p)));
        say("reach_at_least", &|| format!("{:?}", m.reach_at_least(id, 1.5)));
        let next = ObjectId::new((i + 1) % a.objects.len());
        if let Some(there) = b.object(next) {
            say("travel_between", &|| format!("{:?}", m.travel_between((id, p), (next, there))));
        }
    }
    all
}

/// What two modes say of each other.
pub(super) fn modes<D: Domain>(m: &D, mode: &D::Mode, next: &D::Mode) -> Result<(), Broken> {
    entering("carried");
    let (here, there) = (m.carried(mode), m.carried(next));
    let objects =
        (0..m.objects().len()).fold(ComponentSet::EMPTY, |set, i| set.with(ComponentId::Object(ObjectId::new(i))));
    for (mode, carried) in [(mode, here), (next, there)] {
        let text = || format!("{carried:?} in mode {mode:?}");
        ensure(CARRIED, carried.is_subset_of(objects), text, "objects of the domain, and not the robot")?;
    }
    entering("may_go_on");
    let may = m.may_go_on(mode, next);
    ensure(MAY_GO_ON, may || mode != next, || format!("not in mode {mode:?}"), "in the mode that it was made for")?;
    let text = || format!("in mode {mode:?} with {here:?}, what was made for {next:?} with {there:?}");
    ensure(MAY_GO_ON, !may || here == there, text, "the same carried in both")
}

/// The domain without its robot gives the same answers, and draws the same configurations.
fn without_robot<D: Domain>(m: &D, a: &State<D>, said: &[(&'static str, String)]) -> Result<(), Broken> {
    entering("without_robot");
    let Some(bare) = m.without_robot() else { return Ok(()) };
    equal(WITHOUT_ROBOT, &bare.objects().len(), &m.objects().len()).map_err(|broken| broken.of("objects"))?;
    for ((call, is), (_, was)) in answers(&bare, a, a).iter().zip(answers(m, a, a)) {
        alike(WITHOUT_ROBOT, is, &was).map_err(|broken| broken.of(call))?;
    }
    let rng = || rng_of(&said);
    let draw = |m: &D| (m.robot().sample(&mut rng()), m.robot().dimension(), m.robot().groups());
    alike(WITHOUT_ROBOT, &draw(&bare), &draw(m)).map_err(|broken| broken.of("samples of the robot"))?;
    for (there, here) in bare.objects().iter().zip(m.objects()) {
        let draw = |space: &D::Object| (space.sample(&mut rng()), space.dimension(), space.groups());
        alike(WITHOUT_ROBOT, &draw(there), &draw(here)).map_err(|broken| broken.of("samples of an object"))?;
    }
    Ok(())
}

/// Travel between objects between three places, each of another object if there are as many.
fn travels_between<D: Domain>(m: &D, [a, b, c]: [&State<D>; 3]) -> Result<(), Broken> {
    let count = a.objects.len();
    for i in 0..count {
        let ids = [i, (i + 1) % count, (i + 2) % count].map(ObjectId::new);
        let [Some(p), Some(q), Some(r)] = [(a, ids[0]), (b, ids[1]), (c, ids[2])].map(|(s, id)| s.object(id)) else {
            continue;
        };
        let of = |broken: Broken| broken.of(m.component_name(ComponentId::Object(ids[1])));
        let (there, back) = (m.travel_between((ids[0], p), (ids[1], q)), m.travel_between((ids[1], q), (ids[0], p)));
        at_most(TRAVEL_BETWEEN_SYMMETRIC, (there - back).abs(), 0.0, SLACK * (1.0 + there)).map_err(|broken| {
            of(Broken { left: format!("{there:?}").into(), right: format!("{back:?}").into(), ..broken })
        })?;
        // What acts on an object does so from somewhere around it; how far that is from its middle the domain says by its
        // points, if it has any.
        let points = [a, b, c].map(|s| m.working_point(&s.robot));
        let is_told = points.iter().any(|point| *point != [0.0; 3]) || m.object_point(ids[1], q) != [0.0; 3];
        if !is_told {
            continue;
        }
        let around = [a, b, c].map(|s| {
            let gap = apart(m.working_point(&s.robot), m.object_point(ids[1], q));
            2.0 * (gap - m.reach(&s.robot, ids[1], q))
        });
        // Where the robot is inside the object nothing is told.
        let is_inside = [a, b, c].iter().all(|s| m.reach(&s.robot, ids[1], q) <= 0.0);
        if is_inside {
            continue;
        }
        let around = around.into_iter().fold(0.0, f64::max);
        let onwards = m.travel_between((ids[1], q), (ids[2], r));
        let over = there + onwards + around;
        at_most(TRAVEL_BETWEEN_TRIANGLE, m.travel_between((ids[0], p), (ids[2], r)), over, SLACK * (1.0 + over))
            .map_err(of)?;
    }
    Ok(())
}

fn names<D: Domain>(m: &D) -> Result<(), Broken> {
    let objects = (0..m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    let mut seen: Vec<String> = Vec::new();
    for component in std::iter::once(ComponentId::Robot).chain(objects) {
        let name = m.component_name(component).into_owned();
        if name.is_empty() || seen.contains(&name) {
            return Err(Broken::new(NAMES, format!("{name:?}"), format!("none of {seen:?}")));
        }
        seen.push(name);
    }
    Ok(())
}

/// Rounding that is forgiven, metres per metre.
const SLACK: f64 = 1e-9;

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

fn travel<D: Domain>(m: &D, a: &State<D>, b: &State<D>) -> Result<(), Broken> {
    for (i, p) in a.objects.iter().enumerate() {
        let id = ObjectId::new(i);
        let of = |broken: Broken| broken.of(m.component_name(ComponentId::Object(id)));
        for robot in [&a.robot, &b.robot] {
            let metres = m.reach(robot, id, p);
            measure(REACH, metres).map_err(of)?;
            equal(REACH_FROM, &m.reach_from(m.working_point(robot), robot, id, p), &metres).map_err(of)?;
            let gap_m = apart(m.working_point(robot), m.object_point(id, p));
            let at_least = m.reach_at_least(id, gap_m);
            at_most(REACH_AT_LEAST, at_least, metres, SLACK * (1.0 + metres)).map_err(of)?;
            at_most(REACH_AT_LEAST, at_least, m.reach_at_least(id, 1.5 * gap_m), 0.0).map_err(of)?;
        }
        if let (Some(space), Some(q)) = (m.objects().get(i), b.object(id)) {
            let metres = space.distance(p, q);
            let points = apart(m.object_point(id, p), m.object_point(id, q));
            at_most(POINT, points, metres, SLACK * (1.0 + metres)).map_err(of)?;
        }
        for (j, q) in b.objects.iter().enumerate() {
            measure(TRAVEL_BETWEEN, m.travel_between((id, p), (ObjectId::new(j), q))).map_err(of)?;
        }
    }
    Ok(())
}
