//! One run of `check_everything` on the puck domain. Leaves with 0 if nothing is noticed, with 1 and a line if something is.

use darrt_core::laws::everything::Effort;
use darrt_core::laws::{Subjects, check_everything};
use darrt_core::prelude::*;
use darrt_core::problem::Problem;
use darrt_core::testing::puck::{PuckWorld, Setup, paper_strategy};

/// The wall is away from the edges, and so thick that the robot would fit in the middle of it, were it hollow.
fn problem() -> Problem<PuckWorld> {
    let setup = Setup::new([4.0, 3.0], 0.15).robot_at([0.6, 0.6]).robot_goal([3.4, 2.2]);
    let setup = setup.graspable_puck("red", 0.12, [1.2, 1.2]).puck("blue", 0.12, [3.0, 2.2]);
    let setup = setup.wall("wall", [1.7, 0.3], [2.3, 1.3]).pillar("pillar", [1.0, 2.5], 0.2);
    setup.puck_goal(0, [1.2, 2.0]).problem().expect("a problem without a mutant in it")
}

/// Everything is on the floor, and a millimetre from everything else: a user's own oracle.
fn is_free(_: &PuckWorld, state: &State<PuckWorld>) -> bool {
    let (robot, puck, room) = (0.15, 0.12, 1e-3 - 1e-9);
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let to_wall = |p: &[f64; 2]| apart(p, &[p[0].clamp(1.7, 2.3), p[1].clamp(0.3, 1.3)]);
    let fits = |p: &[f64; 2], radius: f64| {
        (radius..=4.0 - radius).contains(&p[0])
            && (radius..=3.0 - radius).contains(&p[1])
            && to_wall(p) >= radius + room
            && apart(p, &[1.0, 2.5]) >= 0.2 + radius + room
    };
    let pucks = &state.objects;
    fits(&state.robot, robot)
        && pucks.iter().all(|at| fits(at, puck) && apart(at, &state.robot) >= robot + puck + room)
        && apart(&pucks[0], &pucks[1]) >= 2.0 * puck + room
}

/// What is noticed first, if anything: a broken law, or a warning that the shipped ones do not have.
fn noticed(effort: Effort) -> Option<String> {
    let problem = problem();
    let all = Subjects::of(&problem).strategy(paper_strategy().ok()?).oracle(is_free).effort(effort);
    match check_everything(problem.shared_domain(), all) {
        Err(report) => Some(report.broken().next().map_or_else(String::new, |broken| broken.name().to_owned())),
        Ok(report) => {
            let hints = ["false in", "no way", "refused every", "none of them ended there", "blocked in", "stood still"];
            let warning = report.warnings().find(|(_, text)| hints.iter().any(|hint| text.contains(hint)));
            warning.map(|(subject, text)| format!("warning of {subject}: {text}"))
        }
    }
}

fn main() {
    let small = Effort { cases: 32, calls: 4096, iterations: 40, apart_ms: 0, ..Effort::default() };
    let first = noticed(small).or_else(|| noticed(Effort { apart_ms: 0, ..Effort::default() }));
    if std::env::var_os("MUTANT_REACHED").is_some() {
        println!("{:?}", darrt_core::mutants::reached());
    }
    if let Some(what) = first {
        println!("{what}");
        std::process::exit(1);
    }
}
