//! M: the combined configuration space of the robot and the movable objects (paper section 3).

use std::borrow::Cow;
use std::fmt::Debug;

use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectConfig, ObjectId, RobotConfig};

/// The combined space M and the static facts that a primitive may read; never B, the obstacles.
///
/// Several robots are one [`Product`](crate::space::Product) space; objects of different kinds are one
/// enum space.
///
/// # Laws
/// `reach` and `travel_between` are finite and non-negative. Two points of an object lie no farther apart than its two
/// configurations, and `reach_at_least` of the gap between working point and object is at most `reach`. A motion `may_go_on`
/// in the mode that it was made for.
///
/// # Example
/// A cart that pushes crates along one rail. Larger: `testing::puck` (feature `testing`), a disc that pushes and carries.
/// ```
/// use darrt_core::prelude::*;
/// use darrt_core::space::RealBox;
///
/// struct Rail {
///     cart: RealBox<1>,
///     crates: Vec<RealBox<1>>,
/// }
///
/// impl Domain for Rail {
///     type Robot = RealBox<1>;
///     type Object = RealBox<1>;
///     type Mode = ();
///     type Contacts = ();
///
///     fn robot(&self) -> &RealBox<1> {
///         &self.cart
///     }
///
///     fn objects(&self) -> &[RealBox<1>] {
///         &self.crates
///     }
///
///     fn reach(&self, cart: &[f64; 1], _: ObjectId, at: &[f64; 1]) -> f64 {
///         (at[0] - cart[0]).abs()
///     }
///
///     fn travel_between(&self, (_, from): (ObjectId, &[f64; 1]), (_, to): (ObjectId, &[f64; 1])) -> f64 {
///         (to[0] - from[0]).abs()
///     }
/// }
///
/// let space = RealBox::new([0.0], [10.0])?;
/// let rail = Rail { cart: space.clone(), crates: vec![space] };
/// assert_eq!(rail.reach(&[2.0], ObjectId::new(0), &[5.0]), 3.0);
/// # Ok::<(), darrt_core::error::Error>(())
/// ```
pub trait Domain: Sized + Send + Sync + 'static {
    /// Space of the robot R.
    type Robot: ComponentSpace;
    /// Space of each movable object.
    type Object: ComponentSpace;
    /// What is held, what rests on what: carried along by motions, never sampled.
    type Mode: Clone + PartialEq + Debug + Send + Sync;
    /// What an instance may touch, and why. Opaque to the planner; read by the validity check.
    type Contacts: Clone + Default + PartialEq + Debug + Send + Sync;

    /// The robot's space.
    fn robot(&self) -> &Self::Robot;

    /// The objects' spaces, in the order of their ids.
    fn objects(&self) -> &[Self::Object];

    /// Name of a component, for people.
    fn component_name(&self, component: ComponentId) -> Cow<'_, str> {
        match component {
            ComponentId::Robot => Cow::Borrowed("robot"),
            ComponentId::Object(id) => Cow::Owned(format!("object {}", id.index())),
        }
    }

    /// This space for a robot that can pass through everything, for domains whose primitives ask what is in the way;
    /// `None` if there is no difference. Everything but those answers is the same.
    fn without_robot(&self) -> Option<Self> {
        None
    }

    /// May a motion that was made for a state in mode `next` begin in one that differs from it only in its mode, which is
    /// `mode`? Always if they are equal; also if the motion itself makes up the difference, as a hand that opens.
    fn may_go_on(&self, mode: &Self::Mode, next: &Self::Mode) -> bool {
        mode == next
    }

    /// The objects that go along with the robot wherever it goes in this mode. Where none are named, plans are improved
    /// between the moves of objects, but not while something is carried.
    fn carried(&self, _mode: &Self::Mode) -> ComponentSet {
        ComponentSet::EMPTY
    }

    /// Metres the robot's working point must travel from `robot` until it can act on `object` at `at`,
    /// obstacles ignored. Used by the tour distances of paper section 4.3.
    fn reach(&self, robot: &RobotConfig<Self>, object: ObjectId, at: &ObjectConfig<Self>) -> f64;

    /// Where the robot's working point is, if [`reach_from`](Self::reach_from) wants to know. Computed once per node of
    /// the tree, because forward kinematics is dearer than everything else in a distance.
    fn working_point(&self, _robot: &RobotConfig<Self>) -> [f64; 3] {
        [0.0; 3]
    }

    /// [`reach`](Self::reach), for a robot whose working point is already known. Must give the same number.
    fn reach_from(
        &self,
        _working_point: [f64; 3],
        robot: &RobotConfig<Self>,
        object: ObjectId,
        at: &ObjectConfig<Self>,
    ) -> f64 {
        self.reach(robot, object, at)
    }

    /// A point that goes with `object`, metres, in the frame of the working point. With
    /// [`reach_at_least`](Self::reach_at_least) it lets the search for the nearest node pass over most of the tree.
    fn object_point(&self, _object: ObjectId, _at: &ObjectConfig<Self>) -> [f64; 3] {
        [0.0; 3]
    }

    /// What [`reach`](Self::reach) is at least when the working point lies `gap_m` metres from the point of `object`; never
    /// less for a wider gap.
    fn reach_at_least(&self, _object: ObjectId, _gap_m: f64) -> f64 {
        0.0
    }

    /// Metres the working point travels from acting on one object to acting on another.
    fn travel_between(&self, from: (ObjectId, &ObjectConfig<Self>), to: (ObjectId, &ObjectConfig<Self>)) -> f64;
}
