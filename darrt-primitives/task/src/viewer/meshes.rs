//! Solids as the viewer draws them.

use std::collections::BTreeMap;

use darrt_geom::{Body, Part, Shape};
use nalgebra::{Isometry3, Point3};

use super::data::{self, PartData, ShapeData, rounded, to};
use crate::problem_file::{PlateRim, ShapeSpec};

/// A surface of more triangles than this is drawn coarser.
const MOST_TRIANGLES: usize = 12_000;

/// The parts of a body; half spaces have no end and are left out (the floor is always drawn).
pub(super) fn parts(body: &Body) -> Vec<PartData> {
    body.parts.iter().filter_map(part).collect()
}

fn part(part: &Part) -> Option<PartData> {
    Some(PartData { shape: shape(&part.shape)?, pose: data::pose(&part.body_from_shape) })
}

fn shape(shape: &Shape) -> Option<ShapeData> {
    Some(match shape {
        Shape::Cuboid { half_extents, .. } => {
            ShapeData::Box { size: [0, 1, 2].map(|i| rounded(2.0 * half_extents[i])) }
        }
        Shape::Sphere { radius, .. } => ShapeData::Sphere { radius: rounded(*radius) },
        Shape::Cylinder { radius, half_height, .. } => {
            ShapeData::Cylinder { radius: rounded(*radius), length: rounded(2.0 * half_height) }
        }
        Shape::Capsule { radius, half_height, .. } => {
            ShapeData::Capsule { radius: rounded(*radius), length: rounded(2.0 * half_height) }
        }
        Shape::ConvexHull(hull) => mesh(hull.vertices(), hull.triangles()),
        Shape::Mesh(surface) => mesh(surface.vertices(), surface.triangles()),
        // Half spaces, and what the geometry crate may learn one day.
        _ => return None,
    })
}

/// The parts of a thing of a problem: `body`, or what it truly looks like where that is only the solid around it.
pub(super) fn parts_of(spec: &ShapeSpec, body: &Body) -> Vec<PartData> {
    let profile = match spec {
        ShapeSpec::Bowl { radius, height, wall } => bowl(*radius, *height, *wall),
        ShapeSpec::Plate { radius, height, rim } => plate(*radius, *height, *rim),
        _ => return parts(body),
    };
    let profile = profile.into_iter().map(|point| point.map(rounded)).collect();
    vec![PartData { shape: ShapeData::Lathe { profile }, pose: data::pose(&Isometry3::identity()) }]
}

/// From the middle of its inside over the wall to the middle below.
fn bowl(radius: f64, height: f64, wall: f64) -> Vec<[f64; 2]> {
    let (top, inside) = (height / 2.0, radius - wall);
    let ground = (wall - top).min(top);
    vec![[0.0, ground], [inside, ground], [inside, top], [radius, top], [radius, -top], [0.0, -top]]
}

/// From the middle of its upper face over the rim to the middle below.
fn plate(radius: f64, height: f64, rim: PlateRim) -> Vec<[f64; 2]> {
    let (sin, cos) = rim.slope_deg.to_radians().sin_cos();
    let (top, rise) = (height / 2.0, rim.width_m * sin);
    let inner = radius - rim.width_m * cos;
    vec![
        [0.0, top - rise],
        [(inner - rim.thickness_m * sin).max(0.0), top - rise],
        [radius - rim.thickness_m * sin, top],
        [radius, top - rim.thickness_m * cos],
        [inner, top - rim.thickness_m * cos - rise],
        [inner, -top],
        [0.0, -top],
    ]
}

