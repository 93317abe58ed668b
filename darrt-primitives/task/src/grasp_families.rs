//! The grasps of a problem file's objects.

use darrt_primitives::error::PrimitiveError;
use darrt_primitives::grasp::footprint::Footprint;
use darrt_primitives::grasp::hold::{Hold, Load, NoHold, hold};
use darrt_primitives::grasp::overhead::{OverheadGrasps, WallGrasps, WallOptions};
use darrt_primitives::grasp::rim::{Rim, RimGrasps, RimOptions};
use darrt_primitives::grasp::side::SideGrasps;
use darrt_primitives::grasp::{Grasp, GraspFamily as Family, Grip};
use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::manipulator::Hand;

use crate::problem_file::{GraspFamily, LengthRange, Object, PlateRim, RimGrasp, ShapeSpec};

/// How far above what an object stands on the fingertips of a grasp from above stay, metres.
const ABOVE_SUPPORT: f64 = 0.005;

/// A family of grasps that does not fit its object.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{key}`: {source}")]
pub struct GraspFlaw {
    /// The key at fault, from the object on, such as `overhead.opening_m`.
    pub key: String,
    /// What is wrong with it.
    pub source: PrimitiveError,
}

/// Every family that `object` names, for the gripper `hand`.
///
/// # Errors
/// [`GraspFlaw`] when the object does not fit between the fingers or a parameter is out of range.
pub fn families(object: &Object, hand: &dyn Hand) -> Result<Vec<Box<dyn Family>>, GraspFlaw> {
    object.grasps.iter().map(|family| one(*family, object, hand).map_err(|error| flaw(*family, error))).collect()
}

/// Why no grasp of the object holds it, family by family; `None` if one does, or if it has none that can be judged.
pub fn why_none_holds(object: &Object, hand: &dyn Hand, payload_kg: f64) -> Option<String> {
    let load = Load {
        mass_kg: object.mass_kg,
        friction: object.friction.fingers,
        grip_force_n: hand.grip_force_n(),
        payload_kg,
    };
    let mut reasons: Vec<(&str, String)> = Vec::new();
    for family in &object.grasps {
        let grasps = one(*family, object, hand).ok()?;
        let judged = |grasp: &Grasp| Some(hold(&grasp.object_from_tool.inverse(), &grasps.pads(grasp)?, &load));
        let reason = grasps.grid().iter().map(judged).reduce(easier)??.err()?;
        reasons.push((name_of(*family), reason.to_string()));
    }
    let (_, first) = reasons.first()?;
    if reasons.iter().all(|(_, reason)| reason == first) {
        return Some(first.clone());
    }
    Some(reasons.iter().map(|(family, reason)| format!("`{family}`: {reason}")).collect::<Vec<_>>().join("; "))
}

/// Why no grasp of the object fits the tilt of a hand that is always tilted alike, the object upright; `None` if one does, or if there is
/// none that can be judged.
pub fn why_none_fits_tilt(object: &Object, hand: &dyn Hand, ties: &HandTies) -> Option<String> {
    ties.up_in_tool?;
    let families = families(object, hand).ok().filter(|families| !families.is_empty())?;
    let fits = families.iter().flat_map(|family| family.grid()).any(|grasp| ties.allow_tilt(&grasp.object_from_tool));
    let names: Vec<_> = object.grasps.iter().map(|family| format!("`{}`", name_of(*family))).collect();
    (!fits).then(|| format!("the hand is always tilted alike, and no grasp of it ({}) is tilted so", names.join(", ")))
}

/// Of what is said about two grasps, that about the one that holds, or is nearer to holding.
fn easier(a: Option<Result<Hold, NoHold>>, b: Option<Result<Hold, NoHold>>) -> Option<Result<Hold, NoHold>> {
    let needs = |found: &NoHold| if let NoHold::Weak { needs_n, .. } = found { *needs_n } else { f64::INFINITY };
    match (a?, b?) {
        (Err(a), Err(b)) if needs(&b) < needs(&a) => Some(Err(b)),
        (Err(_), Ok(b)) => Some(Ok(b)),
        (a, _) => Some(a),
    }
}

fn name_of(family: GraspFamily) -> &'static str {
    match family {
        GraspFamily::Rim => "rim",
        GraspFamily::Overhead => "overhead",
        GraspFamily::Side => "side",
    }
}

