use super::*;
use crate::ContactReason;
use crate::body::{Body, Part};
use crate::oracle::{self, PosedBody};
use crate::shape::Shape;
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Largest coordinate of a random pose.
const ROOM: f64 = 1.0;

fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    // Axis-aligned and grid poses are common in planning problems and hard for iterative methods.
    let free = (prop::array::uniform3(-ROOM..ROOM), prop::array::uniform3(-3.0_f64..3.0));
    let grid = (prop::array::uniform3(-4_i8..5), prop::array::uniform3(0_i8..4)).prop_map(|(t, r)| {
        let quarter = std::f64::consts::FRAC_PI_2;
        (t.map(|x| f64::from(x) * 0.25), [f64::from(r[0]) * quarter, 0.0, 0.0])
    });
    prop_oneof![free, grid].prop_map(|(t, r)| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(r));
        Isometry3::from_parts(Vector3::from(t).into(), turn)
    })
}

fn size() -> impl Strategy<Value = f64> {
    prop_oneof![0.02_f64..0.4, Just(0.25), Just(0.125)]
}

fn points() -> impl Strategy<Value = Vec<Point3<f64>>> {
    prop::collection::vec(prop::array::uniform3(-0.3_f64..0.3).prop_map(Point3::from), 6..20)
}

/// Boxes and balls: pairs the checker decides exactly.
fn simple() -> impl Strategy<Value = Shape> {
    prop_oneof![
        3 => [size(), size(), size()].prop_map(|h| Shape::cuboid(Vector3::from(h)).unwrap()),
        1 => size().prop_map(|r| Shape::sphere(r).unwrap()),
    ]
}

fn bounded() -> impl Strategy<Value = Shape> {
    prop_oneof![
        3 => simple(),
        2 => (size(), size()).prop_map(|(r, h)| Shape::cylinder(r, h).unwrap()),
        1 => (size(), size()).prop_map(|(r, h)| Shape::capsule(r, h).unwrap()),
        1 => points().prop_filter_map("flat", |p| Shape::convex_hull("hull", &p).ok()),
        1 => points().prop_filter_map("empty", |p| {
            let triangles: Vec<[u32; 3]> = (0..u32::try_from(p.len()).unwrap() - 2).map(|i| [i, i + 1, i + 2]).collect();
            crate::TriangleMesh::new("mesh", &p, &triangles).ok().map(|mesh| Shape::Mesh(mesh.into()))
        }),
    ]
}

fn any_shape() -> impl Strategy<Value = Shape> {
    let half_space = prop::array::uniform3(-1.0_f64..1.0)
        .prop_filter_map("zero", |n| nalgebra::Unit::try_new(Vector3::from(n), 0.1))
        .prop_map(|n| Shape::half_space(n).unwrap());
    prop_oneof![9 => bounded(), 1 => half_space]
}

fn parts(shape: impl Strategy<Value = Shape>) -> impl Strategy<Value = Vec<Part>> {
    prop::collection::vec((shape, pose()), 1..3).prop_map(|parts| {
        parts
            .into_iter()
            .map(|(shape, mut body_from_shape)| {
                body_from_shape.translation.vector *= 0.3;
                Part { shape, body_from_shape }
            })
            .collect()
    })
}

/// Moving bodies and fixed ones, all with poses.
#[derive(Debug, Clone)]
struct World {
    bodies: Vec<(Body, Isometry3<f64>)>,
    moving: usize,
}

impl World {
    fn model(&self) -> (CollisionModel, Scratch) {
        let mut builder = CollisionModel::builder();
        for (i, (body, pose)) in self.bodies.iter().enumerate() {
            if i < self.moving { builder.add_moving(body) } else { builder.add_fixed(body, pose) }.unwrap();
        }
        let model = builder.build();
        let mut scratch = model.scratch();
        let poses: Vec<_> = self.bodies.iter().take(self.moving).map(|(_, pose)| *pose).collect();
        model.set_poses(&mut scratch, &poses);
        (model, scratch)
    }

    /// The judge's word over all tested pairs.
    fn judge(&self) -> Option<oracle::Finding> {
        self.judge_of(|_, _| true)
    }

