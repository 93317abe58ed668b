//! Ends of pushes on polygons of every form: on the support, with the margin asked for, and so is the way there.
#![no_main]

use arbitrary::Arbitrary;
use darrt_core::random::{Purpose, stream};
use darrt_geom::SupportSurface;
use darrt_primitives::push::edge_stop::{EdgeRule, EdgeStop, PushEnd};
use libfuzzer_sys::fuzz_target;
use nalgebra::Point2;

/// How far a state on the way may be outside, metres; rounding at corners is far below.
const SLACK: f64 = 1e-6;

#[derive(Debug, Arbitrary)]
enum Outline {
    /// Corners in order, millimetres; mostly refused for crossing itself.
    Corners(Vec<[i16; 2]>),
    /// Distances of the corners from the middle, centimetres, at equal angles: always simple.
    Star(Vec<u8>),
    /// Steps to the right and heights, centimetres: a skyline, with reentrant right angles.
    Skyline(Vec<[u8; 2]>),
}

#[derive(Debug, Arbitrary)]
enum Place {
    /// Millimetres.
    At([i16; 2]),
    /// Drawn from the surface.
    Drawn(u64),
    /// On an edge.
    Edge { edge: u8, share: u8 },
}

#[derive(Debug, Arbitrary)]
struct Case {
    outline: Outline,
    from: Place,
    target: Place,
    crosses: bool,
    /// Millimetres.
    target_margin: u8,
    edge_distance: u16,
}

impl Outline {
    fn corners(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Corners(all) => all.iter().map(|p| Point2::from(p.map(|x| f64::from(x) / 1000.0))).collect(),
            Self::Star(radii) => {
                let step = std::f64::consts::TAU / radii.len() as f64;
                let corner = |(i, radius): (usize, &u8)| {
                    let (sin, cos) = (step * i as f64).sin_cos();
                    Point2::new(cos, sin) * (0.05 + f64::from(*radius) / 100.0)
                };
                radii.iter().enumerate().map(corner).collect()
            }
            Self::Skyline(steps) => {
                let mut x = 0.0;
                let mut corners = Vec::new();
                for [width, height] in steps {
                    let height = 0.05 + f64::from(*height) / 100.0;
                    corners.push(Point2::new(x, height));
                    x += 0.01 + f64::from(*width) / 100.0;
                    corners.push(Point2::new(x, height));
                }
                corners.dedup();
                corners.extend([Point2::new(x, 0.0), Point2::new(0.0, 0.0)]);
                corners
            }
        }
    }
}

impl Place {
    fn point(&self, surface: &SupportSurface) -> Point2<f64> {
        match self {
            Self::At(at) => Point2::from(at.map(|x| f64::from(x) / 1000.0)),
            Self::Drawn(seed) => {
                surface.sample(&mut stream(*seed, 0, 0, Purpose::Sample), 0.0).unwrap_or(surface.edges()[0].start)
            }
            Self::Edge { edge, share } => {
                let all = surface.edges();
                let edge = all[usize::from(*edge) % all.len()];
                edge.start + (edge.end - edge.start) * (f64::from(*share) / 255.0)
            }
        }
    }
}

fuzz_target!(|case: Case| {
    let Ok(surface) = SupportSurface::new("table", &case.outline.corners(), 0.75) else { return };
    let (from, target) = (case.from.point(&surface), case.target.point(&surface));
    let stop = EdgeStop {
        rule: if case.crosses { EdgeRule::LineCrossing } else { EdgeRule::NearestEdgePoint },
        target_margin: f64::from(case.target_margin) / 1000.0,
        edge_distance: f64::from(case.edge_distance % 1024) / 1000.0,
    };
    if let Ok(end) = stop.end_of_push(&surface, &from, &target) {
        keeps_its_promise(&surface, &stop, &from, &target, &end);
    }
});

fn keeps_its_promise(
    surface: &SupportSurface,
    stop: &EdgeStop,
    from: &Point2<f64>,
    target: &Point2<f64>,
    end: &PushEnd,
) {
    assert!(surface.contains(from));
    let depth = surface.depth(&end.center);
    if end.limited_by_edge {
        assert!(depth >= stop.edge_distance - 1e-8, "{depth} inside, asked for {}", stop.edge_distance);
        assert!((end.center - target).norm() < (from - target).norm(), "not nearer to the target");
    } else {
        assert_eq!(end.center, *target);
        assert!(depth >= stop.target_margin, "{depth} inside, asked for {}", stop.target_margin);
    }
    let at = |s: f64| from + s * end.length * end.direction.into_inner();
    assert!((at(1.0) - end.center).norm() < 1e-9 * (1.0 + end.length));
    for i in 0..=64 {
        let depth = surface.depth(&at(f64::from(i) / 64.0));
        assert!(depth >= -SLACK, "{} m off the support at {i}/64 of the way", -depth);
    }
}
