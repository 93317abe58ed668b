//! Are reach and the travel between objects metres between places, and not something else?

use rand::Rng;

use super::{REACH_DEAF, REACH_METRES, SLACK, TRAVEL_BETWEEN_DEAF, TRAVEL_BETWEEN_METRES};
use crate::domain::Domain;
use crate::laws::feed::elsewhere;
use crate::laws::watch::entering;
use crate::laws::{Broken, at_most, ensure};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

/// How many states are looked at. That a distance between places is the same in all of them by chance has never been seen.
const STATES: usize = 24;
/// How many metres a metre of an object's travel changes at most.
const MOST_SLOPE: f64 = 3.0;
/// Objects that travel less than this between all samples may be as near everywhere, metres.
const STAYS_M: f64 = 0.1;

pub(super) fn check<D: Domain>(m: &D, like: &State<D>, rng: &mut dyn Rng) -> Result<(), Broken> {
    let states: Vec<State<D>> = (0..STATES).map(|_| elsewhere(m, like, rng)).collect();
    for (i, space) in m.objects().iter().enumerate() {
        let id = ObjectId::new(i);
        let of = |broken: Broken| broken.of(m.component_name(ComponentId::Object(id)));
        let pairs = || states.iter().zip(states.iter().cycle().skip(1));
        let (mut hears_robot, mut hears_object, mut hears_places, mut moves) = (false, false, false, false);
        for (here, there) in pairs() {
            let (Some(p), Some(q)) = (here.object(id), there.object(id)) else { continue };
            let metres = space.distance(p, q);
            moves |= metres > STAYS_M;
            let bound = MOST_SLOPE * metres + SLACK;
            entering("reach");
            let [near, moved] = [p, q].map(|at| m.reach(&here.robot, id, at));
            at_most(REACH_METRES, (near - moved).abs(), bound, 0.0).map_err(of)?;
            hears_object |= near != moved;
            hears_robot |= near != m.reach(&there.robot, id, p);
            entering("travel_between");
            let start = like.object(id).unwrap_or(p);
            let [first, second] = [p, q].map(|at| m.travel_between((id, start), (id, at)));
            at_most(TRAVEL_BETWEEN_METRES, (first - second).abs(), bound, 0.0).map_err(of)?;
            at_most(TRAVEL_BETWEEN_METRES, m.travel_between((id, p), (id, p)), 0.0, SLACK)
                .map_err(|broken| of(broken.of("to itself")))?;
            hears_places |= first != second;
        }
        if !moves || m.robot().dimension() == 0 {
            continue;
        }
        let text = |what: &str| format!("the same in {STATES} of {STATES} states, {what}");
        let deaf = "another one";
        ensure(REACH_DEAF, hears_object, || text("wherever the object is"), deaf).map_err(of)?;
        ensure(REACH_DEAF, hears_robot, || text("wherever the robot is"), deaf).map_err(of)?;
        ensure(TRAVEL_BETWEEN_DEAF, hears_places, || text("wherever the object is"), deaf).map_err(of)?;
    }
    Ok(())
}
