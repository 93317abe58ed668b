//! Goals at the edge: places that a goal names and that lie nearer to the edge of a surface than objects are left elsewhere.

use darrt_geom::SupportSurface;
use darrt_primitives::action::place::ON_SURFACE_M;
use darrt_primitives::edge_margin::Brink;
use nalgebra::Point2;

use crate::planning_error::PlanningError;
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{GoalState, GoalTarget, ProblemFile, Region};
use crate::supports::Supports;

/// A region is judged at so many places along each side.
const PLACES: u32 = 5;

/// Where the goals of the object with this index, whose origin is `half_height_m` above what it stands on, force it nearer to
/// an edge than `[safety] edge_margin_m`. In a region without any place far enough inside, half of the best distance will do.
pub(crate) fn brinks(
    problem: &ProblemFile,
    index: usize,
    half_height_m: f64,
    geometry: &Geometry,
    supports: &Supports,
) -> Vec<Brink> {
    let Some(object) = problem.objects.get(index) else { return Vec::new() };
    let goals = problem.goal.objects.iter();
    let goals = goals.filter(|goal| goal.object == object.name && goal.state() != GoalState::Held);
    let mut found = Vec::new();
    for (goal, id) in goals.flat_map(|goal| supports.of_object(index).iter().map(move |id| (goal, *id))) {
        let Some(support) = supports.all.get(id.index()) else { continue };
        let is_part = |name: &str| {
            let part = geometry.scene.surfaces().iter().position(|surface| surface.name() == name);
            part.is_some_and(|part| supports.holding(index, part) == id)
        };
        let height_m = support.surface.height() + half_height_m;
        let [min, max] = match goal.target() {
            Some(GoalTarget::On { surface, at }) if is_part(surface) => [at, at],
            Some(GoalTarget::Within { surface, region }) if is_part(surface) => {
                let Some(region) = region.over(&support.surface) else { continue };
                [region.min, region.max]
            }
            Some(GoalTarget::At { position: [x, y, z] }) if (z - height_m).abs() <= ON_SURFACE_M => [[x, y]; 2],
            _ => continue,
        };
        let (min, max) = (Point2::from(min), Point2::from(max));
        let deepest_m = deepest_m(&support.surface, &min, &max);
        if (0.0..problem.safety.edge_margin_m).contains(&deepest_m) {
            let margin_m = if min == max { deepest_m } else { deepest_m / 2.0 };
            found.push(Brink { surface: id, min, max, margin_m });
        }
    }
    found
}

/// What a person should know of goals at the edge, one line each.
///
/// # Errors
/// [`PlanningError`] when the bodies of the problem cannot be built.
pub fn notices(problem: &ProblemFile) -> Result<Vec<String>, PlanningError> {
    let geometry = problem.geometry()?;
    let supports = Supports::new(problem, &geometry)?;
    let mut lines = Vec::new();
    for (index, (object, solid)) in problem.objects.iter().zip(&geometry.objects).enumerate() {
        for brink in brinks(problem, index, solid.depth_below_origin, &geometry, &supports) {
            let Some(support) = supports.all.get(brink.surface.index()) else { continue };
            let inside_mm = 1e3 * deepest_m(&support.surface, &brink.min, &brink.max);
            lines.push(format!(
                "a goal of `{}` is {inside_mm:.0} mm inside the edge of `{}`, nearer than `safety.edge_margin_m` of {:.0} mm",
                object.name,
                support.surface.name(),
                1e3 * problem.safety.edge_margin_m
            ));
        }
    }
    Ok(lines)
}

/// How far inside the edge the best place of a region is, metres; negative where all of it is beside the surface.
fn deepest_m(surface: &SupportSurface, min: &Point2<f64>, max: &Point2<f64>) -> f64 {
    let region = Region { min: [min.x, min.y], max: [max.x, max.y] };
    region.places(PLACES).map(|at| surface.depth(&at)).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem_file::ObjectGoal;
    use crate::testing::builtin;

    /// The first line about Plate1 with a goal on its side table, whose edges are 0.09 m or more from the built-in goal.
    fn said(edit: impl Fn(&mut ObjectGoal)) -> Option<String> {
        let mut problem = builtin("plate1").unwrap();
        edit(&mut problem.goal.objects[0]);
        notices(&problem).unwrap().into_iter().next()
    }

    fn edge() -> [f64; 2] {
        let problem = builtin("plate1").unwrap();
        let geometry = problem.geometry().unwrap();
        let surface = geometry.scene.surfaces().iter().find(|s| s.name() == "side table").unwrap();
        let (low, high) = surface.bounds();
        [high.x, f64::midpoint(low.y, high.y)]
    }

    #[test]
    fn goals_near_an_edge_are_told_and_others_are_not() {
        assert_eq!(said(|_| ()), None);
        let [x, y] = edge();
        let line = said(|goal| goal.at = Some([x - 0.02, y])).unwrap();
        assert!(line.contains("`plate` is 20 mm inside the edge of `side table`") && line.contains("30 mm"), "{line}");
    }

    #[test]
    fn a_region_is_at_the_edge_if_none_of_its_places_is_far_enough_inside() {
        let [x, y] = edge();
        let within = |deepest: f64| {
            said(|goal| {
                goal.at = None;
                goal.region = Some(Region { min: [x - deepest, y - 0.01], max: [x - 0.001, y + 0.01] });
            })
        };
        assert!(within(0.028).is_some());
        assert_eq!(within(0.032), None);
    }
}