/// Names the key of the problem file that an error of a family is about.
fn flaw(family: GraspFamily, error: PrimitiveError) -> GraspFlaw {
    use PrimitiveError as E;
    let family = name_of(family);
    let name = match &error {
        E::NotFinite { name, .. }
        | E::NotPositive { name, .. }
        | E::OutOfRange { name, .. }
        | E::NotBelow { name, .. }
        | E::WrongCount { name, .. }
        | E::Empty { name } => *name,
        _ => "",
    };
    let key = match name {
        "open finger gap" | "held thickness" => "opening_m",
        "grasp approach" => "approach_m",
        "fingertip insertion" | "fingertip depth" | "fingertip reach past the axis" => "insertion_m",
        "azimuth grid" => "azimuths",
        name if name.contains("tilt") || name.contains("lean") => "tilts_deg",
        _ => return GraspFlaw { key: "shape".to_owned(), source: error },
    };
    let source = match error {
        // The file has degrees.
        E::OutOfRange { name, value, low, high } if key == "tilts_deg" => {
            let [value, low, high] = [value, low, high].map(|angle| (angle.to_degrees() * 1e6).round() / 1e6 + 0.0);
            match family {
                "rim" => E::Malformed {
                    what: "the tilt of the hand",
                    detail: format!(
                        "{value} degrees; only {low} to {high} are flush with the rim, else it turns in the hand"
                    ),
                },
                _ => E::OutOfRange { name, value, low, high },
            }
        }
        error => error,
    };
    GraspFlaw { key: format!("{family}.{key}"), source }
}

/// How far the object is lifted by the families it names: least and best, metres. Half the wish is enough.
pub fn lift_m(object: &Object) -> [f64; 2] {
    let lift = |family: &GraspFamily| match family {
        GraspFamily::Rim => object.rim.lift_m,
        GraspFamily::Overhead => object.overhead.lift_m,
        GraspFamily::Side => object.side.lift_m,
    };
    let best = object.grasps.iter().map(lift).fold(0.0, f64::max);
    [best / 2.0, best]
}

fn one(family: GraspFamily, object: &Object, hand: &dyn Hand) -> Result<Box<dyn Family>, PrimitiveError> {
    let grip = |open_gap: f64, closed_gap: f64, approach: LengthRange| -> Result<Grip, PrimitiveError> {
        Ok(Grip {
            open_gap,
            tip_ahead: hand.tip_beyond_tool_m(closed_gap),
            approach: approach.planned()?,
            pad_length: hand.pad_length_m(),
            pad_width: 2.0 * hand.tip_half_width_m(),
        })
    };
    let missing = |kind: &str| {
        let fit = match family {
            GraspFamily::Rim => "rim grasps take a plate, a cylinder or a bowl",
            GraspFamily::Overhead => "overhead grasps take a box, a cylinder, a capsule or a bowl",
            GraspFamily::Side => "side grasps take a box, a cylinder or a capsule",
        };
        PrimitiveError::Malformed { what: "the shape", detail: format!("{fit}, this is a {kind}") }
    };
    Ok(match (family, &object.shape) {
        (GraspFamily::Rim, shape) => {
            let (rim, thickness) = rim_of(shape)?.ok_or_else(|| missing(shape.kind()))?;
            let RimGrasp { insertion_m, azimuths, opening_m, approach_m, .. } = object.rim;
            if let ShapeSpec::Plate { rim: PlateRim { width_m: high, .. }, .. } = *shape
                && insertion_m > high
            {
                // Farther in there is the bottom.
                let name = "fingertip insertion";
                return Err(PrimitiveError::OutOfRange { name, value: insertion_m, low: 0.0, high });
            }
            let tilts = radians(&object.rim_tilts_deg());
            let options = RimOptions { insertion: insertion_m, tilts, grid_azimuths: azimuths };
            Box::new(RimGrasps::new(rim, grip(opening_m, thickness, approach_m)?, options)?)
        }
        (GraspFamily::Overhead, ShapeSpec::Bowl { radius, height, wall }) => {
            let over = &object.overhead;
            let max_lean = over.tilts_deg.iter().fold(0.0_f64, |most, t| most.max(t.abs())).to_radians();
            let options = WallOptions {
                depth: depth_from_above(over.insertion_m, *height)?,
                max_lean,
                grid_leans: radians(&over.tilts_deg),
                grid_azimuths: over.azimuths,
                ..WallOptions::default()
            };
            let grip = grip(over.opening_m, *wall, over.approach_m)?;
            Box::new(WallGrasps::new(*radius, *height, *wall, grip, options)?)
        }
        (GraspFamily::Overhead, shape) => {
            let over = &object.overhead;
            let (footprint, height, width) = outline(shape).ok_or_else(|| missing(shape.kind()))?;
            let grip = grip(over.opening_m, width, over.approach_m)?;
            let depth = depth_from_above(over.insertion_m, height)?;
            let grasps = OverheadGrasps::new(footprint, height, depth, grip)?;
            Box::new(grasps.with_round_ends(round_end(shape)))
        }
        (GraspFamily::Side, shape) => {
            let side = &object.side;
            let (footprint, height, width) = outline(shape).ok_or_else(|| missing(shape.kind()))?;
            let grip = grip(side.opening_m, width, side.approach_m)?;
            Box::new(SideGrasps::new(footprint, height, side.insertion_m, 0.0, grip)?.with_round_ends(round_end(shape)))
        }
    })
}

