//! One call checks everything: the puck domain passes, what is wrong with it is named with the smallest case, kept, and shown
//! again, and a call that hangs is reported like anything else.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::time::Duration;

use darrt_core::laws::everything::{Effort, Verdict};
use darrt_core::laws::{Report, Subjects, check_everything, check_thoroughly, with_patience};
use darrt_core::partial::PartialState;
use darrt_core::prelude::*;
use darrt_core::testing::puck::{
    Carry, Obstacle, Oracle, Outline, Pick, Place, PuckWorld, Push, Setup, Transit, paper_strategy, problems,
};
use darrt_core::verify::Replay;
use rand::Rng;

/// Fewer cases than by default: what is wrong here shows at once.
fn check(subjects: impl FnOnce(Subjects<PuckWorld>) -> Subjects<PuckWorld>) -> Result<Report, Box<Report>> {
    let problem = problems::graspable().unwrap();
    let all = Subjects::of(&problem).strategy(paper_strategy().unwrap()).cases(32);
    check_everything(problem.shared_domain(), subjects(all))
}

#[test]
fn the_puck_domain_keeps_every_law() -> Result<(), Box<Report>> {
    let problem = problems::graspable().unwrap();
    let all = Subjects::of(&problem).strategy(paper_strategy().unwrap());
    // The user's own oracle: pucks and robot do not overlap, with each other or with the pillar.
    let all = all.oracle(|m: &PuckWorld, state| {
        let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let fits = m.robot().contains(&state.robot) && m.objects()[0].contains(&state.objects[0]);
        let pillar = [2.0, 1.5];
        fits && apart(&state.robot, &state.objects[0]) >= m.touch_distance(ObjectId::new(0))
            && apart(&state.robot, &pillar) >= 0.4 + m.robot_radius()
            && apart(&state.objects[0], &pillar) >= 0.4 + 0.12
    });
    let report = check_everything(problem.shared_domain(), all)?;
    assert!(report.rows.len() >= 15 && report.rows.iter().all(|row| row.cases > 0), "{report}");
    // It fits a screen.
    assert!(report.to_string().lines().count() <= 24, "{report}");
    println!("{report}");
    Ok(())
}

/// Goes past its target by a half.
struct Overshoots;

impl Primitive<PuckWorld> for Overshoots {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(21, "Overshoots")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        Transit.useful(m, from, to)
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let aim = to.robot_overlay(m, &from.robot);
        let far = [0, 1].map(|i| aim[i] + 1.5 * (aim[i] - from.robot[i]));
        Transit.propagate(m, from, &PartialState::anywhere(m).with_robot(m, far), rng)
    }
}

fn primitives(first: impl Primitive<PuckWorld> + 'static) -> Vec<Box<dyn Primitive<PuckWorld>>> {
    vec![Box::new(first), Box::new(Push), Box::new(Pick), Box::new(Carry), Box::new(Place)]
}

#[test]
fn a_failing_case_is_made_simple_kept_and_shown_again() {
    let folder = std::env::temp_dir().join(format!("laws-everything-{}", std::process::id()));
    let file = folder.join("cases.txt");
    let found = check(|all| all.primitives(primitives(Overshoots)).regressions(&file)).unwrap_err();
    let row = found.rows.iter().find(|row| row.subject == "Overshoots").unwrap();
    let Verdict::Broken(broken) = &row.verdict else { panic!("{found}") };
    assert_eq!(broken.name(), "primitive.progress", "{found}");
    // Few digits: multiples of a sixteenth.
    let digits = broken.replay.chars().filter(char::is_ascii_digit).count();
    assert!(digits < 120, "{}", broken.replay);
    let case = row.case.unwrap();
    assert!(std::fs::read_to_string(&file).unwrap().contains(&format!("Overshoots\t{case}\n")));
    // That case alone, and no others.
    let again = check(|all| all.primitives(primitives(Overshoots)).only("Overshoots", case)).unwrap_err();
    assert_eq!((again.rows.len(), again.rows[0].cases), (1, 1));
    assert_eq!(again.broken().next().map(|b| b.law), Some(broken.law));
    // Kept cases come first, with another seed as well.
    let later = check(|all| all.primitives(primitives(Overshoots)).regressions(&file).seed(5)).unwrap_err();
    assert_eq!(later.rows.iter().find(|row| row.subject == "Overshoots").unwrap().case, Some(case));
    let _ = std::fs::remove_dir_all(folder);
}