    /// The judge's word over the tested pairs that are asked for.
    fn judge_of(&self, asked: impl Fn(usize, usize) -> bool) -> Option<oracle::Finding> {
        let posed: Vec<_> = self.bodies.iter().map(|(body, pose)| PosedBody { body, world_from_body: *pose }).collect();
        oracle::nearest(&posed, &|i, j| i.min(j) >= self.moving || !asked(i, j)).unwrap()
    }

    /// The judge's word over the pairs that these closer ones name, each at most once, and over the others: with the
    /// clearance of each.
    fn judge_each(&self, query: &Query<'_>) -> Vec<(f64, oracle::Finding)> {
        let clearance = |i: usize, j: usize| {
            let [a, b] = [i, j].map(|i| BodyIndex::new(u16::try_from(i).unwrap()));
            query.clearance_of(a, b)
        };
        let kinds = query.closer.iter().map(|closer| closer.clearance.min(query.clearance)).chain([query.clearance]);
        kinds.filter_map(|kind| Some((kind, self.judge_of(|i, j| clearance(i, j) == kind)?))).collect()
    }
}

fn world(
    moving: impl Strategy<Value = Shape> + Clone,
    fixed: impl Strategy<Value = Shape>,
) -> impl Strategy<Value = World> {
    let bodies =
        (prop::collection::vec((parts(moving), pose()), 1..4), prop::collection::vec((parts(fixed), pose()), 0..4));
    bodies.prop_map(|(moving, fixed)| {
        let count = moving.len();
        let named = moving.into_iter().chain(fixed).enumerate();
        let bodies = named.map(|(i, (parts, pose))| (Body::new(format!("b{i}"), parts).unwrap(), pose)).collect();
        World { bodies, moving: count }
    })
}

