//! A full configuration of robot and objects with its mode, and the names of its components.

use std::fmt;

use smallvec::SmallVec;

use crate::domain::Domain;
use crate::space::ComponentSpace;

/// Configuration of the robot of domain `D`.
pub type RobotConfig<D> = <<D as Domain>::Robot as ComponentSpace>::Config;
/// Configuration of one object of domain `D`.
pub type ObjectConfig<D> = <<D as Domain>::Object as ComponentSpace>::Config;
/// Per-object values; inline for up to two objects.
pub type PerObject<T> = SmallVec<[T; 2]>;

/// Index of a movable object in its domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(u16);

impl ObjectId {
    /// The object with this index; indices past `u16::MAX` saturate and so name no object.
    pub fn new(index: usize) -> Self {
        Self(u16::try_from(index).unwrap_or(u16::MAX))
    }

    /// Position in [`State::objects`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A movable component, one of `{R, o_1 ... o_n}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ComponentId {
    /// The robot R.
    Robot,
    /// One object.
    Object(ObjectId),
}

/// A set of movable components; the robot and at most [`ComponentSet::MAX_OBJECTS`] objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct ComponentSet(u64);

impl ComponentSet {
    /// How many objects a domain may have.
    pub const MAX_OBJECTS: usize = 63;
    /// No component.
    pub const EMPTY: Self = Self(0);
    /// The robot alone.
    pub const ROBOT: Self = Self(1);

    fn bit(component: ComponentId) -> u64 {
        match component {
            ComponentId::Robot => 1,
            ComponentId::Object(id) if id.index() < Self::MAX_OBJECTS => 2 << id.index(),
            ComponentId::Object(_) => 0,
        }
    }

    /// This set with `component`.
    #[must_use]
    pub fn with(self, component: ComponentId) -> Self {
        Self(self.0 | Self::bit(component))
    }

    /// Is `component` in the set?
    pub fn contains(self, component: ComponentId) -> bool {
        self.0 & Self::bit(component) != 0
    }

    /// Components in either set.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Is every component of this set in `other`?
    pub fn is_subset_of(self, other: Self) -> bool {
        self.0 & other.0 == self.0
    }

    /// Is the set empty?
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// How many components it names.
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }
}

/// A configuration of every movable component, and the mode it is in.
pub struct State<D: Domain> {
    /// Configuration of the robot.
    pub robot: RobotConfig<D>,
    /// Configuration of each object, by [`ObjectId`].
    pub objects: PerObject<ObjectConfig<D>>,
    /// What is held, what rests on what.
    pub mode: D::Mode,
}

impl<D: Domain> State<D> {
    /// Configuration of one object; `None` if the domain has no such object.
    pub fn object(&self, id: ObjectId) -> Option<&ObjectConfig<D>> {
        self.objects.get(id.index())
    }

    /// Do the two states agree in every component within its tolerance, and in the mode?
    pub fn is_near(&self, m: &D, other: &Self) -> bool {
        let robot = m.robot();
        self.mode == other.mode
            && robot.distance(&self.robot, &other.robot) <= robot.tolerance()
            && self.objects.len() == other.objects.len()
            && (m.objects().iter().zip(&self.objects).zip(&other.objects))
                .all(|((space, a), b)| space.distance(a, b) <= space.tolerance())
    }
}

impl<D: Domain> Clone for State<D> {
    fn clone(&self) -> Self {
        Self { robot: self.robot.clone(), objects: self.objects.clone(), mode: self.mode.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.robot.clone_from(&source.robot);
        self.objects.clone_from(&source.objects);
        self.mode.clone_from(&source.mode);
    }
}

impl<D: Domain> PartialEq for State<D> {
    fn eq(&self, other: &Self) -> bool {
        self.robot == other.robot && self.objects == other.objects && self.mode == other.mode
    }
}

impl<D: Domain> fmt::Debug for State<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("State")
            .field("robot", &self.robot)
            .field("objects", &self.objects)
            .field("mode", &self.mode)
            .finish()
    }
}
