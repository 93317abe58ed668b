use super::*;
use std::sync::Arc;

fn fixed(shape: Shape, at: [f64; 3]) -> FixedBody {
    FixedBody {
        body: Body::single("table", shape).unwrap(),
        world_from_body: Isometry3::translation(at[0], at[1], at[2]),
    }
}

/// What is said about a polygon at a height on a body.
fn said(carrier: &FixedBody, polygon: &[[f64; 2]], z: f64) -> Option<String> {
    let corners: Vec<_> = polygon.iter().map(|&p| Point2::from(p)).collect();
    let surface = SupportSurface::new("top", &corners, z).unwrap();
    check(&surface, polygon, carrier, "surface[0]").err().map(|(key, flaw)| format!("`{key}` {flaw}"))
}

fn square(half: f64) -> [[f64; 2]; 4] {
    [[-half, -half], [half, -half], [half, half], [-half, half]]
}

#[test]
fn the_top_of_a_convex_body_carries() {
    let cube = fixed(Shape::cuboid(Vector3::repeat(0.5)).unwrap(), [0.0, 0.0, 0.5]);
    assert_eq!(said(&cube, &square(0.5), 1.0), None);
    assert_eq!(said(&cube, &square(0.5006), 1.0008), None);
    let notch = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [0.0, 0.0], [-0.5, 0.5]];
    assert_eq!(said(&cube, &notch, 1.0), None);
    let column = fixed(Shape::cylinder(0.5, 0.4).unwrap(), [0.0, 0.0, 0.4]);
    assert_eq!(said(&column, &square(0.35), 0.8), None);
    let wedge = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.5, 1.0]];
    let wedge = fixed(Shape::convex_hull("wedge", &wedge.map(Point3::from)).unwrap(), [0.0; 3]);
    assert_eq!(said(&wedge, &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]], 1.0), None);
    assert!(said(&wedge, &[[0.0, 0.0], [0.7, 0.0], [0.0, 0.5]], 1.0).unwrap().contains("[0.7, 0]"));
}

#[test]
fn surfaces_above_in_and_beside_their_body_are_refused_with_numbers() {
    let cube = fixed(Shape::cuboid(Vector3::repeat(0.5)).unwrap(), [0.0, 0.0, 0.5]);
    assert_eq!(
        said(&cube, &square(0.5), 1.2).unwrap(),
        "`surface[0].z` puts the surface `top` at the height 1.2, but the top of its body `table` is at 1; they may \
         differ by 0.001 m"
    );
    assert!(said(&cube, &square(0.5), 0.9).unwrap().contains("at the height 0.9"));
    assert_eq!(
        said(&cube, &[[-0.5, -0.5], [0.5, -0.5], [0.75, 0.5]], 1.0).unwrap(),
        "`surface[0].polygon[2]` is the corner [0.75, 0.5] of the surface `top`, 0.25 m beside its body `table`; at most \
         0.001 m is on it"
    );
    let column = fixed(Shape::cylinder(0.5, 0.4).unwrap(), [0.0, 0.0, 0.4]);
    assert!(said(&column, &square(0.4), 0.8).unwrap().contains("polygon[0]"));
    let ball = fixed(Shape::sphere(0.5).unwrap(), [0.0; 3]);
    assert!(said(&ball, &square(0.1), 0.5).is_some());
}

/// Two boxes of 4 cm one above the other, undersides at 0.4 and 0.9: a shelf without sides.
fn shelf(turned: bool) -> FixedBody {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for bottom in [0.4, 0.9] {
        let first = u32::try_from(vertices.len()).unwrap();
        for z in [bottom, bottom + 0.04] {
            vertices.extend(square(0.5).map(|[x, y]| Point3::new(x, y, z)));
        }
        let quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        for [a, b, c, d] in quads.map(|quad| quad.map(|i| first + i)) {
            triangles.extend(if turned { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    fixed(Shape::Mesh(Arc::new(TriangleMesh::new("shelf", &vertices, &triangles).unwrap())), [1.0, 0.0, 0.0])
}

#[test]
fn the_boards_of_a_mesh_carry_and_their_undersides_do_not() {
    let there = square(0.5).map(|[x, y]| [x + 1.0, y]);
    for z in [0.44, 0.94, 0.9405] {
        assert_eq!(said(&shelf(false), &there, z), None, "{z}");
        assert_eq!(said(&shelf(true), &there, z), None, "{z}");
    }
    for z in [0.4, 0.9, 0.6, 1.0, 0.2] {
        assert!(said(&shelf(false), &there, z).is_some(), "{z}");
    }
    let above = said(&shelf(false), &there, 1.2).unwrap();
    assert!(above.starts_with("`surface[0]` puts the surface `top` at the height 1.2, but at ["), "{above}");
    assert!(above.contains("`table`") && above.contains("0.94") && above.contains("0.001"), "{above}");
    let wide = there.map(|[x, y]| [x, y * 1.1]);
    assert!(said(&shelf(false), &wide, 0.94).unwrap().contains("nothing"));
}
