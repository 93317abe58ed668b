//! How far a point is from the surface of an object as fingers meet it: a bowl is hollow here.

use nalgebra::{Point3, Vector2, Vector3};

use crate::problem_file::ShapeSpec;

/// Steps with which a direction is found, metres.
const STEP_M: f64 = 1e-6;

/// A ray that needs more steps grazes the surface.
const MOST_STEPS: usize = 64;

/// A ray so near the surface has met it, metres.
const MET_M: f64 = 1e-7;

/// Distance from the surface of the shape, metres: negative inside, never more than the true one outside. `None` for a shape
/// that no fingers take.
pub(super) fn distance(shape: &ShapeSpec, p: &Point3<f64>) -> Option<f64> {
    let section = Vector2::new(p.x.hypot(p.y), p.z);
    Some(match *shape {
        ShapeSpec::Box { size: [x, y, z] } => {
            let beyond = p.coords.abs() - Vector3::new(x, y, z) / 2.0;
            beyond.sup(&Vector3::zeros()).norm() + beyond.max().min(0.0)
        }
        ShapeSpec::Sphere { radius } => p.coords.norm() - radius,
        ShapeSpec::Cylinder { radius, height } => rectangle(section, [-radius, radius], [-height / 2.0, height / 2.0]),
        ShapeSpec::Capsule { radius, height } => {
            let half = height / 2.0 - radius;
            (p - Point3::new(0.0, 0.0, p.z.clamp(-half, half))).norm() - radius
        }
        ShapeSpec::Bowl { radius, height, wall } => {
            let side = rectangle(section, [radius - wall, radius], [-height / 2.0, height / 2.0]);
            let bottom = rectangle(section, [-radius, radius], [-height / 2.0, wall - height / 2.0]);
            side.min(bottom)
        }
        ShapeSpec::Plate { radius, height, rim } => {
            // The rim in its own axes: from its lower edge inward along its face, and across.
            let (sin, cos) = rim.slope_deg.to_radians().sin_cos();
            let from_edge = section - Vector2::new(radius, height / 2.0 - rim.thickness_m * cos);
            let (inward, upward) = (Vector2::new(-cos, -sin), Vector2::new(-sin, cos));
            let in_rim = Vector2::new(from_edge.dot(&inward), from_edge.dot(&upward));
            let ring = rectangle(in_rim, [0.0, rim.width_m], [0.0, rim.thickness_m]);
            let inside = radius - rim.width_m * cos;
            ring.min(rectangle(section, [-inside, inside], [-height / 2.0, height / 2.0 - rim.width_m * sin]))
        }
        ShapeSpec::Hull { .. } | ShapeSpec::Mesh { .. } => return None,
    })
}

/// Distance from a rectangle in the plane through the axis.
fn rectangle(p: Vector2<f64>, [left, right]: [f64; 2], [bottom, top]: [f64; 2]) -> f64 {
    let beyond = Vector2::new((left - p.x).max(p.x - right), (bottom - p.y).max(p.y - top));
    beyond.sup(&Vector2::zeros()).norm() + beyond.max().min(0.0)
}

/// Where a ray along a unit vector enters the shape: how far from its start, at most `most_m`, and the outward normal there.
/// A start inside counts as entering at once.
pub(super) fn enters(
    shape: &ShapeSpec,
    start: &Point3<f64>,
    along: &Vector3<f64>,
    most_m: f64,
) -> Option<(f64, Vector3<f64>)> {
    let mut gone = 0.0;
    for _ in 0..MOST_STEPS {
        let at = start + along * gone;
        let left = distance(shape, &at)?;
        if left <= MET_M {
            return Some((gone, normal(shape, &at)?));
        }
        gone += left;
        if gone > most_m {
            return None;
        }
    }
    None
}

