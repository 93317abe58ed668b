//! What the fingers do to objects: gripping one, pushing one.

use std::sync::Arc;

use darrt_geom::{Clearance, Shape, clearance};
use nalgebra::{Isometry3, Point2, Vector2, Vector3};

use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::Robot;
use super::solid::{Placed, Solid, exact, lower_bound};
use super::stage::Stage;
use crate::problem_file::{Object, ShapeSpec};

/// What rounding may do to a curvature, 1/m.
const CURVATURE_ROUNDING: f64 = 1e-6;

/// Standard gravity.
const GRAVITY_M_S2: f64 = 9.81;

/// Half the thickness of the sheet between the fingers that must meet a held object, metres.
const SHEET_M: f64 = 5e-4;

/// The object is in the hand: near both fingertips, and between them.
pub(super) fn check_grip(
    site: Site<'_>,
    time: f64,
    robot: &Robot,
    stage: &Stage,
    object: usize,
    options: &VerifyOptions,
) -> Result<(), Refusal> {
    let (solid, pose) = stage.object(object);
    let refuse = |message: String| site.refusal(time, RefusalKind::Grasp, message);
    let [left, right] = robot.tips;
    let mut middles = Vec::new();
    for tip in [left, right] {
        let mut distance = f64::INFINITY;
        let mut name = "";
        for index in robot.solids_of(tip) {
            let (tip_solid, tip_pose) = stage.link_solid(index);
            name = tip_solid.name();
            let found = exact(tip_solid, &tip_pose, solid, pose).map_err(|e| refuse(e.to_string()))?;
            distance = distance.min(found.distance);
        }
        if distance > options.grip_m {
            let text =
                format!("{name} is {distance:.4} m from {}, at most {} m holds it", solid.name(), options.grip_m);
            return Err(refuse(text).about(name, solid.name()));
        }
        middles.extend(robot.solids_of(tip).next().map(|index| stage.link_solid(index)));
    }
    let [(tip, left_pose), (_, right_pose)] = middles[..] else { return Ok(()) };
    let Some(shape) = tip.shape() else { return Ok(()) };
    let (low, high) = shape.local_aabb();
    let half = (high - low) / 2.0;
    let sheet = Shape::cuboid(Vector3::new(half.x, SHEET_M, half.z))
        .and_then(|shape| Solid::new(&Arc::from("the space between the fingers"), shape))
        .map_err(|e| refuse(e.to_string()))?;
    let middle = left_pose.translation.vector.lerp(&right_pose.translation.vector, 0.5);
    let sheet_pose = Isometry3::from_parts(middle.into(), left_pose.rotation);
    let found = exact(&sheet, &sheet_pose, solid, pose).map_err(|e| refuse(e.to_string()))?;
    if found.intersects {
        return Ok(());
    }
    Err(refuse(format!("{} is not between the fingers", solid.name())))
}

/// How a pushed object moves at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct SlideDirection {
    /// Unit vector: where its centre goes.
    pub(super) heading: Vector2<f64>,
    /// How far it turns for each metre, 1/m, at least 0.
    pub(super) curvature: f64,
}

/// A pushed object without its outermost skin: what a pushing finger must not reach.
#[derive(Debug)]
pub(super) struct PushCore {
    core: Solid,
    name: String,
    radius_m: f64,
    /// With the fingers.
    friction: f64,
}

impl PushCore {
    /// The core of `object`, or why a hand that pushes so hard cannot push it.
    pub(super) fn new(object: &Object, skin_m: f64, push_force_n: f64) -> Result<Self, String> {
        let name = &object.name;
        if !object.pushable() {
            return Err(format!("`{name}` may not be pushed"));
        }
        let needed_n = object.friction.table * object.mass_kg * GRAVITY_M_S2;
        if needed_n > push_force_n {
            return Err(format!(
                "`{name}` is too heavy to be pushed: {needed_n:.1} N against its friction, the arm has {push_force_n} N"
            ));
        }
        if object.shape.round_radius().is_none() {
            return Err(format!("`{name}` is not round and cannot be pushed"));
        }
        Self::of(object, skin_m, 0.0)
    }

    /// `object` without a skin so thick at its sides, and above and below; or why that is not known.
    pub(super) fn of(object: &Object, skin_m: f64, top_m: f64) -> Result<Self, String> {
        let name = object.name.clone();
        let core = match object.shape {
            ShapeSpec::Cylinder { radius, height }
            | ShapeSpec::Bowl { radius, height, .. }
            | ShapeSpec::Plate { radius, height, .. } => Shape::cylinder(radius - skin_m, height / 2.0 - top_m),
            ShapeSpec::Sphere { radius } => Shape::sphere(radius - skin_m),
            ShapeSpec::Capsule { radius, height } => Shape::capsule(radius - skin_m, height / 2.0 - radius),
            ShapeSpec::Box { size } => Shape::cuboid(Vector3::from(size) / 2.0 - Vector3::new(skin_m, skin_m, top_m)),
            _ => {
                return Err(format!(
                    "the verifier knows nothing of the skin of `{name}`: it is neither round nor a box"
                ));
            }
        };
        let core = core.and_then(|shape| Solid::new(&Arc::from(name.as_str()), shape));
        let radius_m = object.shape.round_radius().unwrap_or(0.0);
        let friction = object.friction.fingers;
        Ok(Self { core: core.map_err(|error| error.to_string())?, name, radius_m, friction })
    }

