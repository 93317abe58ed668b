//! A rail with a cart that carries a turret, and other such carts as objects: the smallest world with two
//! groups per component and an angle.
//!
//! A configuration is `[position, heading]`, metres in `[0, 4]` and radians in `[-pi, pi]`; group 0 is the
//! position, group 1 the heading. One radian counts as one metre.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use crate::domain::Domain;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::space::so2::{turn, wrap};
use crate::space::{ComponentSpace, GroupSet, Place};
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};

/// `[position, heading]`, metres and radians.
pub type Config = [f64; 2];

/// Length of the rail, metres.
pub const RAIL_M: f64 = 4.0;

/// A component space made of functions; [`Sketch::default`] is the honest one.
#[derive(Debug, Clone, Copy)]
pub struct Sketch {
    /// [`ComponentSpace::contains`].
    pub contains: fn(&Config) -> bool,
    /// [`ComponentSpace::distance`].
    pub distance: fn(&Config, &Config) -> f64,
    /// [`ComponentSpace::interpolate`].
    pub interpolate: fn(&Config, &Config, f64) -> Config,
    /// [`ComponentSpace::sample`].
    pub sample: fn(&mut dyn Rng) -> Config,
    /// [`ComponentSpace::overlay`].
    pub overlay: fn(&Config, &Config, GroupSet) -> Config,
    /// [`ComponentSpace::index_coordinates`]: the coordinates of position and heading, the groups in that order.
    pub index_coordinates: fn(&Config) -> [f64; 2],
    /// [`ComponentSpace::tolerance`].
    pub tolerance: f64,
    /// [`ComponentSpace::dimension`].
    pub dimension: usize,
    /// [`ComponentSpace::sample_at`].
    pub sample_at: fn(&mut dyn Rng) -> Option<Config>,
}

impl Default for Sketch {
    fn default() -> Self {
        let sample_at = |rng: &mut dyn Rng| Some([rng.random_range(0.0..=0.2), sample(rng)[1]]);
        let tolerance = 1e-9;
        Self {
            contains: inside,
            distance,
            interpolate,
            sample,
            overlay,
            index_coordinates,
            tolerance,
            dimension: 2,
            sample_at,
        }
    }
}

/// On the rail, with a heading in `[-pi, pi]`.
pub fn inside([x, heading]: &Config) -> bool {
    (0.0..=RAIL_M).contains(x) && (-PI..=PI).contains(heading)
}

/// Metres along the rail, and one per radian.
pub fn distance(a: &Config, b: &Config) -> f64 {
    (a[0] - b[0]).abs() + turn(a[1], b[1]).abs()
}

/// Straight, and round the shorter way.
pub fn interpolate(a: &Config, b: &Config, t: f64) -> Config {
    if t <= 0.0 {
        *a
    } else if t >= 1.0 {
        *b
    } else {
        [a[0] + (b[0] - a[0]) * t, wrap(a[1] + turn(a[1], b[1]) * t)]
    }
}

/// Anywhere.
pub fn sample(rng: &mut dyn Rng) -> Config {
    [rng.random_range(0.0..=RAIL_M), rng.random_range(-PI..=PI)]
}

/// Group by group.
pub fn overlay(from: &Config, target: &Config, groups: GroupSet) -> Config {
    let pick = |group: u32, a: f64, b: f64| if groups.contains(group) { b } else { a };
    [pick(0, from[0], target[0]), pick(1, from[1], target[1])]
}

/// The position, and a point that a turned heading moves away by no more than the turn.
pub fn index_coordinates([x, heading]: &Config) -> [f64; 2] {
    [*x, heading.sin()]
}

impl ComponentSpace for Sketch {
    type Config = Config;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn contains(&self, q: &Config) -> bool {
        (self.contains)(q)
    }

    fn distance(&self, a: &Config, b: &Config) -> f64 {
        (self.distance)(a, b)
    }

    fn interpolate(&self, a: &Config, b: &Config, t: f64) -> Config {
        (self.interpolate)(a, b, t)
    }

    fn sample(&self, rng: &mut dyn Rng) -> Config {
        (self.sample)(rng)
    }

    fn sample_at(&self, _: Place, rng: &mut dyn Rng) -> Option<Config> {
        (self.sample_at)(rng)
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn groups(&self) -> GroupSet {
        GroupSet::first(2)
    }

    fn index_coordinates(&self, q: &Config, mark: &mut dyn FnMut(u32, f64)) {
        (0..).zip((self.index_coordinates)(q)).for_each(|(group, x)| mark(group, x));
    }

    fn overlay(&self, from: &Config, target: &Config, groups: GroupSet) -> Config {
        (self.overlay)(from, target, groups)
    }
}

/// A mode that is a number, in a cell that a careless primitive can write to.
#[derive(Debug, Default)]
pub struct Tag(AtomicU32);

impl Tag {
    /// The mode of this number.
    pub fn new(number: u32) -> Self {
        Self(AtomicU32::new(number))
    }

