//! Attaching, letting go, coming up to objects and retreating, in any order: the mode against a plain model of it.

use darrt_core::state::ObjectId;
use darrt_core::testing::strategies::config;
use darrt_primitives::mode::{Held, Mode, SurfaceId};
use nalgebra::Isometry3;
use proptest::prelude::*;
use proptest_state_machine::{ReferenceStateMachine, StateMachineTest, prop_state_machine};

/// How many objects there are.
const OBJECTS: usize = 3;
/// How many surfaces.
const SURFACES: usize = 2;

/// The table of `Mode`'s documentation as plain data: where every object is, and what the hand does.
#[derive(Debug, Clone, PartialEq)]
struct Model {
    /// The surface of every object that rests.
    rests_on: Vec<Option<usize>>,
    held: Option<(usize, Isometry3<f64>)>,
    engaged: Option<usize>,
    gap_m: f64,
    /// Was the last transition legal?
    was_legal: bool,
}

/// What is asked of the mode; often it is not legal.
#[derive(Debug, Clone)]
enum Step {
    Open { gap_m: f64 },
    Engage { object: usize },
    Disengage,
    Attach { object: usize, grasp: f64, gap_m: f64 },
    Release { surface: usize, gap_m: f64 },
}

impl Model {
    /// The model after `step`, or `None` if it is not legal.
    fn after(&self, step: &Step) -> Option<Self> {
        let mut next = self.clone();
        match *step {
            Step::Open { gap_m } => {
                self.held.is_none().then_some(())?;
                next.gap_m = gap_m;
            }
            Step::Engage { object } => {
                (self.held.is_none() && self.rests(object)).then_some(())?;
                next.engaged = Some(object);
            }
            Step::Disengage => {
                self.engaged?;
                next.engaged = None;
            }
            Step::Attach { object, grasp, gap_m } => {
                (self.held.is_none() && self.rests(object)).then_some(())?;
                next.held = Some((object, Isometry3::translation(grasp, 0.0, 0.0)));
                next.rests_on[object] = None;
                next.engaged = None;
                next.gap_m = gap_m;
            }
            Step::Release { surface, gap_m } => {
                let (object, _) = self.held?;
                next.held = None;
                next.rests_on[object] = Some(surface);
                next.engaged = Some(object);
                next.gap_m = gap_m;
            }
        }
        Some(next)
    }

    fn rests(&self, object: usize) -> bool {
        self.rests_on.get(object).is_some_and(Option::is_some)
    }
}

impl ReferenceStateMachine for Model {
    type State = Self;
    type Transition = Step;

    fn init_state() -> BoxedStrategy<Self> {
        let surfaces = proptest::collection::vec((0..SURFACES).prop_map(Some), OBJECTS);
        let model = |rests_on| Self { rests_on, held: None, engaged: None, gap_m: 0.08, was_legal: true };
        surfaces.prop_map(model).boxed()
    }

    fn transitions(_: &Self) -> BoxedStrategy<Step> {
        // One object more than there are.
        let object = || 0..=OBJECTS;
        let gap = || 0.0..0.1_f64;
        prop_oneof![
            gap().prop_map(|gap_m| Step::Open { gap_m }),
            object().prop_map(|object| Step::Engage { object }),
            Just(Step::Disengage),
            (object(), -0.1..0.1, gap()).prop_map(|(object, grasp, gap_m)| Step::Attach { object, grasp, gap_m }),
            (0..SURFACES, gap()).prop_map(|(surface, gap_m)| Step::Release { surface, gap_m }),
        ]
        .boxed()
    }

    fn apply(state: Self, step: &Step) -> Self {
        match state.after(step) {
            Some(next) => Self { was_legal: true, ..next },
            None => Self { was_legal: false, ..state },
        }
    }
}

struct Real;

impl StateMachineTest for Real {
    type SystemUnderTest = Mode;
    type Reference = Model;

    fn init_test(model: &Model) -> Mode {
        Mode::resting(model.rests_on.iter().flatten().map(|s| SurfaceId::new(*s)), model.gap_m)
    }

    fn apply(mode: Mode, model: &Model, step: Step) -> Mode {
        let before = mode.clone();
        let next = match step {
            Step::Open { gap_m } => mode.opened_to(gap_m),
            Step::Engage { object } => mode.engaged_with(ObjectId::new(object)),
            Step::Disengage => mode.disengaged(),
            Step::Attach { object, grasp, gap_m } => {
                let tool_from_object = Isometry3::translation(grasp, 0.0, 0.0);
                mode.attached(Held { object: ObjectId::new(object), tool_from_object, max_tilt_rad: 1.0 }, gap_m)
            }
            Step::Release { surface, gap_m } => mode.released_on(SurfaceId::new(surface), gap_m),
        };
        assert_eq!(next.is_some(), model.was_legal, "{step:?} from {before:?}");
        assert_eq!(mode, before, "the mode that was asked has changed");
        next.unwrap_or(mode)
    }

    fn check_invariants(mode: &Mode, model: &Model) {
        for (i, surface) in model.rests_on.iter().enumerate() {
            assert_eq!(mode.support_of(ObjectId::new(i)), surface.map(SurfaceId::new));
        }
        let held = model.held.map(|(i, tool_from_object)| Held {
            object: ObjectId::new(i),
            tool_from_object,
            max_tilt_rad: 1.0,
        });
        assert_eq!(mode.held().copied(), held);
        assert_eq!(mode.engaged(), model.engaged.map(ObjectId::new));
        assert_eq!(mode.gap_m(), model.gap_m);
        assert_eq!(mode.is_hand_free(), model.held.is_none() && model.engaged.is_none());
        // What the documentation promises: everything is somewhere, and in one place only.
        let floating = (0..OBJECTS).filter(|i| mode.support_of(ObjectId::new(*i)).is_none()).count();
        assert_eq!(floating, usize::from(mode.held().is_some()));
        assert!(mode.held().is_none() || mode.engaged().is_none());
    }
}

prop_state_machine! {
    #![proptest_config(config(256, Some("tests/regressions/laws_modes.txt")))]

    /// Any sequence of transitions, legal or not.
    #[test]
    fn attach_and_detach_in_any_order(sequential 1..40 => Real);
}
