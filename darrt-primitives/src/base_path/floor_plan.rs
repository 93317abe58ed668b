//! The fixed bodies as a base sees them that moves on the floor: outlines, and the heights from which to which they reach.

use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;

use nalgebra::Vector2;

use super::outline::Outline;
use super::section::Placed;

/// What a base could run into.
#[derive(Debug, Clone)]
pub(crate) struct Obstacle {
    /// Seen from above.
    pub(crate) outline: Outline,
    /// Lowest and highest point, metres.
    pub(crate) z_m: [f64; 2],
}

impl Obstacle {
    /// A solid, seen from above.
    pub(crate) fn new(solid: &Placed<'_>) -> Option<Self> {
        solid.section(solid.z_m).map(|outline| Self { outline, z_m: solid.z_m })
    }

    /// Where it begins along x at the earliest, metres.
    fn left_m(&self) -> f64 {
        self.outline.centre().x - self.outline.reach_m()
    }
}

/// Where two obstacles are nearest to each other, with nothing between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gap {
    /// Half way between them.
    pub(crate) middle: Vector2<f64>,
    /// Metres.
    pub(crate) width_m: f64,
}

/// Wider gaps than this are passed by every robot, metres.
const WIDE_M: f64 = 2.0;
/// Of many obstacles the gaps narrower than this are looked for first, metres.
const LEAST_WIDE_M: f64 = WIDE_M / 16.0;

/// What rounding may do to a length, metres.
const ROUNDING_M: f64 = 1e-9;
/// Most gaps that are kept.
const MOST_GAPS: usize = 10_000;

/// The fixed bodies of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct FloorPlan {
    pub(crate) obstacles: Vec<Obstacle>,
    /// Where a robot could be too wide.
    pub(crate) gaps: Vec<Gap>,
    /// Some bodies are not in here: meshes, which are surfaces, and slanting half spaces.
    pub(crate) has_gaps: bool,
}

impl FloorPlan {
    /// The plan of a scene.
    pub(crate) fn new(fixed: &[FixedBody]) -> Self {
        let mut plan = Self::default();
        for body in fixed {
            for part in &body.body.parts {
                match &part.shape {
                    Shape::Mesh(_) => plan.has_gaps = true,
                    Shape::HalfSpace { normal, .. } => {
                        // A level one stays as far below as it is, wherever the base goes.
                        let normal = body.world_from_body * (part.body_from_shape * normal);
                        plan.has_gaps |= normal.x != 0.0 || normal.y != 0.0;
                    }
                    _ => {
                        let solid = Placed::new(part, &body.world_from_body);
                        plan.obstacles.extend(solid.as_ref().and_then(Obstacle::new));
                    }
                }
            }
        }
        plan.find_gaps();
        plan
    }

    /// Only so many gaps are kept, the narrowest: where there are more of them among near neighbours, those farther apart need not
    /// be looked at.
    fn find_gaps(&mut self) {
        let count = self.obstacles.len();
        // Of so few pairs all are kept.
        let is_small = count * count.saturating_sub(1) / 2 <= MOST_GAPS;
        let mut up_to_m = if is_small { WIDE_M } else { LEAST_WIDE_M };
        loop {
            self.gaps = self.gaps_below(up_to_m);
            if up_to_m >= WIDE_M || self.gaps.len() > MOST_GAPS {
                break;
            }
            up_to_m = (2.0 * up_to_m).min(WIDE_M);
        }
        // So many that looking through them would take longer than driving around: the narrowest count.
        if self.gaps.len() > MOST_GAPS {
            self.gaps.sort_by(|a, b| a.width_m.total_cmp(&b.width_m));
            self.gaps.truncate(MOST_GAPS);
        }
    }

