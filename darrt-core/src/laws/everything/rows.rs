//! The rows of the table: each subject in turn, on a thread of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rand::RngExt;

use super::report::{Report, Row, Verdict};
use super::world::{SIMPLEST, World};
use crate::domain::Domain;
use crate::laws::watch::{entering, or_abandon, watched};
use crate::laws::{self, Broken};
use crate::random::{Purpose, Stream, stream};
use crate::state::{ComponentId, ObjectId};

mod parts;
mod primitives;
mod ways;
mod whole;

/// What a case looked at; laws that hold because nothing happened are no proof, so these are counted.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) tried: AtomicU64,
    pub(super) hit: AtomicU64,
    pub(super) reached: AtomicU64,
    pub(super) free: AtomicU64,
    /// Propagations with instances of primitives that nobody knows.
    pub(super) unknown: AtomicU64,
    /// Useful, and found a way, by what is still to be done.
    pub(super) kinds: [[AtomicU64; 2]; KINDS],
    /// The same for a single object that is to be moved, by its index.
    pub(super) objects: [[AtomicU64; 2]; OBJECTS],
    /// Ways of which it was seen how far they are free, and those that are free to their ends, by what is still to be done.
    pub(super) walks: [[AtomicU64; 2]; KINDS],
    /// Ways on which the one component that the target names has moved, and those that ended there.
    pub(super) arrived: [AtomicU64; 2],
}

/// What may still be to be done: something for the robot, for an object; and whether the mode is still that of the start.
pub(super) const KINDS: usize = 8;

/// Of so many objects it is counted which of them find a way.
pub(super) const OBJECTS: usize = 32;

impl Tally {
    pub(super) fn count(which: &AtomicU64) {
        which.fetch_add(1, Relaxed);
    }

    pub(super) fn get(which: &AtomicU64) -> u64 {
        which.load(Relaxed)
    }
}

/// A case: its number is all that it depends on, and the level to which it is made simpler.
type Case<D> = Box<dyn Fn(&World<D>, u64, u8) -> Result<(), Broken> + Send>;

/// What is looked at once.
type Once<D> = Box<dyn FnOnce(&World<D>, &mut Row) -> Result<(), Broken> + Send>;

/// One row to be.
pub(super) struct Plan<D: Domain> {
    pub(super) subject: String,
    /// Laws that are looked at.
    pub(super) laws: usize,
    pub(super) cases: u64,
    pub(super) case: Case<D>,
    /// What is looked at once, after the cases, and may warn.
    pub(super) finally: Once<D>,
}

impl<D: Domain> Plan<D> {
    pub(super) fn new(
        subject: impl Into<String>,
        laws: usize,
        cases: u64,
        case: impl Fn(&World<D>, u64, u8) -> Result<(), Broken> + Send + 'static,
    ) -> Self {
        Self { subject: subject.into(), laws, cases, case: Box::new(case), finally: Box::new(|_, _| Ok(())) }
    }

    pub(super) fn finally(self, once: impl FnOnce(&World<D>, &mut Row) -> Result<(), Broken> + Send + 'static) -> Self {
        Self { finally: Box::new(once), ..self }
    }
}

/// The generator of a case.
pub(super) fn rng_of_case(case: u64) -> Stream {
    stream(case, 21, 0, Purpose::Attempt)
}

pub(super) fn all<D: Domain>(world: &Arc<World<D>>, report: &mut Report) {
    let early = Answers::of(world);
    let mut plans = parts::plans(world);
    plans.extend(primitives::plans(world));
    plans.extend(whole::plans(world));
    plans.extend(ways::plans(world));
    for plan in plans {
        let only = world.subjects.effort.only.as_ref();
        if only.is_none_or(|(subject, _)| *subject == plan.subject) {
            report.push(run(world, plan));
        }
    }
    if world.subjects.effort.only.as_ref().is_none_or(|(subject, _)| subject == Answers::ROW) {
        report.push(Answers::again(world, early));
    }
}

