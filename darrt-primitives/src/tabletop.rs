//! M for table-top manipulation: a mobile manipulator, rigid objects, and the surfaces that carry them.

use std::borrow::Cow;
use std::sync::Arc;

use darrt_core::domain::Domain;
use darrt_core::primitive::PrimitiveId;
use darrt_core::state::{ComponentId, ComponentSet, ObjectId, State};
use darrt_geom::body::Body;
use darrt_geom::error::GeomError;
use darrt_geom::scene::FixedBody;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Vector3};
use smallvec::SmallVec;

use crate::collision_scene::{CollisionScene, NearPair, Strictness};
use crate::contract::Contract;
use crate::edge_margin::Brink;
use crate::grasp::hold::{Hold, Load, NoHold, hold};
use crate::grasp::{Grasp, GraspFamily};
use crate::length_range::LengthRange;
use crate::manipulator::{Configuration, Hand, Manipulator, USUAL_GAP_M};
use crate::mobile_arm_space::MobileArmSpace;
use crate::mode::{Contacts, Held, Mode, SurfaceId};
use crate::object_space::ObjectSpace;
use crate::primitive::STANDARD;
use crate::push::edge_stop::{EdgeRule, RimReach};

pub mod builder;

/// A rigid object that can be manipulated, besides its configuration space.
pub struct Movable {
    /// Its shape, in a frame at the centre with z up when it stands; its name.
    pub body: Body,
    /// Radius about its z axis if it is round, metres.
    pub round_radius_m: Option<f64>,
    /// Height of its centre above what it stands on, metres.
    pub half_height_m: f64,
    /// Farthest point of its shape from its centre, metres.
    pub reach_m: f64,
    /// May it be pushed? Only round objects may.
    pub is_pushable: bool,
    /// Where it may stand.
    pub surfaces: SmallVec<[SurfaceId; 4]>,
    /// How it may be grasped.
    pub grasps: Vec<Box<dyn GraspFamily>>,
    /// What a rim grasp needs of the edge.
    pub rim: RimReach,
    /// How far Pick lifts it: at least and at best, metres.
    pub lift_m: [f64; 2],
    /// Its mass, kilograms.
    pub mass_kg: f64,
    /// Friction with what it stands on and with the fingers.
    pub friction: ObjectFriction,
    /// How far its z axis may lean from the vertical while it is carried, radians.
    pub max_tilt_rad: f64,
    /// Where its goals want it nearer to an edge than objects are left elsewhere.
    pub brinks: Vec<Brink>,
}

impl std::fmt::Debug for Movable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Movable").field("body", &self.body).field("surfaces", &self.surfaces).finish_non_exhaustive()
    }
}

/// Coefficients of Coulomb friction of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectFriction {
    /// With the surface under it.
    pub table: f64,
    /// With the fingers.
    pub fingers: f64,
}

/// What objects stand on and are pushed across without meeting an edge: a surface, or several that lie flush as one, and the
/// fixed bodies under it, which what stands on it touches.
#[derive(Debug, Clone)]
pub struct Support {
    /// The surface.
    pub surface: SupportSurface,
    /// Names of the fixed bodies whose tops it is.
    pub bodies: Vec<Arc<str>>,
}

/// Parameters of Push; metres.
#[derive(Debug, Clone, PartialEq)]
pub struct PushSettings {
    /// Gap between the fingers; less for an object that is too narrow for it.
    pub gap_m: f64,
    /// Least height of the fingertips above the surface; a third of the object's height, if that is more.
    pub fingertip_clearance_m: f64,
    /// Leans of the hand from the vertical in the order in which they are tried, radians in `[0, MAX_LEAN]`.
    pub leans_rad: Vec<f64>,
    /// How far behind the contact the hand comes down.
    pub standoff_m: LengthRange,
    /// Length of the way down, along the hand.
    pub approach_m: LengthRange,
    /// How far to any side an object may be from where it is thought to be.
    pub position_error_m: f64,
    /// How far an object may turn on the arc of one push, radians in `[0, pi)`; 0 for straight pushes only.
    pub max_turn_rad: f64,
    /// Where a push to a place off the support ends.
    pub edge_rule: EdgeRule,
    /// How far inside the edge the object's centre stops: least and most.
    pub edge_distance_m: [f64; 2],
}

/// Parameters of Place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceSettings {
    /// Directions of the last straight motion, unit vectors in the world, pointing down.
    pub approach_directions: Vec<Vector3<f64>>,
    /// Length of that motion.
    pub approach_m: LengthRange,
    /// How far the hand then backs out in a straight line.
    pub retreat_m: LengthRange,
    /// How much farther than the held thickness the fingers open to let go, metres.
    pub release_opening_m: f64,
}