/// The direction in which the distance grows.
fn normal(shape: &ShapeSpec, at: &Point3<f64>) -> Option<Vector3<f64>> {
    let slope =
        |axis: Vector3<f64>| Some(distance(shape, &(at + axis * STEP_M))? - distance(shape, &(at - axis * STEP_M))?);
    Vector3::new(slope(Vector3::x())?, slope(Vector3::y())?, slope(Vector3::z())?).try_normalize(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem_file::PlateRim;

    fn shapes() -> Vec<ShapeSpec> {
        vec![
            ShapeSpec::Box { size: [0.05, 0.08, 0.12] },
            ShapeSpec::Sphere { radius: 0.04 },
            ShapeSpec::Cylinder { radius: 0.14, height: 0.02 },
            ShapeSpec::Capsule { radius: 0.03, height: 0.1 },
        ]
    }

    /// Against the oracle, where collisions see the same solid.
    #[test]
    fn distances_outside_are_those_of_the_solid() {
        for shape in shapes() {
            let solid = shape.body("solid").unwrap();
            let dot = darrt_geom::Body::single("dot", darrt_geom::Shape::sphere(1e-4).unwrap()).unwrap();
            for i in 0..400 {
                let turn = f64::from(i) * 2.4;
                let p = Point3::new(0.2 * turn.sin(), 0.2 * (1.7 * turn).cos(), 0.1 * (0.3 * turn).sin());
                let at = nalgebra::Isometry3::translation(p.x, p.y, p.z);
                let found =
                    darrt_geom::clearance::between(&dot, &at, &solid, &nalgebra::Isometry3::identity()).unwrap();
                if found.distance > 1e-3 {
                    let own = distance(&shape, &p).unwrap();
                    assert!((own - found.distance - 1e-4).abs() < 3e-5, "{shape:?} {p}: {own} {}", found.distance);
                }
            }
        }
    }

    /// From below a plate is what collisions see; above they fill its rim.
    #[test]
    fn the_underside_of_a_plate_is_that_of_the_solid() {
        let rim = PlateRim { slope_deg: 15.0, width_m: 0.045, thickness_m: 0.005 };
        let plate = ShapeSpec::Plate { radius: 0.14, height: 0.025, rim };
        let solid = plate.body("plate").unwrap();
        let dot = darrt_geom::Body::single("dot", darrt_geom::Shape::sphere(1e-4).unwrap()).unwrap();
        for i in 0..400 {
            let turn = f64::from(i) * 2.4;
            let (radius, depth) = (0.1 + 0.05 * turn.sin(), 0.004 + 0.004 * (1.7 * turn).cos());
            // A point this much below the lower face of the rim.
            let under =
                0.0125 - 0.005 * 15.0_f64.to_radians().cos() - (0.14 - radius) * 15.0_f64.to_radians().tan() - depth;
            let p = Point3::new(radius * turn.cos(), radius * turn.sin(), under);
            let at = nalgebra::Isometry3::translation(p.x, p.y, p.z);
            let found = darrt_geom::clearance::between(&dot, &at, &solid, &nalgebra::Isometry3::identity()).unwrap();
            let own = distance(&plate, &p).unwrap();
            if own > 1e-3 {
                assert!((own - found.distance - 1e-4).abs() < 5e-4, "{p}: {own} {}", found.distance);
            }
        }
        let at = |x: f64, z: f64| distance(&plate, &Point3::new(x, 0.0, z)).unwrap();
        assert!(at(0.0, 0.0125) > 0.01, "it is hollow above");
        assert!(at(0.139, 0.009) < 0.0 && at(0.0, 0.0) < 0.0);
    }

    /// Pads as the planner closes them lie on the surface, whatever the family.
    #[test]
    fn planned_pads_touch_what_they_hold() {
        let hand = darrt_pr2::robot::Gripper;
        for name in ["plate1", "sloping-rim-plate", "two-tables"] {
            let object = crate::testing::builtin(name).unwrap().objects.remove(0);
            for grasp in crate::grasp_families::families(&object, &hand).unwrap().iter().flat_map(|f| f.grid()) {
                for side in [1.0, -1.0] {
                    // A centimetre behind the fingertips, on the pad.
                    let tip = darrt_primitives::manipulator::Hand::tip_beyond_tool_m(&hand, grasp.closed_gap_m);
                    let on_pad = Point3::new(tip - 0.01, side * grasp.closed_gap_m / 2.0, 0.0);
                    let gap = distance(&object.shape, &(grasp.object_from_tool * on_pad)).unwrap();
                    assert!(gap.abs() < 1e-9, "{name} {gap} {grasp:?}");
                }
            }
        }
    }

    #[test]
    fn a_bowl_is_hollow() {
        let bowl = ShapeSpec::Bowl { radius: 0.075, height: 0.065, wall: 0.005 };
        let at = |x: f64, z: f64| distance(&bowl, &Point3::new(0.0, x, z)).unwrap();
        for (x, z, expected) in [
            (0.0, 0.0, 0.0275),
            (0.06, 0.0, 0.010),
            (0.0725, 0.0, -0.0025),
            (0.08, 0.0, 0.005),
            (0.0, -0.04, 0.0075),
            (0.072, 0.0425, 0.01),
        ] {
            assert!((at(x, z) - expected).abs() < 1e-12, "{x} {z}: {}", at(x, z));
        }
    }

    #[test]
    fn rays_enter_where_the_surface_is_with_its_normal() {
        let plate = ShapeSpec::Cylinder { radius: 0.14, height: 0.02 };
        let down = -Vector3::z();
        let (gone, normal) = enters(&plate, &Point3::new(0.1, 0.05, 0.013), &down, 0.01).unwrap();
        assert!((gone - 0.003).abs() < 1e-6 && (normal - Vector3::z()).norm() < 1e-6);
        assert_eq!(enters(&plate, &Point3::new(0.1, 0.05, 0.013), &down, 0.002), None);
        assert_eq!(enters(&plate, &Point3::new(0.15, 0.0, 0.013), &down, 0.1), None);
        let (gone, normal) = enters(&plate, &Point3::new(-0.2, 0.0, 0.0), &Vector3::x(), 0.1).unwrap();
        assert!((gone - 0.06).abs() < 1e-6 && (normal + Vector3::x()).norm() < 1e-6);
        assert_eq!(enters(&plate, &Point3::new(0.0, 0.0, 0.004), &down, 0.1).unwrap().0, 0.0);
    }
}