    /// The number.
    pub fn number(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }

    /// Changes the number behind everybody's back.
    pub fn overwrite(&self, number: u32) {
        self.0.store(number, Ordering::Relaxed);
    }
}

impl Clone for Tag {
    fn clone(&self) -> Self {
        Self::new(self.number())
    }
}

impl PartialEq for Tag {
    fn eq(&self, other: &Self) -> bool {
        self.number() == other.number()
    }
}

/// The world: one robot cart and others.
#[derive(Debug, Clone)]
pub struct Bench {
    /// Space of the robot.
    pub robot: Sketch,
    /// Spaces of the other carts.
    pub objects: Vec<Sketch>,
    /// [`Domain::reach`], by the configurations of robot and object.
    pub reach: fn(&Config, &Config) -> f64,
    /// [`Domain::reach_from`], by the working point and the configuration of the object.
    pub reach_from: fn([f64; 3], &Config) -> f64,
    /// [`Domain::object_point`], the first coordinate, by the configuration of the object.
    pub object_point: fn(&Config) -> f64,
    /// [`Domain::reach_at_least`].
    pub reach_at_least: fn(f64) -> f64,
    /// [`Domain::travel_between`], by the configurations of the two objects.
    pub travel_between: fn(&Config, &Config) -> f64,
    /// [`Domain::may_go_on`].
    pub may_go_on: fn(&Tag, &Tag) -> bool,
    /// [`Domain::carried`].
    pub carried: fn(&Tag) -> ComponentSet,
    /// [`Domain::without_robot`].
    pub without_robot: fn(&Bench) -> Option<Bench>,
    /// [`Domain::component_name`].
    pub name: fn(ComponentId) -> String,
}

impl Default for Bench {
    fn default() -> Self {
        let along = |a: &Config, b: &Config| (a[0] - b[0]).abs();
        Self {
            robot: Sketch::default(),
            objects: vec![Sketch::default(); 2],
            reach: along,
            reach_from: |point, at| (point[0] - at[0]).abs(),
            object_point: |at| at[0],
            reach_at_least: |gap_m| gap_m,
            travel_between: along,
            may_go_on: |mode, next| mode == next,
            carried: |_| ComponentSet::EMPTY,
            without_robot: |_| None,
            name,
        }
    }
}

/// "robot", "cart 0", "cart 1".
pub fn name(component: ComponentId) -> String {
    match component {
        ComponentId::Robot => "robot".to_owned(),
        ComponentId::Object(id) => format!("cart {}", id.index()),
    }
}

impl Domain for Bench {
    type Robot = Sketch;
    type Object = Sketch;
    type Mode = Tag;
    type Contacts = ComponentSet;

    fn robot(&self) -> &Sketch {
        &self.robot
    }

    fn objects(&self) -> &[Sketch] {
        &self.objects
    }

    fn component_name(&self, component: ComponentId) -> Cow<'_, str> {
        Cow::Owned((self.name)(component))
    }

    fn may_go_on(&self, mode: &Tag, next: &Tag) -> bool {
        (self.may_go_on)(mode, next)
    }

    fn carried(&self, mode: &Tag) -> ComponentSet {
        (self.carried)(mode)
    }

    fn without_robot(&self) -> Option<Self> {
        (self.without_robot)(self)
    }

    fn reach(&self, robot: &Config, _: ObjectId, at: &Config) -> f64 {
        (self.reach)(robot, at)
    }

    fn working_point(&self, robot: &Config) -> [f64; 3] {
        [robot[0], 0.0, 0.0]
    }

    fn reach_from(&self, working_point: [f64; 3], _: &Config, _: ObjectId, at: &Config) -> f64 {
        (self.reach_from)(working_point, at)
    }

    fn object_point(&self, _: ObjectId, at: &Config) -> [f64; 3] {
        [(self.object_point)(at), 0.0, 0.0]
    }

    fn reach_at_least(&self, _: ObjectId, gap_m: f64) -> f64 {
        (self.reach_at_least)(gap_m)
    }

    fn travel_between(&self, from: (ObjectId, &Config), to: (ObjectId, &Config)) -> f64 {
        (self.travel_between)(from.1, to.1)
    }
}

/// Robot at `robot`, cart 0 at 2 m and cart 1 at 3 m, mode 0.
pub fn state(robot: Config) -> State<Bench> {
    State { robot, objects: [[2.0, 0.0], [3.0, 0.5]].into_iter().collect(), mode: Tag::default() }
}

