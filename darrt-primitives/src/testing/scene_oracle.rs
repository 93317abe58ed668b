//! The slow, obvious judge of table-top states: every body against every other through [`darrt_geom::oracle`], with margins or
//! without, and whole motions by looking at many states. To hold a fast validity against with
//! [`check_against_oracle`](darrt_core::laws::check_against_oracle).

use std::sync::Arc;

use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_geom::oracle::{Finding, PosedBody, intersections, nearest};
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point2};

use crate::manipulator::{LinkGroup, Manipulator};
use crate::mode::{Contacts, SurfaceId};
use crate::tabletop::{Tabletop, TabletopState};

/// How far the oracle's distances may be off, metres.
const ROUNDING_M: f64 = 1e-5;

/// The judge, among these fixed bodies.
#[derive(Debug, Clone)]
pub struct SceneOracle {
    /// The obstacles.
    pub fixed: Vec<FixedBody>,
    /// How many states of a motion are looked at.
    pub looks: u32,
    /// Whether all pairs must keep their margins too.
    pub asks_margins: bool,
}

/// Which of the bodies one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Link(usize),
    Object(ObjectId),
    Fixed(usize),
}

impl SceneOracle {
    /// Among these bodies.
    pub fn new(fixed: &[FixedBody]) -> Self {
        Self { fixed: fixed.to_vec(), looks: 64, asks_margins: false }
    }

    /// The same, and all pairs must keep the least margins of the domain. What begins too near is not excepted.
    pub fn with_margins(fixed: &[FixedBody]) -> Self {
        Self { asks_margins: true, ..Self::new(fixed) }
    }

    /// Link, object or obstacle: the bodies stand in this order.
    fn kind<M: Manipulator>(m: &Tabletop<M>, index: usize) -> Kind {
        let links = m.manipulator().links().len();
        let objects = m.movables().len();
        if index < links {
            Kind::Link(index)
        } else if index < links + objects {
            Kind::Object(ObjectId::new(index - links))
        } else {
            Kind::Fixed(index - links - objects)
        }
    }

    /// May these two touch?
    fn may_touch<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        contacts: &Contacts,
        (a, b): (Kind, Kind),
    ) -> bool {
        let group = |link: usize| m.manipulator().links().get(link).map(|l| l.group);
        match (a, b) {
            (Kind::Link(a), Kind::Link(b)) => {
                let pairs = m.manipulator().self_pairs();
                !pairs.contains(&(a, b)) && !pairs.contains(&(b, a))
            }
            (Kind::Link(link), Kind::Object(id)) => {
                let is_held = state.mode.held().is_some_and(|held| held.object == id);
                let is_exempt = contacts.fingers.is_some_and(|(object, _)| object == id);
                group(link) == Some(LinkGroup::Finger) && (is_held || is_exempt)
            }
            (Kind::Link(link), Kind::Fixed(body)) => group(link) == Some(LinkGroup::Base) && self.is_floor(body),
            (Kind::Object(id), Kind::Fixed(body)) => {
                let lifted = contacts.support.filter(|(object, _)| *object == id).map(|(_, surface)| surface);
                let surfaces = [state.mode.support_of(id), lifted];
                surfaces.into_iter().flatten().any(|surface| self.is_under(m, surface, body))
            }
            _ => matches!((a, b), (Kind::Fixed(_), Kind::Fixed(_))),
        }
    }

    /// Must these two be near each other?
    fn may_be_near<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        contacts: &Contacts,
        (a, b): (Kind, Kind),
    ) -> bool {
        let is_hand = |kind: Kind| match kind {
            Kind::Link(link) => {
                let group = m.manipulator().links().get(link).map(|l| l.group);
                matches!(group, Some(LinkGroup::Hand | LinkGroup::Finger))
            }
            _ => false,
        };
        let held = state.mode.held().map(|held| held.object);
        if let (link, Kind::Object(id)) | (Kind::Object(id), link) = (a, b)
            && is_hand(link)
            && held == Some(id)
        {
            return true;
        }
        let named = [contacts.support.map(|(id, _)| id), contacts.fingers.map(|(id, _)| id), state.mode.engaged()];
        let surface = |id| contacts.support.map(|(_, surface)| surface).or(state.mode.support_of(id));
        let Some((id, surface)) = named.into_iter().flatten().find_map(|id| Some((id, surface(id)?))) else {
            return false;
        };
        let works = |kind: Kind| is_hand(kind) || kind == Kind::Object(id);
        let is_worked_at = |kind: Kind| match kind {
            Kind::Fixed(body) => self.is_under(m, surface, body),
            kind => kind == Kind::Object(id),
        };
        works(a) && is_worked_at(b) || works(b) && is_worked_at(a)
    }

    /// The first pair found that is nearer than its margin.
    fn margins<M: Manipulator>(
        &self,
        m: &Tabletop<M>,
        state: &TabletopState<M>,
        contacts: &Contacts,
        bodies: &[PosedBody<'_>],
    ) -> Result<(), Blame> {
        let safety = &m.settings().safety;
        for (is_near, margin_m) in [(false, safety.least_margin_m), (true, safety.contact_margin_m)] {
            let skip = |a, b| {
                let pair = (Self::kind(m, a), Self::kind(m, b));
                self.may_touch(m, state, contacts, pair) || self.may_be_near(m, state, contacts, pair) != is_near
            };
            if let Ok(Some(found)) = nearest(bodies, &skip)
                && found.distance < margin_m - ROUNDING_M
            {
                return Err(Self::blame(m, bodies, &found));
            }
        }
        Ok(())
    }

    fn is_floor(&self, body: usize) -> bool {
        let parts = self.fixed.get(body).map_or(&[][..], |fixed| &fixed.body.parts);
        parts.iter().all(|part| matches!(part.shape, Shape::HalfSpace { .. }))
    }

    fn is_under<M: Manipulator>(&self, m: &Tabletop<M>, surface: SurfaceId, body: usize) -> bool {
        let under = m.supports().get(surface.index()).map_or(&[][..], |support| &support.bodies);
        self.fixed.get(body).is_some_and(|fixed| under.contains(&fixed.body.name))
    }

    fn rules<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>) -> Result<(), Blame> {
        let [x, y, _] = state.robot.base;
        let blame = |kind, first: &str, second: &str| Blame {
            kind,
            first: first.into(),
            second: second.into(),
            place: [x, y, 0.0],
        };
        if !m.robot().contains(&state.robot) {
            return Err(blame(BlockKind::Limits, "robot", "its limits"));
        }
        for (i, (space, pose)) in m.objects().iter().zip(&state.objects).enumerate() {
            let id = ObjectId::new(i);
            let is_held = state.mode.held().is_some_and(|held| held.object == id);
            let at = Point2::new(pose.translation.x, pose.translation.y);
            let surface = state.mode.support_of(id).and_then(|s| m.surface(s));
            if !space.contains(pose) {
                return Err(blame(BlockKind::Limits, "object", "its bounds"));
            }
            if !is_held && !surface.is_some_and(|s| s.contains(&at)) {
                return Err(blame(BlockKind::OffSupport, "object", "its surface"));
            }
        }
        Ok(())
    }

    fn blame<M: Manipulator>(m: &Tabletop<M>, bodies: &[PosedBody<'_>], found: &Finding) -> Blame {
        let kind = match (Self::kind(m, found.first), Self::kind(m, found.second)) {
            (Kind::Link(_), Kind::Link(_)) => BlockKind::RobotItself,
            (Kind::Link(_), Kind::Object(_)) => BlockKind::RobotObject,
            (Kind::Link(_), Kind::Fixed(_)) => BlockKind::RobotFixed,
            (Kind::Object(_), Kind::Object(_)) => BlockKind::ObjectObject,
            _ => BlockKind::ObjectFixed,
        };
        let name = |index: usize| bodies.get(index).map_or_else(|| "body".into(), |b| Arc::clone(&b.body.name));
        let place = [found.place.x, found.place.y, found.place.z];
        Blame { kind, first: name(found.first), second: name(found.second), place }
    }
}

