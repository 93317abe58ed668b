//! Where the obstacles and surfaces of a problem are in the world.
//!
//! An obstacle may stand on a surface that is the top of another obstacle that stands on a surface, so every item
//! depends on at most one other; the chains are followed without recursion and a circle is an error.

use std::collections::BTreeMap;

use darrt_geom::SupportSurface;
use nalgebra::{Isometry3, Point2, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::error::{Flaw, Located};
use super::{Obstacle, ProblemFile, ShapeSpec, Surface};

/// The top face of a box counts as level when its normal leans less than this from the vertical (1 - cosine).
const LEVEL_TOLERANCE: f64 = 1e-9;

/// A support surface in the world and what carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedSurface {
    /// The surface.
    pub support: SupportSurface,
    /// The obstacle that objects on it touch, if the file names one.
    pub body: Option<String>,
}

/// The obstacles and surfaces of a problem in the world, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Pose of each obstacle's shape.
    pub world_from_obstacle: Vec<Isometry3<f64>>,
    /// The surfaces.
    pub surfaces: Vec<PlacedSurface>,
}

impl Layout {
    /// Places everything; the references of the problem must already be checked.
    pub(crate) fn new(problem: &ProblemFile) -> Result<Self, Located> {
        let mut resolver = Resolver::new(problem);
        for index in 0..problem.obstacles.len() {
            resolver.resolve(Item::Obstacle(index))?;
        }
        for index in 0..problem.surfaces.len() {
            resolver.resolve(Item::Surface(index))?;
        }
        Ok(Self {
            world_from_obstacle: resolver.obstacles.into_iter().flatten().collect(),
            surfaces: resolver.surfaces.into_iter().flatten().collect(),
        })
    }

    /// The surface called `name`.
    pub fn surface(&self, name: &str) -> Option<&PlacedSurface> {
        self.surfaces.iter().find(|surface| surface.support.name() == name)
    }
}

#[derive(Clone, Copy, Debug)]
enum Item {
    Obstacle(usize),
    Surface(usize),
}

impl Item {
    fn key(self) -> String {
        match self {
            Self::Obstacle(index) => format!("obstacle[{index}]"),
            Self::Surface(index) => format!("surface[{index}]"),
        }
    }
}

struct Resolver<'a> {
    problem: &'a ProblemFile,
    obstacle_index: BTreeMap<&'a str, usize>,
    surface_index: BTreeMap<&'a str, usize>,
    obstacles: Vec<Option<Isometry3<f64>>>,
    surfaces: Vec<Option<PlacedSurface>>,
}

impl<'a> Resolver<'a> {
    fn new(problem: &'a ProblemFile) -> Self {
        Self {
            problem,
            obstacle_index: (0..)
                .zip(&problem.obstacles)
                .map(|(index, obstacle)| (obstacle.name.as_str(), index))
                .collect(),
            surface_index: (0..)
                .zip(&problem.surfaces)
                .map(|(index, surface)| (surface.name.as_str(), index))
                .collect(),
            obstacles: vec![None; problem.obstacles.len()],
            surfaces: vec![None; problem.surfaces.len()],
        }
    }

    /// Places `item` and, before it, everything below it.
    fn resolve(&mut self, item: Item) -> Result<(), Located> {
        let mut chain = vec![item];
        let mut lowest = item;
        while let Some(below) = self.unplaced_below(lowest) {
            if chain.len() > self.obstacles.len() + self.surfaces.len() {
                let text = "stands on itself, by way of `standing_on` and `top_of`";
                return Err(Flaw::Inconsistent(text.to_owned()).at(item.key()));
            }
            chain.push(below);
            lowest = below;
        }
        chain.into_iter().rev().try_for_each(|item| self.place(item))
    }

    /// What `item` stands on or is the top of, unless that is placed already.
    fn unplaced_below(&self, item: Item) -> Option<Item> {
        match item {
            Item::Obstacle(index) => {
                let name = self.problem.obstacles.get(index)?.standing_on.as_deref()?;
                let below = *self.surface_index.get(name)?;
                self.surfaces.get(below)?.is_none().then_some(Item::Surface(below))
            }
            Item::Surface(index) => {
                let name = self.problem.surfaces.get(index)?.top_of.as_deref()?;
                let below = *self.obstacle_index.get(name)?;
                self.obstacles.get(below)?.is_none().then_some(Item::Obstacle(below))
            }
        }
    }

    fn place(&mut self, item: Item) -> Result<(), Located> {
        let problem = self.problem;
        match item {
            Item::Obstacle(index) => {
                let placed = match problem.obstacles.get(index) {
                    Some(obstacle) => Some(self.obstacle_pose(obstacle).map_err(|f| f.at(item.key()))?),
                    None => None,
                };
                if let Some(slot) = self.obstacles.get_mut(index) {
                    *slot = placed;
                }
            }
            Item::Surface(index) => {
                let placed = match problem.surfaces.get(index) {
                    Some(surface) => Some(self.surface_place(surface).map_err(|f| f.at(item.key()))?),
                    None => None,
                };
                if let Some(slot) = self.surfaces.get_mut(index) {
                    *slot = placed;
                }
            }
        }
        Ok(())
    }

