//! The plain look at one moment: every pair of solids that may not touch, exactly. No bounds, no memory, nothing left out: what
//! the quick look is held to.

use nalgebra::Point3;

use super::super::margins;
use super::super::solid::exact;
use super::{Hit, Rule, SmallestClearance, Stage, TooNear};

impl Stage {
    /// As [`Stage::check`], of all pairs.
    pub(in crate::verify) fn check_plain(&mut self, step: u32, time: f64) -> Result<(), Hit> {
        self.states += 1;
        for index in 0..self.pairs.len() {
            let pair = &self.pairs[index];
            let (rule, may_m) = (pair.rule, pair.may_m);
            if rule == Rule::Free {
                continue;
            }
            let (a, b) = (pair.a, pair.b);
            let (mut pose_a, pose_b) = (self.world_from(a), self.world_from(b));
            if rule == Rule::Standing {
                pose_a.translation.z += self.lift_m;
            }
            let (solid_a, solid_b) = (&self.solids[a], &self.solids[b]);
            let names = (solid_a.name().to_owned(), solid_b.name().to_owned());
            self.exact_tests += 1;
            // A pose that the oracle refuses counts as a collision.
            let Ok(answer) = exact(solid_a, &pose_a, solid_b, &pose_b) else {
                return Err(Hit { names, place: Point3::from(pose_a.translation.vector) });
            };
            if answer.intersects {
                return Err(Hit { names, place: answer.place });
            }
            let Rule::Apart(kind) = rule else { continue };
            let (kind, distance_m) = (kind.index(), answer.distance);
            let margin_m = self.margins.least_m[kind].min(may_m);
            if distance_m < margin_m - margins::ROUNDING_M && self.too_near.is_none() {
                let (names, place) = (names.clone(), answer.place);
                self.too_near = Some(TooNear { names, place, distance_m, margin_m, time });
            }
            if distance_m < self.nearest_m[kind] {
                self.nearest_m[kind] = distance_m;
                self.note_clearance(kind, SmallestClearance { distance_m, bodies: names, step, time });
            }
        }
        Ok(())
    }
}