    /// The gaps that are narrower than this.
    fn gaps_below(&self, up_to_m: f64) -> Vec<Gap> {
        let mut gaps = Vec::new();
        // Those that begin farther to the left than the widest is wide cannot reach here.
        let mut by_left: Vec<(f64, usize)> = self.obstacles.iter().map(Obstacle::left_m).zip(0..).collect();
        by_left.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let widest_m = self.obstacles.iter().map(|obstacle| 2.0 * obstacle.outline.reach_m()).fold(0.0, f64::max);
        let between = |low_m: f64, high_m: f64| {
            let first = by_left.partition_point(|(left_m, _)| *left_m < low_m - widest_m);
            by_left
                .get(first..)
                .unwrap_or_default()
                .iter()
                .take_while(move |(left_m, _)| *left_m <= high_m)
                .map(|(_, i)| *i)
        };
        for (i, a) in self.obstacles.iter().enumerate() {
            let (centre, reach_m) = (a.outline.centre(), a.outline.reach_m() + up_to_m);
            let is_near = |k: &usize| {
                let other = self.obstacles.get(*k).filter(|_| *k != i).map(|other| &other.outline);
                other.is_some_and(|other| (centre - other.centre()).norm() <= reach_m + other.reach_m())
            };
            let mut near: Vec<usize> = between(centre.x - reach_m, centre.x + reach_m).filter(is_near).collect();
            near.sort_unstable();
            let others = near.iter().filter(|j| **j > i);
            for (j, b) in others.filter_map(|j| Some((*j, self.obstacles.get(*j)?))) {
                if a.z_m[0] >= b.z_m[1] || b.z_m[0] >= a.z_m[1] {
                    continue;
                }
                let contact = a.outline.contact(&b.outline, up_to_m);
                let (width_m, middle) = (contact.distance_m, a.outline.beside(&contact));
                let is_filled = |k: &usize| {
                    let outline = self.obstacles.get(*k).filter(|_| *k != j).map(|other| &other.outline);
                    // OPTIMIZATION: mostly the circle around it says that it is elsewhere.
                    outline.is_some_and(|outline| {
                        let reach_m = outline.reach_m() + ROUNDING_M;
                        let is_near = (outline.centre() - middle).norm_squared() <= reach_m * reach_m;
                        is_near && outline.beyond_m(&middle) <= 0.0
                    })
                };
                // What fills the middle is half as far from `a` as `b` may be.
                if width_m > 0.0 && width_m < up_to_m && !near.iter().any(is_filled) {
                    gaps.push(Gap { middle, width_m });
                }
            }
        }
        gaps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_geom::body::{Body, Part};
    use nalgebra::{Isometry3, Unit, Vector3};

    fn fixed(shape: Shape) -> FixedBody {
        FixedBody { body: Body::single("it", shape).unwrap(), world_from_body: Isometry3::translation(1.0, 0.0, 0.5) }
    }

    #[test]
    fn what_has_an_outline_is_in_the_plan_and_the_rest_is_missed() {
        let solid = fixed(Shape::cuboid(Vector3::new(0.5, 0.5, 0.5)).unwrap());
        let floor = fixed(Shape::half_space(Vector3::z_axis()).unwrap());
        let plan = FloorPlan::new(&[solid.clone(), floor]);
        assert!(!plan.has_gaps && plan.obstacles.len() == 1);
        assert_eq!(plan.obstacles[0].z_m, [0.0, 1.0]);
        let ramp = fixed(Shape::half_space(Unit::new_normalize(Vector3::new(0.1, 0.0, 1.0))).unwrap());
        assert!(FloorPlan::new(&[solid, ramp]).has_gaps);
    }

    #[test]
    fn a_gap_is_where_nothing_is_between() {
        let pillar = |x: f64| FixedBody {
            world_from_body: Isometry3::translation(x, 0.0, 0.5),
            ..fixed(Shape::cylinder(0.1, 0.5).unwrap())
        };
        let plan = FloorPlan::new(&[pillar(0.0), pillar(1.0)]);
        assert_eq!(plan.gaps.len(), 1);
        assert!((plan.gaps[0].width_m - 0.8).abs() < 1e-9 && (plan.gaps[0].middle.x - 0.5).abs() < 1e-9);
        // The outer two have the third one between them.
        let plan = FloorPlan::new(&[pillar(0.0), pillar(1.0), pillar(0.5)]);
        assert_eq!(plan.gaps.len(), 2);
        assert!(FloorPlan::new(&[pillar(0.0), pillar(5.0)]).gaps.is_empty());
    }

    #[test]
    fn of_too_many_gaps_the_narrowest_are_kept_wherever_they_are_looked_for_first() {
        // Pillars on a spiral whose turns draw together: gaps of all widths.
        let pillar = |i: u32| {
            let (angle, radius) = (0.4 * f64::from(i).sqrt(), 0.1 * f64::from(i).sqrt());
            FixedBody {
                world_from_body: Isometry3::translation(radius * angle.cos(), radius * angle.sin(), 0.5),
                ..fixed(Shape::cylinder(0.005, 0.5).unwrap())
            }
        };
        let plan = FloorPlan::new(&(0..1500).map(pillar).collect::<Vec<_>>());
        let mut all = plan.gaps_below(WIDE_M);
        assert!(all.len() > MOST_GAPS, "{}", all.len());
        all.sort_by(|a, b| a.width_m.total_cmp(&b.width_m));
        assert_eq!(plan.gaps, all[..MOST_GAPS]);
    }

    #[test]
    fn a_body_of_several_parts_has_an_outline_for_each() {
        let part =
            |x| Part { shape: Shape::sphere(0.1).unwrap(), body_from_shape: Isometry3::translation(x, 0.0, 0.0) };
        let body = Body::new("two", vec![part(0.0), part(1.0)]).unwrap();
        let plan = FloorPlan::new(&[FixedBody { body, world_from_body: Isometry3::identity() }]);
        assert_eq!(plan.obstacles.len(), 2);
    }
}