/// Pairs of the first body that may be nearer, and all pairs of the second that may be nearer still.
fn closer(clearances: [f64; 2]) -> [Closer; 2] {
    [0, 1].map(|i| Closer {
        ones: BodySet::from_iter([BodyIndex::new(i)]),
        others: BodySet::ALL,
        clearance: clearances[usize::from(i)],
        only: None,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn bounds_never_exceed_the_judges_distance(world in world(bounded().boxed(), any_shape())) {
        let (model, mut scratch) = world.model();
        let none = AllowedContacts::none();
        let found = model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 10.0);
        match (world.judge(), found) {
            (None, found) => prop_assert_eq!(found, Ok(10.0)),
            (Some(judged), Ok(bound)) => {
                prop_assert!(!judged.intersects, "{judged:?} but {bound}");
                prop_assert!((0.0..=judged.distance + 1e-9).contains(&bound), "{judged:?} but {bound}");
            }
            (Some(judged), Err(hit)) => {
                // The judge's word on touching shapes is good to the rounding of the iteration.
                prop_assert!(judged.distance < 1e-6, "{judged:?} but {hit:?}");
            }
        }
        let again = model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 10.0);
        prop_assert_eq!(found, again);
        if let Ok(bound) = found {
            prop_assert_eq!(model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 0.05), Ok(bound.min(0.05)));
        }
    }

    #[test]
    fn boxes_and_balls_are_decided_at_the_clearance_of_each_pair(
        world in world(simple().boxed(), simple()), clearance in 0.0_f64..0.3, nearer in prop::array::uniform2(0.0_f64..0.3),
    ) {
        let (model, mut scratch) = world.model();
        let (none, closer) = (AllowedContacts::none(), closer(nearer));
        let query =
            Query { moved: &BodySet::ALL, against: &BodySet::ALL, allowed: &none, clearance, closer: &closer, cap: 10.0 };
        let found = model.lower_bound(&mut scratch, &query);
        let judged = world.judge_each(&query);
        if judged.iter().all(|(clearance, judged)| judged.distance > clearance + 1e-5) {
            prop_assert!(found.is_ok(), "{judged:?} but {found:?}");
        } else if judged.iter().any(|(clearance, judged)| judged.distance < clearance - 1e-5) {
            prop_assert!(found.is_err(), "{judged:?} but {found:?}");
        }
    }

    #[test]
    fn boxes_and_balls_are_decided_at_the_clearance(world in world(simple().boxed(), simple()), clearance in 0.0_f64..0.3) {
        let (model, mut scratch) = world.model();
        let found = model.clearance(&mut scratch, &BodySet::ALL, &AllowedContacts::none(), clearance, 10.0);
        if let Some(judged) = world.judge() {
            if judged.distance > clearance + 1e-5 {
                prop_assert!(found.is_ok(), "{judged:?} but {found:?}");
            } else if judged.distance < clearance - 1e-5 {
                prop_assert!(found.is_err(), "{judged:?} but {found:?}");
            }
            if let Ok(bound) = found {
                // Face-face pairs are exact; the worst the fifteen axes do to two boxes is well under a factor of two.
                prop_assert!(bound > 0.5 * judged.distance - 1e-9, "{judged:?} but {bound}");
            }
        }
    }

    #[test]
    fn the_distance_of_two_bodies_is_the_judges(world in world(bounded().boxed(), any_shape()), enough in 0.0_f64..2.0) {
        let (model, scratch) = world.model();
        for a in model.moving().iter() {
            for b in model.indices().filter(|b| *b != a) {
                let judged = world.judge_of(|i, j| [a.get(), b.get()] == [i, j] || [b.get(), a.get()] == [i, j]).unwrap();
                let found = model.distance_between(&scratch, a, b, enough);
                if found >= enough {
                    prop_assert!(judged.distance >= found - 1e-5, "{judged:?} but {found}");
                } else {
                    prop_assert!((judged.distance.max(0.0) - found).abs() < 1e-4, "{judged:?} but {found}");
                }
            }
        }
    }

    #[test]
    fn enlarging_never_frees(world in world(bounded().boxed(), any_shape()), grow in 1.0_f64..2.0) {
        let (model, mut scratch) = world.model();
        let small = model.clearance(&mut scratch, &BodySet::ALL, &AllowedContacts::none(), 0.0, 10.0);
        let mut larger = world.clone();
        for part in larger.bodies.iter_mut().flat_map(|(body, _)| &mut body.parts) {
            part.shape = match &part.shape {
                Shape::Cuboid { half_extents } => Shape::cuboid(half_extents * grow).unwrap(),
                Shape::Sphere { radius } => Shape::sphere(radius * grow).unwrap(),
                Shape::Cylinder { radius, half_height } => Shape::cylinder(radius * grow, half_height * grow).unwrap(),
                Shape::Capsule { radius, half_height } => Shape::capsule(radius * grow, half_height * grow).unwrap(),
                other => other.clone(),
            };
        }
        let (model, mut scratch) = larger.model();
        let large = model.clearance(&mut scratch, &BodySet::ALL, &AllowedContacts::none(), 0.0, 10.0);
        if small.is_err() {
            let touching = world.judge().is_some_and(|judged| !judged.intersects);
            prop_assert!(touching || large.is_err(), "{small:?} but {large:?}");
        }
    }

    #[test]
    fn allowed_disabled_and_unmoved_pairs_do_not_count(world in world(bounded().boxed(), any_shape())) {
        let (model, mut scratch) = world.model();
        let mut all = AllowedContacts::none();
        for a in model.indices() {
            for b in model.indices() {
                all.allow(a, b, ContactReason::Other("test"));
            }
        }
        prop_assert_eq!(model.clearance(&mut scratch, &BodySet::ALL, &all, 0.1, 3.0), Ok(3.0));
        let none = AllowedContacts::none();
        prop_assert_eq!(model.clearance(&mut scratch, &BodySet::EMPTY, &none, 0.1, 3.0), Ok(3.0));
        let query = Query { moved: &BodySet::ALL, against: &BodySet::EMPTY, allowed: &none, clearance: 0.1, closer: &[], cap: 3.0 };
        prop_assert_eq!(model.lower_bound(&mut scratch, &query), Ok(3.0));
        // The whole is the least of its parts, body by body.
        let whole = model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 3.0);
        let each: Vec<_> = model.moving().iter().map(|body| {
            model.clearance(&mut scratch, &BodySet::from_iter([body]), &none, 0.0, 3.0)
        }).collect();
        prop_assert_eq!(whole.is_err(), each.iter().any(Result::is_err));
    }

    #[test]
    fn yes_or_no_is_what_the_reasons_say(
        first in world(bounded().boxed(), any_shape()), at in prop::collection::vec(prop::array::uniform3(-1.0_f64..1.0), 3),
        clearance in 0.0_f64..0.1, nearer in prop::array::uniform2(0.0_f64..0.1),
    ) {
        let (model, mut scratch) = first.model();
        let (none, closer) = (AllowedContacts::none(), closer(nearer));
        let query = Query { moved: &BodySet::ALL, against: &BodySet::ALL, allowed: &none, clearance, closer: &closer, cap: 0.0 };
        // The second state is asked about with the first one's answer in memory, and then the first again.
        let poses: Vec<_> = first.bodies.iter().take(first.moving).map(|(_, pose)| *pose).collect();
        let moved: Vec<_> = poses.iter().zip(&at).map(|(pose, at)| Isometry3::translation(at[0], at[1], at[2]) * pose).collect();
        for poses in [&poses, &moved, &poses] {
            model.set_poses(&mut scratch, poses);
            let expected = model.lower_bound(&mut scratch, &query).is_ok();
            prop_assert_eq!(model.is_clear(&mut scratch, &query), expected);
            let nobody = Query { moved: &BodySet::EMPTY, ..query };
            prop_assert!(model.is_clear(&mut scratch, &nobody), "what nobody asks about does not count");
        }
    }

    #[test]
    fn a_watched_motion_is_free_as_far_as_it_says(
        world in world(bounded().boxed(), any_shape()),
        along in prop::collection::vec(prop::array::uniform3(-1.0_f64..1.0), 3), clearance in 0.0_f64..0.05,
        nearer in prop::array::uniform2(0.0_f64..0.05),
    ) {
        let (model, mut scratch) = world.model();
        let (none, closer) = (AllowedContacts::none(), closer(nearer));
        let velocities: Vec<Vector3<f64>> = along.into_iter().map(Vector3::from).collect();
        let reach: Vec<f64> = velocities.iter().take(world.moving).map(Vector3::norm).collect();
        let query = Query { moved: &BodySet::ALL, against: &BodySet::ALL, allowed: &none, clearance, closer: &closer, cap: 2.0 };
        let settled = model.lower_bound(&mut scratch, &query);
        model.watch(&mut scratch, &query, &Travel { reach: &reach, chain: &BodySet::EMPTY, from: 0.0, to: 2.0 });
        let mut t = 0.0;
        for _ in 0..12 {
            let Ok(until) = model.free_until(&mut scratch, t, 0.7) else {
                // Pairs that stand are not watched; of the others the first look sees all.
                prop_assert!(t > 0.0 || settled.is_err());
                return Ok(());
            };
            prop_assert!(until >= t && until <= (t + 0.7).min(2.0));
            if settled.is_ok() {
                for fraction in [0.5, 1.0] {
                    let mut moved = world.clone();
                    for ((_, pose), velocity) in moved.bodies.iter_mut().take(world.moving).zip(&velocities) {
                        pose.translation.vector += velocity * (t + (until - t) * fraction);
                    }
                    for (clearance, judged) in moved.judge_each(&query) {
                        // Meshes keep a slack of 2e-5 m.
                        prop_assert!(judged.distance >= clearance - 3e-5, "{judged:?} at {t}, free until {until}");
                    }
                }
            }
            t = (until + 1e-3).min(2.0);
            let poses: Vec<_> = world.bodies.iter().take(world.moving).zip(&velocities).map(|((_, pose), velocity)| {
                let mut pose = *pose;
                pose.translation.vector += velocity * t;
                pose
            }).collect();
            model.set_poses(&mut scratch, &poses);
        }
    }
}

