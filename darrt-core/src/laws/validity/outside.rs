//! A validity judged from outside: what it makes of numbers that are none, how far an allowed contact reaches, what kinds it
//! names, and whether it remembers.

use rand::RngExt;

use super::{BLAME_KIND, EXEMPTS, NAN, PURE, Trial};
use crate::domain::Domain;
use crate::laws::feed::{components, elsewhere, moved, rng_of, spoilt_states};
use crate::laws::watch::entering;
use crate::laws::{Broken, ensure};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind};

/// How many spoilt states are shown.
const SPOILT: usize = 8;
/// How many blames are looked into.
const BLAMES: usize = 3;
/// How often something is put elsewhere to see whether it was to blame.
const PLACES: usize = 8;
/// An object within this reach may be touched from the start on, metres.
const HAND_M: f64 = 0.1;

impl<D: Domain> Trial<'_, D> {
    pub(super) fn outside(&self, seed: u64) -> Result<(), Broken> {
        let mut rng = rng_of(&(self.from, seed));
        self.not_a_number(&mut rng)?;
        let mut states = Vec::new();
        for _ in 0..self.claims.anywhere {
            let on_the_way = self.instance.at(self.m, rng.random_range(0.0..=1.0), self.from);
            let there = elsewhere(self.m, &on_the_way, &mut rng);
            // Everything anywhere; only the robot anywhere; and one object in the place of another.
            let robot = State { robot: there.robot.clone(), ..on_the_way.clone() };
            let mut pile = on_the_way.clone();
            let count = pile.objects.len();
            if count > 1 {
                let (from, to) = (rng.random_range(0..count), rng.random_range(0..count));
                if let (Some(q), Some(space)) = (pile.objects.get(from).cloned(), self.m.objects().get(to))
                    && space.contains(&q)
                    && let Some(slot) = pile.objects.get_mut(to)
                {
                    *slot = q;
                }
            }
            states.extend([there, robot, pile]);
        }
        self.exempts(&states)?;
        self.kinds(&states, &mut rng)?;
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

    /// Names of what the instance may touch: what it names and moves, and what is at hand from the start.
    fn may_touch(&self) -> Vec<String> {
        let mut set = self.instance.moves;
        if let Some(id) = self.instance.object {
            set = set.with(ComponentId::Object(id));
        }
        for (i, at) in self.from.objects.iter().enumerate() {
            let id = ObjectId::new(i);
            let metres = self.m.reach(&self.from.robot, id, at);
            if metres.is_nan() || metres <= HAND_M {
                set = set.with(ComponentId::Object(id));
            }
        }
        let objects = components(self.m, set).into_iter().filter(|component| *component != ComponentId::Robot);
        objects.map(|component| self.m.component_name(component).into_owned()).collect()
    }

    fn exempts(&self, states: &[State<D>]) -> Result<(), Broken> {
        if self.instance.contacts == D::Contacts::default() {
            return Ok(());
        }
        let names = self.may_touch();
        for state in states {
            let Err(blame) = self.judge(state, &D::Contacts::default()) else { continue };
            let is_named = names.iter().any(|name| *blame.first == **name || *blame.second == **name);
            if !is_named && self.judge(state, &self.instance.contacts).is_ok() {
                let found = format!("free with {:?}: {state:?}", self.instance.contacts);
                return Err(Broken::new(EXEMPTS, found, format!("without: {blame}")));
            }
        }
        Ok(())
    }

    fn kinds(&self, states: &[State<D>], rng: &mut crate::random::Stream) -> Result<(), Broken> {
        let objects: Vec<_> = (0..self.m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i))).collect();
        let names: Vec<_> = objects.iter().map(|id| self.m.component_name(*id).into_owned()).collect();
        let robot = self.m.component_name(ComponentId::Robot).into_owned();
        let mut seen = 0;
        for state in states {
            let Err(blame) = self.judge(state, &D::Contacts::default()) else { continue };
            let both = [&*blame.first, &*blame.second];
            let of_objects = both.iter().filter(|name| names.iter().any(|known| known == **name)).count();
            let is_robot = both.iter().any(|name| **name == *robot);
            let fits = match blame.kind {
                BlockKind::RobotFixed | BlockKind::RobotItself => of_objects == 0,
                BlockKind::RobotObject => of_objects < 2,
                BlockKind::ObjectFixed => of_objects < 2 && !is_robot,
                BlockKind::ObjectObject => !is_robot,
                _ => true,
            };
            let text = || blame.to_string();
            ensure(BLAME_KIND, fits, text, "a kind that fits the names of the two bodies")?;
            if seen < BLAMES && self.is_collision(&blame) {
                seen += 1;
                self.is_to_blame(state, &blame, &objects, rng)?;
            }
        }
        Ok(())
    }

    fn is_collision(&self, blame: &Blame) -> bool {
        use BlockKind::{ObjectFixed, ObjectObject, RobotFixed, RobotItself, RobotObject};
        matches!(blame.kind, RobotFixed | RobotItself | RobotObject | ObjectFixed | ObjectObject)
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
        let twins: Vec<State<D>> = all
            .iter()
            .map(|state| {
                // The same but for one component.
                let movable = components(self.m, ComponentSet::ROBOT.union(self.instance.moves));
                let which = movable.get(rng.random_range(0..movable.len().max(1))).copied();
                moved(self.m, state, which.unwrap_or(ComponentId::Robot), rng)
            })
            .collect();
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