    fn obstacle_pose(&self, obstacle: &Obstacle) -> Result<Isometry3<f64>, Flaw> {
        let rotation = rotation(obstacle);
        let position = match (&obstacle.standing_on, obstacle.at.as_slice()) {
            (None, &[x, y, z]) => Vector3::new(x, y, z),
            (Some(name), &[x, y]) => {
                let height = self.surface_index.get(name.as_str()).and_then(|&index| self.surfaces.get(index));
                let z = height.and_then(Option::as_ref).map(|surface| surface.support.height());
                let (Some(z), Some(depth)) = (z, obstacle.shape.depth_below_origin()) else {
                    let text = "is a mesh; give its place as `at = [x, y, z]` without `standing_on`";
                    return Err(Flaw::Inconsistent(text.to_owned()));
                };
                Vector3::new(x, y, z + depth)
            }
            (_, at) => {
                let bound = "3, or 2 with `standing_on`".to_owned();
                return Err(Flaw::WrongLength { found: at.len(), bound });
            }
        };
        Ok(Isometry3::from_parts(Translation3::from(position), rotation))
    }

    fn surface_place(&self, surface: &Surface) -> Result<PlacedSurface, Flaw> {
        let body = surface.carrying_body().map(str::to_owned);
        let name = surface.name.as_str();
        if let (Some(polygon), Some(z)) = (&surface.polygon, surface.z) {
            let corners: Vec<_> = polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect();
            let support = SupportSurface::new(name, &corners, z)?;
            return Ok(PlacedSurface { support, body });
        }
        let index = surface.top_of.as_deref().and_then(|top| self.obstacle_index.get(top).copied());
        let shape = index.and_then(|i| self.problem.obstacles.get(i)).map(|o| &o.shape);
        let pose = index.and_then(|i| self.obstacles.get(i)).and_then(Option::as_ref);
        let (Some(ShapeSpec::Box { size }), Some(world_from_box)) = (shape, pose) else {
            let text = "needs `top_of` naming a box, or `polygon` and `z`";
            return Err(Flaw::Inconsistent(text.to_owned()));
        };
        let up = world_from_box.rotation * Vector3::z();
        if up.z < 1.0 - LEVEL_TOLERANCE {
            let lean = up.z.clamp(-1.0, 1.0).acos().to_degrees();
            let text = format!("is the top of a box that leans {lean} degrees; it must be level");
            return Err(Flaw::Inconsistent(text));
        }
        let [x, y, z] = size.map(|length| length / 2.0);
        let corners = [(-x, -y), (x, -y), (x, y), (-x, y)];
        let corners = corners.map(|(x, y)| (world_from_box * Point3::new(x, y, z)).xy());
        let support = SupportSurface::new(name, &corners, world_from_box.translation.z + z)?;
        Ok(PlacedSurface { support, body })
    }
}

fn rotation(obstacle: &Obstacle) -> UnitQuaternion<f64> {
    if let Some([x, y, z, w]) = obstacle.quaternion {
        return UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    }
    let [roll, pitch, yaw] = obstacle.rpy.unwrap_or([0.0, 0.0, obstacle.yaw.unwrap_or(0.0)]);
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::builtin;
    use std::f64::consts::FRAC_PI_2;

    fn box_on(name: &str, size: [f64; 3], at: Vec<f64>, standing_on: Option<&str>) -> Obstacle {
        let standing_on = standing_on.map(str::to_owned);
        let shape = ShapeSpec::Box { size };
        Obstacle { name: name.to_owned(), shape, at, standing_on, yaw: None, rpy: None, quaternion: None }
    }

    fn top_of(name: &str) -> Surface {
        Surface { name: name.to_owned(), top_of: Some(name.to_owned()), polygon: None, z: None, body: None }
    }

    #[test]
    fn boxes_stand_on_boxes_in_any_order_of_the_file() {
        let mut problem = builtin("simple-plate").unwrap();
        problem.obstacles.insert(0, box_on("upper", [0.1, 0.1, 0.2], vec![0.3, 0.4], Some("lower")));
        problem.obstacles.insert(1, box_on("lower", [0.2, 0.2, 0.1], vec![0.3, 0.4], Some("central table")));
        problem.surfaces.insert(0, top_of("upper"));
        problem.surfaces.insert(1, top_of("lower"));
        let layout = Layout::new(&problem).unwrap();
        assert!((layout.surface("lower").unwrap().support.height() - 0.85).abs() < 1e-12);
        assert!((layout.surface("upper").unwrap().support.height() - 1.05).abs() < 1e-12);
        let upper = layout.world_from_obstacle[0].translation.vector;
        assert!((upper - Vector3::new(0.3, 0.4, 0.95)).norm() < 1e-12);
    }

    #[test]
    fn turned_boxes_have_turned_tops() {
        let lid = box_on("lid", [0.4, 0.2, 0.1], vec![0.0, 0.0, 1.0], None);
        let mut turns = [lid.clone(), lid.clone(), lid];
        turns[0].yaw = Some(FRAC_PI_2);
        turns[1].rpy = Some([0.0, 0.0, FRAC_PI_2]);
        turns[2].quaternion = Some([0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]);
        for lid in turns {
            let mut problem = builtin("simple-plate").unwrap();
            problem.obstacles.push(lid);
            problem.surfaces.push(top_of("lid"));
            let layout = Layout::new(&problem).unwrap();
            let (low, high) = layout.surface("lid").unwrap().support.bounds();
            assert!((low - Point2::new(-0.1, -0.2)).norm() < 1e-12 && (high - Point2::new(0.1, 0.2)).norm() < 1e-12);
        }
    }

    #[test]
    fn long_towers_do_not_need_the_stack() {
        let mut problem = builtin("simple-plate").unwrap();
        for level in (0..3000).rev() {
            let below = if level == 0 { "central table".to_owned() } else { format!("b{}", level - 1) };
            let name = format!("b{level}");
            problem.obstacles.push(box_on(&name, [0.1, 0.1, 0.001], vec![0.3, 0.4], Some(&below)));
            problem.surfaces.push(top_of(&name));
        }
        let layout = Layout::new(&problem).unwrap();
        assert!((layout.surface("b2999").unwrap().support.height() - 3.75).abs() < 1e-9);
    }
}
