//! The robot on the straight line of its space, everything else at rest.

use std::fmt;

use super::Motion;
use crate::domain::Domain;
use crate::space::ComponentSpace;
use crate::state::{RobotConfig, State};

/// Moves the robot along `interpolate`; objects and mode stay.
pub struct Straight<D: Domain> {
    from: State<D>,
    to: RobotConfig<D>,
    length_m: f64,
}

impl<D: Domain> Straight<D> {
    /// The motion from `from` to robot configuration `to`. `length_m` must bound the travel of every point
    /// of the robot and must grow in proportion to `t` (law of [`Motion`]).
    pub fn new(from: State<D>, to: RobotConfig<D>, length_m: f64) -> Self {
        Self { from, to, length_m }
    }
}

impl<D: Domain> Motion<D> for Straight<D> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        out.clone_from(&self.from);
        out.robot = m.robot().interpolate(&self.from.robot, &self.to, t.clamp(0.0, 1.0));
    }
}

impl<D: Domain> fmt::Debug for Straight<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Straight")
            .field("from", &self.from)
            .field("to", &self.to)
            .field("length_m", &self.length_m)
            .finish()
    }
}