    /// No finger reaches deeper into the object than its skin. The nearest points of each fingertip and the core, left and
    /// right; `None` for one that has no shape.
    pub(super) fn check_depth(
        &self,
        site: Site<'_>,
        time: f64,
        robot: &Robot,
        stage: &Stage,
        object: usize,
    ) -> Result<[Option<Clearance>; 2], Refusal> {
        let (_, pose) = stage.object(object);
        let core = Placed { solid: &self.core, world_from_solid: pose, centre: self.core.world_centre(pose) };
        let mut nearest = [None; 2];
        for &link in &robot.fingers {
            let tip = robot.tips.iter().position(|tip| *tip == link);
            for index in robot.solids_of(link) {
                let (solid, solid_pose) = stage.link_solid(index);
                // OPTIMIZATION: of what is behind the tips only the depth counts.
                let placed =
                    || Placed { solid, world_from_solid: &solid_pose, centre: solid.world_centre(&solid_pose) };
                if tip.is_none() && lower_bound(&placed(), &core) > 0.0 {
                    continue;
                }
                let refuse = |text: String| site.refusal(time, RefusalKind::Push, text).about(solid.name(), &self.name);
                let found = clearance::between(&solid.body, &solid_pose, &self.core.body, pose);
                let found = found.map_err(|error| refuse(error.to_string()))?;
                if found.distance <= 0.0 {
                    return Err(refuse(format!("{} presses into {}", solid.name(), self.name)).at(&found.first));
                }
                if let Some(nearest) = tip.and_then(|tip| nearest.get_mut(tip))
                    && nearest.is_none_or(|n: Clearance| found.distance < n.distance)
                {
                    *nearest = Some(found);
                }
            }
        }
        Ok(nearest)
    }

    /// Both fingertips touch the rim, behind the centre and on either side of it, and the object moves by `way` along the
    /// ray from the middle of the contacts through its centre. `tips`: see [`PushCore::check_depth`].
    #[expect(clippy::too_many_arguments, reason = "one moment of a push")]
    pub(super) fn check_contact(
        &self,
        site: Site<'_>,
        time: f64,
        robot: &Robot,
        stage: &Stage,
        object: usize,
        tips: [Option<Clearance>; 2],
        way: &SlideDirection,
        options: &VerifyOptions,
    ) -> Result<(), Refusal> {
        let (_, pose) = stage.object(object);
        let centre = Point2::from(pose.translation.vector.xy());
        let direction = way.heading;
        let mut contacts = Vec::new();
        for (tip, nearest) in robot.tips.into_iter().zip(tips) {
            let name = robot.tree.link_names().get(tip).map_or("fingertip", |name| name);
            let refuse = |text: String| site.refusal(time, RefusalKind::Push, text).about(name, &self.name);
            let Some(found) = nearest else { return Err(refuse(format!("{name} has no shape to touch with"))) };
            if found.distance > 2.0 * options.push_contact_m {
                let gap = found.distance - options.push_contact_m;
                let text = format!("{name} is {gap:.4} m from the rim of {} that it pushes", self.name);
                return Err(refuse(text).at(&found.first));
            }
            let arm = found.first.xy() - centre;
            if arm.dot(&direction) >= 0.0 {
                return Err(refuse(format!("{name} touches {} in front of its centre", self.name)).at(&found.first));
            }
            contacts.push(arm);
        }
        let [a, b] = contacts[..] else { return Ok(()) };
        let refuse = |text: String| site.refusal(time, RefusalKind::Push, text);
        if direction.perp(&a) * direction.perp(&b) >= 0.0 {
            return Err(refuse(format!("both fingertips touch {} on the same side of its way", self.name)));
        }
        let ray = -(a + b);
        let angle = ray.perp(&direction).atan2(ray.dot(&direction)).abs();
        if angle > options.push_ray_rad {
            let (angle, bound) = (angle.to_degrees(), options.push_ray_rad.to_degrees());
            let name = &self.name;
            let text = format!(
                "{name} moves {angle:.2} degrees off the ray from the contacts through its centre, at most {bound:.2}"
            );
            return Err(refuse(text));
        }
        let most = self.most_curvature(a.angle(&b) / 2.0);
        if way.curvature > most + CURVATURE_ROUNDING {
            let (name, curvature) = (&self.name, way.curvature);
            let text = format!("{name} turns by {curvature:.3} rad per metre, two fingers hold it up to {most:.3}");
            return Err(refuse(text));
        }
        Ok(())
    }

    /// The largest curvature at which contacts at this angle on either side of the way keep the object, 1/m: the force line
    /// may pass R sin(beta) beside the centre, or R sin(alpha) cos(alpha) / cos(beta) if the angle of friction alpha is the
    /// smaller one, and a disc that rests on its rim, which resists turning most, turns by that over R squared per metre.
    ///
    /// # Source
    /// Lynch and Mason, Stable pushing: mechanics, controllability and planning, 1996.
    fn most_curvature(&self, beta: f64) -> f64 {
        let alpha = self.friction.atan();
        let offset = if alpha < beta { alpha.sin() * alpha.cos() / beta.cos() } else { beta.sin() };
        offset / self.radius_m
    }
}
