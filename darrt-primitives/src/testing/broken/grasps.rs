//! Broken grasps.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use darrt_core::laws::Broken;
use darrt_geom::body::Body;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

use super::{Case, unusable};
use crate::grasp::footprint::Footprint;
use crate::grasp::hold::PadContact;
use crate::grasp::overhead::OverheadGrasps;
use crate::grasp::{Grasp, GraspFamily, GraspKind, Grip};
use crate::laws::check_grasps;
use crate::laws::grasp::{
    APPROACH, BETWEEN, CONTACT, COVERS, DEPTH, FLUSH, GAPS, GRID, KIND, OPEN, OVERHANG, PADS, POSE, REACH, SEEDED,
    VARIED,
};
use crate::length_range::LengthRange;
use crate::testing::gantry::{MAX_GAP_M, TIP_BEYOND_TOOL_M, TIP_HALF_WIDTH_M};

/// Honest grasps of a tin, and what is changed about them.
struct Family {
    honest: OverheadGrasps,
    /// What becomes of a grasp that was drawn.
    change: fn(Grasp, &mut dyn Rng) -> Grasp,
    /// What becomes of the grid.
    grid: fn(Vec<Grasp>) -> Vec<Grasp>,
    needs_overhang: bool,
    /// The bound, if another than the honest one.
    reach_m: Option<f64>,
    /// What it tells of the pads.
    pads: fn(&OverheadGrasps, &Grasp) -> Option<PadContact>,
}

impl GraspFamily for Family {
    fn sample(&self, rng: &mut dyn Rng) -> Grasp {
        let grasp = self.honest.sample(rng);
        (self.change)(grasp, rng)
    }

    fn grid(&self) -> Vec<Grasp> {
        (self.grid)(self.honest.grid())
    }

    fn needs_overhang(&self) -> bool {
        self.needs_overhang
    }

    fn pads(&self, grasp: &Grasp) -> Option<PadContact> {
        (self.pads)(&self.honest, grasp)
    }

    fn tool_reach_m(&self) -> f64 {
        self.reach_m.unwrap_or_else(|| self.honest.tool_reach_m())
    }
}

/// The gripper of the gantry.
struct Plates;

impl crate::manipulator::Hand for Plates {
    fn max_gap_m(&self) -> f64 {
        MAX_GAP_M
    }

    fn tip_beyond_tool_m(&self, _: f64) -> f64 {
        TIP_BEYOND_TOOL_M
    }

    fn tip_half_width_m(&self) -> f64 {
        TIP_HALF_WIDTH_M
    }
}

fn check(change: impl FnOnce(&mut Family)) -> Result<(), Broken> {
    let (radius, height) = (0.04, 0.08);
    let grip = Grip { open_gap: 0.095, tip_ahead: TIP_BEYOND_TOOL_M, ..Grip::default() };
    let honest = OverheadGrasps::new(Footprint::Disc { radius }, height, 0.03, grip).map_err(unusable)?;
    let shape = Shape::cylinder(radius, 0.5 * height).map_err(unusable)?;
    let body = Body::single("tin", shape).map_err(unusable)?;
    let mut family = Family {
        honest,
        change: |grasp, _| grasp,
        grid: |grid| grid,
        needs_overhang: false,
        reach_m: None,
        pads: GraspFamily::pads,
    };
    change(&mut family);
    check_grasps(&family, &body, &Plates, darrt_core::testing::broken::seed())
}

fn drawn(change: fn(Grasp, &mut dyn Rng) -> Grasp) -> Result<(), Broken> {
    check(|family| family.change = change)
}

fn moved(grasp: Grasp, by: Isometry3<f64>) -> Grasp {
    Grasp { object_from_tool: grasp.object_from_tool * by, ..grasp }
}

/// A case about grasps of a tin.
fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(|_| {}) }
}

pub(super) fn cases() -> Vec<Case> {
    [gaps(), poses(), turns()].concat()
}