/// The rim of a shape that has one, and its thickness. That of a bowl, taken from above and below, is the edge of its wall.
fn rim_of(shape: &ShapeSpec) -> Result<Option<(Rim, f64)>, PrimitiveError> {
    Ok(match *shape {
        ShapeSpec::Cylinder { radius, height } => Some((Rim::level(radius, height, radius)?, height)),
        ShapeSpec::Bowl { radius, height, wall } => Some((Rim::level(radius, height, wall)?, height)),
        ShapeSpec::Plate { radius, height, rim: PlateRim { slope_deg, width_m, thickness_m } } => {
            let slope = slope_deg.to_radians();
            Some((Rim::sloping(radius, height / 2.0, slope, width_m, thickness_m)?, thickness_m))
        }
        _ => None,
    })
}

/// Length of the ends at which the sides are not upright, metres.
fn round_end(shape: &ShapeSpec) -> f64 {
    match *shape {
        ShapeSpec::Capsule { radius, .. } => radius,
        _ => 0.0,
    }
}

/// How far fingertips reach below the top of an object `height` metres high: as far as wanted, or as the object is high.
fn depth_from_above(insertion: LengthRange, height: f64) -> Result<f64, PrimitiveError> {
    // Rounded to a nanometre: the number is shown.
    let most = ((height - ABOVE_SUPPORT) * 1e9).round() / 1e9;
    if insertion.least_m <= most {
        return Ok(insertion.wanted_m.min(most));
    }
    Err(PrimitiveError::OutOfRange { name: "fingertip insertion", value: insertion.least_m, low: 0.0, high: most })
}

/// Outline, height and least width of a shape that fingers can close around.
fn outline(shape: &ShapeSpec) -> Option<(Footprint, f64, f64)> {
    match *shape {
        ShapeSpec::Box { size: [x, y, z] } => Some((Footprint::Box { size_x: x, size_y: y }, z, x.min(y))),
        ShapeSpec::Cylinder { radius, height } | ShapeSpec::Capsule { radius, height } => {
            Some((Footprint::Disc { radius }, height, 2.0 * radius))
        }
        _ => None,
    }
}

fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|d| d.to_radians()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::builtin;
    use darrt_pr2::robot::Gripper;

    /// What is said about the object of a built-in problem after an edit.
    fn said(problem: &str, edit: impl Fn(&mut Object)) -> String {
        let mut object = builtin(problem).unwrap().objects.remove(0);
        families(&object, &Gripper).unwrap();
        edit(&mut object);
        families(&object, &Gripper).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn fingertips_reach_no_deeper_than_an_object_is_high() {
        let deep = |height| depth_from_above(LengthRange::new(0.01, 0.03), height);
        assert_eq!(deep(0.1), Ok(0.03));
        assert!((deep(0.03).unwrap() - 0.025).abs() < 1e-12);
        assert!(deep(0.014).is_err());
    }

    #[test]
    fn flaws_name_family_and_key_in_the_units_of_the_file() {
        assert_eq!(
            said("plate1", |o| o.rim.opening_m = 0.02),
            "`rim.opening_m`: held thickness must be below 0.02, found 0.02"
        );
        assert_eq!(
            said("plate1", |o| o.rim.insertion_m = 0.15),
            "`rim.insertion_m`: fingertip insertion must be below 0.14, found 0.15"
        );
        assert_eq!(
            said("plate1", |o| o.rim.tilts_deg = Some(vec![0.0, 30.0])),
            "`rim.tilts_deg`: the tilt of the hand cannot be used: 30 degrees; only -1 to 1 are flush with the rim, else it \
             turns in the hand"
        );
        assert_eq!(
            said("bowl", |o| o.overhead.tilts_deg = vec![0.0, 70.0]),
            "`overhead.tilts_deg`: largest lean must lie in [0, 60], found 70"
        );
        let none = LengthRange::new(0.0, 0.0);
        assert!(said("bowl", |o| o.overhead.approach_m = none).starts_with("`overhead.approach_m`: "));
        assert_eq!(
            said("bowl", |o| o.overhead.insertion_m = LengthRange::new(0.07, 0.1)),
            "`overhead.insertion_m`: fingertip insertion must lie in [0, 0.06], found 0.07"
        );
        let sphere = said("plate1", |o| {
            o.grasps = vec![GraspFamily::Side];
            o.shape = ShapeSpec::Sphere { radius: 0.03 };
        });
        assert!(sphere.starts_with("`shape`: ") && sphere.contains("this is a sphere"), "{sphere}");
    }
}
