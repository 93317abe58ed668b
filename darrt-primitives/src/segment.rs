//! One segment of a motion: what moves on it, what that may meet, and how fast.

use darrt_core::space::so2::turn;
use darrt_geom::body_set::{BodyIndex, BodySet};
use nalgebra::Isometry3;

use crate::collision_scene::{CollisionScene, Worker};
use crate::manipulator::Manipulator;
use crate::push::slide::Slide;
use crate::tabletop::{Tabletop, TabletopState};

/// One segment of a motion: the robot moves in a straight line of its space, and what is pushed on an arc.
#[derive(Debug)]
pub(crate) struct Segment {
    /// Parameter at its beginning.
    pub(crate) begin: f64,
    /// Parameter at its end.
    pub(crate) end: f64,
    /// What moves.
    pub(crate) moved: BodySet,
    /// What it may meet: all but what moves rigidly with it.
    against: BodySet,
    /// The links, and what is held.
    chain: BodySet,
    /// Bound on the metres by which any pair approaches per unit of the parameter.
    pub(crate) fastest: f64,
}

impl Segment {
    /// What moves from `a`, where every body stands, to `b`, and how fast each body travels: written to `worker.reach`,
    /// metres per unit of the parameter, which goes from `begin` to `end`.
    pub(crate) fn new<M: Manipulator>(
        m: &Tabletop<M>,
        a: &TabletopState<M>,
        b: &TabletopState<M>,
        (begin, end): (f64, f64),
        worker: &mut Worker,
    ) -> Self {
        let around = &**m.collision_scene();
        let span = end - begin;
        let mut moved = around.moved(a, b);
        let mut chain = *around.all_links();
        let drives = a.robot.arm == b.robot.arm && a.robot.base != b.robot.base;
        let mut held_travel = 0.0;
        if a.robot == b.robot {
            worker.link_travel.fill(0.0);
        } else {
            let reach_m = m.held_reach_m(&a.mode);
            held_travel = m.manipulator().link_travel_m(&a.robot, &b.robot, reach_m, &mut worker.link_travel);
        }
        worker.reach.fill(0.0);
        let mut fastest = 0.0_f64;
        for ((id, travel), pose) in around.links().iter().zip(&worker.link_travel).zip(&worker.poses) {
            let travel = if drives { travel.min(drive_travel(around, *id, pose, a, b)) } else { *travel };
            if let Some(slot) = worker.reach.get_mut(id.get()) {
                *slot = travel / span;
                fastest = fastest.max(*slot);
            }
        }
        let fastest_link = fastest;
        for (i, ((id, from), to)) in around.objects().iter().zip(&a.objects).zip(&b.objects).enumerate() {
            let Some(slot) = worker.reach.get_mut(id.get()) else { continue };
            if a.mode.held().is_some_and(|held| held.object.index() == i) {
                chain.insert(*id);
                let travel = if drives { held_travel.min(drive_travel(around, *id, from, a, b)) } else { held_travel };
                *slot = travel / span;
                fastest = fastest.max(*slot);
            } else {
                *slot = slide_travel(around, *id, from, to) / span;
                fastest = fastest.max(fastest_link + *slot);
            }
        }
        // A held object that happens to end where it began moves in between.
        if let Some(id) = a.mode.held().and_then(|held| around.objects().get(held.object.index()))
            && a.robot != b.robot
        {
            moved.insert(*id);
        }
        // A robot that drives with its arm at rest moves as one body, with what it holds.
        let against = if drives { BodySet::ALL.difference(&moved) } else { BodySet::ALL };
        Self { begin, end, moved, against, chain, fastest }
    }

    /// Begins to watch the pairs that may come near on this segment; see [`CollisionScene::free_until`].
    pub(crate) fn watch(&self, around: &CollisionScene, worker: &mut Worker) {
        around.watch(worker, (&self.moved, &self.against, &self.chain), (self.begin, self.end));
    }
}

/// Bound on the travel of a body that slides from one pose to another.
fn slide_travel(around: &CollisionScene, body: BodyIndex, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
    let slide = Slide::new(*from, *to);
    let turned = match around.model().ball(body) {
        _ if slide.turn() == 0.0 => 0.0,
        Some((centre, radius)) => slide.turn().abs() * (centre.coords.norm() + radius),
        None => f64::INFINITY,
    };
    slide.length_m() + turned
}

/// Bound on the travel of a body, now at `pose`, that turns about the axis of the base and drives with it.
fn drive_travel<M: Manipulator>(
    around: &CollisionScene,
    body: BodyIndex,
    pose: &Isometry3<f64>,
    a: &TabletopState<M>,
    b: &TabletopState<M>,
) -> f64 {
    let Some((centre, radius)) = around.model().ball(body) else { return f64::INFINITY };
    let [x, y, yaw] = a.robot.base;
    let drive = (b.robot.base[0] - x).hypot(b.robot.base[1] - y);
    let centre = pose * centre;
    drive + turn(yaw, b.robot.base[2]).abs() * ((centre.x - x).hypot(centre.y - y) + radius)
}
