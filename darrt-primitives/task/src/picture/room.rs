//! Draws what does not move: tables, legs, walls, what stands on the tables.

use darrt_geom::{Scene, SupportSurface};
use nalgebra::{Point2, Point3};
use svg::Node as _;
use svg::node::element::Element;

use super::ink::{self, Anchor, Ink};
use super::outline::body_points;
use super::palette;
use super::view::{Projection, View, Window};
use crate::problem_file::geometry::Geometry;

/// How near to a surface something must begin to stand on it (m).
const STANDS: f64 = 0.01;
/// From this length on, something tall is a wall (m).
const WALL_LENGTH: f64 = 2.0;
/// From this height on, something long is a wall (m).
const WALL_HEIGHT: f64 = 1.0;
/// Walls that would hide more than this in a side view are left out of it (m).
const WALL_HIDES: f64 = 0.6;

/// What a fixed body is to a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// Its top is a support surface.
    Table,
    /// Below a support surface: legs, a foot.
    Under,
    /// It stands on a support surface.
    Clutter,
    /// Long and tall.
    Wall,
    /// Anything else.
    Furniture,
}

/// A fixed body as the picture needs it.
#[derive(Debug, Clone)]
struct Fixture {
    /// Its name.
    name: String,
    /// What it is to a person.
    role: Role,
    /// Its corners in the world.
    points: Vec<Point3<f64>>,
}

/// All fixed bodies.
#[derive(Debug, Clone)]
pub(super) struct Room {
    fixtures: Vec<Fixture>,
}

impl Room {
    /// The fixed bodies of a problem; unbounded ones are left out.
    pub(super) fn new(geometry: &Geometry) -> Self {
        let bodies = geometry.scene.bodies().iter().enumerate();
        let fixtures = bodies.filter_map(|(index, fixed)| {
            let points = body_points(&fixed.body, &fixed.world_from_body);
            let role = role(&geometry.scene, &points, geometry.carriers.contains(&Some(index)))?;
            Some(Fixture { name: fixed.body.name.to_string(), role, points })
        });
        Self { fixtures: fixtures.collect() }
    }

    /// The corners of everything but walls.
    pub(super) fn inner_points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.fixtures.iter().filter(|fixture| fixture.role != Role::Wall).flat_map(|fixture| &fixture.points)
    }

    /// Draws the bodies that the view shows, what is farther away first.
    pub(super) fn draw(&self, view: &View, group: &mut Element) {
        let projection = view.projection;
        let key = |fixture: &&Fixture| fixture.points.iter().map(|p| projection.nearness(p)).fold(f64::MIN, f64::max);
        let mut shown: Vec<&Fixture> = self.fixtures.iter().filter(|f| is_shown(f, projection)).collect();
        shown.sort_by(|a, b| key(a).total_cmp(&key(b)));
        for fixture in shown {
            let mut drawn = ink::group(&fixture.name);
            drawn.append(ink::polygon(&view.silhouette(&fixture.points), &paint(fixture.role, projection)));
            group.append(drawn);
        }
    }

    /// Writes the names of what stands on tables into their silhouettes, or beside them where they do not fit.
    pub(super) fn name_clutter(&self, view: &View, group: &mut Element) {
        for fixture in self.fixtures.iter().filter(|fixture| fixture.role == Role::Clutter) {
            let Some(window) = Window::around(fixture.points.iter().map(|p| view.see(p))) else { continue };
            let (width, height) = window.size();
            let size = 11.0;
            let inside = ink::text_width(&fixture.name, size) <= width + 2.0;
            let middle = nalgebra::center(&window.low, &window.high);
            let line = if inside { middle.y + size * 0.35 } else { middle.y + height / 2.0 + size };
            let at = Point2::new(middle.x, line);
            let label = ink::text(&at, size, palette::CLUTTER_LINE, Anchor::Middle, &fixture.name);
            group.append(if inside { label } else { ink::haloed(label) });
        }
    }
}

/// The corners of a surface in the world.
pub(super) fn surface_points(surface: &SupportSurface) -> impl Iterator<Item = Point3<f64>> {
    surface.vertices().map(|corner| Point3::new(corner.x, corner.y, surface.height()))
}

/// `None` for a body without points.
fn role(scene: &Scene, points: &[Point3<f64>], carries: bool) -> Option<Role> {
    let first = *points.first()?;
    let (low, high) = points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
    let size = high - low;
    if carries {
        return Some(Role::Table);
    }
    let middle = nalgebra::center(&low, &high).xy();
    let over = || scene.surfaces().iter().filter(|surface| surface.contains(&middle));
    if over().any(|surface| (low.z - surface.height()).abs() < STANDS) {
        return Some(Role::Clutter);
    }
    if over().any(|surface| high.z < surface.height()) {
        return Some(Role::Under);
    }
    let is_wall = size.x.max(size.y) >= WALL_LENGTH && size.z >= WALL_HEIGHT;
    Some(if is_wall { Role::Wall } else { Role::Furniture })
}

fn is_shown(fixture: &Fixture, projection: Projection) -> bool {
    if projection == Projection::Above || fixture.role != Role::Wall {
        return true;
    }
    let window = Window::around(fixture.points.iter().map(|p| projection.flat(p)));
    window.is_some_and(|window| window.size().0 < WALL_HIDES)
}

fn paint(role: Role, projection: Projection) -> Ink<'static> {
    let from_above = projection == Projection::Above;
    match role {
        Role::Table => {
            let opacity = if from_above { 1.0 } else { 0.75 };
            Ink::filled(palette::TABLE).opacity(opacity).line(palette::TABLE_LINE, 1.0)
        }
        Role::Under if from_above => Ink::lined(palette::TABLE_LINE, 0.7).dash("2 2"),
        Role::Under => Ink::filled(palette::TABLE).opacity(0.35).line(palette::TABLE_LINE, 0.7),
        Role::Clutter => {
            let opacity = if from_above { 1.0 } else { 0.55 };
            Ink::filled(palette::CLUTTER).opacity(opacity).line(palette::CLUTTER_LINE, 1.0)
        }
        Role::Wall => Ink::filled(palette::FURNITURE).line(palette::FURNITURE_LINE, 0.7),
        Role::Furniture => Ink::filled(palette::FURNITURE).opacity(0.8).line(palette::FURNITURE_LINE, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::builtin;

    #[test]
    fn the_furniture_of_the_paper_is_recognised() {
        let room = Room::new(&builtin("plate3").unwrap().geometry().unwrap());
        let role = |name: &str| room.fixtures.iter().find(|f| f.name == name).map(|f| f.role);
        assert_eq!(role("central table top"), Some(Role::Table));
        assert_eq!(role("side table"), Some(Role::Table));
        assert_eq!(role("leg near left"), Some(Role::Under));
        assert_eq!(role("kettle"), Some(Role::Clutter));
        assert_eq!(role("wall far"), Some(Role::Wall));
        assert_eq!(role("floor"), None);
    }

    #[test]
    fn side_views_look_through_the_walls_before_them() {
        let room = Room::new(&builtin("plate3").unwrap().geometry().unwrap());
        let wall = |name: &str| room.fixtures.iter().find(|f| f.name == name).unwrap();
        assert!(!is_shown(wall("wall right"), Projection::FromTheRight));
        assert!(is_shown(wall("wall far"), Projection::FromTheRight));
        assert!(is_shown(wall("wall right"), Projection::Above));
    }
}