fn gaps() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("an empty grid", "a selection by a filter that nothing passes", GRID, || {
            check(|family| family.grid = |_| Vec::new())
        }),
        case("a grid in another order", "the grid comes from a set without order", GRID, || {
            check(|family| {
                family.grid = |mut grid| {
                    let by = CALLS.fetch_add(1, Relaxed) as usize % grid.len().max(1);
                    grid.rotate_left(by);
                    grid
                };
            })
        }),
        case("opens to close", "the two gaps are exchanged", GAPS, || {
            drawn(|grasp, _| Grasp { open_gap_m: grasp.closed_gap_m, closed_gap_m: grasp.open_gap_m, ..grasp })
        }),
        case("opens wider than it can", "the gap of another gripper", GAPS, || {
            drawn(|grasp, _| Grasp { open_gap_m: 0.12, ..grasp })
        }),
        case("closes on a thinner tin", "the radius where the diameter was wanted", CONTACT, || {
            drawn(|grasp, _| Grasp { closed_gap_m: 0.5 * grasp.closed_gap_m, ..grasp })
        }),
        case("shifted along the opening", "one finger on the tin, the other one in it", CONTACT, || {
            check(|family| {
                family.change = |grasp, _| moved(grasp, Isometry3::translation(0.0, 0.02, 0.0));
                family.reach_m = Some(0.1);
            })
        }),
        case("opens by a hair", "the hand is not in the middle, and opens too little for that", OPEN, || {
            check(|family| {
                family.change = |grasp, _| {
                    let open_gap_m = grasp.closed_gap_m + 0.002;
                    Grasp { open_gap_m, ..moved(grasp, Isometry3::translation(0.0, 0.004, 0.0)) }
                };
                family.reach_m = Some(0.1);
            })
        }),
        case("tells of another azimuth", "degrees where radians were wanted", KIND, || {
            drawn(|grasp, _| match grasp.kind {
                GraspKind::Overhead { azimuth } => {
                    Grasp { kind: GraspKind::Overhead { azimuth: azimuth.to_degrees() }, ..grasp }
                }
                _ => grasp,
            })
        }),
        case("closes on nothing", "a thickness that was left at 0", GAPS, || {
            drawn(|grasp, _| Grasp { closed_gap_m: 0.0, ..grasp })
        }),
    ]
}

fn poses() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("one in a hundred is no number", "normalises a direction of no length now and then", POSE, || {
            drawn(|grasp, rng| {
                let is_bad = rng.random_bool(0.02);
                if is_bad { moved(grasp, Isometry3::translation(f64::NAN, 0.0, 0.0)) } else { grasp }
            })
        }),
        case("a quaternion that is none", "a rotation composed without being normalised", POSE, || {
            drawn(|grasp, _| {
                let q = UnitQuaternion::new_unchecked(Quaternion::from(grasp.object_from_tool.rotation.coords * 1.01));
                let object_from_tool = Isometry3::from_parts(grasp.object_from_tool.translation, q);
                Grasp { object_from_tool, ..grasp }
            })
        }),
        case("no approach", "the length of the approach was left at 0", POSE, || {
            drawn(|grasp, _| Grasp { approach_m: LengthRange::new(0.0, 0.0).unwrap_or(grasp.approach_m), ..grasp })
        }),
        case("farther than it says", "the offset of the tool is not in the bound", REACH, || {
            drawn(|grasp, _| moved(grasp, Isometry3::translation(-0.1, 0.0, 0.0)))
        }),
        case("comes from inside", "the hand points away from the object", APPROACH, || {
            drawn(|grasp, _| {
                let back = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI);
                moved(grasp, Isometry3::from_parts(Translation3::identity(), back))
            })
        }),
        Case {
            name: "grasps beside the tin",
            wrong: "the middle of the tin is measured from its rim",
            law: BETWEEN,
            broken: || {
                check(|family| {
                    family.change = |grasp, _| moved(grasp, Isometry3::translation(-0.08, 0.0, 0.0));
                    family.reach_m = Some(f64::INFINITY);
                })
            },
            honest: || check(|_| {}),
        },
        case("needs no overhang, it says not", "a flag copied from the grasps of rims", OVERHANG, || {
            check(|family| family.needs_overhang = true)
        }),
        case("a grasp of its own", "the azimuth comes from a counter", SEEDED, || {
            drawn(|grasp, _| {
                let turn = f64::from(CALLS.fetch_add(1, Relaxed) % 11) * 1e-3;
                moved(grasp, Isometry3::rotation(Vector3::x() * turn))
            })
        }),
        case("always the first", "draws, and then takes the first of the grid", VARIED, || {
            check(|family| {
                family.change = |_, _| {
                    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
                    Grasp {
                        object_from_tool: Isometry3::from_parts(Translation3::new(0.0, 0.0, 0.035), down),
                        open_gap_m: 0.095,
                        closed_gap_m: 0.08,
                        approach_m: Grip::default().approach,
                        kind: GraspKind::Overhead { azimuth: std::f64::consts::FRAC_PI_2 },
                    }
                };
            })
        }),
    ]
}

