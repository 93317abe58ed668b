//! The collision checker against the oracle: never free where the oracle intersects, never a bound above its distance.
#![no_main]

use arbitrary::Arbitrary;
use darrt_fuzz::solids::BodySketch;
use darrt_geom::oracle::{self, Finding, PosedBody};
use darrt_geom::{AllowedContacts, Body, BodyIndex, BodySet, CollisionModel, ContactReason, Hit, Scratch};
use libfuzzer_sys::fuzz_target;
use nalgebra::Isometry3;

/// Most bodies of each kind.
const MOST: usize = 4;

#[derive(Debug, Arbitrary)]
struct Case {
    moving: Vec<BodySketch>,
    fixed: Vec<BodySketch>,
    allowed: Vec<[u8; 2]>,
    /// Millimetres.
    clearance: u8,
    cap: u16,
}

/// Bodies at poses, the moving ones first.
struct World {
    bodies: Vec<(Body, Isometry3<f64>)>,
    model: CollisionModel,
    scratch: Scratch,
    allowed: AllowedContacts,
}

impl Case {
    /// `None` where a body cannot be built.
    fn world(&self) -> Option<World> {
        let mut builder = CollisionModel::builder();
        let mut bodies = Vec::new();
        for (i, sketch) in self.moving.iter().take(MOST).enumerate() {
            let (body, pose) = sketch.body(&format!("moving {i}"))?;
            builder.add_moving(&body).ok()?;
            bodies.push((body, pose));
        }
        let poses: Vec<_> = bodies.iter().map(|(_, pose)| *pose).collect();
        for (i, sketch) in self.fixed.iter().take(MOST).enumerate() {
            let (body, pose) = sketch.body(&format!("fixed {i}"))?;
            builder.add_fixed(&body, &pose).ok()?;
            bodies.push((body, pose));
        }
        let model = builder.build();
        let mut scratch = model.scratch();
        model.set_poses(&mut scratch, &poses);
        let mut allowed = AllowedContacts::none();
        for [a, b] in self.allowed.iter().take(4) {
            let index = |i: u8| BodyIndex::new(u16::from(i) % 8);
            allowed.allow(index(*a), index(*b), ContactReason::Adjacent);
        }
        Some(World { bodies, model, scratch, allowed })
    }
}

impl World {
    fn ask(&mut self, clearance: f64, cap: f64) -> Result<f64, Hit> {
        self.model.clearance(&mut self.scratch, &BodySet::ALL, &self.allowed, clearance, cap)
    }

    /// The judge's word over the pairs that the model tests.
    fn judge(&self) -> Option<Finding> {
        let posed: Vec<_> = self.bodies.iter().map(|(body, pose)| PosedBody { body, world_from_body: *pose }).collect();
        let indices: Vec<_> = self.model.indices().collect();
        let skip = |i: usize, j: usize| {
            !self.model.is_tested(indices[i], indices[j]) || self.allowed.contains(indices[i], indices[j])
        };
        oracle::nearest(&posed, &skip).expect("bodies and poses are sound")
    }
}

fuzz_target!(|case: Case| {
    let Some(mut world) = case.world() else { return };
    let found = world.ask(0.0, 10.0);
    match (world.judge(), found) {
        (None, found) => assert_eq!(found, Ok(10.0)),
        (Some(judged), Ok(bound)) => {
            assert!(!judged.intersects, "free by {bound}, but {judged:?}");
            assert!((0.0..=judged.distance + 1e-9).contains(&bound), "{bound}, but {judged:?}");
        }
        // Touching shapes: the judge's word is good to the rounding of an iteration.
        (Some(judged), Err(hit)) => assert!(judged.distance < 1e-6, "{hit:?}, but {judged:?}"),
    }
    assert_eq!(found, world.ask(0.0, 10.0), "the same question");
    let (clearance, cap) = (f64::from(case.clearance) / 1000.0, f64::from(case.cap) / 1000.0);
    if let (Some(judged), Ok(bound)) = (world.judge(), world.ask(clearance, cap)) {
        assert!(bound <= cap && bound <= judged.distance + 1e-9, "{bound}, but {judged:?}");
        assert!(judged.distance >= clearance - 1e-9, "free at a clearance of {clearance}, but {judged:?}");
    }
});
