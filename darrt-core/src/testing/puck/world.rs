//! M: a disc robot and round pucks on a rectangular floor.

use std::borrow::Cow;
use std::sync::Arc;

use super::plane;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::space::RealBox;
use crate::state::{ComponentId, ComponentSet, ObjectId, PerObject, State};

/// `[x, y]` of a centre, metres, in the frame whose origin is the lower left corner of the floor.
pub type Point = [f64; 2];

/// One puck.
#[derive(Debug, Clone, PartialEq)]
pub struct Puck {
    /// Its name, for people.
    pub name: Arc<str>,
    /// Metres.
    pub radius_m: f64,
    /// Can the robot grab it?
    pub is_graspable: bool,
}

/// How the robot and one puck belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Grip {
    /// The puck lies on the floor.
    Resting,
    /// The puck moves with the robot.
    Held {
        /// `puck - robot`, metres.
        offset: Point,
    },
}

/// What is held, and what the robot touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// One grip per puck; at most one is held.
    pub grips: PerObject<Grip>,
    /// The puck that the robot touches on purpose without holding it.
    pub touching: Option<ObjectId>,
}

impl Mode {
    /// All of `count` pucks rest, and the robot touches none.
    pub fn resting(count: usize) -> Self {
        Self { grips: (0..count).map(|_| Grip::Resting).collect(), touching: None }
    }

    /// The held puck and its offset from the robot.
    pub fn held(&self) -> Option<(ObjectId, Point)> {
        self.grips.iter().enumerate().find_map(|(i, grip)| match grip {
            Grip::Held { offset } => Some((ObjectId::new(i), *offset)),
            Grip::Resting => None,
        })
    }

    /// This mode, touching nothing but `puck`.
    #[must_use]
    pub fn touching(&self, puck: Option<ObjectId>) -> Self {
        Self { grips: self.grips.clone(), touching: puck }
    }

    /// This mode with `grip` on `puck`.
    #[must_use]
    pub fn with_grip(&self, puck: ObjectId, grip: Grip) -> Self {
        let mut mode = self.clone();
        if let Some(slot) = mode.grips.get_mut(puck.index()) {
            *slot = grip;
        }
        mode
    }
}

/// The robot and the pucks; the obstacles are not here (see [`Clearance`](super::Clearance)).
#[derive(Debug, Clone, PartialEq)]
pub struct PuckWorld {
    robot: RealBox<2>,
    robot_radius_m: f64,
    pucks: Vec<Puck>,
    spaces: Vec<RealBox<2>>,
}

impl PuckWorld {
    /// A floor of `size` metres with a robot and pucks that stay on it with their whole discs.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a radius is not positive, or too large for the floor.
    pub fn new(size: Point, robot_radius_m: f64, pucks: Vec<Puck>) -> Result<Self, Error> {
        let robot = disc_space("radius of the robot", size, robot_radius_m)?;
        let spaces = pucks.iter().map(|p| disc_space(&format!("radius of puck {}", p.name), size, p.radius_m));
        Ok(Self { robot, robot_radius_m, spaces: spaces.collect::<Result<_, _>>()?, pucks })
    }

    /// Radius of the robot, metres.
    pub fn robot_radius(&self) -> f64 {
        self.robot_radius_m
    }

    /// The pucks, by id.
    pub fn pucks(&self) -> &[Puck] {
        &self.pucks
    }

    /// One puck.
    pub fn puck(&self, id: ObjectId) -> Option<&Puck> {
        self.pucks.get(id.index())
    }

    /// Metres between the centres of robot and puck when their rims touch.
    pub fn touch_distance(&self, id: ObjectId) -> f64 {
        self.robot_radius_m + self.puck(id).map_or(0.0, |p| p.radius_m)
    }

    /// Metres between the rims of robot and puck; negative if they overlap.
    pub fn gap(&self, state: &State<Self>, id: ObjectId) -> f64 {
        state.object(id).map_or(f64::INFINITY, |at| plane::distance(&state.robot, at) - self.touch_distance(id))
    }

    /// The ids of all pucks.
    pub fn ids(&self) -> impl Iterator<Item = ObjectId> + use<> {
        (0..self.pucks.len()).map(ObjectId::new)
    }
}

impl Domain for PuckWorld {
    type Robot = RealBox<2>;
    type Object = RealBox<2>;
    type Mode = Mode;
    /// The pucks that the robot may touch.
    type Contacts = ComponentSet;

    fn robot(&self) -> &RealBox<2> {
        &self.robot
    }

    fn objects(&self) -> &[RealBox<2>] {
        &self.spaces
    }

    fn component_name(&self, component: ComponentId) -> Cow<'_, str> {
        match component {
            ComponentId::Robot => Cow::Borrowed("robot"),
            ComponentId::Object(id) => self.puck(id).map_or(Cow::Borrowed("no puck"), |p| Cow::Borrowed(&*p.name)),
        }
    }

    fn carried(&self, mode: &Mode) -> ComponentSet {
        mode.held().map_or(ComponentSet::EMPTY, |(id, _)| ComponentSet::EMPTY.with(ComponentId::Object(id)))
    }

    fn reach(&self, robot: &Point, object: ObjectId, at: &Point) -> f64 {
        (plane::distance(robot, at) - self.touch_distance(object)).max(0.0)
    }

    fn working_point(&self, robot: &Point) -> [f64; 3] {
        [robot[0], robot[1], 0.0]
    }

    fn object_point(&self, _: ObjectId, at: &Point) -> [f64; 3] {
        [at[0], at[1], 0.0]
    }

    fn reach_at_least(&self, object: ObjectId, gap_m: f64) -> f64 {
        (gap_m - self.touch_distance(object)).max(0.0)
    }

    fn travel_between(&self, from: (ObjectId, &Point), to: (ObjectId, &Point)) -> f64 {
        // From somewhere around one puck to somewhere around the other.
        (plane::distance(from.1, to.1) - self.touch_distance(from.0) - self.touch_distance(to.0)).max(0.0)
    }
}

/// The centres that keep a disc on the floor.
fn disc_space(name: &str, size: Point, radius_m: f64) -> Result<RealBox<2>, Error> {
    for side in size {
        in_range("side of the floor", side, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
    }
    let largest = size[0].min(size[1]) / 2.0;
    in_range(name, radius_m, f64::MIN_POSITIVE, largest, "positive and at most half a side of the floor")?;
    RealBox::new([radius_m; 2], [size[0] - radius_m, size[1] - radius_m])
}