impl<M: Manipulator> Validity<Tabletop<M>> for SceneOracle {
    fn check(&self, m: &Tabletop<M>, state: &TabletopState<M>, contacts: &Contacts) -> Result<(), Blame> {
        Self::rules(m, state)?;
        let robot = m.manipulator();
        let mut poses = vec![Isometry3::identity(); robot.links().len()];
        robot.link_poses(&state.robot, state.mode.gap_m(), &mut poses);
        let posed = |body, pose: &Isometry3<f64>| PosedBody { body, world_from_body: *pose };
        let links = robot.links().iter().zip(&poses).map(|(link, pose)| posed(&link.body, pose));
        let objects = m.movables().iter().zip(&state.objects).map(|(movable, pose)| posed(&movable.body, pose));
        let fixed = self.fixed.iter().map(|fixed| posed(&fixed.body, &fixed.world_from_body));
        let bodies: Vec<_> = links.chain(objects).chain(fixed).collect();
        let skip = |a, b| self.may_touch(m, state, contacts, (Self::kind(m, a), Self::kind(m, b)));
        let place = [state.robot.base[0], state.robot.base[1], 0.0];
        match intersections(&bodies, &skip) {
            Ok(found) => match found.first() {
                Some(found) => Err(Self::blame(m, &bodies, found)),
                None if self.asks_margins => self.margins(m, state, contacts, &bodies),
                None => Ok(()),
            },
            Err(error) => Err(Blame {
                kind: BlockKind::Other,
                first: error.to_string().into(),
                second: "a pose that can be judged".into(),
                place,
            }),
        }
    }

    fn free_prefix(&self, m: &Tabletop<M>, instance: &Instance<Tabletop<M>>, from: &TabletopState<M>) -> FreePrefix {
        let mut last = 0.0;
        for i in 0..=self.looks.max(1) {
            let t = f64::from(i) / f64::from(self.looks.max(1));
            if let Err(blame) = self.check(m, &instance.at(m, t, from), &instance.contacts) {
                return FreePrefix::blocked(last, blame);
            }
            last = t;
        }
        FreePrefix::FREE
    }
}
