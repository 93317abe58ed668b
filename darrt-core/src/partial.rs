//! A partially specified configuration: the samples of paper section 4.2.
//!
//! Only the named components count; an unnamed component may be anywhere, and no primitive may use it as
//! a target. A partial state has no mode: nobody samples what is held.

use std::fmt;

use crate::domain::Domain;
use crate::error::Error;
use crate::random::{Purpose, stream};
use crate::space::{ComponentSpace, GroupSet};
use crate::state::{ComponentId, ComponentSet, ObjectConfig, ObjectId, PerObject, RobotConfig, State};

/// Where the robot should be; only the named groups count.
pub struct RobotTarget<D: Domain> {
    /// The target configuration; meaningless outside `groups`.
    pub config: RobotConfig<D>,
    /// The groups (base, arm, ...) that the target names.
    pub groups: GroupSet,
}

impl<D: Domain> Clone for RobotTarget<D> {
    fn clone(&self) -> Self {
        Self { config: self.config.clone(), groups: self.groups }
    }
}

impl<D: Domain> PartialEq for RobotTarget<D> {
    fn eq(&self, other: &Self) -> bool {
        self.config == other.config && self.groups == other.groups
    }
}

impl<D: Domain> fmt::Debug for RobotTarget<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RobotTarget").field("config", &self.config).field("groups", &self.groups).finish()
    }
}

/// Configurations for some of the components.
///
/// # Laws
/// `overlay(s)` meets this target for every `s`; the empty target is met by every state.
pub struct PartialState<D: Domain> {
    robot: Option<RobotTarget<D>>,
    objects: PerObject<Option<ObjectConfig<D>>>,
}

impl<D: Domain> PartialState<D> {
    /// The target that every state meets.
    pub fn anywhere(m: &D) -> Self {
        Self { robot: None, objects: m.objects().iter().map(|_| None).collect() }
    }

    /// The target that names every component of `state`.
    pub fn of_state(m: &D, state: &State<D>) -> Self {
        let robot = RobotTarget { config: state.robot.clone(), groups: m.robot().groups() };
        Self { robot: Some(robot), objects: state.objects.iter().cloned().map(Some).collect() }
    }

    /// This target with the whole robot at `config`.
    #[must_use]
    pub fn with_robot(self, m: &D, config: RobotConfig<D>) -> Self {
        let groups = m.robot().groups();
        self.with_robot_groups(config, groups)
    }

    /// This target with the named groups of the robot as in `config`. No groups: the robot is unnamed.
    #[must_use]
    pub fn with_robot_groups(mut self, config: RobotConfig<D>, groups: GroupSet) -> Self {
        self.robot = (!groups.is_empty()).then_some(RobotTarget { config, groups });
        self
    }

    /// This target with `object` at `config`; unchanged if the domain has no such object.
    #[must_use]
    pub fn with_object(mut self, object: ObjectId, config: ObjectConfig<D>) -> Self {
        if let Some(slot) = self.objects.get_mut(object.index()) {
            *slot = Some(config);
        }
        self
    }

    /// What it asks of the robot.
    pub fn robot(&self) -> Option<&RobotTarget<D>> {
        self.robot.as_ref()
    }

    /// What it asks of one object.
    pub fn object(&self, id: ObjectId) -> Option<&ObjectConfig<D>> {
        self.objects.get(id.index())?.as_ref()
    }

    /// The named objects and their targets, by id.
    pub fn objects(&self) -> impl Iterator<Item = (ObjectId, &ObjectConfig<D>)> {
        self.objects.iter().enumerate().filter_map(|(i, o)| Some((ObjectId::new(i), o.as_ref()?)))
    }

    /// The named components.
    pub fn components(&self) -> ComponentSet {
        let robot = if self.robot.is_some() { ComponentSet::ROBOT } else { ComponentSet::EMPTY };
        self.objects().fold(robot, |set, (id, _)| set.with(ComponentId::Object(id)))
    }

    /// The robot configuration that `from` must take to meet the robot part (`from` itself if unnamed).
    pub fn robot_overlay(&self, m: &D, from: &RobotConfig<D>) -> RobotConfig<D> {
        match &self.robot {
            Some(target) => m.robot().overlay(from, &target.config, target.groups),
            None => from.clone(),
        }
    }

