//! From a problem file to solids, poses and support surfaces.

use darrt_geom::{Body, FixedBody, GeomError, Part, Scene, Shape, SupportSurface, TriangleMesh};
use nalgebra::{Isometry3, Point2, Point3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::error::{Flaw, Located};
use super::layout::Layout;
use super::upper_face;
use super::{GoalTarget, Object, ObjectGoal, PlateRim, ProblemFile, ProblemFileError, ShapeSpec};

/// The name of the floor, a half space below z = 0 that is part of every scene.
pub const FLOOR: &str = "floor";

/// A movable object as a solid, and where it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct StartingObject {
    /// The solid; its frame is the origin of the shape.
    pub body: Body,
    /// Pose at the start.
    pub world_from_object: Isometry3<f64>,
    /// How far the solid reaches below its origin (m): at rest the origin is this much above the surface.
    pub depth_below_origin: f64,
    /// Index of the surface it starts on, in the scene and in the file.
    pub surface: usize,
}

/// Everything geometric about a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Obstacles in the order of the file, then the floor, and the support surfaces in the order of the file.
    pub scene: Scene,
    /// The movable objects in the order of the file.
    pub objects: Vec<StartingObject>,
    /// For each support surface the index of the obstacle in the scene that objects on it touch, where known.
    pub carriers: Vec<Option<usize>>,
}

impl ProblemFile {
    /// The surface on which `object` stands with its middle over a point and its bottom at a height (m): the first of those on which
    /// it [may stand](ProblemFile::allowed_surfaces) that is not farther than `within_m` above or below.
    pub fn surface_under(
        &self,
        object: &Object,
        scene: &Scene,
        (at, bottom_m): (&Point2<f64>, f64),
        within_m: f64,
    ) -> Option<String> {
        let carries = |name: &&str| {
            scene
                .surface(name)
                .is_some_and(|surface| (surface.height() - bottom_m).abs() <= within_m && surface.contains(at))
        };
        self.allowed_surfaces(object).into_iter().find(carries).map(str::to_owned)
    }
}

impl ShapeSpec {
    /// The solid called `name`; a bowl becomes the solid cylinder around it, and the rim of a plate is filled above. Reads the
    /// file of a mesh.
    ///
    /// # Errors
    /// When a length is out of range, hull points are flat, or the mesh file cannot be used.
    pub fn body(&self, name: &str) -> Result<Body, GeomError> {
        let shape = match self {
            Self::Plate { radius, height, rim } => return plate(name, *radius, *height, *rim),
            Self::Box { size } => Shape::cuboid(Vector3::from(*size) / 2.0),
            Self::Sphere { radius } => Shape::sphere(*radius),
            Self::Cylinder { radius, height } | Self::Bowl { radius, height, .. } => {
                Shape::cylinder(*radius, height / 2.0)
            }
            Self::Capsule { radius, height } => Shape::capsule(*radius, height / 2.0 - radius),
            Self::Hull { points } => {
                let points: Vec<_> = points.iter().map(|&point| Point3::from(point)).collect();
                Shape::convex_hull(name, &points)
            }
            Self::Mesh { file, scale } => {
                let mesh = TriangleMesh::from_file(file, &Vector3::repeat(*scale))?;
                Ok(Shape::Mesh(Arc::new(mesh)))
            }
        };
        Body::single(name, shape?)
    }
}

/// Corners of what stands for a circle around the rim of a plate; it is 0.2 % wider.
const RIM_CORNERS: u32 = 48;

/// The bottom, a cylinder, and the rim, the hull of its two lower edges and its upper one.
fn plate(name: &str, radius: f64, height: f64, rim: PlateRim) -> Result<Body, GeomError> {
    let (sin, cos) = rim.slope_deg.to_radians().sin_cos();
    let (top, rise) = (height / 2.0, rim.width_m * sin);
    let lower = [radius, top - rim.thickness_m * cos];
    let inner = [radius - rim.width_m * cos, lower[1] - rise];
    let upper = [radius - rim.thickness_m * sin, top];
    let wider = 1.0 / (PI / f64::from(RIM_CORNERS)).cos();
    let corners = (0..RIM_CORNERS).flat_map(|corner| {
        let (sin, cos) = (TAU * f64::from(corner) / f64::from(RIM_CORNERS)).sin_cos();
        [lower, inner, upper].map(|[r, z]| Point3::new(wider * r * cos, wider * r * sin, z))
    });
    let rim = Part::centred(Shape::convex_hull(name, &corners.collect::<Vec<_>>())?);
    let bottom = Part {
        shape: Shape::cylinder(inner[0], (height - rise) / 2.0)?,
        body_from_shape: Isometry3::translation(0.0, 0.0, -rise / 2.0),
    };
    Body::new(name, vec![bottom, rim])
}

impl ProblemFile {
    /// The fixed world: obstacles, the floor, support surfaces.
    ///
    /// # Errors
    /// When something cannot be placed or built, with the path of its key; mesh files are read here.
    pub fn scene(&self) -> Result<Scene, ProblemFileError> {
        let layout = Layout::new(self).map_err(|flaw| self.located(flaw))?;
        self.build_scene(&layout).map_err(|flaw| self.located(flaw))
    }