/// Runs the cases of one row; of one that fails the simplest form.
fn run<D: Domain>(world: &Arc<World<D>>, plan: Plan<D>) -> Row {
    let effort = &world.subjects.effort;
    let file = effort.regressions.clone();
    let mut row = Row::new(plan.subject.clone(), plan.laws);
    let mut numbers = super::saved::read(file.as_deref(), &plan.subject);
    let base: u64 = stream(world.seed, 22, 0, Purpose::Attempt).random();
    numbers.extend((0..plan.cases).map(|i| base.wrapping_add(i)));
    if let Some((_, Some(case))) = &effort.only {
        numbers = vec![*case];
    }
    row.cases = numbers.len() as u64;
    let (shared, now) = (Arc::clone(world), Arc::new(AtomicU64::new(0)));
    let current = Arc::clone(&now);
    // A single case, not the whole row.
    let is_replay = matches!(effort.only, Some((_, Some(_))));
    let subject = plan.subject.clone();
    let after = Arc::new(AtomicBool::new(false));
    let is_after = Arc::clone(&after);
    let done = or_abandon(move || {
        for number in numbers {
            current.store(number, Relaxed);
            let about = || format!("check_everything(.., .only({subject:?}, {number}))");
            watched(&about, || one(&shared, &plan.case, number)).map_err(|broken| broken.replayed_by(about))?;
        }
        let mut row = Row::new("", 0);
        if !is_replay {
            is_after.store(true, Relaxed);
            let about = || format!("check_everything(.., .only({subject:?}, None))");
            let finally = plan.finally;
            watched(&about, || finally(&shared, &mut row)).map_err(|broken| broken.replayed_by(about))?;
        }
        Ok(row)
    });
    match done {
        Ok(found) => {
            row.warnings = found.warnings;
            // Some count other things than cases.
            row.cases = row.cases.max(found.cases);
        }
        Err(broken) => {
            // What shows only behind all cases is shown again by all of them.
            row.case = (!after.load(Relaxed)).then(|| now.load(Relaxed));
            if let Some(Err(why)) = row.case.map(|case| super::saved::add(file.as_deref(), &row.subject, case)) {
                row.warn(why);
            }
            row.verdict = Verdict::Broken(Box::new(broken));
        }
    }
    row
}

/// The case as it is; if it fails, the simplest in which the same law is broken.
fn one<D: Domain>(world: &World<D>, case: &Case<D>, number: u64) -> Result<(), Broken> {
    let Err(found) = case(world, number, 0) else { return Ok(()) };
    let simplest =
        (1..=SIMPLEST).rev().find_map(|level| case(world, number, level).err().filter(|b| b.law == found.law));
    Err(simplest.unwrap_or(found))
}

/// Answers from before all other questions, to be asked again after them, at least a second later.
struct Answers {
    began: std::time::Instant,
    said: Result<Vec<String>, Broken>,
}

impl Answers {
    const ROW: &str = "early and late";

    fn of<D: Domain>(world: &Arc<World<D>>) -> Self {
        Self { began: std::time::Instant::now(), said: Self::ask(world) }
    }

    fn ask<D: Domain>(world: &Arc<World<D>>) -> Result<Vec<String>, Broken> {
        let world = Arc::clone(world);
        or_abandon(move || {
            let about = || "check_everything(..), the same questions early and late".to_owned();
            watched(&about, || {
                let (m, start) = (&*world.m, &world.subjects.start);
                let mut rng = stream(world.seed, 23, 0, Purpose::Attempt);
                let other = world.any_state(&mut rng, 0);
                let mut all = laws::space::answers_of(m.robot(), [&start.robot, &other.robot])?;
                for (i, space) in m.objects().iter().enumerate() {
                    let id = ObjectId::new(i);
                    if let (Some(p), Some(q)) = (start.object(id), other.object(id)) {
                        all.extend(laws::space::answers_of(space, [p, q])?);
                    }
                    all.push(m.component_name(ComponentId::Object(id)).into_owned());
                }
                all.extend(
                    laws::domain::answers(m, start, &other).into_iter().map(|(call, say)| format!("{call}: {say}")),
                );
                let to = crate::partial::PartialState::of_state(m, &other);
                for primitive in world.subjects.primitives.iter() {
                    entering("useful");
                    let useful = primitive.useful(m, start, &to);
                    all.push(format!(
                        "{}: useful {useful}, approach {:?}",
                        primitive.name(),
                        primitive.approach(m, start, &to)
                    ));
                }
                if let Some(validity) = &world.subjects.validity {
                    entering("check");
                    all.push(format!("check: {:?}", validity.check(m, &other, &D::Contacts::default())));
                }
                if let Some(goal) = &world.subjects.goal {
                    entering("is_satisfied");
                    all.push(format!("is_satisfied: {}", goal.is_satisfied(m, &other)));
                }
                Ok(all)
            })
        })
    }

    fn again<D: Domain>(world: &Arc<World<D>>, early: Self) -> Row {
        // By default a clock of seconds has then gone on.
        let apart = std::time::Duration::from_millis(world.subjects.effort.apart_ms);
        let left = apart.saturating_sub(early.began.elapsed());
        std::thread::sleep(left);
        let mut row = Row { cases: 1, ..Row::new(Self::ROW, 2) };
        let found = early.said.and_then(|was| {
            let is = Self::ask(world)?;
            let law = laws::domain::PURE;
            match was.iter().zip(&is).find(|(was, is)| was != is) {
                Some((was, is)) => Err(Broken::new(law, is.as_str(), was.as_str()).of("asked again later")),
                None => Ok(()),
            }
        });
        if let Err(broken) = found {
            row.verdict = Verdict::Broken(Box::new(broken));
        }
        row
    }
}