/// The robot, all of it, at `robot`.
pub fn robot_at(robot: Config) -> PartialState<Bench> {
    let m = Bench::default();
    PartialState::anywhere(&m).with_robot(&m, robot)
}

/// Cart 0 at `at`, everything else anywhere.
pub fn cart_at(at: Config) -> PartialState<Bench> {
    PartialState::anywhere(&Bench::default()).with_object(cart(), at)
}

/// Cart 0.
pub fn cart() -> ObjectId {
    ObjectId::new(0)
}

/// [`Primitive::propagate`] without its receiver.
pub type Propagate =
    fn(&Bench, &State<Bench>, &PartialState<Bench>, &mut dyn Rng) -> Result<Instances<Bench>, Infeasible>;

/// A primitive made of functions.
#[derive(Debug, Clone, Copy)]
pub struct Act {
    /// [`Primitive::useful`].
    pub useful: fn(&Bench, &State<Bench>, &PartialState<Bench>) -> bool,
    /// [`Primitive::approach`].
    pub approach: fn(&Bench, &State<Bench>, &PartialState<Bench>) -> Option<f64>,
    /// [`Primitive::propagate`].
    pub propagate: Propagate,
}

impl Primitive<Bench> for Act {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(20, "Act")
    }

    fn useful(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> bool {
        (self.useful)(m, from, to)
    }

    fn approach(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> Option<f64> {
        (self.approach)(m, from, to)
    }

    fn propagate(
        &self,
        m: &Bench,
        from: &State<Bench>,
        to: &PartialState<Bench>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Bench>, Infeasible> {
        (self.propagate)(m, from, to, rng)
    }
}

/// [`Validity::check`] without its receiver, with the wall first.
pub type Check = fn((f64, f64), &State<Bench>, ComponentSet) -> Result<(), Blame>;

/// A validity made of functions; [`Rule::default`] is the honest one.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// The robot may not be on `[wall.0, wall.1]` metres of the rail.
    pub wall: (f64, f64),
    /// [`Validity::check`], with the wall first.
    pub check: Check,
    /// [`Validity::free_prefix`].
    pub free_prefix: fn(&Self, &Bench, &Instance<Bench>, &State<Bench>) -> FreePrefix,
}

impl Default for Rule {
    fn default() -> Self {
        Self { wall: (1.0, 1.5), check, free_prefix: |rule, m, instance, from| scan(rule, m, instance, from, 1e-3) }
    }
}

/// Closer than this along the rail, carts touch; metres.
pub const TOUCH_M: f64 = 0.1;

/// Everything is on the rail, and the robot keeps off the wall, and off the carts that it may not touch.
///
/// # Errors
/// The blame.
pub fn check(wall: (f64, f64), state: &State<Bench>, contacts: ComponentSet) -> Result<(), Blame> {
    let x = state.robot[0];
    let all = std::iter::once((ComponentId::Robot, &state.robot));
    let objects = state.objects.iter().enumerate().map(|(i, at)| (ComponentId::Object(ObjectId::new(i)), at));
    for (id, at) in all.chain(objects) {
        if !inside(at) {
            return Err(Blame { first: name(id).into(), ..blame(BlockKind::Limits, "ends of the rail", 0.0) });
        }
    }
    if wall.0 <= x && x <= wall.1 {
        return Err(blame(BlockKind::RobotFixed, "wall", x));
    }
    for (i, cart) in state.objects.iter().enumerate() {
        let id = ComponentId::Object(ObjectId::new(i));
        if (cart[0] - x).abs() < TOUCH_M && !contacts.contains(id) {
            return Err(blame(BlockKind::RobotObject, &name(id), x));
        }
    }
    Ok(())
}

/// The robot meets `second` at `x` metres of the rail.
pub fn blame(kind: BlockKind, second: &str, x: f64) -> Blame {
    Blame { kind, first: Arc::from("robot"), second: Arc::from(second), place: [x, 0.0, 0.0] }
}

/// Looks every `step_m` metres of motion, at both ends too, and goes back one step from the first state
/// that is not valid.
pub fn scan(rule: &Rule, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>, step_m: f64) -> FreePrefix {
    let steps = (instance.motion.length() / step_m).ceil().max(1.0);
    let (mut free, mut i) = (0.0, 0.0);
    while i <= steps {
        let t = i / steps;
        if let Err(blame) = (rule.check)(rule.wall, &instance.at(m, t, from), instance.contacts) {
            return FreePrefix::blocked(free, blame);
        }
        free = t;
        i += 1.0;
    }
    FreePrefix::FREE
}

impl Validity<Bench> for Rule {
    fn check(&self, _: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), Blame> {
        (self.check)(self.wall, state, *contacts)
    }

    fn free_prefix(&self, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        (self.free_prefix)(self, m, instance, from)
    }
}
