//! Where the robot stands to bring its hand to a pose: base and arm.

use std::cell::OnceCell;

use darrt_core::domain::Domain;
use darrt_core::primitive::Infeasible;
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use darrt_core::validity::Blame;
use nalgebra::Isometry3;
use rand::{Rng, RngExt};
use smallvec::SmallVec;

use crate::collision_scene::Hand;
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::{Contacts, Mode};
use crate::tabletop::{Tabletop, TabletopState};

/// How many arm configurations are drawn for one base.
const ARM_TRIES: usize = 4;

/// Of so many bases drawn the nearest is tried first. With all of them at once the robot would hardly ever go round a table.
const NEAREST_OF: usize = 4;

/// On so many more bases a stance with more of the wanted margins is looked for when one that keeps the rules is found.
const MORE_TRIES: usize = 8;

/// With how much [care](darrt_core::validity::Validity::most_care) a stance is looked at: what is asked of it goes down as
/// states are found that keep no more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Care {
    /// What all states so far keep.
    kept: usize,
    /// With less the stance is refused.
    least: usize,
}

/// What is asked of a stance.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Where the hand shall be.
    pub world_from_tool: &'a Isometry3<f64>,
    /// How many bases are tried.
    pub tries: usize,
    /// Where the base shall stand; `None`: wherever it may.
    pub base: Option<[f64; 3]>,
}

/// Why a stance will not do.
#[derive(Debug)]
pub enum Refused<M: Manipulator> {
    /// The arm does not reach far enough from there.
    Unreachable,
    /// Something is in the way.
    Blocked(Box<Blocked<M>>),
}

/// A state in which something is in the way. What it is, is found out when somebody asks: of all the stances that are refused
/// only the last one is asked about.
#[derive(Debug)]
pub struct Blocked<M: Manipulator> {
    state: TabletopState<M>,
    contacts: Contacts,
}

impl<M: Manipulator> Refused<M> {
    /// The same for the planner, which counts it.
    pub fn why(&self, m: &Tabletop<M>) -> Infeasible {
        match self {
            Self::Unreachable => Infeasible::Unreachable,
            Self::Blocked(blocked) => blocked.why(m),
        }
    }
}

impl<M: Manipulator> Blocked<M> {
    /// What is in the way.
    fn why(&self, m: &Tabletop<M>) -> Infeasible {
        let found = m.collision_scene().check(m.manipulator(), &self.state, &self.contacts);
        found.err().map_or(Infeasible::Unreachable, Infeasible::Blocked)
    }
}

/// Tries bases for the wanted hand pose: sometimes the present one first, then random ones, the nearer ones of each few first,
/// each with a few arm configurations. `accept` makes something of a stance, or refuses it and the next is tried. The first
/// stance with all the margins that are wanted is taken, or of those found on a few more bases the one with the most. The hand is
/// the one at work in `from`.
///
/// # Errors
/// [`Infeasible::Blocked`] with what was in the way of the last stance that the arm reached, [`Infeasible::Unreachable`]
/// if it reached none.
pub fn stance<M: Manipulator, T>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    wanted: &Wanted<'_>,
    rng: &mut dyn Rng,
    mut accept: impl FnMut(&Configuration<M::Joints>, &mut Care) -> Result<T, Refused<M>>,
) -> Result<T, Infeasible> {
    let robot = m.manipulator();
    let hand = from.robot.arm.hand_at_work();
    let Wanted { world_from_tool, tries, base: only } = *wanted;
    let [empty, loaded] = m.settings().drives;
    let drives = if from.mode.held().is_some() { loaded } else { empty };
    let here = from.robot.base;
    let space = m.robot().base();
    let mut left = tries;
    // The last one is tried first.
    let mut bases: SmallVec<[[f64; 3]; NEAREST_OF]> = SmallVec::new();
    if let Some(base) = only.filter(|base| drives || *base == here) {
        bases.resize(tries, base);
        left = 0;
    } else if !drives || rng.random_bool(0.5) {
        let stays = if drives { tries.min(1) } else { tries };
        bases.resize(stays, here);
        left -= stays;
    }
    let most = m.collision_scene().most_care();
    let (mut best, mut least) = (None, 0);
    let mut tries_left = usize::MAX;
    let mut blocked = None;
    // How often the arm had no answer at the same base again.
    let (mut lost, mut last) = (0, [f64::NAN; 3]);
    loop {
        if bases.is_empty() {
            let few = left.min(NEAREST_OF);
            bases.extend((0..few).map(|_| robot.base_for_hand(hand, world_from_tool, rng)));
            bases.sort_by(|a, b| space.distance(&here, b).total_cmp(&space.distance(&here, a)));
            left -= few;
        }
        let Some(base) = bases.pop().filter(|_| tries_left > 0 && lost < ARM_TRIES) else { break };
        tries_left -= 1;
        let parked = Configuration { base, arm: from.robot.arm };
        if !m.robot().base().contains(&base)
            || !robot.may_reach_with(hand, &base, world_from_tool)
            || !m.collision_scene().is_base_clear(robot, &parked)
        {
            continue;
        }
        for _ in 0..ARM_TRIES {
            let Some(arm) = robot.inverse_from(&from.robot.arm, &base, world_from_tool, rng) else {
                // Where all bases are one, the same is asked again; a numeric inverse takes longest where there is nothing.
                lost += usize::from(base == last);
                last = base;
                break;
            };
            let mut care = Care { kept: most, least };
            match accept(&Configuration { base, arm }, &mut care) {
                Ok(found) if care.kept >= most => return Ok(found),
                Ok(found) => {
                    tries_left = tries_left.min(MORE_TRIES);
                    // From here on only a better one will do.
                    (best, least) = (Some(found), care.kept + 1);
                }
                Err(Refused::Blocked(found)) => blocked = Some(found),
                Err(Refused::Unreachable) => {}
            }
        }
    }
    best.ok_or_else(|| blocked.map_or(Infeasible::Unreachable, |found| found.why(m)))
}

