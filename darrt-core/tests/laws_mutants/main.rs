//! Shipped implementors with one answer changed: how many of these mutants the laws kill. What survives is listed in
//! `docs/mutation-check.md` with the reason.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

mod others;
mod primitives;
mod spaces;
mod validities;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{available_parallelism, scope};

use darrt_core::laws::everything::Effort;
use darrt_core::laws::{Subjects, check_everything};
use darrt_core::prelude::*;
use darrt_core::problem::Problem;
use darrt_core::testing::puck::{PuckWorld, Setup, paper_strategy};

/// One mutant: whose, what was changed, and whether anything was noticed.
type Mutant = (&'static str, &'static str, Box<dyn Fn() -> bool + Send + Sync>);

/// Mutants that no law can kill, because they are right as well: for each the reason is in the page.
const EQUAL: [(&str, &str); 5] = [
    ("Push", "nothing may touch"),
    ("Push", "the length is twice as long"),
    ("Push", "another primitive"),
    ("Push", "no approach"),
    ("RealBox", "the distance is the sum of the axes"),
];

fn problem() -> Problem<PuckWorld> {
    let setup = Setup::new([4.0, 3.0], 0.15).robot_at([0.6, 0.6]);
    let setup = setup.graspable_puck("red", 0.12, [1.2, 1.2]).puck("blue", 0.12, [3.0, 2.2]);
    setup.wall("wall", [1.9, 0.0], [2.1, 1.0]).puck_goal(0, [1.2, 2.2]).problem().unwrap()
}

fn subjects(problem: &Problem<PuckWorld>) -> Subjects<PuckWorld> {
    let effort = Effort { cases: 32, calls: 4096, iterations: 40, apart_ms: 0, ..Effort::default() };
    Subjects::of(problem).strategy(paper_strategy().unwrap()).oracle(is_free).effort(effort)
}

/// Everything is on the floor, and a millimetre from everything else.
fn is_free(m: &PuckWorld, state: &State<PuckWorld>) -> bool {
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let to_wall = |p: &[f64; 2]| apart(p, &[p[0].clamp(1.9, 2.1), p[1].clamp(0.0, 1.0)]);
    let (robot, pucks) = (&state.robot, &state.objects);
    let fits = m.robot().contains(robot) && m.objects().iter().zip(pucks).all(|(space, at)| space.contains(at));
    fits && to_wall(robot) >= m.robot_radius() + 1e-3 - 1e-9
        && pucks.iter().all(|at| to_wall(at) >= 0.121 - 1e-9 && apart(at, robot) >= m.robot_radius() + 0.121 - 1e-9)
        && apart(&pucks[0], &pucks[1]) >= 0.241 - 1e-9
}

/// Is any law broken, or anything warned of that is not with the shipped ones?
fn notices(change: impl FnOnce(Subjects<PuckWorld>) -> Subjects<PuckWorld>) -> bool {
    let problem = problem();
    match check_everything(problem.shared_domain(), change(subjects(&problem))) {
        Err(_) => true,
        Ok(report) => report
            .warnings()
            .any(|(_, text)| ["false in", "no way", "refused every"].iter().any(|hint| text.contains(hint))),
    }
}

fn all_pucks() -> ComponentSet {
    (0..2).fold(ComponentSet::ROBOT, |set, i| set.with(ComponentId::Object(ObjectId::new(i))))
}

#[test]
fn without_a_change_nothing_is_noticed() {
    let problem = problem();
    let report = check_everything(problem.shared_domain(), subjects(&problem));
    assert!(report.is_ok() && !notices(|all| all), "{report:?}");
}

#[test]
fn the_laws_kill_nineteen_of_twenty_mutants() {
    let all: Vec<Mutant> =
        [primitives::all(), validities::all(), spaces::all(), others::all()].into_iter().flatten().collect();
    let is_equal = |(whose, what, _): &&Mutant| EQUAL.contains(&(*whose, *what));
    let next = AtomicUsize::new(0);
    let work = || -> Vec<&Mutant> {
        let taken = std::iter::from_fn(|| all.get(next.fetch_add(1, Ordering::Relaxed)));
        taken.filter(|mutant| !(mutant.2)()).collect()
    };
    let survivors: Vec<_> = scope(|scope| {
        let workers: Vec<_> = (0..available_parallelism().map_or(1, usize::from)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    let unknown: Vec<_> =
        survivors.iter().filter(|mutant| !is_equal(mutant)).map(|(who, what, _)| (who, what)).collect();
    let killed = all.len() - survivors.len();
    println!(
        "{killed} of {} killed; survivors: {:?}",
        all.len(),
        survivors.iter().map(|m| (m.0, m.1)).collect::<Vec<_>>()
    );
    assert!(all.len() >= 90, "{}", all.len());
    assert!(unknown.is_empty(), "survivors without a reason: {unknown:?}");
    assert!(20 * killed >= 19 * all.len(), "{killed} of {}", all.len());
}
