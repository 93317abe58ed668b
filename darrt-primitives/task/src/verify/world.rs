//! What stands around: fixed bodies, support surfaces, movable objects, by index.

use darrt_geom::{Scene, SupportSurface};
use nalgebra::{Isometry3, Point2, Vector3};

use super::flush::Flush;
use super::refusal::{Refusal, RefusalKind};
use super::solid::Solid;
use crate::problem_file::{Object, ProblemFile};

/// A movable object.
#[derive(Debug)]
pub(super) struct Movable<'a> {
    pub(super) spec: &'a Object,
    pub(super) solid: Solid,
    /// Where the problem starts it.
    pub(super) world_from_start: Isometry3<f64>,
    /// The surface that it starts on.
    pub(super) start_surface: usize,
    /// How far it reaches below its origin, metres.
    pub(super) depth_below_origin: f64,
    /// The surfaces that it may stand on.
    pub(super) surfaces: Vec<usize>,
}

/// The fixed world and the objects.
#[derive(Debug)]
pub(super) struct World<'a> {
    /// Every part of every fixed body.
    pub(super) fixed: Vec<(Solid, Isometry3<f64>)>,
    /// By part: the body that it is of.
    body_of_fixed: Vec<usize>,
    pub(super) movables: Vec<Movable<'a>>,
    scene: Scene,
    /// By surface: the body under it, where known.
    carriers: Vec<Option<usize>>,
    flush: Flush,
    /// By object and surface, see [`World::across`].
    groups: Vec<Vec<Vec<usize>>>,
}

impl<'a> World<'a> {
    pub(super) fn new(problem: &'a ProblemFile) -> Result<Self, Refusal> {
        let refuse = |error: &dyn std::fmt::Display| {
            Refusal::whole(RefusalKind::Problem, format!("the scene of the problem cannot be built: {error}"))
        };
        let geometry = problem.geometry().map_err(|e| refuse(&e))?;
        let (mut fixed, mut body_of_fixed) = (Vec::new(), Vec::new());
        for (index, body) in geometry.scene.bodies().iter().enumerate() {
            for part in &body.body.parts {
                let solid = Solid::new(&body.body.name, part.shape.clone()).map_err(|e| refuse(&e))?;
                fixed.push((solid, body.world_from_body * part.body_from_shape));
                body_of_fixed.push(index);
            }
        }
        let surface_index = |name: &str| geometry.scene.surfaces().iter().position(|s| s.name() == name);
        let mut movables = Vec::new();
        for (spec, object) in problem.objects.iter().zip(&geometry.objects) {
            movables.push(Movable {
                spec,
                solid: Solid::of(object.body.clone()),
                world_from_start: object.world_from_object,
                start_surface: object.surface,
                depth_below_origin: object.depth_below_origin,
                surfaces: problem.allowed_surfaces(spec).into_iter().filter_map(surface_index).collect(),
            });
        }
        let carriers = geometry.carriers;
        let scene = geometry.scene;
        let flush = Flush::new(scene.surfaces());
        let of_object = |movable: &Movable<'_>| {
            (0..scene.surfaces().len()).map(|surface| flush.group(surface, &movable.surfaces)).collect()
        };
        let groups = movables.iter().map(of_object).collect();
        Ok(Self { fixed, body_of_fixed, movables, scene, carriers, flush, groups })
    }

    /// Index of the movable object called `name`.
    pub(super) fn object(&self, name: &str) -> Option<usize> {
        self.movables.iter().position(|movable| movable.spec.name == name)
    }

    /// What an object is called.
    pub(super) fn object_name(&self, object: usize) -> &str {
        self.movables.get(object).map_or("object", |movable| &movable.spec.name)
    }

    /// The surface with this name.
    pub(super) fn surface_called(&self, name: &str) -> Option<&SupportSurface> {
        self.scene.surface(name)
    }

    pub(super) fn surface(&self, index: usize) -> Option<&SupportSurface> {
        self.scene.surfaces().get(index)
    }

    /// Whether an object that stands on the surface, or across a seam from it, touches the fixed body: the one under it, or any
    /// where that is not known.
    pub(super) fn carries(&self, object: usize, surface: usize, fixed: usize) -> bool {
        let body = self.body_of_fixed.get(fixed).copied();
        let is_on = |surface| self.carriers.get(surface).copied().flatten().is_none_or(|carrier| Some(carrier) == body);
        self.across(object, surface).iter().copied().any(is_on)
    }

    /// The surfaces to which the object can be pushed from a surface without meeting an edge; that one first.
    pub(super) fn across(&self, object: usize, surface: usize) -> &[usize] {
        self.groups.get(object).and_then(|groups| groups.get(surface)).map_or(&[], |group| group)
    }

    /// Of the surface on which an object stands and those flush with it the one that its centre is over.
    pub(super) fn under(&self, object: usize, surface: usize, centre: &Point2<f64>) -> Option<usize> {
        self.flush.under(self.scene.surfaces(), self.across(object, surface), centre)
    }

    /// The allowed surface on which the object stands at `pose`, or what is wrong with each.
    pub(super) fn standing(
        &self,
        object: usize,
        pose: &Isometry3<f64>,
        slack_m: f64,
        upright_rad: f64,
    ) -> Result<usize, String> {
        let Some(movable) = self.movables.get(object) else { return Err("does not exist".to_owned()) };
        let lean = (pose.rotation * Vector3::z()).angle(&Vector3::z());
        if lean > upright_rad {
            let (lean, bound) = (lean.to_degrees(), upright_rad.to_degrees());
            return Err(format!("leans {lean:.3} degrees, at most {bound:.3} are upright"));
        }
        let bottom = pose.translation.z - movable.depth_below_origin;
        let centre = Point2::from(pose.translation.vector.xy());
        let mut flaws = Vec::new();
        let mut level = Vec::new();
        for &index in &movable.surfaces {
            let Some(surface) = self.surface(index) else { continue };
            let (above, inside) = (bottom - surface.height(), surface.depth(&centre));
            if above.abs() <= slack_m && inside >= 0.0 {
                return Ok(index);
            }
            if above.abs() <= slack_m {
                level.push(index);
            }
            let name = surface.name();
            flaws.push(if inside < 0.0 {
                format!("its centre is {:.4} m beside `{name}`", -inside)
            } else {
                format!("its bottom is {above:.4} m above `{name}`, at most {slack_m} is on it")
            });
        }
        // In the seam between two it is beside both.
        let in_seam = self.flush.under(self.scene.surfaces(), &level, &centre);
        in_seam.ok_or_else(|| format!("stands on no surface: {}", flaws.join("; ")))
    }
}
