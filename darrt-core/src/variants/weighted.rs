//! Sum and maximum of weighted distances in the subspaces, for comparison with the tours.

use crate::distance::Distance;
use crate::distance::euclidean::object_travel;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::nearest::bounds::{Lanes, Ways};
use crate::nearest::pruned::nearest_pruned;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::State;
use crate::tree::{NodeId, Tree};

/// How the distances of the components become one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    Sum,
    Maximum,
}

/// Weighted sum, or maximum, of the distances of the named components to their targets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weighted {
    rule: Rule,
    robot: f64,
    object: f64,
}

impl Weighted {
    /// The sum of `robot` times the distance of the robot and `object` times that of every object.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a weight that is not finite and positive.
    pub fn sum(robot: f64, object: f64) -> Result<Self, Error> {
        Self::new(Rule::Sum, robot, object)
    }

    /// The largest of these. The authors' later software measured so, with equal weights; what is nearer than the largest
    /// does not count.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a weight that is not finite and positive.
    pub fn maximum(robot: f64, object: f64) -> Result<Self, Error> {
        Self::new(Rule::Maximum, robot, object)
    }

    fn new(rule: Rule, robot: f64, object: f64) -> Result<Self, Error> {
        let weight = |name, value| in_range(name, value, f64::MIN_POSITIVE, 1e6, "positive and at most 1e6");
        Ok(Self { rule, robot: weight("weight of the robot", robot)?, object: weight("weight of an object", object)? })
    }

    fn at_least(&self, ways: &Ways, out: &mut Lanes) {
        // Rounded down, so that the weights make no bound too large.
        let weight = |w: f64| crate::nearest::coordinate_index::narrow(w * (1.0 - 1e-6));
        *out = [0.0; crate::nearest::bounds::LANES];
        let robot = ways.robot_m.iter().map(|way_m| (weight(self.robot), way_m));
        let objects = ways.objects.iter().map(|object| (weight(self.object), &object.way_m));
        for (weight, way_m) in robot.chain(objects) {
            for (out, way) in out.iter_mut().zip(way_m) {
                *out = crate::nearest::coordinate_index::narrow(self.join(f64::from(*out), f64::from(weight * way)));
            }
        }
    }

    fn join(&self, a: f64, b: f64) -> f64 {
        match self.rule {
            Rule::Sum => a + b,
            // A distance that is no number is not the smaller one.
            Rule::Maximum if b > a || b.is_nan() => b,
            Rule::Maximum => a,
        }
    }
}

impl<D: Domain> Distance<D> for Weighted {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        let robot = match to.robot() {
            Some(_) => self.robot * m.robot().distance(&from.robot, &to.robot_overlay(m, &from.robot)),
            None => 0.0,
        };
        let objects = to.objects().map(|(id, target)| self.object * object_travel(m, from, id, target));
        objects.fold(robot, |all, way| self.join(all, way))
    }

    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        nearest_pruned(m, tree, to, |ways, out| self.at_least(ways, out), |node| self.distance(m, &node.state, to))
    }
}