fn ball(name: &str) -> Body {
    Body::single(name, Shape::sphere(0.1).unwrap()).unwrap()
}

#[test]
fn bodies_keep_their_order_and_bad_ones_are_refused() {
    let mut builder = CollisionModel::builder();
    let floor = Body::single("floor", Shape::half_space(Vector3::z_axis()).unwrap()).unwrap();
    assert!(matches!(builder.add_moving(&floor), Err(crate::GeomError::UnboundedMoving { .. })));
    let floor = builder.add_fixed(&floor, &Isometry3::identity()).unwrap();
    let a = builder.add_moving(&ball("a")).unwrap();
    let b = builder.add_moving(&ball("b")).unwrap();
    assert!(matches!(builder.add_moving(&ball("b")), Err(crate::GeomError::DuplicateName { .. })));
    assert!(builder.disable(a, BodyIndex::new(9)).is_err());
    builder.disable(b, a).unwrap();
    let model = builder.build();
    assert_eq!((floor.get(), a.get(), b.get(), model.len()), (0, 1, 2, 3));
    assert!(model.is_tested(floor, a) && !model.is_tested(a, b) && !model.is_tested(b, a));
    assert_eq!(model.find("b"), Some(b));
    assert_eq!(model.name(a).map(|n| &**n), Some("a"));
    assert_eq!(model.name(BodyIndex::new(7)), None);
}

