//! B: the obstacles, and how far a motion keeps clear of them.

use std::sync::Arc;

use super::plane;
use super::world::{Point, PuckWorld};
use crate::domain::Domain;
use crate::motion::Instance;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};

/// Bodies that may not touch keep at least this many metres apart.
pub const CLEARANCE_M: f64 = 1e-3;
/// Bodies that may touch overlap by no more than this many metres, for rounding.
pub const OVERLAP_M: f64 = 1e-6;
/// The shortest step along a motion, metres: half of what must stay clear, so that nothing is skipped.
const STEP_M: f64 = CLEARANCE_M / 2.0;

/// The shape and place of an obstacle, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline {
    /// A round pillar.
    Disc {
        /// Its centre.
        centre: Point,
        /// Its radius.
        radius_m: f64,
    },
    /// A wall along the axes.
    Rectangle {
        /// Lower left corner.
        lower: Point,
        /// Upper right corner.
        upper: Point,
    },
}

impl Outline {
    /// Signed metres from `p` to the outline, negative inside.
    pub fn distance(&self, p: &Point) -> f64 {
        match self {
            Self::Disc { centre, radius_m } => plane::distance(p, centre) - radius_m,
            Self::Rectangle { lower, upper } => plane::to_rectangle(p, lower, upper),
        }
    }
}

/// Something that never moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its name, for people.
    pub name: Arc<str>,
    /// Where it is.
    pub outline: Outline,
}

/// The planner's rule: no overlap, [`CLEARANCE_M`] between whatever may not touch, all discs on the floor.
#[derive(Debug, Clone, Default)]
pub struct Clearance {
    obstacles: Vec<Obstacle>,
    /// The robot collides with nothing.
    ignores_robot: bool,
}

/// Two bodies and the room between them.
#[derive(Debug, Clone, Copy)]
struct Pair {
    first: ComponentId,
    second: Body,
    /// Metres that they may still approach each other.
    room_m: f64,
    /// How many of the two move.
    movers: u8,
}

#[derive(Debug, Clone, Copy)]
enum Body {
    Puck(ObjectId),
    Obstacle(usize),
}

impl Clearance {
    /// The rule for these obstacles.
    pub fn new(obstacles: Vec<Obstacle>) -> Self {
        Self { obstacles, ignores_robot: false }
    }

    /// The obstacles.
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Calls `visit` with every pair of bodies of which at least one is in `moves`.
    fn pairs(
        &self,
        m: &PuckWorld,
        state: &State<PuckWorld>,
        contacts: ComponentSet,
        moves: ComponentSet,
        mut visit: impl FnMut(Pair),
    ) {
        let is_moving = |c: ComponentId| u8::from(moves.contains(c));
        let discs = std::iter::once((ComponentId::Robot, &state.robot, m.robot_radius())).chain(
            m.ids().zip(&state.objects).zip(m.pucks()).map(|((id, at), p)| (ComponentId::Object(id), at, p.radius_m)),
        );
        for (first, at, radius_m) in discs.skip(usize::from(self.ignores_robot)) {
            if is_moving(first) > 0 {
                for (i, obstacle) in self.obstacles.iter().enumerate() {
                    let room_m = obstacle.outline.distance(at) - radius_m - CLEARANCE_M;
                    visit(Pair { first, second: Body::Obstacle(i), room_m, movers: 1 });
                }
            }
            for ((id, other), puck) in m.ids().zip(&state.objects).zip(m.pucks()) {
                let second = ComponentId::Object(id);
                let movers = is_moving(first) + is_moving(second);
                if first < second && movers > 0 {
                    let may_touch = first == ComponentId::Robot && contacts.contains(second);
                    let kept_m = if may_touch { -OVERLAP_M } else { CLEARANCE_M };
                    let room_m = plane::distance(at, other) - radius_m - puck.radius_m - kept_m;
                    visit(Pair { first, second: Body::Puck(id), room_m, movers });
                }
            }
        }
    }

    fn blame(&self, m: &PuckWorld, state: &State<PuckWorld>, pair: &Pair) -> Blame {
        let name = |c: ComponentId| Arc::<str>::from(m.component_name(c));
        let (is_robot, at) = match pair.first {
            ComponentId::Robot => (true, Some(&state.robot)),
            ComponentId::Object(id) => (false, state.object(id)),
        };
        let (second, kind) = match pair.second {
            Body::Puck(id) if is_robot => (name(ComponentId::Object(id)), BlockKind::RobotObject),
            Body::Puck(id) => (name(ComponentId::Object(id)), BlockKind::ObjectObject),
            Body::Obstacle(i) => {
                let kind = if is_robot { BlockKind::RobotFixed } else { BlockKind::ObjectFixed };
                (self.obstacles.get(i).map_or_else(|| "no obstacle".into(), |o| Arc::clone(&o.name)), kind)
            }
        };
        blame(kind, name(pair.first), second, at)
    }