    /// The fixed world and the movable objects at their start.
    ///
    /// # Errors
    /// As [`ProblemFile::scene`].
    pub fn geometry(&self) -> Result<Geometry, ProblemFileError> {
        self.build_geometry().map_err(|flaw| self.located(flaw))
    }

    /// The names of the surfaces to which `object` could be pushed from where it starts without meeting an edge, that one
    /// included: those on which it may stand and that lie flush, directly or by way of others. Empty if that cannot be said.
    pub fn surfaces_across(&self, object: &Object) -> Vec<String> {
        let Ok(layout) = Layout::new(self) else { return Vec::new() };
        let allowed = self.allowed_surfaces(object);
        let surfaces = layout.surfaces.iter().map(|surface| &surface.support);
        let surfaces: Vec<_> = surfaces.filter(|surface| allowed.contains(&surface.name())).collect();
        let names = |group: Vec<usize>| -> Vec<String> {
            group.into_iter().filter_map(|i| Some(surfaces.get(i)?.name().to_owned())).collect()
        };
        let groups = SupportSurface::flush_groups(&surfaces).into_iter().map(names);
        groups.into_iter().find(|group| group.contains(&object.on)).unwrap_or_default()
    }

    /// Names a flaw that was found in this problem after reading.
    pub(super) fn located(&self, (key, flaw): Located) -> ProblemFileError {
        ProblemFileError::Invalid { file: format!("problem `{}`", self.name), key, flaw: Box::new(flaw) }
    }

    fn build_geometry(&self) -> Result<Geometry, Located> {
        let layout = Layout::new(self)?;
        let scene = self.build_scene(&layout)?;
        let objects = (0..)
            .zip(&self.objects)
            .map(|(index, object)| starting(object, scene.surfaces()).map_err(|f| f.at(format!("object[{index}]"))))
            .collect::<Result<_, _>>()?;
        let carriers = layout
            .surfaces
            .iter()
            .map(|surface| self.obstacles.iter().position(|o| Some(&o.name) == surface.body.as_ref()))
            .collect();
        Ok(Geometry { scene, objects, carriers })
    }

    fn build_scene(&self, layout: &Layout) -> Result<Scene, Located> {
        let mut bodies = Vec::with_capacity(self.obstacles.len() + 1);
        for (index, (obstacle, pose)) in self.obstacles.iter().zip(&layout.world_from_obstacle).enumerate() {
            let body = obstacle
                .shape
                .body(&obstacle.name)
                .map_err(|error| Flaw::from(error).at(format!("obstacle[{index}]")))?;
            bodies.push(FixedBody { body, world_from_body: *pose });
        }
        let whole = |error: GeomError| Flaw::from(error).at("obstacle");
        let floor = Shape::half_space(Vector3::z_axis()).and_then(|shape| Body::single(FLOOR, shape)).map_err(whole)?;
        bodies.push(FixedBody { body: floor, world_from_body: Isometry3::identity() });
        for (index, (surface, placed)) in self.surfaces.iter().zip(&layout.surfaces).enumerate() {
            let carrier = self.obstacles.iter().zip(&bodies).find(|(o, _)| Some(&o.name) == surface.body.as_ref());
            if let (Some(polygon), Some((_, carrier))) = (&surface.polygon, carrier) {
                upper_face::check(&placed.support, polygon, carrier, &format!("surface[{index}]"))?;
            }
        }
        let surfaces = layout.surfaces.iter().map(|surface| surface.support.clone()).collect();
        Scene::new(bodies, surfaces).map_err(whole)
    }
}

impl StartingObject {
    /// Pose of the object standing upright with its centre over world `at` on `surface`, turned by `yaw` (rad).
    pub fn standing(&self, surface: &SupportSurface, at: [f64; 2], yaw: f64) -> Isometry3<f64> {
        upright([at[0], at[1], surface.height() + self.depth_below_origin], yaw)
    }

    /// Pose of the object at a goal; `None` for a goal with a region, or on a surface that is not in `scene`.
    ///
    /// A free yaw is taken as 0.
    pub fn world_from_goal(&self, goal: &ObjectGoal, scene: &Scene) -> Option<Isometry3<f64>> {
        let yaw = goal.yaw.unwrap_or(0.0);
        match goal.target()? {
            GoalTarget::On { surface, at } => Some(self.standing(scene.surface(surface)?, at, yaw)),
            GoalTarget::At { position } => Some(upright(position, yaw)),
            GoalTarget::Within { .. } => None,
        }
    }
}

fn upright([x, y, z]: [f64; 3], yaw: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Isometry3::from_parts(Vector3::new(x, y, z).into(), turn)
}

fn starting(object: &Object, surfaces: &[SupportSurface]) -> Result<StartingObject, Flaw> {
    let body = object.shape.body(&object.name)?;
    let depth_below_origin = -body.local_aabb().0.z;
    let found = surfaces.iter().enumerate().find(|(_, surface)| surface.name() == object.on);
    let Some((surface, plane)) = found else {
        return Err(Flaw::Inconsistent(format!("starts on `{}`, which does not exist", object.on)));
    };
    let height = plane.height() + depth_below_origin;
    let world_from_object = upright([object.at[0], object.at[1], height], object.yaw);
    Ok(StartingObject { body, world_from_object, depth_below_origin, surface })
}