/// Distances that plans keep, metres, each at least 0. The margins are kept where the room allows, the least ones always.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafetySettings {
    /// Wanted distance of the robot from everything else.
    pub robot_margin_m: f64,
    /// Wanted distance of a held object from everything else.
    pub held_margin_m: f64,
    /// Wanted distance of a pushed object from everything but what it slides on and what pushes it.
    pub object_margin_m: f64,
    /// Least distance of every pair that need not be near.
    pub least_margin_m: f64,
    /// Least distance of a pair that must be near and does not touch: the hand or what it holds, against the object that it
    /// handles and against what that object stands on.
    pub contact_margin_m: f64,
    /// How far inside the edge of a surface the centre of an object is set down or pushed, unless the goal lies nearer.
    pub edge_margin_m: f64,
}

impl Default for SafetySettings {
    /// What a careful engineer keeps with a robot that knows where it is to within a centimetre: 20 mm about the robot and
    /// what it holds, 10 mm about what it pushes, never less than 5 mm, 2 mm beside what it handles, 30 mm inside edges.
    fn default() -> Self {
        Self {
            robot_margin_m: 0.02,
            held_margin_m: 0.02,
            object_margin_m: 0.01,
            least_margin_m: 0.005,
            contact_margin_m: 0.002,
            edge_margin_m: 0.03,
        }
    }
}

/// Parameters of all actions.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSettings<J> {
    /// Push.
    pub push: PushSettings,
    /// Place.
    pub place: PlaceSettings,
    /// Distances that plans keep.
    pub safety: SafetySettings,
    /// How far a hand that stands at an object backs out in a straight line before it does anything else.
    pub retreat_m: LengthRange,
    /// The longest distance between inverse-kinematics solutions along a straight line of the hand, metres.
    pub line_step_m: f64,
    /// May the base drive with an empty hand, and with an object in it?
    pub drives: [bool; 2],
    /// How many base poses are tried for one hand pose (8 in the authors' software).
    pub base_tries: usize,
    /// How many grasps of an object are tried.
    pub grasp_tries: usize,
    /// Arm postures to travel through; may be empty.
    pub postures: Vec<J>,
    /// Gap of the hand where nothing else asks for one, metres; for a robot with several hands [`Manipulator::idle_gap_m`].
    pub travel_gap_m: f64,
}

impl<J> ActionSettings<J> {
    /// [`ActionSettings::for_hand`] for the first of its hands, with the gap that all of them have between two actions.
    pub fn for_robot<M: Manipulator<Joints = J>>(robot: &M) -> Self {
        Self { travel_gap_m: robot.idle_gap_m(), ..Self::for_hand(robot.hand()) }
    }

    /// What serves at ordinary tables: the values that problem files have by default, within what `hand` can open. All
    /// primitives may drive the base, and there are no postures to travel through.
    pub fn for_hand(hand: &dyn Hand) -> Self {
        Self {
            push: PushSettings {
                gap_m: 0.088_f64.min(hand.max_gap_m()),
                fingertip_clearance_m: 0.005,
                leans_rad: [0.0_f64, 35.0, 60.0].map(f64::to_radians).to_vec(),
                standoff_m: LengthRange::constant(0.03, 0.05),
                approach_m: LengthRange::constant(0.02, 0.10),
                position_error_m: 0.01,
                max_turn_rad: 60.0_f64.to_radians(),
                edge_rule: EdgeRule::NearestEdgePoint,
                edge_distance_m: [0.03, 0.08],
            },
            place: PlaceSettings {
                approach_directions: vec![-Vector3::z()],
                approach_m: LengthRange::constant(0.02, 0.10),
                retreat_m: LengthRange::constant(0.03, 0.10),
                release_opening_m: RELEASE_OPENING_M,
            },
            safety: SafetySettings::default(),
            retreat_m: LengthRange::constant(0.03, 0.10),
            line_step_m: 0.05,
            drives: [true, true],
            base_tries: 24,
            grasp_tries: 4,
            postures: Vec::new(),
            travel_gap_m: USUAL_GAP_M.min(hand.max_gap_m()),
        }
    }
}

/// How much the fingers open to let go of an object, metres: at a table's corner there is no room for more.
const RELEASE_OPENING_M: f64 = 0.01;

/// What a metre of the empty hand counts in the tour distances against a metre of an object. A hand that is near an
/// object is no better placed than one that is far: it has to back out first. With weight 1 the nearest node is always
/// the one whose hand is wedged beside the object.
const REACH_WEIGHT: f64 = 0.1;