    /// The rules that need no distances: on the floor, and held where the mode says.
    fn check_mode(m: &PuckWorld, state: &State<PuckWorld>) -> Result<(), Blame> {
        if !m.robot().contains(&state.robot) {
            return Err(blame(BlockKind::Limits, "robot".into(), "edge of the floor".into(), Some(&state.robot)));
        }
        for ((space, at), puck) in m.objects().iter().zip(&state.objects).zip(m.pucks()) {
            if !space.contains(at) {
                return Err(blame(BlockKind::Limits, Arc::clone(&puck.name), "edge of the floor".into(), Some(at)));
            }
        }
        if let Some((id, offset)) = state.mode.held()
            && let Some(at) = state.object(id)
            && plane::distance(at, &plane::add(&state.robot, &offset)) > OVERLAP_M
        {
            let name = m.component_name(ComponentId::Object(id));
            return Err(blame(BlockKind::Other, name.into(), "grip of the robot".into(), Some(at)));
        }
        Ok(())
    }
}

/// Metres to the nearest edge of the floor of anything that moves; negative outside.
fn room_to_edge(m: &PuckWorld, state: &State<PuckWorld>, moves: ComponentSet) -> f64 {
    let ids = m.ids().map(ComponentId::Object);
    let discs = std::iter::once((ComponentId::Robot, m.robot(), &state.robot))
        .chain(ids.zip(m.objects()).zip(&state.objects).map(|((id, space), at)| (id, space, at)));
    let moving = discs.filter(|(id, ..)| moves.contains(*id));
    let rooms = moving.flat_map(|(_, space, at)| {
        let axes = at.iter().zip(space.lower()).zip(space.upper());
        axes.map(|((x, lower), upper)| (x - lower).min(upper - x))
    });
    rooms.fold(f64::INFINITY, f64::min)
}

fn blame(kind: BlockKind, first: Arc<str>, second: Arc<str>, at: Option<&Point>) -> Blame {
    Blame { kind, first, second, place: at.map_or([0.0; 3], |p| [p[0], p[1], 0.0]) }
}

/// What may touch: what the instance declares, and what the mode says is touched or held.
fn may_touch(state: &State<PuckWorld>, contacts: ComponentSet) -> ComponentSet {
    let held = state.mode.held().map(|(id, _)| id);
    let named = [held, state.mode.touching].into_iter().flatten();
    named.fold(contacts, |set, id| set.with(ComponentId::Object(id)))
}

impl Validity<PuckWorld> for Clearance {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        Self::check_mode(m, state)?;
        let everything = m.ids().fold(ComponentSet::ROBOT, |set, id| set.with(ComponentId::Object(id)));
        let mut worst: Option<Pair> = None;
        self.pairs(m, state, may_touch(state, *contacts), everything, |pair| {
            if worst.is_none_or(|w| pair.room_m < w.room_m) {
                worst = Some(pair);
            }
        });
        match worst {
            Some(pair) if pair.room_m < 0.0 => Err(self.blame(m, state, &pair)),
            _ => Ok(()),
        }
    }

    fn without_robot(&self) -> Option<Arc<dyn Validity<PuckWorld>>> {
        Some(Arc::new(Self { ignores_robot: true, ..self.clone() }))
    }

    /// Conservative advancement: no point moves farther than `length * dt` (law of
    /// [`Motion`](crate::motion::Motion)), so the room between two bodies lasts at least for the time
    /// `room / (length * movers)`.
    fn free_prefix(&self, m: &PuckWorld, instance: &Instance<PuckWorld>, from: &State<PuckWorld>) -> FreePrefix {
        let mut state = from.clone();
        let mut free = 0.0;
        let mut t = 0.0;
        loop {
            instance.motion.at_into(m, t, &mut state);
            // Everything is checked at both ends, in between only what moves.
            let is_end = t <= 0.0 || t >= 1.0;
            let checked = if is_end { self.check(m, &state, &instance.contacts) } else { Self::check_mode(m, &state) };
            if let Err(blame) = checked {
                return FreePrefix::blocked(free, blame);
            }
            let mut tightest: Option<(f64, Pair)> = None;
            self.pairs(m, &state, may_touch(&state, instance.contacts), instance.moves, |pair| {
                let reach = pair.room_m / f64::from(pair.movers.max(1));
                if tightest.is_none_or(|(least, _)| reach < least) {
                    tightest = Some((reach, pair));
                }
            });
            match tightest {
                Some((_, pair)) if pair.room_m < 0.0 => return FreePrefix::blocked(free, self.blame(m, &state, &pair)),
                _ => free = t,
            }
            if t >= 1.0 {
                return FreePrefix::FREE;
            }
            let reach_m = tightest.map_or(f64::INFINITY, |(reach, _)| reach);
            let reach_m = reach_m.min(room_to_edge(m, &state, instance.moves)).max(STEP_M);
            t = advance(t, reach_m, instance.motion.length());
        }
    }
}

/// The next parameter: `reach_m` of travel further, but not past the end.
fn advance(t: f64, reach_m: f64, length_m: f64) -> f64 {
    let next = t + reach_m / length_m;
    // Also for a motion of no length, and for one too long to be resolved.
    if next > t && next < 1.0 { next } else { 1.0 }
}