#[test]
fn there_is_a_limit_on_bodies() {
    let mut builder = CollisionModel::builder();
    for i in 0..crate::FIRST_OF_CROWD {
        builder.add_moving(&ball(&format!("{i}"))).unwrap();
    }
    let message = builder.add_moving(&ball("one more")).unwrap_err().to_string();
    assert!(message.contains("512") && message.contains("511"), "{message}");
    for i in crate::FIRST_OF_CROWD..crate::MAXIMUM_BODIES {
        builder.add_fixed(&ball(&format!("{i}")), &Isometry3::identity()).unwrap();
    }
    let message = builder.add_fixed(&ball("one more"), &Isometry3::identity()).unwrap_err().to_string();
    assert!(message.contains("16385") && message.contains("16384"), "{message}");
}

/// Balls on a grid, one ball that moves among them: what is seen of the crowd is what is seen of each alone.
#[test]
fn each_of_a_crowd_is_seen_where_it_is() {
    let mut builder = CollisionModel::builder();
    let moving = builder.add_moving(&ball("moving")).unwrap();
    let place = |i: u32| Vector3::new(f64::from(i % 40), f64::from(i / 40 % 5), f64::from(i / 200));
    for i in 0..1000 {
        builder.add_fixed(&ball(&format!("{i}")), &Isometry3::from(place(i) * 3.0)).unwrap();
    }
    let model = builder.build();
    let mut scratch = model.scratch();
    let none = AllowedContacts::none();
    for i in 0..1000 {
        let at = place(i) * 3.0;
        let mut ask = |x: f64| {
            model.set_pose(&mut scratch, moving, &Isometry3::translation(at.x + x, at.y, at.z));
            model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 5.0)
        };
        let hit = ask(0.01).unwrap_err();
        assert_eq!(model.name(hit.second).map(ToString::to_string), Some(i.to_string()));
        assert!(ask(1.5).is_ok());
    }
}

#[test]
fn unposed_and_unsound_bodies_hit_until_they_are_placed() {
    let mut builder = CollisionModel::builder();
    let a = builder.add_moving(&ball("a")).unwrap();
    let wall = Body::single("wall", Shape::cuboid(Vector3::new(0.1, 1.0, 1.0)).unwrap()).unwrap();
    let wall = builder.add_fixed(&wall, &Isometry3::translation(1.0, 0.0, 0.0)).unwrap();
    let model = builder.build();
    let mut scratch = model.scratch();
    let none = AllowedContacts::none();
    let moved = BodySet::from_iter([a]);
    let ask = |scratch: &mut Scratch| model.clearance(scratch, &moved, &none, 0.0, 5.0);
    assert_eq!(ask(&mut scratch).unwrap_err().first, a);
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        model.set_pose(&mut scratch, a, &Isometry3::translation(bad, 0.0, 0.0));
        assert_eq!(ask(&mut scratch).unwrap_err().separation, f64::NEG_INFINITY);
    }
    model.set_pose(&mut scratch, a, &Isometry3::identity());
    model.set_pose(&mut scratch, wall, &Isometry3::identity());
    assert!((ask(&mut scratch).unwrap() - 0.8).abs() < 1e-12);
    model.set_pose(&mut scratch, a, &Isometry3::translation(0.85, 0.25, 0.0));
    let hit = ask(&mut scratch).unwrap_err();
    assert_eq!((hit.first, hit.second), (a, wall));
    assert!(hit.separation < 0.0 && (hit.place - Point3::new(0.9, 0.25, 0.0)).norm() < 0.1);
}

