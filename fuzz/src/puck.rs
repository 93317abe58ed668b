//! States, targets and problems of the puck domain from bytes.

use arbitrary::Arbitrary;
use darrt_core::goal::Reach;
use darrt_core::partial::PartialState;
use darrt_core::primitive::Primitive;
use darrt_core::problem::{Parts, Problem};
use darrt_core::space::{ComponentSpace, RealBox};
use darrt_core::state::{ObjectId, State};
use darrt_core::testing::puck::{
    Carry, Clearance, Grip, Judge, Mode, Obstacle, Outline, Pick, Place, Point, Puck, PuckWorld, Push, Transit,
};

/// Most pucks of a case.
const MOST: usize = 4;

/// Where something is: shares of the width and the height, in 65535ths.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub struct Spot {
    x: u16,
    y: u16,
}

impl Spot {
    fn within(self, space: &RealBox<2>) -> Point {
        let (lower, upper) = (space.lower(), space.upper());
        let share = [self.x, self.y].map(|s| f64::from(s) / f64::from(u16::MAX));
        std::array::from_fn(|i| (lower[i] + share[i] * (upper[i] - lower[i])).clamp(lower[i], upper[i]))
    }
}

/// How the robot and one puck belong together.
#[derive(Debug, Clone, Copy, Arbitrary)]
enum Relation {
    None,
    Held { puck: u8, angle: u8 },
    Touched { puck: u8, angle: u8 },
}

/// A state of the domain.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub struct StateSketch {
    robot: Spot,
    pucks: [Spot; MOST],
    relation: Relation,
}

/// A target: which components it names, where they should be, and which of them are there already.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub struct TargetSketch {
    named: u8,
    met: u8,
    robot: Spot,
    pucks: [Spot; MOST],
}

/// A floor with one to four pucks, every second of them graspable.
///
/// # Panics
/// Never: the sizes are in range.
#[must_use]
pub fn world(pucks: u8) -> PuckWorld {
    let count = usize::from(pucks) % MOST + 1;
    let puck = |i: usize| Puck { name: format!("puck {i}").into(), radius_m: 0.12, is_graspable: i.is_multiple_of(2) };
    PuckWorld::new([4.0, 3.0], 0.15, (0..count).map(puck).collect()).expect("sizes in range")
}

/// All primitives of the domain.
#[must_use]
pub fn primitives() -> Vec<Box<dyn Primitive<PuckWorld>>> {
    vec![Box::new(Transit), Box::new(Push), Box::new(Pick), Box::new(Carry), Box::new(Place)]
}

impl StateSketch {
    /// The state: every component in its space, a held or touched puck at the rim of the robot if there is room.
    #[must_use]
    pub fn state(&self, m: &PuckWorld) -> State<PuckWorld> {
        use darrt_core::domain::Domain as _;
        let objects = m.objects().iter().zip(self.pucks).map(|(space, spot)| spot.within(space)).collect();
        let mode = Mode::resting(m.objects().len());
        let mut state = State { robot: self.robot.within(m.robot()), objects, mode };
        let (Relation::Held { puck, angle } | Relation::Touched { puck, angle }) = self.relation else { return state };
        let id = ObjectId::new(usize::from(puck) % m.objects().len());
        let angle = f64::from(angle) / 256.0 * std::f64::consts::TAU;
        let offset = [angle.cos(), angle.sin()].map(|x| x * m.touch_distance(id));
        let at = [state.robot[0] + offset[0], state.robot[1] + offset[1]];
        if m.objects()[id.index()].contains(&at) {
            state.objects[id.index()] = at;
            state.mode = match self.relation {
                Relation::Held { .. } => state.mode.with_grip(id, Grip::Held { offset }),
                _ => state.mode.touching(Some(id)),
            };
        }
        state
    }
}

impl TargetSketch {
    /// The target, as seen from a state.
    #[must_use]
    pub fn target(&self, m: &PuckWorld, from: &State<PuckWorld>) -> PartialState<PuckWorld> {
        use darrt_core::domain::Domain as _;
        let mut target = PartialState::anywhere(m);
        if self.named & 1 == 1 {
            target = target.with_robot(m, if self.met & 1 == 1 { from.robot } else { self.robot.within(m.robot()) });
        }
        for (i, (space, spot)) in m.objects().iter().zip(self.pucks).enumerate() {
            if self.named >> (i + 1) & 1 == 1 {
                let at = if self.met >> (i + 1) & 1 == 1 { from.objects[i] } else { spot.within(space) };
                target = target.with_object(ObjectId::new(i), at);
            }
        }
        target
    }
}

/// A problem with a wall and a pillar; `None` if the start is not valid.
#[must_use]
pub fn problem(m: &PuckWorld, start: &State<PuckWorld>, goal: &PartialState<PuckWorld>) -> Option<Problem<PuckWorld>> {
    let wall = Outline::Rectangle { lower: [1.9, 0.6], upper: [2.1, 2.0] };
    let pillar = Outline::Disc { centre: [3.0, 1.0], radius_m: 0.2 };
    let obstacles =
        vec![Obstacle { name: "wall".into(), outline: wall }, Obstacle { name: "pillar".into(), outline: pillar }];
    Problem::new(Parts {
        domain: m.clone(),
        start: start.clone(),
        goal: Box::new(Reach::new(goal.clone())),
        primitives: primitives(),
        validity: Box::new(Clearance::new(obstacles.clone())),
        verifier: Box::new(Judge::new(obstacles)),
    })
    .ok()
}
