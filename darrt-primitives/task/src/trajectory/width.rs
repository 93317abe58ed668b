//! How wide a hand is open: the gap between its tips, from their shapes.

use darrt_geom::Body;
use darrt_primitives::kinematics::{KinematicTree, link_bodies};
use nalgebra::{Isometry3, Vector3};

use crate::clock::ClockError;
use crate::robot::RobotFacts;

/// The tips of a hand and the axis along which it opens.
#[derive(Debug)]
pub struct HandWidth {
    tree: KinematicTree,
    tool: usize,
    /// That on the side of +y of the tool first.
    tips: [(usize, Option<Body>); 2],
}

impl HandWidth {
    /// The hand of a robot.
    ///
    /// # Errors
    /// [`ClockError::Robot`] when a link is not there or its shape cannot be used.
    pub fn new(facts: &RobotFacts) -> Result<Self, ClockError> {
        let refuse = |error: &dyn std::fmt::Display| ClockError::Robot(error.to_string());
        let tree = KinematicTree::new(&facts.description).map_err(|e| refuse(&e))?;
        let mut bodies = link_bodies(&facts.description, &tree, &facts.meshes.paths()).map_err(|e| refuse(&e))?;
        let link = |name: &str| tree.link_index(name).ok_or_else(|| refuse(&format!("it has no link `{name}`")));
        let tool = link(&facts.tool_link)?;
        let [left, right] = [link(&facts.tip_links[0])?, link(&facts.tip_links[1])?];
        let mut body = |link: usize| (link, bodies.get_mut(link).and_then(Option::take));
        let tips = [body(left), body(right)];
        Ok(Self { tree, tool, tips })
    }

    /// The gap between the inner faces of the tips with these values of the tree's variables, metres, at least 0. Tips without
    /// shapes count as points.
    pub fn gap_m(&self, joints: &[f64]) -> f64 {
        let mut links = vec![Isometry3::identity(); self.tree.link_count()];
        if self.tree.forward(joints, &Isometry3::identity(), &mut links).is_err() {
            return 0.0;
        }
        let pose = |link: usize| links.get(link).copied().unwrap_or_default();
        let across = pose(self.tool).rotation * Vector3::y();
        let [left, right] = &self.tips;
        // The innermost point of either tip along the opening axis.
        let reach = |(link, body): &(usize, Option<Body>), inward: Vector3<f64>| {
            let tip = pose(*link);
            let parts = body.iter().flat_map(|body| &body.parts);
            let reaches = parts.map(|part| {
                let placed = tip * part.body_from_shape;
                placed.translation.vector.dot(&inward)
                    + part.shape.support_extent(&(placed.rotation.inverse() * inward))
            });
            let reach = reaches.fold(f64::NEG_INFINITY, f64::max);
            if reach.is_finite() { reach } else { tip.translation.vector.dot(&inward) }
        };
        (-reach(left, -across) - reach(right, across)).max(0.0)
    }
}
