//! A gantry at two tables: two round tins that can be pushed and grasped from above, and a long box that can only be
//! grasped.

use darrt_core::state::{ObjectId, State};
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use darrt_geom::support::SupportSurface;
use nalgebra::{Point2, Vector2, Vector3};

use super::gantry::{Gantry, motion};
use crate::error::PrimitiveError;
use crate::grasp::Grip;
use crate::grasp::footprint::Footprint;
use crate::grasp::overhead::OverheadGrasps;
use crate::length_range::LengthRange;
use crate::manipulator::Configuration;
use crate::mode::{Mode, SurfaceId};
use crate::push::edge_stop::EdgeRule;
use crate::tabletop::builder::{BuildError, TabletopBuilder};
use crate::tabletop::{
    ActionSettings, Movable, ObjectFriction, PlaceSettings, PushSettings, SafetySettings, Tabletop, TabletopState,
};

/// The domain.
pub type Table = Tabletop<Gantry>;
/// Its state.
pub type TableState = TabletopState<Gantry>;

/// The table on which everything stands at the start.
const LEFT: &str = "left table";
/// Height of both tables, metres.
const HEIGHT_M: f64 = 0.7;
/// Radius and height of a tin, metres.
const TIN_M: [f64; 2] = [0.04, 0.08];
/// Sizes of the box, metres.
const BOX_M: [f64; 3] = [0.05, 0.16, 0.06];
/// How far inside the edges of the tables objects are left, metres.
const EDGE_MARGIN_M: f64 = 0.02;
/// How far below the top the fingertips grasp, metres.
const DEPTH_M: f64 = 0.03;

/// Where the objects stand at the start.
const PLACES_M: [[f64; 2]; 3] = [[-0.6, -0.3], [-0.4, 0.3], [-0.5, 0.0]];
/// How they are turned.
const YAW_RAD: f64 = 0.3;

/// One of the objects: 0 and 1 are tins, 2 is the box.
pub fn object(index: usize) -> ObjectId {
    ObjectId::new(index)
}

/// The tables with `robot` beside them.
///
/// # Errors
/// [`BuildError`] for a robot whose limits, weights or links cannot be used.
pub fn table(robot: Gantry) -> Result<Table, BuildError> {
    altered_table(robot, |_, _| ())
}

/// The same after `change` of the objects and of the settings.
///
/// # Errors
/// As [`table`].
pub fn altered_table(
    robot: Gantry,
    change: impl FnOnce(&mut [Movable], &mut ActionSettings<motion::Joints>),
) -> Result<Table, BuildError> {
    furnished_table(robot, &[], change)
}

/// The same with `fixed` bodies in the room. The tables themselves have none.
///
/// # Errors
/// As [`table`], and for a body that cannot be used.
pub fn furnished_table(
    robot: Gantry,
    fixed: &[FixedBody],
    change: impl FnOnce(&mut [Movable], &mut ActionSettings<motion::Joints>),
) -> Result<Table, BuildError> {
    let [radius, height] = TIN_M;
    let tin = |name: &str| movable(name, Shape::cylinder(radius, 0.5 * height)?, Footprint::Disc { radius });
    let [x, y, z] = BOX_M;
    let cuboid = Shape::cuboid(Vector3::new(x, y, z) / 2.0)?;
    let cuboid = movable("box", cuboid, Footprint::Box { size_x: x, size_y: y })?;
    let mut objects = [tin("red tin")?, tin("blue tin")?, cuboid];
    let mut settings = settings()?;
    change(&mut objects, &mut settings);
    let mut world = TabletopBuilder::new(robot, waiting())
        .base_within([-2.0; 2], [2.0; 2])
        .objects_within([-1.5, -1.5, 0.0], [1.5, 1.5, 1.6])
        .with_settings(|all| *all = settings);
    for (name, x) in [(LEFT, -0.5), ("right table", 0.5)] {
        let size = Vector2::new(0.8, 1.2);
        world = world.support(SupportSurface::rectangle(name, Point2::new(x, 0.0), size, 0.0, HEIGHT_M)?, &[]);
    }
    world = fixed.iter().cloned().fold(world, TabletopBuilder::fixed);
    for (movable, at) in objects.into_iter().zip(PLACES_M) {
        world = world.object(movable, LEFT, at, YAW_RAD);
    }
    Ok(world.build()?.0)
}

/// The honest gantry at the tables.
///
/// # Errors
/// None that could happen.
pub fn honest_table() -> Result<Table, BuildError> {
    table(Gantry::new()?)
}

fn movable(name: &str, shape: Shape, footprint: Footprint) -> Result<Movable, BuildError> {
    let (low, high) = shape.local_aabb();
    let grip = Grip {
        open_gap: 0.095,
        tip_ahead: super::gantry::TIP_BEYOND_TOOL_M,
        approach: LengthRange::new(0.05, 0.1)?,
        ..Grip::default()
    };
    let grasps = OverheadGrasps::new(footprint, high.z - low.z, DEPTH_M, grip)?;
    let movable = Movable {
        lift_m: [0.05, 0.15],
        mass_kg: 0.3,
        friction: ObjectFriction { table: 0.3, fingers: 0.5 },
        ..Movable::new(name, shape)?
    };
    Ok(movable.grasped_by(grasps))
}

fn settings() -> Result<ActionSettings<motion::Joints>, PrimitiveError> {
    Ok(ActionSettings {
        push: PushSettings {
            gap_m: 0.04,
            fingertip_clearance_m: 0.005,
            leans_rad: vec![0.0],
            standoff_m: LengthRange::new(0.02, 0.03)?,
            approach_m: LengthRange::new(0.06, 0.12)?,
            position_error_m: 0.002,
            max_turn_rad: 1.0,
            edge_rule: EdgeRule::NearestEdgePoint,
            edge_distance_m: [0.02, 0.06],
        },
        place: PlaceSettings {
            approach_directions: vec![-Vector3::z()],
            approach_m: LengthRange::new(0.05, 0.1)?,
            retreat_m: LengthRange::new(0.05, 0.1)?,
            release_opening_m: 0.01,
        },
        safety: SafetySettings { edge_margin_m: EDGE_MARGIN_M, ..SafetySettings::default() },
        retreat_m: LengthRange::new(0.05, 0.1)?,
        line_step_m: 0.02,
        drives: [true, true],
        base_tries: 12,
        grasp_tries: 6,
        postures: vec![motion::pointing_down(0.0, 0.0, 1.4, 0.0)],
        travel_gap_m: 0.08,
    })
}

fn waiting() -> Configuration<motion::Joints> {
    Configuration { base: [-0.5, 0.0, 0.0], arm: motion::pointing_down(0.0, 0.0, 1.4, 0.0) }
}

/// Two tins and the box on the left table, the hand open above them.
pub fn start(m: &Table) -> TableState {
    let standing = |(i, [x, y]): (usize, [f64; 2])| {
        let surface = m.surface(SurfaceId::new(0))?;
        let space = darrt_core::domain::Domain::objects(m).get(i)?;
        Some(space.standing(surface, &Point2::new(x, y), YAW_RAD))
    };
    State {
        robot: waiting(),
        objects: PLACES_M.into_iter().enumerate().filter_map(standing).collect(),
        mode: Mode::resting([SurfaceId::new(0); 3], 0.08),
    }
}
