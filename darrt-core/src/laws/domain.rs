//! Laws of [`Domain`], and those of its component spaces by name.

use crate::domain::Domain;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

use super::space::{SpaceClaims, check_component_space};
use super::{Broken, at_most, equal, measure};

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
/// Hop is a measure.
pub const HOP: &str = "domain.hop: hop is finite and not negative";
/// What goes on from where it was made for.
pub const MAY_GO_ON: &str = "domain.may-go-on: a motion may begin in the mode that it was made for";
/// Names tell the components apart.
pub const NAMES: &str = "domain.names: every component has a name of its own";

/// The laws of this file.
pub const LAWS: &[&str] = &[COUNT, REACH, REACH_FROM, POINT, REACH_AT_LEAST, HOP, MAY_GO_ON, NAMES];

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
    let check = || {
        for state in states {
            equal(COUNT, &state.objects.len(), &m.objects().len())?;
            equal(MAY_GO_ON, &m.may_go_on(&state.mode, &state.mode), &true)?;
        }
        let robot = check_component_space(m.robot(), claims, [&a.robot, &b.robot, &c.robot], ts, seed);
        robot.map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))?;
        for (i, space) in m.objects().iter().enumerate() {
            let id = ObjectId::new(i);
            let (Some(p), Some(q), Some(r)) = (a.object(id), b.object(id), c.object(id)) else { continue };
            check_component_space(space, claims, [p, q, r], ts, seed)
                .map_err(|broken| broken.of(m.component_name(ComponentId::Object(id))))?;
        }
        names(m)?;
        travel(m, a, b)
    };
    check().map_err(|broken| {
        broken.replayed_by(|| format!("check_domain({claims:?}, [&{a:?}, &{b:?}, &{c:?}], {ts:?}, {seed})"))
    })
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
            measure(HOP, m.hop((id, p), (ObjectId::new(j), q))).map_err(of)?;
        }
    }
    Ok(())
}
