//! A validity judged from outside: what it makes of numbers that are none, how far an allowed contact reaches, what kinds it
//! names, and whether it remembers.

use std::collections::BTreeSet;
use std::sync::Arc;

use rand::{Rng, RngExt};

use super::{BLAME_KIND, BLAME_PLACE, EXEMPTS, NAN, PURE, Trial, WITHOUT_ROBOT};
use crate::domain::Domain;
use crate::laws::feed::{
    beyond_face, components, count_of, elsewhere, everything, moved, piled, rng_of, spoilt_states,
};
use crate::laws::watch::entering;
use crate::laws::{Broken, ensure};
use crate::motion::Instance;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, Validity};

/// How far outside of their spaces components are shown.
const BEYOND_M: [f64; 3] = [1e-3, 0.3, 20.0];
/// How many coordinates of a component are shown there.
const MOST_BEYOND: usize = 12;
/// How many spoilt states are shown.
const SPOILT: usize = 8;
/// In how many states besides an allowed contact is tried.
const EXEMPTED: usize = 96;
/// How many borders of what is in the way are gone to, and how often the way there is halved.
const BORDERS: usize = 48;
const HALVINGS: u32 = 14;
/// How many blames are looked into.
const BLAMES: usize = 3;
/// So many collisions of several pairs of bodies do not all happen at the origin.
const MANY_PLACES: usize = 6;
/// How far from all of them, in rooms, bodies do not meet.
const MOST_ROOMS: f64 = 10.0;
/// How many states are asked again in which objects are in the way.
const MET: usize = 6;
/// How often something is put elsewhere to see whether it was to blame.
const PLACES: usize = 8;
/// An object within this reach may be touched from the start on, metres.
const HAND_M: f64 = 0.1;

/// Names of what the instance may touch: what it names and moves, and what is at hand from the start.
fn may_touch<D: Domain>(m: &D, instance: &Instance<D>, from: &State<D>) -> Vec<String> {
    let mut set = instance.moves;
    if let Some(id) = instance.object {
        set = set.with(ComponentId::Object(id));
    }
    for (i, at) in from.objects.iter().enumerate() {
        let id = ObjectId::new(i);
        let metres = m.reach(&from.robot, id, at);
        if metres.is_nan() || metres <= HAND_M {
            set = set.with(ComponentId::Object(id));
        }
    }
    let objects = components(m, set).into_iter().filter(|component| *component != ComponentId::Robot);
    objects.map(|component| m.component_name(component).into_owned()).collect()
}

/// Just inside of objects that are in the way: from states that are free, the robot straight towards those of `states` where
/// it meets an object, as far as it comes. What may touch shows in the last millimetres only, if it may not enter. Not so of
/// what is fixed: there a contact with an object may well ask for less room beside it.
pub(in crate::laws) fn borders<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    states: &[State<D>],
    rng: &mut dyn Rng,
) -> Vec<State<D>> {
    let judge = |state: &State<D>| {
        entering("check");
        validity.check(m, state, &D::Contacts::default())
    };
    let meets = |found: Result<(), Blame>| found.is_err_and(|blame| blame.kind == BlockKind::RobotObject);
    let is_free = |state: &State<D>| judge(state).is_ok();
    let free: Vec<&State<D>> = states.iter().filter(|state| is_free(state)).collect();
    let blocked: Vec<&State<D>> = states.iter().filter(|state| meets(judge(state))).collect();
    let mut found = Vec::new();
    for _ in 0..BORDERS {
        let pick =
            |all: &[&State<D>], rng: &mut dyn Rng| all.get(rng.random_range(0..all.len().max(1))).map(|s| (*s).clone());
        let (Some(start), Some(into)) = (pick(&free, rng), pick(&blocked, rng)) else { break };
        let at = |t: f64| State { robot: m.robot().interpolate(&start.robot, &into.robot, t), ..start.clone() };
        let (mut inside, mut outside) = (1.0, 0.0);
        if is_free(&at(1.0)) {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            *(if is_free(&at(middle)) { &mut outside } else { &mut inside }) = middle;
        }
        let border = at(inside);
        if meets(judge(&border)) {
            found.push(border);
        }
    }
    found
}

/// Parameters at which an instance is asked what it touches.
const WAY: [f64; 9] = [0.0, 1e-6, 0.02, 0.1, 0.5, 0.9, 0.98, 1.0 - 1e-6, 1.0];

fn pair(blame: &Blame) -> [Arc<str>; 2] {
    let mut both = [Arc::clone(&blame.first), Arc::clone(&blame.second)];
    both.sort();
    both
}

