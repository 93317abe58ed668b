//! The arm with what it holds, rigid on the base: what a drive carries through the room.

use darrt_geom::body_set::{BodyIndex, BodySet};
use nalgebra::Isometry3;

use super::{CollisionScene, Strict};
use crate::manipulator::{Configuration, Manipulator, world_from_base};
use crate::mode::Contacts;
use crate::tabletop::TabletopState;

/// Links of an arm and the object in its hand, as they stand to the base.
#[derive(Debug, Clone, Default)]
pub struct Load {
    base_from_body: Vec<(BodyIndex, Isometry3<f64>)>,
    /// All links of the robot, for their poses.
    poses: Vec<Isometry3<f64>>,
}

impl CollisionScene {
    /// Takes the arm of `state` with what it holds as `out`.
    pub fn load<M: Manipulator>(&self, robot: &M, state: &TabletopState<M>, out: &mut Load) {
        let at_origin = Configuration { base: [0.0; 3], arm: state.robot.arm };
        out.poses.resize(self.links.len(), Isometry3::identity());
        robot.link_poses(&at_origin, state.mode.gap_m(), &mut out.poses);
        let links = self.links.iter().copied().zip(out.poses.iter().copied());
        out.base_from_body.clear();
        out.base_from_body.extend(links.filter(|(id, _)| self.arm_links.contains(*id)));
        let held = state.mode.held().and_then(|held| {
            let pose = robot.world_from_tool(&at_origin) * held.tool_from_object;
            Some((*self.objects.get(held.object.index())?, pose))
        });
        out.base_from_body.extend(held);
    }

    /// The first of `bases` at which something of the room, or an object that is not held, is in the way of the load, with this
    /// [care](CollisionScene::most_care). `like` says where the objects are, and what is held. `None`: at none.
    pub fn load_blocked<'a, M: Manipulator>(
        &self,
        load: &Load,
        like: &TabletopState<M>,
        bases: impl IntoIterator<Item = &'a [f64; 3]>,
        care: usize,
    ) -> Option<usize> {
        self.with_worker(|worker| {
            self.set_rules(like, &Contacts::default(), Strict::with(care), worker);
            self.pose_objects(like, worker);
            let moved: BodySet = load.base_from_body.iter().map(|(id, _)| *id).collect();
            let against = BodySet::ALL.difference(&self.all_links).difference(&moved);
            bases.into_iter().position(|base| {
                let world_from_base = world_from_base(base);
                for (id, base_from_body) in &load.base_from_body {
                    self.model.set_pose(&mut worker.scratch, *id, &(world_from_base * base_from_body));
                }
                !self.is_clear(worker, &moved, &against)
            })
        })
    }
}