#[test]
fn a_scratch_of_another_model_does_no_harm() {
    let mut builder = CollisionModel::builder();
    let a = builder.add_moving(&ball("a")).unwrap();
    let small = builder.build();
    let mut scratch = CollisionModel::builder().build().scratch();
    let none = AllowedContacts::none();
    assert!(small.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 1.0).is_err());
    small.set_poses(&mut scratch, &[Isometry3::identity(), Isometry3::identity()]);
    assert_eq!(small.clearance(&mut scratch, &BodySet::from_iter([a]), &none, 0.0, 1.0), Ok(1.0));
}

/// Found by fuzzing: the nearest points of a box and a mesh with slivers were farther apart than the two.
#[test]
fn a_mesh_with_slivers_is_no_farther_than_it_is() {
    let point = |p: [f64; 3]| Point3::from(p.map(|x| x / 400.0));
    let corners: Vec<_> = [
        [-73.0, -73.0, -73.0],
        [-73.0, -73.0, 9.0],
        [-73.0, -73.0, -73.0],
        [-73.0, -73.0, -73.0],
        [-73.0, -73.0, -73.0],
        [-73.0, -1.0, -1.0],
        [1.0, -73.0, -73.0],
        [-72.0, -73.0, -73.0],
        [-73.0, -73.0, -73.0],
        [-73.0, -73.0, -73.0],
    ]
    .map(point)
    .to_vec();
    let strip: Vec<[u32; 3]> = (0..8).map(|i| [i, i + 1, i + 2]).collect();
    let mesh = Shape::Mesh(crate::TriangleMesh::new("mesh", &corners, &strip).unwrap().into());
    let length = |share: f64| 0.005 + 0.495 * share / 65535.0;
    let turned = |x: u8, z: u8| {
        let quarter =
            |axis, count: u8| UnitQuaternion::from_axis_angle(&axis, f64::from(count) * std::f64::consts::FRAC_PI_2);
        quarter(Vector3::z_axis(), z) * quarter(Vector3::x_axis(), x)
    };
    let pose = |at: [f64; 3], turn| Isometry3::from_parts((Vector3::from(at) / 8.0).into(), turn);
    let cuboid = |half: [f64; 3]| Shape::cuboid(Vector3::from(half)).unwrap();
    let bodies = [
        Body::new("first", vec![Part::centred(cuboid([length(17306.0), 0.5, 0.375]))]).unwrap(),
        Body::new(
            "second",
            vec![
                Part::centred(cuboid([26050.0, 10394.0, 21319.0].map(length))),
                Part {
                    shape: cuboid([11785.0, 35821.0, 59864.0].map(length)),
                    body_from_shape: pose([1.0, 1.0, 1.0], turned(0, 0)),
                },
            ],
        )
        .unwrap(),
        Body::new(
            "third",
            vec![
                Part::centred(cuboid([0.125, length(47031.0), length(47031.0)])),
                Part { shape: mesh, body_from_shape: pose([8.0, -2.0, -3.0], turned(1, 3)) },
            ],
        )
        .unwrap(),
    ];
    let poses = [
        pose([1.0, 1.0, 2.0], turned(0, 1)),
        pose([4.0, 0.0, -7.0], turned(2, 0)),
        pose([-8.0, 0.0, 0.0], turned(0, 0)),
    ];
    let mut builder = CollisionModel::builder();
    for body in &bodies {
        builder.add_moving(body).unwrap();
    }
    let model = builder.build();
    let mut scratch = model.scratch();
    model.set_poses(&mut scratch, &poses);
    let none = AllowedContacts::none();
    let posed: Vec<_> =
        bodies.iter().zip(poses).map(|(body, world_from_body)| PosedBody { body, world_from_body }).collect();
    let judged = oracle::nearest(&posed, &|_, _| false).unwrap().unwrap();
    let found = model.clearance(&mut scratch, &BodySet::ALL, &none, 0.0, 10.0).unwrap();
    assert!(found <= judged.distance + 1e-9, "{found} {judged:?}");
    let strict = model.clearance(&mut scratch, &BodySet::ALL, &none, 0.209, 39.0);
    assert!(judged.distance < 0.209 && strict.is_err(), "{strict:?} {judged:?}");
}