/// The two bodies of each blame on the way of an instance, if nothing may touch.
fn needed<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    instance: &Instance<D>,
    from: &State<D>,
) -> BTreeSet<[Arc<str>; 2]> {
    let bare = |t: f64| validity.check(m, &instance.at(m, t, from), &D::Contacts::default());
    WAY.into_iter().filter_map(|t| Some(pair(&bare(t).err()?))).collect()
}

/// So many states in which the contacts excuse the robot from something fixed are one too many: a contact with an object may
/// ask for less room beside it, and a state drawn at random can lie in those last millimetres, but hardly two.
const FIXED_EXCUSED: usize = 2;

/// Of `states`, those that the contacts of `instance` make valid were blamed on something that it may touch.
pub(in crate::laws) fn exempts<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    instance: &Instance<D>,
    from: &State<D>,
    states: &[State<D>],
) -> Result<(), Broken> {
    if instance.contacts == D::Contacts::default() {
        return Ok(());
    }
    let (names, needed) = (may_touch(m, instance, from), needed(m, validity, instance, from));
    let mut fixed = 0;
    for state in states {
        entering("check");
        let Err(blame) = validity.check(m, state, &D::Contacts::default()) else { continue };
        let is_named = names.iter().any(|name| *blame.first == **name || *blame.second == **name);
        // Another object must be one that it touches on its way.
        let is_excused = is_named && (blame.kind != BlockKind::ObjectObject || needed.contains(&pair(&blame)));
        if !is_excused && validity.check(m, state, &instance.contacts).is_ok() {
            fixed += usize::from(blame.kind == BlockKind::RobotFixed);
            if blame.kind == BlockKind::RobotFixed && fixed < FIXED_EXCUSED {
                continue;
            }
            let found = format!("free with {:?}: {state:?}", instance.contacts);
            return Err(Broken::new(EXEMPTS, found, format!("without: {blame}")));
        }
    }
    Ok(())
}