    /// `from` with every named component at its target; the mode is kept.
    #[must_use]
    pub fn overlay(&self, m: &D, from: &State<D>) -> State<D> {
        let mut state = from.clone();
        state.robot = self.robot_overlay(m, &from.robot);
        for (slot, target) in state.objects.iter_mut().zip(&self.objects) {
            if let Some(target) = target {
                *slot = target.clone();
            }
        }
        state
    }

    /// Is the robot part met?
    pub fn is_robot_met(&self, m: &D, state: &State<D>) -> bool {
        let robot = m.robot();
        self.robot.is_none() || robot.distance(&state.robot, &self.robot_overlay(m, &state.robot)) <= robot.tolerance()
    }

    /// Is the part for one object met? An unnamed object is.
    pub fn is_object_met(&self, m: &D, state: &State<D>, id: ObjectId) -> bool {
        match (self.object(id), state.object(id), m.objects().get(id.index())) {
            (Some(target), Some(config), Some(space)) => space.distance(config, target) <= space.tolerance(),
            (target, _, _) => target.is_none(),
        }
    }

    /// Are all named objects where they should be?
    pub fn are_objects_met(&self, m: &D, state: &State<D>) -> bool {
        self.objects().all(|(id, _)| self.is_object_met(m, state, id))
    }

    /// Is every named component within tolerance of its target?
    pub fn is_met(&self, m: &D, state: &State<D>) -> bool {
        self.are_objects_met(m, state) && self.is_robot_met(m, state)
    }

    /// Does this target name only what `other` names, with the same values?
    pub fn is_subset_of(&self, m: &D, other: &Self) -> bool {
        let robot = match (&self.robot, &other.robot) {
            (None, _) => true,
            // Outside the named groups a configuration means nothing.
            (Some(a), Some(b)) => {
                b.groups.covers(a.groups) && m.robot().overlay(&b.config, &a.config, a.groups) == b.config
            }
            (Some(_), None) => false,
        };
        robot && self.objects().all(|(id, config)| other.object(id) == Some(config))
    }

    /// Everything this target names, and from `other` what this one leaves open.
    #[must_use]
    pub fn or(mut self, m: &D, other: &Self) -> Self {
        self.robot = match (self.robot.take(), &other.robot) {
            (Some(a), Some(b)) => Some(RobotTarget {
                config: m.robot().overlay(&b.config, &a.config, a.groups),
                groups: a.groups.union(b.groups),
            }),
            (a, b) => a.or_else(|| b.clone()),
        };
        for (slot, theirs) in self.objects.iter_mut().zip(&other.objects) {
            if slot.is_none() {
                slot.clone_from(theirs);
            }
        }
        self
    }

    /// Checks the number of objects and that every named component lies in its space.
    ///
    /// # Errors
    /// [`Error::ObjectCount`] or [`Error::GoalOutside`] with the component and its configuration.
    pub fn check(&self, m: &D) -> Result<(), Error> {
        if self.objects.len() != m.objects().len() {
            return Err(Error::ObjectCount {
                what: "the target",
                found: self.objects.len(),
                expected: m.objects().len(),
            });
        }
        let outside = |component: ComponentId, config: String| Error::GoalOutside {
            component: m.component_name(component).into_owned(),
            config,
        };
        if let Some(target) = &self.robot {
            // The groups that it leaves open are filled from a configuration that does lie in the space.
            let within = m.robot().sample(&mut stream(0, 0, 0, Purpose::Attempt));
            if !m.robot().contains(&m.robot().overlay(&within, &target.config, target.groups)) {
                return Err(outside(ComponentId::Robot, format!("{:?}", target.config)));
            }
        }
        for ((id, config), space) in self.objects().filter_map(|o| Some((o, m.objects().get(o.0.index())?))) {
            if !space.contains(config) {
                return Err(outside(ComponentId::Object(id), format!("{config:?}")));
            }
        }
        Ok(())
    }
}

impl<D: Domain> Clone for PartialState<D> {
    fn clone(&self) -> Self {
        Self { robot: self.robot.clone(), objects: self.objects.clone() }
    }
}

impl<D: Domain> PartialEq for PartialState<D> {
    fn eq(&self, other: &Self) -> bool {
        self.robot == other.robot && self.objects == other.objects
    }
}

impl<D: Domain> fmt::Debug for PartialState<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PartialState").field("robot", &self.robot).field("objects", &self.objects).finish()
    }
}