/// The robot at `base` with its arm at the end of a line that may have none.
///
/// # Errors
/// [`Refused::Unreachable`] if there is no such arm configuration.
pub fn at_end<M: Manipulator>(base: [f64; 3], arms: &[M::Joints]) -> Result<Configuration<M::Joints>, Refused<M>> {
    arms.last().map(|arm| Configuration { base, arm: *arm }).ok_or(Refused::Unreachable)
}

/// A state to ask about: how it would be if the robot stood elsewhere.
#[derive(Debug)]
pub struct Probe<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    state: TabletopState<M>,
    /// Found out when it is first asked about.
    hand: OnceCell<Hand>,
}

impl<'a, M: Manipulator> Probe<'a, M> {
    /// As `like`, in this mode.
    pub fn new(m: &'a Tabletop<M>, like: &TabletopState<M>, mode: Mode) -> Self {
        let mut state = like.clone();
        state.mode = mode;
        Self { m, state, hand: OnceCell::new() }
    }

    /// The state asked about last.
    pub fn state(&self) -> &TabletopState<M> {
        &self.state
    }

    /// Puts an object elsewhere for the next question.
    pub fn place(&mut self, object: ObjectId, world_from_object: &Isometry3<f64>) {
        if let Some(pose) = self.state.objects.get_mut(object.index()) {
            *pose = *world_from_object;
        }
    }

    /// Could the hand alone be at `world_from_tool`?
    ///
    /// # Errors
    /// What is in its way.
    pub fn check_hand(&self, world_from_tool: &Isometry3<f64>, contacts: &Contacts) -> Result<(), Blame> {
        self.m.collision_scene().check_hand(self.hand(), &self.state, world_from_tool, contacts)
    }

    /// [`Probe::check_hand`] with care and without reasons, which takes less time where it is asked often.
    pub fn is_hand_clear(&self, world_from_tool: &Isometry3<f64>, contacts: &Contacts, care: usize) -> bool {
        self.m.collision_scene().is_hand_clear(self.hand(), &self.state, world_from_tool, contacts, care)
    }

    fn hand(&self) -> &Hand {
        self.hand.get_or_init(|| self.m.collision_scene().hand(self.m.manipulator(), &self.state))
    }

    /// Is nothing in the way with the robot at `q`, what it holds in its hand, with this
    /// [care](darrt_core::validity::Validity::most_care)?
    pub fn is_clear(&mut self, q: &Configuration<M::Joints>, contacts: &Contacts, care: usize) -> bool {
        self.put(q);
        self.m.collision_scene().is_state_clear(self.m.manipulator(), &self.state, contacts, care)
    }

    fn put(&mut self, q: &Configuration<M::Joints>) {
        self.state.robot = *q;
        if let Some(held) = self.state.mode.held().copied()
            && let Some(pose) = self.state.objects.get_mut(held.object.index())
        {
            *pose = self.m.manipulator().world_from_tool(q) * held.tool_from_object;
        }
    }

    /// [`Probe::is_clear`] as a reason to refuse a stance, whose base [`stance`] has found clear: with as much care as it keeps.
    ///
    /// # Errors
    /// [`Refused::Blocked`] with the state asked about.
    pub fn check(
        &mut self,
        q: &Configuration<M::Joints>,
        contacts: &Contacts,
        care: &mut Care,
    ) -> Result<(), Refused<M>> {
        self.put(q);
        let (around, robot) = (self.m.collision_scene(), self.m.manipulator());
        let is_clear = |level| match level {
            0 => around.is_rest_clear(robot, &self.state, contacts),
            level => around.is_state_clear(robot, &self.state, contacts, level),
        };
        let kept = (care.least..=care.kept).rev().find(|level| is_clear(*level));
        if let Some(kept) = kept {
            care.kept = kept;
        }
        self.clear_or_refused(kept.is_some(), contacts)
    }

    /// [`Probe::is_clear`] as a reason to refuse a configuration.
    ///
    /// # Errors
    /// [`Refused::Blocked`] with the state asked about.
    pub fn check_all(
        &mut self,
        q: &Configuration<M::Joints>,
        contacts: &Contacts,
        care: usize,
    ) -> Result<(), Refused<M>> {
        let is_clear = self.is_clear(q, contacts, care);
        self.clear_or_refused(is_clear, contacts)
    }

    fn clear_or_refused(&self, is_clear: bool, contacts: &Contacts) -> Result<(), Refused<M>> {
        if is_clear {
            return Ok(());
        }
        Err(Refused::Blocked(Box::new(Blocked { state: self.state.clone(), contacts: *contacts })))
    }
}
