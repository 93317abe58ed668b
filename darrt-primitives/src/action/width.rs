//! Is the robot with its arm at rest too wide for a passage on its way that it could pass with another arm?

use darrt_geom::body::{Body, Part};
use nalgebra::{Isometry3, Vector2, Vector3};

use crate::manipulator::{Configuration, LinkGroup, Manipulator};
use crate::mode::Held;
use crate::tabletop::{Tabletop, TabletopState};

/// A passage lies on the way if the way by it is not longer than this many times the straight one.
const ON_THE_WAY: f64 = 1.5;

/// The passages of one drive, and how wide the robot is.
pub(super) struct Widths<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    held: Option<Held>,
    finger_gap_m: f64,
    /// Widths of the passages on the way that the base passes, metres.
    passages_m: Vec<f64>,
    /// Of the links, with the base at the origin.
    poses: Vec<Isometry3<f64>>,
}

impl<'a, M: Manipulator> Widths<'a, M> {
    /// For a drive from `from` to `target`.
    pub(super) fn new(m: &'a Tabletop<M>, from: &TabletopState<M>, target: &Configuration<M::Joints>) -> Self {
        let poses = vec![Isometry3::identity(); m.manipulator().links().len()];
        let (held, finger_gap_m) = (from.mode.held().copied(), from.mode.gap_m());
        let mut widths = Self { m, held, finger_gap_m, passages_m: Vec::new(), poses };
        let [a, b] = [&from.robot.base, &target.base].map(|[x, y, _]| Vector2::new(*x, *y));
        let gaps = &m.collision_scene().floor_plan().gaps;
        let on_the_way =
            gaps.iter().filter(|gap| (gap.middle - a).norm() + (gap.middle - b).norm() <= ON_THE_WAY * (b - a).norm());
        widths.passages_m.extend(on_the_way.map(|gap| gap.width_m));
        if !widths.passages_m.is_empty() {
            let base_m = widths.width_m(&from.robot.arm, |group| group == LinkGroup::Base);
            widths.passages_m.retain(|passage_m| base_m < *passage_m);
        }
        widths
    }

    /// Is there a passage on the way that the base passes and the robot with this arm does not?
    pub(super) fn is_wide(&mut self, arm: &M::Joints) -> bool {
        if self.passages_m.is_empty() {
            return false;
        }
        let width_m = self.width_m(arm, |_| true);
        self.passages_m.iter().any(|passage_m| *passage_m <= width_m)
    }

    /// From side to side or from front to back, whichever is less, with the least margin on both sides, metres.
    fn width_m(&mut self, arm: &M::Joints, counts: impl Fn(LinkGroup) -> bool) -> f64 {
        let (m, robot) = (self.m, self.m.manipulator());
        let parked = Configuration { base: [0.0; 3], arm: *arm };
        robot.link_poses(&parked, self.finger_gap_m, &mut self.poses);
        let links = robot.links().iter().zip(&self.poses).filter(|(link, _)| counts(link.group));
        let links = links.map(|(link, pose)| (&link.body, *pose));
        let held = self.held.as_ref().filter(|_| counts(LinkGroup::Hand)).and_then(|held| {
            let pose = robot.world_from_tool(&parked) * held.tool_from_object;
            m.movables().get(held.object.index()).map(|movable| (&movable.body, pose))
        });
        let extents = links.chain(held).flat_map(|(body, pose): (&Body, Isometry3<f64>)| {
            body.parts.iter().filter(|part| part.shape.is_bounded()).map(move |part| extent(part, &pose))
        });
        let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let [low, high] = extents.fold(none, |[low, high], extent| {
            [[0, 1].map(|i| low[i].min(extent[0][i])), [0, 1].map(|i| high[i].max(extent[1][i]))]
        });
        let [_, least_m] = m.collision_scene().drive_margins_m(0);
        (high[0] - low[0]).min(high[1] - low[1]) + 2.0 * least_m
    }
}

/// Least and greatest x and y of a part of a body, metres.
fn extent(part: &Part, base_from_body: &Isometry3<f64>) -> [[f64; 2]; 2] {
    let pose = base_from_body * part.body_from_shape;
    let reach =
        |sign: f64, axis: Vector3<f64>| part.shape.support_extent(&pose.inverse_transform_vector(&(axis * sign)));
    let [x, y] = [pose.translation.x, pose.translation.y];
    [
        [x - reach(-1.0, Vector3::x()), y - reach(-1.0, Vector3::y())],
        [x + reach(1.0, Vector3::x()), y + reach(1.0, Vector3::y())],
    ]
}