impl<D: Domain> Trial<'_, D> {
    pub(super) fn outside(&self, seed: u64) -> Result<(), Broken> {
        let mut rng = rng_of(&(self.from, seed));
        self.not_a_number(&mut rng)?;
        self.beyond(&mut rng);
        let mut states = Vec::new();
        for _ in 0..self.claims.anywhere {
            let on_the_way = self.instance.at(self.m, rng.random_range(0.0..=1.0), self.from);
            let there = elsewhere(self.m, &on_the_way, &mut rng);
            // Everything anywhere; only the robot anywhere; and one object in the place of another.
            let robot = State { robot: there.robot.clone(), ..on_the_way.clone() };
            states.extend(piled(self.m, &on_the_way, &mut rng));
            states.extend([there, robot]);
        }
        if self.instance.contacts != D::Contacts::default() {
            let half = self.instance.at(self.m, 0.5, self.from);
            let mut more: Vec<_> = (0..EXEMPTED).map(|_| elsewhere(self.m, &half, &mut rng)).collect();
            more.extend(borders(self.m, self.validity, &more, &mut rng));
            self.exempts(&more)?;
        }
        self.exempts(&states)?;
        self.kinds(&states, &mut rng)?;
        self.without_robot(&states, &mut rng)?;
        self.remembers_nothing(&states, &mut rng)
    }

    fn judge(&self, state: &State<D>, contacts: &D::Contacts) -> Result<(), Blame> {
        entering("check");
        self.validity.check(self.m, state, contacts)
    }

    fn not_a_number(&self, rng: &mut crate::random::Stream) -> Result<(), Broken> {
        let mut all = spoilt_states(self.m, self.from);
        for _ in 0..SPOILT.min(all.len()) {
            let bad = all.swap_remove(rng.random_range(0..all.len()));
            for contacts in [&D::Contacts::default(), &self.instance.contacts] {
                let text = || format!("free: {:?}", bad.state);
                ensure(NAN, self.judge(&bad.state, contacts).is_err(), text, "not valid")
                    .map_err(|broken| broken.of(&bad.what).of(self.m.component_name(bad.component)))?;
            }
        }
        Ok(())
    }

    /// One number of one component beyond its face: whatever is said of it, it is said without a panic.
    fn beyond(&self, rng: &mut crate::random::Stream) {
        for component in everything(self.m) {
            for coordinate in 0..count_of(self.m, self.from, component).min(MOST_BEYOND) {
                for is_upper in [false, true] {
                    let metres = BEYOND_M.get(rng.random_range(0..BEYOND_M.len())).copied().unwrap_or(0.0);
                    let at = beyond_face(self.m, self.from, component, coordinate, is_upper, metres);
                    let _ = self.judge(&at, &self.instance.contacts);
                }
            }
        }
    }

    fn exempts(&self, states: &[State<D>]) -> Result<(), Broken> {
        exempts(self.m, self.validity, self.instance, self.from, states)
    }

    /// The robot's place makes no difference to the rules for the objects alone, and they forbid nothing that is allowed.
    fn without_robot(&self, states: &[State<D>], rng: &mut crate::random::Stream) -> Result<(), Broken> {
        let Some(alone) = self.validity.without_robot() else { return Ok(()) };
        for state in states.iter().step_by(3) {
            entering("check without the robot");
            let here = alone.check(self.m, state, &D::Contacts::default());
            let away = moved(self.m, state, ComponentId::Robot, rng);
            let there = alone.check(self.m, &away, &D::Contacts::default());
            // A state in which something is held may be wrong because of where the hand is: that says nothing.
            let collides = |found: &Result<(), Blame>| match found {
                Ok(()) => Some(false),
                Err(blame) => is_collision(blame).then_some(true),
            };
            let differs = collides(&here).zip(collides(&there)).is_some_and(|(here, there)| here != there);
            let text = || format!("{here:?}, and {there:?} with the robot elsewhere");
            ensure(WITHOUT_ROBOT, !differs, text, "the same")?;
            let is_stricter = here.is_err() && self.judge(state, &D::Contacts::default()).is_ok();
            ensure(WITHOUT_ROBOT, !is_stricter, || format!("{here:?}"), "free, as with the robot")?;
            // Nor do they allow what objects may not do among themselves.
            let with = self.judge(state, &D::Contacts::default()).err().filter(|blame| {
                let is_of_objects = matches!(blame.kind, BlockKind::ObjectFixed | BlockKind::ObjectObject);
                is_of_objects && self.m.carried(&state.mode).is_empty()
            });
            let text = || "free without the robot".to_owned();
            let is_laxer = here.is_ok() && with.is_some();
            let against = || with.as_ref().map_or_else(String::new, ToString::to_string);
            ensure(WITHOUT_ROBOT, !is_laxer, text, "as with it")
                .map_err(|broken| Broken { right: against().into(), ..broken })?;
        }
        Ok(())
    }

    fn kinds(&self, states: &[State<D>], rng: &mut crate::random::Stream) -> Result<(), Broken> {
        let objects: Vec<_> = (0..self.m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i))).collect();
        let names: Vec<_> = objects.iter().map(|id| self.m.component_name(*id).into_owned()).collect();
        let robot = self.m.component_name(ComponentId::Robot).into_owned();
        let mut seen = 0;
        let room_m = extent(states.iter().flat_map(|state| points(self.m, state)));
        let (mut places, mut is_told, mut pairs) = (0, false, BTreeSet::new());
        for state in states {
            let Err(blame) = self.judge(state, &D::Contacts::default()) else { continue };
            let both = [&*blame.first, &*blame.second];
            let of_objects = both.iter().filter(|name| names.iter().any(|known| known == **name)).count();
            let is_robot = both.iter().any(|name| **name == *robot);
            let fits = match blame.kind {
                BlockKind::RobotFixed | BlockKind::RobotItself => of_objects == 0,
                BlockKind::RobotObject => of_objects == 1,
                BlockKind::ObjectFixed => of_objects == 1 && !is_robot,
                BlockKind::ObjectObject => of_objects == 2,
                // Two components that meet have a kind of their own.
                BlockKind::Other => of_objects + usize::from(is_robot) < 2,
                _ => true,
            };
            let text = || blame.to_string();
            ensure(BLAME_KIND, fits, text, "a kind that fits the names of the two bodies")?;
            if is_collision(&blame) {
                self.is_near(state, &blame, room_m)?;
                places += 1;
                is_told |= blame.place != [0.0; 3];
                pairs.insert(pair(&blame));
            }
            if seen < BLAMES && is_collision(&blame) {
                seen += 1;
                self.is_to_blame(state, &blame, &objects, rng)?;
            }
        }
        // One body may stand at the origin, but not all.
        let is_open = places < MANY_PLACES || pairs.len() < 2;
        let text = || format!("{places} of {places} collisions at [0.0, 0.0, 0.0]");
        ensure(BLAME_PLACE, is_told || is_open, text, "where they meet")
    }

    /// A collision is where bodies are, if the domain tells where they are.
    fn is_near(&self, state: &State<D>, blame: &Blame, room_m: f64) -> Result<(), Broken> {
        let apart_m = |p: &[f64; 3]| extent([*p, blame.place].into_iter());
        let nearest_m = points(self.m, state).iter().map(apart_m).fold(f64::INFINITY, f64::min);
        let holds = room_m <= 0.0 || nearest_m <= MOST_ROOMS * room_m;
        let text = || format!("{blame}, {nearest_m:?} m from robot and objects");
        let against = format!("where they meet, in a room of {room_m:?} m");
        ensure(BLAME_PLACE, holds, text, "near them").map_err(|broken| Broken { right: against.into(), ..broken })
    }

    /// Whoever the kind names is to blame: the same two bodies do not meet wherever it is put.
    fn is_to_blame(
        &self,
        state: &State<D>,
        blame: &Blame,
        objects: &[ComponentId],
        rng: &mut crate::random::Stream,
    ) -> Result<(), Broken> {
        let same = |state: &State<D>| {
            let found = self.judge(state, &D::Contacts::default());
            found.is_err_and(|found| found.first == blame.first && found.second == blame.second)
        };
        let kind = blame.kind;
        let of_robot = matches!(kind, BlockKind::RobotFixed | BlockKind::RobotItself | BlockKind::RobotObject);
        let of_objects = matches!(kind, BlockKind::RobotObject | BlockKind::ObjectFixed | BlockKind::ObjectObject);
        // Itself it may hit everywhere.
        if of_robot && kind != BlockKind::RobotItself {
            let stays = (0..PLACES).all(|_| same(&moved(self.m, state, ComponentId::Robot, rng)));
            ensure(BLAME_KIND, !stays, || blame.to_string(), "not the robot's: they meet wherever the robot is")?;
        }
        if of_objects && !objects.is_empty() {
            let stays = (0..PLACES).all(|_| {
                let all = objects.iter().fold(state.clone(), |state, id| moved(self.m, &state, *id, rng));
                same(&all)
            });
            ensure(BLAME_KIND, !stays, || blame.to_string(), "not an object's: they meet wherever the objects are")?;
        }
        Ok(())
    }

    /// The same answers in another order, with repeats, and with neighbours in between.
    fn remembers_nothing(&self, states: &[State<D>], rng: &mut crate::random::Stream) -> Result<(), Broken> {
        let mut all: Vec<&State<D>> = states.iter().step_by(3).collect();
        all.push(self.from);
        // An answer that is remembered for the robot alone shows where objects are in its way and then are not.
        let is_met = |state: &&State<D>| {
            let found = self.judge(state, &D::Contacts::default());
            found.is_err_and(|blame| matches!(blame.kind, BlockKind::RobotObject | BlockKind::ObjectObject))
        };
        all.extend(states.iter().filter(is_met).take(MET));
        let everything = everything(self.m);
        let mut twins: Vec<State<D>> = Vec::new();
        for state in &all {
            // The same but for one component, and but for all objects.
            let movable = components(self.m, ComponentSet::ROBOT.union(self.instance.moves));
            let which = movable.get(rng.random_range(0..movable.len().max(1))).copied();
            twins.push(moved(self.m, state, which.unwrap_or(ComponentId::Robot), rng));
            let objects = everything.iter().filter(|id| **id != ComponentId::Robot);
            twins.push(objects.fold((*state).clone(), |state, id| moved(self.m, &state, *id, rng)));
        }
        all.extend(&twins);
        let text = |state: &State<D>| {
            let answer = self.judge(state, &D::Contacts::default());
            answer.map_or_else(|blame| blame.to_string(), |()| "free".to_owned())
        };
        let first: Vec<String> = all.iter().map(|state| text(state)).collect();
        for _ in 0..2 * all.len() {
            let i = rng.random_range(0..all.len());
            if let (Some(state), Some(was)) = (all.get(i), first.get(i)) {
                let is = text(state);
                ensure(PURE, is == *was, || format!("{is}, for {state:?}"), "what it said before")
                    .map_err(|broken| Broken { right: was.clone().into(), ..broken })?;
            }
        }
        Ok(())
    }
}

/// Where the domain says that robot and objects are; the origin for one that does not say.
fn points<D: Domain>(m: &D, state: &State<D>) -> Vec<[f64; 3]> {
    let objects = state.objects.iter().enumerate().map(|(i, at)| m.object_point(ObjectId::new(i), at));
    std::iter::once(m.working_point(&state.robot)).chain(objects).collect()
}

/// Metres from one corner to the other of the box around points.
fn extent(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let nothing = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (low, high) = points.fold(nothing, |(low, high), p| {
        let all = [0, 1, 2].map(|i: usize| (low[i].min(p[i]), high[i].max(p[i])));
        (all.map(|(low, _)| low), all.map(|(_, high)| high))
    });
    let metres = [0, 1, 2].map(|i: usize| (high[i] - low[i]).max(0.0));
    metres.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn is_collision(blame: &Blame) -> bool {
    use BlockKind::{ObjectFixed, ObjectObject, RobotFixed, RobotItself, RobotObject};
    matches!(blame.kind, RobotFixed | RobotItself | RobotObject | ObjectFixed | ObjectObject)
}