/// Waits for ever for targets of the robot.
struct Hangs;

impl Primitive<PuckWorld> for Hangs {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(22, "Hangs")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        while to.robot().is_some() && to.objects().count() == 0 && !to.is_met(m, from) {
            std::thread::sleep(Duration::from_millis(50));
        }
        false
    }

    fn propagate(
        &self,
        _: &PuckWorld,
        _: &State<PuckWorld>,
        _: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        Err(Infeasible::NoProgress)
    }
}

#[test]
fn a_hang_is_reported_and_names_the_call() {
    let found = with_patience(0.3, || check(|all| all.primitives(primitives(Hangs)))).unwrap_err();
    let broken = found.broken().next().unwrap();
    assert_eq!(broken.name(), "call.returns", "{found}");
    assert!(broken.left.contains("useful has not come back"), "{found}");
    assert!(broken.replay.contains("useful of Hangs, from &State"), "{found}");
}

/// Never of use, or never successful.
struct Idle(bool);

impl Primitive<PuckWorld> for Idle {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(23, "Idle")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        self.0 && !to.is_met(m, from)
    }

    fn propagate(
        &self,
        _: &PuckWorld,
        _: &State<PuckWorld>,
        _: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        Err(Infeasible::NoContact)
    }
}

#[test]
fn what_is_never_useful_is_warned_of_and_what_never_succeeds_is_broken() {
    let report = check(|all| all.primitives(primitives(Idle(false)))).unwrap();
    assert!(report.warnings().any(|(row, text)| row == "Idle" && text.contains("was false in")), "{report}");
    let found = check(|all| all.primitives(primitives(Idle(true)))).unwrap_err();
    assert!(found.broken().any(|broken| broken.name() == "primitive.feasible"), "{found}");
    // It shows behind all cases, and so it is shown again by the whole row, alone.
    assert!(found.to_string().contains(".only(\"Idle\", None)"), "{found}");
    let again = check(|all| all.primitives(primitives(Idle(true))).only("Idle", None)).unwrap_err();
    assert!(again.rows.len() == 1 && again.broken().any(|broken| broken.name() == "primitive.feasible"), "{again}");
}

/// Pucks may move by themselves in some domains: no fault, but worth a word where they never do.
#[test]
fn a_verifier_that_lets_pucks_move_by_themselves_is_warned_of() {
    let setup = Setup::new([3.0, 3.0], 0.15).robot_at([0.6, 0.6]).puck("blue", 0.12, [1.2, 1.2]);
    let setup = setup.pillar("pillar", [2.5, 0.5], 0.2).robot_goal([2.4, 2.4]).puck_goal(0, [1.2, 2.0]);
    let problem = setup.problem().unwrap();
    let warned = |verifier: Option<Replay<Oracle>>| {
        let all = Subjects::of(&problem).strategy(paper_strategy().unwrap()).cases(32);
        let all = all.only("planner and verifier", None);
        let all = if let Some(verifier) = verifier { all.verifier(verifier) } else { all };
        let report = check_everything(problem.shared_domain(), all).unwrap();
        report.warnings().any(|(_, text)| text.contains("moves as in a step of Push, while the robot stood still"))
    };
    assert!(!warned(None), "the judge of the pucks");
    let outline = Outline::Disc { centre: [2.5, 0.5], radius_m: 0.2 };
    let oracle = Oracle::new(vec![Obstacle { name: "pillar".into(), outline }]);
    assert!(warned(Some(Replay::new(oracle, 1e-3))), "one that looks at states alone");
}

#[test]
fn the_same_seed_gives_the_same_report_and_a_budget_more_rounds() {
    let [first, second] = [(); 2].map(|()| check(|all| all.seed(4)).unwrap());
    assert_eq!(first, second);
    let problem = problems::open().unwrap();
    let effort = Effort { cases: 8, calls: 64, iterations: 0, apart_ms: 0, ..Effort::default() };
    let subjects = Subjects::of(&problem).effort(effort);
    let report = check_thoroughly(problem.shared_domain(), subjects, Duration::from_millis(1500)).unwrap();
    assert!(report.rounds >= 2 && report.rows.iter().any(|row| row.cases >= 16), "{report}");
}