/// Turned about an axis of the tool, and it says so.
fn turned(grasp: Grasp, axis: Vector3<f64>, by_rad: f64) -> Grasp {
    let grasp = moved(grasp, Isometry3::rotation(axis * by_rad));
    let opening = grasp.object_from_tool.rotation * Vector3::y();
    Grasp { kind: GraspKind::Overhead { azimuth: opening.y.atan2(opening.x) }, ..grasp }
}

/// Grasps of a box, whose sides are flat.
fn cuboid(change: fn(Grasp, &mut dyn Rng) -> Grasp) -> Result<(), Broken> {
    let grip = Grip { open_gap: 0.095, tip_ahead: TIP_BEYOND_TOOL_M, ..Grip::default() };
    let footprint = Footprint::Box { size_x: 0.05, size_y: 0.16 };
    let honest = OverheadGrasps::new(footprint, 0.06, 0.03, grip).map_err(unusable)?;
    let shape = Shape::cuboid(Vector3::new(0.025, 0.08, 0.03)).map_err(unusable)?;
    let body = Body::single("box", shape).map_err(unusable)?;
    let family =
        Family { honest, change, grid: |grid| grid, needs_overhang: false, reach_m: None, pads: GraspFamily::pads };
    check_grasps(&family, &body, &Plates, darrt_core::testing::broken::seed())
}

fn turns() -> Vec<Case> {
    vec![
        Case {
            name: "rolled by ten degrees",
            wrong: "an azimuth that is rounded to whole decades of degrees",
            law: FLUSH,
            broken: || cuboid(|grasp, _| turned(grasp, Vector3::x(), 0.17)),
            honest: || cuboid(|grasp, _| grasp),
        },
        case("deeper than the table", "the depth is that of a higher tin", DEPTH, || {
            check(|family| {
                family.change = |grasp, _| moved(grasp, Isometry3::translation(0.06, 0.0, 0.0));
                family.reach_m = Some(0.2);
            })
        }),
        case("leans far over", "the hand comes from above, it says", KIND, || {
            drawn(|grasp, _| turned(grasp, Vector3::y(), 0.7))
        }),
        case("from above is from the side", "a kind copied from another family", KIND, || {
            drawn(|grasp, _| Grasp { kind: GraspKind::Side { azimuth: 0.0, flipped: false }, ..grasp })
        }),
        case("a grid of one", "the first of the grid is enough for a test", COVERS, || {
            check(|family| family.grid = |grid| grid.into_iter().take(1).collect())
        }),
        case("the same again and again", "an index that is not counted up", GRID, || {
            check(|family| {
                family.grid = |grid| grid.first().map_or_else(Vec::new, |first| vec![*first; grid.len()]);
            })
        }),
        case("pads in millimetres", "the data sheet has them", PADS, || {
            check(|family| {
                family.pads = |honest, grasp| {
                    let pads = honest.pads(grasp)?;
                    Some(PadContact { size_m: pads.size_m.map(|metres| 1e3 * metres), ..pads })
                };
            })
        }),
        case("pads of no number", "the mean of no patches", PADS, || {
            check(|family| {
                family.pads = |honest, grasp| Some(PadContact { spin_arm_m: f64::NAN, ..honest.pads(grasp)? });
            })
        }),
    ]
}
