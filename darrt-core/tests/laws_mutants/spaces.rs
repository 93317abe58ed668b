//! Spaces.

use darrt_core::laws::{SpaceClaims, check_component_space, check_space_covers};
use darrt_core::prelude::*;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::{RealBox, Se2};
use rand::Rng;

use super::Mutant;

/// A stock space with some answers changed.
struct Warped<S: ComponentSpace> {
    inner: S,
    contains: fn(&S, &S::Config) -> bool,
    distance: fn(&S, &S::Config, &S::Config) -> f64,
    interpolate: fn(&S, &S::Config, &S::Config, f64) -> S::Config,
    sample: fn(&S, &mut dyn Rng) -> S::Config,
    dimension: usize,
    tolerance: f64,
}

impl<S: ComponentSpace> Warped<S> {
    fn new(inner: S) -> Self {
        let (dimension, tolerance) = (inner.dimension(), inner.tolerance());
        Self {
            inner,
            contains: S::contains,
            distance: S::distance,
            interpolate: S::interpolate,
            sample: S::sample,
            dimension,
            tolerance,
        }
    }
}

impl<S: ComponentSpace> ComponentSpace for Warped<S> {
    type Config = S::Config;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn contains(&self, q: &S::Config) -> bool {
        (self.contains)(&self.inner, q)
    }

    fn distance(&self, a: &S::Config, b: &S::Config) -> f64 {
        (self.distance)(&self.inner, a, b)
    }

    fn interpolate(&self, a: &S::Config, b: &S::Config, t: f64) -> S::Config {
        (self.interpolate)(&self.inner, a, b, t)
    }

    fn sample(&self, rng: &mut dyn Rng) -> S::Config {
        (self.sample)(&self.inner, rng)
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

/// Is any law of a space broken, for samples of the shipped one?
fn is_off<S: ComponentSpace>(make: fn() -> S, change: fn(&mut Warped<S>)) -> bool {
    let mut space = Warped::new(make());
    change(&mut space);
    let honest = make();
    let check = |i: u64| {
        let [a, b, c] = [0, 1, 2].map(|k| honest.sample(&mut stream(i, k, 0, Purpose::Sample)));
        check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.8], i)
    };
    (0..64).any(|i| check(i).is_err()) || check_space_covers(&space, 512, 0).is_err()
}

fn square() -> RealBox<2> {
    RealBox::new([0.0, 0.0], [2.0, 1.0]).unwrap()
}

fn plane() -> Se2 {
    Se2::new([0.0, 0.0], [2.0, 1.0], 0.5).unwrap()
}

pub(super) fn all() -> Vec<Mutant> {
    type OnSquare = (&'static str, fn(&mut Warped<RealBox<2>>));
    type OnPlane = (&'static str, fn(&mut Warped<Se2>));
    let of_square: Vec<OnSquare> = vec![
        ("contains is negated", |s| s.contains = |s, q| !s.contains(q)),
        ("contains forgets an axis", |s| s.contains = |_, q| (0.0..=2.0).contains(&q[0])),
        ("contains forgets the lower bound", |s| s.contains = |_, q| q[0] <= 2.0 && q[1] <= 1.0),
        ("contains everything", |s| s.contains = |_, _| true),
        ("contains less", |s| s.contains = |s, q| s.contains(q) && q[0] < 1.9),
        ("the distance forgets an axis", |s| s.distance = |_, a, b| (a[0] - b[0]).abs()),
        ("the distance forgets its root", |s| s.distance = |s, a, b| s.distance(a, b).powi(2)),
        ("the distance is the sum of the axes", |s| s.distance = |_, a, b| (a[0] - b[0]).abs() + (a[1] - b[1]).abs()),
        ("the distance adds where it subtracts", |s| s.distance = |_, a, b| (a[0] + b[0]).hypot(a[1] - b[1])),
        ("the distance has a sign", |s| s.distance = |_, a, b| a[0] - b[0] + a[1] - b[1]),
        ("the distance is one too much", |s| s.distance = |s, a, b| s.distance(a, b) + 1.0),
        ("the distance is 0", |s| s.distance = |_, _, _| 0.0),
        ("interpolates to the other end", |s| s.interpolate = |s, a, b, t| s.interpolate(b, a, t)),
        ("interpolates too far", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, 1.1 * t)),
        ("interpolates not far enough", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, 0.9 * t)),
        ("interpolates unevenly", |s| s.interpolate = |s, a, b, t| s.interpolate(a, b, t * t)),
        ("interpolates one axis", |s| s.interpolate = |s, a, b, t| [s.interpolate(a, b, t)[0], b[1]]),
        ("stays at the start", |s| s.interpolate = |_, a, _, _| *a),
        ("samples the lower half", |s| s.sample = |s, rng| s.sample(rng).map(|x| 0.5 * x)),
        ("samples a point", |s| s.sample = |_, _| [0.5, 0.5]),
        ("samples a line", |s| s.sample = |s, rng| [s.sample(rng)[0], 0.5]),
        ("samples beyond the bound", |s| s.sample = |s, rng| s.sample(rng).map(|x| 1.01 * x)),
        ("no dimension", |s| s.dimension = 0),
        ("the tolerance is a metre", |s| s.tolerance = 1.0),
        ("the tolerance is 0", |s| s.tolerance = 0.0),
    ];
    let of_plane: Vec<OnPlane> = vec![
        ("the distance forgets the heading", |s| s.distance = |_, a, b| (a[0] - b[0]).hypot(a[1] - b[1])),
        ("the heading is not wrapped", |s| {
            s.distance = |_, a, b| (a[0] - b[0]).hypot(a[1] - b[1]) + 0.5 * (a[2] - b[2]).abs();
        }),
        ("the heading goes the long way", |s| {
            s.interpolate = |s, a, b, t| {
                let [x, y, yaw] = s.interpolate(a, b, t);
                [x, y, if t > 0.0 && t < 1.0 { a[2] + (b[2] - a[2]) * t } else { yaw }]
            };
        }),
        ("contains any heading", |s| s.contains = |s, q| s.contains(&[q[0], q[1], 0.0])),
        ("samples half of the headings", |s| s.sample = |s, rng| s.sample(rng).map(f64::abs)),
    ];
    let square_mutants = of_square
        .into_iter()
        .map(|(what, change)| -> Mutant { ("RealBox", what, Box::new(move || is_off(square, change))) });
    let plane_mutants =
        of_plane.into_iter().map(|(what, change)| -> Mutant { ("Se2", what, Box::new(move || is_off(plane, change))) });
    square_mutants.chain(plane_mutants).collect()
}
