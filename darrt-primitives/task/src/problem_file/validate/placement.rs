//! Objects and goals are inside the surfaces they name, and inside the bounds.

use nalgebra::Point2;

use super::world::in_bounds;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::layout::Layout;
use crate::problem_file::{GoalTarget, Object, ObjectGoal, ProblemFile, Region};

/// A region is looked at in so many places along each side.
const PLACES: u32 = 17;

/// Places the world and checks what stands in it.
pub(super) fn check(problem: &ProblemFile) -> Result<(), Located> {
    let layout = Layout::new(problem)?;
    for (index, obstacle) in problem.obstacles.iter().enumerate() {
        if let (Some(name), &[x, y]) = (&obstacle.standing_on, obstacle.at.as_slice()) {
            on_surface(&layout, name, &obstacle.name, [x, y], &format!("obstacle[{index}].at"))?;
        }
    }
    for (index, object) in problem.objects.iter().enumerate() {
        let key = format!("object[{index}]");
        on_surface(&layout, &object.on, &object.name, object.at, &format!("{key}.at"))?;
        centre_in_bounds(problem, &layout, object, &object.on, object.at, &key)?;
    }
    for (index, goal) in problem.goal.objects.iter().enumerate() {
        check_goal(problem, &layout, goal, &format!("goal.object[{index}]"))?;
    }
    Ok(())
}

fn check_goal(problem: &ProblemFile, layout: &Layout, goal: &ObjectGoal, key: &str) -> Result<(), Located> {
    let Some(object) = problem.object(&goal.object) else {
        return Ok(());
    };
    match goal.target() {
        Some(GoalTarget::On { surface, at }) => {
            on_surface(layout, surface, &goal.object, at, &format!("{key}.at"))?;
            centre_in_bounds(problem, layout, object, surface, at, key)
        }
        Some(GoalTarget::Within { surface, region }) => {
            let Some(plane) = layout.surface(surface).map(|plane| &plane.support) else { return Ok(()) };
            let is_on = |part: &Region| part.places(PLACES).any(|at| plane.contains(&at));
            if region.over(plane).as_ref().is_some_and(is_on) {
                return Ok(());
            }
            let centre = [f64::midpoint(region.min[0], region.max[0]), f64::midpoint(region.min[1], region.max[1])];
            // No part of it is on the surface; how far beside it is, its middle tells.
            on_surface(layout, surface, &goal.object, centre, &format!("{key}.region, its middle,"))
        }
        Some(GoalTarget::At { .. }) | None => Ok(()),
    }
}

/// The point is inside the polygon of the surface.
fn on_surface(layout: &Layout, surface: &str, name: &str, at: [f64; 2], key: &str) -> Result<(), Located> {
    let depth =
        layout.surface(surface).map_or(f64::NEG_INFINITY, |plane| plane.support.depth(&Point2::new(at[0], at[1])));
    if depth >= 0.0 {
        return Ok(());
    }
    Err(Flaw::OffSurface { name: name.to_owned(), at, outside: -depth, surface: surface.to_owned() }.at(key))
}

/// The centre of an object that stands at `at` on `surface` is in the bounds of the objects.
fn centre_in_bounds(
    problem: &ProblemFile,
    layout: &Layout,
    object: &Object,
    surface: &str,
    at: [f64; 2],
    key: &str,
) -> Result<(), Located> {
    let bounds = &problem.bounds;
    in_bounds(&format!("{key}.at[0]"), at[0], "object_x", bounds.object_x)?;
    in_bounds(&format!("{key}.at[1]"), at[1], "object_y", bounds.object_y)?;
    let height = layout.surface(surface).map(|plane| plane.support.height());
    match (height, object.shape.depth_below_origin()) {
        (Some(z), Some(depth)) => {
            let key = format!("{key}, the height of its centre,");
            in_bounds(&key, z + depth, "object_z", bounds.object_z)
        }
        _ => Ok(()),
    }
}