/// A surface, of many triangles a coarser one.
fn mesh(vertices: &[Point3<f64>], triangles: &[[u32; 3]]) -> ShapeData {
    let (low, high) = vertices
        .iter()
        .fold((Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3])), |(low, high), p| {
            (low.inf(p), high.sup(p))
        });
    let mut cells = 256.0;
    let mut drawn = (vertices.to_vec(), triangles.to_vec());
    while drawn.1.len() > MOST_TRIANGLES {
        drawn = clustered(vertices, triangles, &low, (high - low).max() / cells);
        cells /= 1.5;
    }
    ShapeData::Mesh {
        vertices: drawn.0.iter().flat_map(|p| [p.x, p.y, p.z].map(rounded)).collect(),
        triangles: drawn.1.into_iter().flatten().collect(),
    }
}

/// All corners in one cell of a grid become their mean; triangles that lose a corner so, or are there already, go.
fn clustered(
    vertices: &[Point3<f64>],
    triangles: &[[u32; 3]],
    low: &Point3<f64>,
    cell_m: f64,
) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let mut of_cell: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut sums: Vec<(Point3<f64>, f64)> = Vec::new();
    let mut renamed = Vec::with_capacity(vertices.len());
    for p in vertices {
        // No coordinate is below `low`.
        let key = [0, 1, 2].map(|i| to((p[i] - low[i]) / cell_m, 1.0).to_bits());
        let next = u32::try_from(sums.len()).unwrap_or(u32::MAX);
        let index = *of_cell.entry(key).or_insert(next);
        if index == next {
            sums.push((Point3::origin(), 0.0));
        }
        if let Some((sum, count)) = sums.get_mut(index as usize) {
            sum.coords += p.coords;
            *count += 1.0;
        }
        renamed.push(index);
    }
    let mut seen = std::collections::BTreeSet::new();
    let new = |corner: u32| renamed.get(corner as usize).copied();
    let kept = triangles.iter().filter_map(|[a, b, c]| {
        let [a, b, c] = [new(*a)?, new(*b)?, new(*c)?];
        let mut key = [a, b, c];
        key.sort_unstable();
        (a != b && b != c && c != a && seen.insert(key)).then_some([a, b, c])
    });
    let kept = kept.collect();
    (sums.into_iter().map(|(sum, count)| sum / count).collect(), kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_geom::TriangleMesh;
    use std::sync::Arc;

    #[test]
    fn a_fine_surface_is_drawn_coarser_and_keeps_its_size() {
        let count = 200_u32;
        let at = |i: u32| f64::from(i) / f64::from(count);
        let vertices: Vec<_> = (0..=count)
            .flat_map(|i| (0..=count).map(move |j| Point3::new(at(i), at(j), (at(i) * at(j)).sin())))
            .collect();
        let corner = |i: u32, j: u32| i * (count + 1) + j;
        let triangles: Vec<_> = (0..count)
            .flat_map(|i| (0..count).map(move |j| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let surface = Shape::Mesh(Arc::new(TriangleMesh::new("wave", &vertices, &triangles).unwrap()));
        let Some(ShapeData::Mesh { vertices, triangles }) = shape(&surface) else { panic!("not a mesh") };
        assert!(triangles.len() / 3 <= MOST_TRIANGLES && triangles.len() / 3 > MOST_TRIANGLES / 8);
        assert!(triangles.iter().all(|corner| (*corner as usize) < vertices.len() / 3));
        let largest = vertices.iter().copied().fold(0.0, f64::max);
        assert!((0.97..=1.0).contains(&largest), "{largest}");
    }

    #[test]
    fn bowls_are_open_and_plates_have_their_rim() {
        let top = |profile: &[[f64; 2]]| profile.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
        let deep = bowl(0.1, 0.06, 0.005);
        assert!(deep[0][1] < 0.0 && (top(&deep) - 0.03).abs() < 1e-12);
        let rim = PlateRim { slope_deg: 30.0, width_m: 0.04, thickness_m: 0.005 };
        let flat = plate(0.14, 0.03, rim);
        assert!(flat[0][1] < 0.015 && (top(&flat) - 0.015).abs() < 1e-12 && flat.iter().all(|p| p[0] <= 0.14));
    }
}
