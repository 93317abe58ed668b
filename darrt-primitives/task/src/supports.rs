//! The supports of the planning domain: the surfaces of a problem file, those that lie flush joined to one.
//!
//! A support is what an object can be pushed across without meeting an edge. Two tables that stand flush are one for an object
//! that may stand on both, and only the one on which it may stand for another; so supports are made per set of allowed surfaces.
//! The names stay those of the file: a goal `on` one of two joined tables means that part of the support.

use std::sync::Arc;

use darrt_geom::{GeomError, SupportSurface};
use darrt_primitives::mode::SurfaceId;
use darrt_primitives::tabletop::Support;
use smallvec::SmallVec;

use crate::problem_file::ProblemFile;
use crate::problem_file::geometry::Geometry;

/// The supports, and which of them serve which object.
#[derive(Debug)]
pub(crate) struct Supports {
    /// By [`SurfaceId`].
    pub(crate) all: Vec<Support>,
    /// By support: its surfaces as indices into those of the file, ascending.
    members: Vec<Vec<usize>>,
    /// By object of the file: where it may stand.
    of_object: Vec<SmallVec<[SurfaceId; 4]>>,
}

impl Supports {
    /// The supports of a problem with this geometry.
    ///
    /// # Errors
    /// When more than 64 surfaces lie flush.
    pub(crate) fn new(problem: &ProblemFile, geometry: &Geometry) -> Result<Self, GeomError> {
        let surfaces = geometry.scene.surfaces();
        let mut supports = Self { all: Vec::new(), members: Vec::new(), of_object: Vec::new() };
        // The surfaces of the file come first, each by itself: a support has the index of its surface wherever nothing is joined.
        for index in 0..surfaces.len() {
            supports.add(geometry, vec![index])?;
        }
        for (object, solid) in problem.objects.iter().zip(&geometry.objects) {
            let allowed = problem.allowed_surfaces(object);
            let named = |index: &usize| surfaces.get(*index).is_some_and(|s| allowed.contains(&s.name()));
            let allowed: Vec<usize> = (0..surfaces.len()).filter(named).collect();
            let polygons: Vec<&SupportSurface> = allowed.iter().filter_map(|index| surfaces.get(*index)).collect();
            let mut ids = SmallVec::new();
            for group in SupportSurface::flush_groups(&polygons) {
                let members = group.into_iter().filter_map(|place| allowed.get(place).copied()).collect();
                ids.push(supports.add(geometry, members)?);
            }
            debug_assert!(allowed.contains(&solid.surface), "an object starts where it may stand");
            supports.of_object.push(ids);
        }
        Ok(supports)
    }

    /// The support made of these surfaces, made now if there is none yet.
    fn add(&mut self, geometry: &Geometry, members: Vec<usize>) -> Result<SurfaceId, GeomError> {
        if let Some(known) = self.members.iter().position(|other| *other == members) {
            return Ok(SurfaceId::new(known));
        }
        let surfaces: Vec<_> = members.iter().filter_map(|index| geometry.scene.surfaces().get(*index)).collect();
        let name = surfaces.iter().map(|surface| surface.name()).collect::<Vec<_>>().join(" + ");
        let mut bodies: Vec<Arc<str>> = Vec::new();
        for carrier in members.iter().filter_map(|index| geometry.carriers.get(*index).copied().flatten()) {
            let name = geometry.scene.bodies().get(carrier).map(|fixed| Arc::clone(&fixed.body.name));
            bodies.extend(name.filter(|name| !bodies.contains(name)));
        }
        self.all.push(Support { surface: SupportSurface::joined(name, &surfaces)?, bodies });
        self.members.push(members);
        Ok(SurfaceId::new(self.all.len() - 1))
    }

    /// Where an object may stand.
    pub(crate) fn of_object(&self, object: usize) -> &[SurfaceId] {
        self.of_object.get(object).map_or(&[], |ids| ids)
    }

    /// The polygons on which an object may stand.
    pub(crate) fn surfaces_of(&self, object: usize) -> impl Iterator<Item = &SupportSurface> {
        self.of_object(object).iter().filter_map(|id| self.all.get(id.index())).map(|support| &support.surface)
    }

    /// The support of an object that holds a surface of the file; that surface by itself if the object may not stand there.
    pub(crate) fn holding(&self, object: usize, surface: usize) -> SurfaceId {
        let holds = |id: &&SurfaceId| self.members.get(id.index()).is_some_and(|members| members.contains(&surface));
        self.of_object(object).iter().find(holds).copied().unwrap_or_else(|| SurfaceId::new(surface))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::builtin;

    /// Simple Plate with a second board flush beside its central table, on which the plate may stand or not.
    fn with_leaf(gap_m: f64, allowed: Option<&[&str]>) -> (ProblemFile, Geometry) {
        let mut problem = builtin("simple-plate").unwrap();
        let geometry = problem.geometry().unwrap();
        let table = geometry.scene.surface("central table").unwrap();
        let ((low, high), z) = (table.bounds(), table.height());
        let mut leaf = problem.obstacles[0].clone();
        leaf.name = "leaf".to_owned();
        leaf.shape = crate::problem_file::ShapeSpec::Box { size: [0.4, high.y - low.y, 0.03] };
        leaf.at = vec![low.x - gap_m - 0.2, f64::midpoint(low.y, high.y), z - 0.015];
        leaf.standing_on = None;
        problem.obstacles.push(leaf);
        let mut surface = problem.surfaces[0].clone();
        (surface.name, surface.top_of) = ("leaf".to_owned(), Some("leaf".to_owned()));
        (surface.polygon, surface.z, surface.body) = (None, None, None);
        problem.surfaces.push(surface);
        problem.objects[0].surfaces = allowed.map(|names| names.iter().map(|name| (*name).to_owned()).collect());
        let geometry = problem.geometry().unwrap();
        (problem, geometry)
    }

    fn index(geometry: &Geometry, name: &str) -> usize {
        geometry.scene.surfaces().iter().position(|s| s.name() == name).unwrap()
    }

    #[test]
    fn without_flush_surfaces_supports_are_those_of_the_file() {
        for name in ["simple-plate", "plate3", "plate-and-two-bowls"] {
            let problem = builtin(name).unwrap();
            let geometry = problem.geometry().unwrap();
            let supports = Supports::new(&problem, &geometry).unwrap();
            assert_eq!(supports.all.len(), geometry.scene.surfaces().len());
            for (support, surface) in supports.all.iter().zip(geometry.scene.surfaces()) {
                assert_eq!(support.surface, *surface);
                assert_eq!(support.bodies.len(), 1);
            }
        }
    }

    #[test]
    fn flush_surfaces_are_one_for_who_may_stand_on_both() {
        let (problem, geometry) = with_leaf(0.001, None);
        let supports = Supports::new(&problem, &geometry).unwrap();
        let (table, leaf) = (index(&geometry, "central table"), index(&geometry, "leaf"));
        let both = supports.holding(0, table);
        assert_eq!(both, supports.holding(0, leaf));
        let support = &supports.all[both.index()];
        assert_eq!(support.surface.name(), "central table + leaf");
        assert_eq!(support.bodies.len(), 2);
        assert!(!supports.of_object(0).contains(&SurfaceId::new(table)));

        for (problem, geometry) in [with_leaf(0.003, None), with_leaf(0.0, Some(&["central table", "side table"]))] {
            let supports = Supports::new(&problem, &geometry).unwrap();
            assert_eq!(
                supports.holding(0, index(&geometry, "central table")).index(),
                index(&geometry, "central table")
            );
            assert_eq!(supports.all.len(), geometry.scene.surfaces().len());
        }
    }
}