/// The domain.
#[derive(Debug)]
pub struct Tabletop<M: Manipulator> {
    manipulator: Arc<M>,
    robot: MobileArmSpace<M::Joints>,
    objects: Vec<ObjectSpace>,
    movables: Arc<[Movable]>,
    supports: Vec<Support>,
    settings: ActionSettings<M::Joints>,
    collision_scene: Arc<CollisionScene>,
    contracts: Arc<[(PrimitiveId, Contract)]>,
}

/// The state of such a domain.
pub type TabletopState<M> = State<Tabletop<M>>;

impl<M: Manipulator> Tabletop<M> {
    /// Puts the parts together; `fixed` are the obstacles, the bodies under the surfaces among them.
    ///
    /// # Errors
    /// [`GeomError`] if there are too many bodies, two share a name, or a shape cannot be checked.
    pub fn new(
        manipulator: Arc<M>,
        robot: MobileArmSpace<M::Joints>,
        objects: Vec<(ObjectSpace, Movable)>,
        supports: Vec<Support>,
        fixed: &[FixedBody],
        settings: ActionSettings<M::Joints>,
    ) -> Result<Self, GeomError> {
        let (objects, movables): (_, Vec<Movable>) = objects.into_iter().unzip();
        // Where one hand stops to be at work and another begins, both are open alike.
        let travel_gap_m = if manipulator.hands() > 1 { manipulator.idle_gap_m() } else { settings.travel_gap_m };
        let settings = ActionSettings { travel_gap_m, ..settings };
        let strictness = Strictness { safety: settings.safety, ..Strictness::default() };
        let collision_scene = CollisionScene::new(&*manipulator, &movables, &supports, fixed, strictness)?;
        let collision_scene = Arc::new(collision_scene);
        let movables = movables.into();
        let contracts = STANDARD.into();
        Ok(Self { manipulator, robot, objects, movables, supports, settings, collision_scene, contracts })
    }

    /// The same with further primitives, by their indices: a primitive is free to be repaired, and its instances are written
    /// into plans, only if its contract is known here.
    #[must_use]
    pub fn with_primitives(mut self, further: &[(PrimitiveId, Contract)]) -> Self {
        self.contracts = self.contracts.iter().chain(further).copied().collect();
        self
    }

    /// What instances of `primitive` keep to, if it is known here.
    pub fn contract(&self, primitive: PrimitiveId) -> Option<&Contract> {
        self.contracts.iter().find(|(id, _)| *id == primitive).map(|(_, contract)| contract)
    }

    /// Pairs of bodies that are nearer than the least margin in `state`, the start, and do not touch, may be as near from
    /// here on, give or take half a millimetre by which a hand may stray from a line. The same for pairs without the robot
    /// in each of the `goals`. Which pairs these are.
    #[must_use]
    pub fn accept_near(&mut self, start: &TabletopState<M>, goals: &[TabletopState<M>]) -> Vec<NearPair> {
        let mut collision_scene = self.collision_scene.copy();
        let states = std::iter::once((start, false)).chain(goals.iter().map(|goal| (goal, true)));
        let robot = &*self.manipulator;
        let found =
            states.flat_map(|(state, is_at_goal)| collision_scene.accept_near(robot, state, is_at_goal)).collect();
        self.collision_scene = Arc::new(collision_scene);
        found
    }

    /// Everything that can be touched, and what may touch what.
    pub fn collision_scene(&self) -> &Arc<CollisionScene> {
        &self.collision_scene
    }

    /// The robot.
    pub fn manipulator(&self) -> &M {
        &self.manipulator
    }

    /// The movable objects, by id.
    pub fn movables(&self) -> &[Movable] {
        &self.movables
    }

    /// One movable object.
    pub fn movable(&self, id: ObjectId) -> Option<&Movable> {
        self.movables.get(id.index())
    }

    /// The support surfaces, by id.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }

    /// One support surface.
    pub fn surface(&self, id: SurfaceId) -> Option<&SupportSurface> {
        self.supports.get(id.index()).map(|s| &s.surface)
    }

    /// Parameters of the actions.
    pub fn settings(&self) -> &ActionSettings<M::Joints> {
        &self.settings
    }

    /// The surface on which `object` would stand at `pose`: its centre lies over the polygon and its bottom within
    /// `slack_m` of it. Only surfaces allowed for the object.
    pub fn surface_under(&self, object: ObjectId, pose: &Isometry3<f64>, slack_m: f64) -> Option<SurfaceId> {
        let movable = self.movable(object)?;
        let bottom = pose.translation.z - movable.half_height_m;
        movable.surfaces.iter().copied().find(|id| {
            self.surface(*id).is_some_and(|s| {
                (bottom - s.height()).abs() <= slack_m
                    && s.contains(&Point2::new(pose.translation.x, pose.translation.y))
            })
        })
    }

