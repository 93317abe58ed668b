use super::super::TriangleMesh;
use crate::body::Body;
use crate::collide::CollisionModel;
use crate::oracle::{PosedBody, nearest};
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::sync::Arc;

type Soup = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// A box with its corners at `centre` plus and minus `half`; every second triangle is turned inside out.
fn block(centre: [f64; 3], half: [f64; 3]) -> Soup {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        Point3::new(centre[0] + sign(0) * half[0], centre[1] + sign(1) * half[1], centre[2] + sign(2) * half[2])
    };
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*d, *c, *a]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

fn all(soups: &[Soup]) -> Soup {
    let mut whole = Soup::default();
    for (vertices, triangles) in soups {
        let first = u32::try_from(whole.0.len()).unwrap();
        whole.0.extend(vertices);
        whole.1.extend(triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
    }
    whole
}

fn mesh((vertices, triangles): &Soup) -> TriangleMesh {
    TriangleMesh::new("mesh", vertices, triangles).unwrap()
}

#[test]
fn cavities_are_air_and_overlaps_are_solid() {
    let at = |x: f64| Point3::new(x, 0.01, 0.02);
    let nested = mesh(&all(&[block([0.0; 3], [1.0; 3]), block([0.0; 3], [0.6; 3]), block([0.0; 3], [0.2; 3])]));
    assert_eq!(nested.open_edges(), 0);
    for (x, is_solid) in [(0.0, true), (0.4, false), (0.8, true), (1.2, false)] {
        assert_eq!(nested.contains(&at(x)), is_solid, "{x}");
    }
    assert!(nested.separates(&at(0.4), &at(1.2)) && nested.separates(&at(0.0), &at(0.4)));
    assert!(!nested.separates(&at(1.2), &at(-3.0)));
    let beside = mesh(&all(&[block([0.0; 3], [1.0; 3]), block([1.0, 0.0, 0.0], [1.0; 3])]));
    for (x, is_solid) in [(-0.5, true), (0.5, true), (1.5, true), (2.5, false)] {
        assert_eq!(beside.contains(&at(x)), is_solid, "{x}");
    }
}

#[test]
fn what_is_not_closed_is_a_shell_and_says_how_open_it_is() {
    let (vertices, mut triangles) = block([0.0; 3], [1.0; 3]);
    triangles.pop();
    let open = mesh(&(vertices, triangles));
    assert_eq!(open.open_edges(), 3);
    assert!(!open.contains(&Point3::new(0.1, 0.2, 0.3)));
    // Beside a closed piece it is a shell by itself.
    let (vertices, mut triangles) = all(&[block([0.0; 3], [1.0; 3]), block([5.0, 0.0, 0.0], [1.0; 3])]);
    triangles.pop();
    let both = mesh(&(vertices, triangles));
    assert!(both.contains(&Point3::new(0.1, 0.2, 0.3)) && !both.contains(&Point3::new(5.1, 0.2, 0.3)));
}

#[test]
fn a_soup_without_common_corners_is_closed_as_well() {
    let (vertices, triangles) = block([0.0; 3], [1.0; 3]);
    let corners: Vec<_> = triangles.iter().flatten().map(|i| vertices[*i as usize]).collect();
    let count = u32::try_from(triangles.len()).unwrap();
    let soup = mesh(&(corners, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()));
    assert!(soup.open_edges() == 0 && soup.contains(&Point3::origin()));
}

#[test]
fn rays_through_corners_and_edges_count_once() {
    let cube = mesh(&block([0.0; 3], [1.0; 3]));
    let slope = Vector3::new(-super::SLOPE[0], -super::SLOPE[1], 1.0);
    for target in cube.vertices().iter().chain([&Point3::new(0.0, 1.0, 1.0), &Point3::new(0.0, 0.0, 1.0)]) {
        for far in [-0.3, -0.01, 0.01, 0.3] {
            let p = target + slope * far;
            let is_inside = p.coords.amax() < 1.0;
            assert_eq!(cube.contains(&p), is_inside, "{p} towards {target}");
        }
    }
}

fn turned() -> impl Strategy<Value = Isometry3<f64>> {
    (prop::array::uniform3(-1.5_f64..1.5), prop::array::uniform3(-3.0_f64..3.0)).prop_map(|(at, turn)| {
        Isometry3::from_parts(Vector3::from(at).into(), UnitQuaternion::from_scaled_axis(Vector3::from(turn)))
    })
}

proptest! {
    #[test]
    fn a_closed_mesh_holds_what_its_box_holds(
        half in prop::array::uniform3(0.05_f64..1.0), at in prop::array::uniform3(-1.2_f64..1.2),
    ) {
        let cube = mesh(&block([0.0; 3], half));
        let p = Point3::from(at);
        let beyond = (0..3).map(|i| p[i].abs() - half[i]).fold(f64::NEG_INFINITY, f64::max);
        prop_assume!(beyond.abs() > 1e-9);
        prop_assert_eq!(cube.contains(&p), beyond < 0.0);
    }

    /// The checker and the judge see a solid where there is one, and both say of a closed mesh what they say of its box.
    #[test]
    fn checker_and_judge_see_a_solid(pose in turned(), world_from_mesh in turned(), radius in 0.02_f64..0.3) {
        let solid = Shape::Mesh(Arc::new(mesh(&block([0.0; 3], [0.8, 0.5, 0.3]))));
        let cuboid = Shape::cuboid(Vector3::new(0.8, 0.5, 0.3)).unwrap();
        let body = |name: &str, shape| Body::single(Arc::from(name), shape).unwrap();
        let ball = body("ball", Shape::sphere(radius).unwrap());
        let verdict = |fixed: &Body| {
            let mut builder = CollisionModel::builder();
            builder.add_fixed(fixed, &world_from_mesh).unwrap();
            let moving = builder.add_moving(&ball).unwrap();
            let model = builder.build();
            let mut scratch = model.scratch();
            model.set_pose(&mut scratch, moving, &pose);
            let fast = model.clearance(
                &mut scratch, &crate::BodySet::ALL, &crate::AllowedContacts::none(), 0.0, 1.0,
            );
            let bodies = [
                PosedBody { body: fixed, world_from_body: world_from_mesh },
                PosedBody { body: &ball, world_from_body: pose },
            ];
            let judged = nearest(&bodies, &|_, _| false).unwrap().unwrap();
            (fast, judged)
        };
        let (fast, judged) = verdict(&body("fixed", solid));
        let (_, truth) = verdict(&body("fixed", cuboid));
        prop_assume!(truth.intersects || truth.distance > 1e-4);
        prop_assert_eq!(judged.intersects, truth.intersects);
        prop_assert_eq!(fast.is_err(), truth.intersects);
        if !truth.intersects {
            prop_assert!((judged.distance - truth.distance).abs() < 1e-4);
        }
    }
}