    /// How far what the hand holds reaches beyond the tool frame, metres; 0 for the empty hand.
    pub fn held_reach_m(&self, mode: &Mode) -> f64 {
        let Some(held) = mode.held() else { return 0.0 };
        held.tool_from_object.translation.vector.norm() + self.movable(held.object).map_or(0.0, |o| o.reach_m)
    }

    /// How far the z axis of what the hand holds may lean from the vertical while it is carried, radians in `[0, pi]`: as far
    /// as the object may, and as the grasp holds.
    pub fn tilt_limit_rad(&self, held: &Held) -> f64 {
        self.movable(held.object).map_or(std::f64::consts::PI, |object| object.max_tilt_rad).min(held.max_tilt_rad)
    }

    /// Does `grasp` by one of the robot's hands, of this family of the object's, hold it?
    ///
    /// # Errors
    /// [`NoHold`] with what fails. A family that does not know where its pads lie ([`GraspFamily::pads`]) always holds.
    pub fn hold(
        &self,
        hand: usize,
        movable: &Movable,
        family: &dyn GraspFamily,
        grasp: &Grasp,
    ) -> Result<Hold, NoHold> {
        let Some(contact) = family.pads(grasp) else { return Ok(Hold { max_tilt_rad: std::f64::consts::PI }) };
        let load = Load {
            mass_kg: movable.mass_kg,
            friction: movable.friction.fingers,
            grip_force_n: self.manipulator.hand_of(hand).grip_force_n(),
            payload_kg: self.manipulator.payload_kg(),
        };
        hold(&grasp.object_from_tool.inverse(), &contact, &load)
    }

    fn tool_point(&self, q: &Configuration<M::Joints>) -> Vector3<f64> {
        self.manipulator.world_from_tool(q).translation.vector
    }
}

impl<M: Manipulator> Domain for Tabletop<M> {
    type Robot = MobileArmSpace<M::Joints>;
    type Object = ObjectSpace;
    type Mode = Mode;
    type Contacts = Contacts;

    fn robot(&self) -> &Self::Robot {
        &self.robot
    }

    fn objects(&self) -> &[ObjectSpace] {
        &self.objects
    }

    fn component_name(&self, component: ComponentId) -> Cow<'_, str> {
        match component {
            ComponentId::Robot => Cow::Borrowed("robot"),
            ComponentId::Object(id) => match self.movable(id) {
                Some(movable) => Cow::Borrowed(&*movable.body.name),
                None => Cow::Owned(format!("object {}", id.index())),
            },
        }
    }

    fn without_robot(&self) -> Option<Self> {
        Some(Self {
            manipulator: Arc::clone(&self.manipulator),
            robot: self.robot.clone(),
            objects: self.objects.clone(),
            movables: Arc::clone(&self.movables),
            supports: self.supports.clone(),
            settings: self.settings.clone(),
            collision_scene: Arc::new(self.collision_scene.without_robot()),
            contracts: Arc::clone(&self.contracts),
        })
    }

    fn may_go_on(&self, mode: &Mode, next: &Mode) -> bool {
        // An empty hand may open or close wherever it stands, and another one go to work.
        mode == next || mode.opened_to(next.gap_m()).is_some_and(|mode| mode.with_hand(next.hand()) == *next)
    }

    fn carried(&self, mode: &Mode) -> ComponentSet {
        mode.held().map_or(ComponentSet::EMPTY, |held| ComponentSet::EMPTY.with(ComponentId::Object(held.object)))
    }

    fn reach(&self, robot: &Configuration<M::Joints>, _: ObjectId, at: &Isometry3<f64>) -> f64 {
        REACH_WEIGHT * (self.tool_point(robot) - at.translation.vector).norm()
    }

    fn working_point(&self, robot: &Configuration<M::Joints>) -> [f64; 3] {
        self.tool_point(robot).into()
    }

    fn reach_from(
        &self,
        working_point: [f64; 3],
        _: &Configuration<M::Joints>,
        _: ObjectId,
        at: &Isometry3<f64>,
    ) -> f64 {
        REACH_WEIGHT * (Vector3::from(working_point) - at.translation.vector).norm()
    }

    fn object_point(&self, _: ObjectId, at: &Isometry3<f64>) -> [f64; 3] {
        at.translation.vector.into()
    }

    fn reach_at_least(&self, _: ObjectId, gap_m: f64) -> f64 {
        REACH_WEIGHT * gap_m
    }

    fn travel_between(&self, from: (ObjectId, &Isometry3<f64>), to: (ObjectId, &Isometry3<f64>)) -> f64 {
        (from.1.translation.vector - to.1.translation.vector).norm()
    }
}
