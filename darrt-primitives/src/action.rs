//! The building blocks of the primitives: functions that turn a state and a wish into instances, for any
//! [`Manipulator`](crate::manipulator::Manipulator). What is in the way of a stance is asked of
//! [`collision_scene`](crate::collision_scene); whether whole motions are free is judged later.
//!
//! | wish | file |
//! |---|---|
//! | follow a straight line of the hand | [`mod@line`] |
//! | retreat from what the hand stands at | [`retreat`] |
//! | go to a configuration, alone or with an object in the hand | [`travel`] |
//! | hold the arm so that the base can drive | `fold`, `drive`, `width` |
//! | find a base and an arm configuration for a hand pose | [`stance`] |
//! | turn what is round so that an arm of few joints reaches it | [`mod@turned`] |
//! | choose the hand, for a robot with several | [`mod@at_work`] |
//! | know how far the hand must travel to push or grasp | [`approach`] |
//! | push an object, or make it slide with a hand of your own | [`push`], [`mod@slide`] |
//! | grasp and lift | [`pick`] |
//! | carry to a pose in the air | [`transfer`] |
//! | set down | [`place`] |

use darrt_core::primitive::{Infeasible, Instances};

use crate::tabletop::{Tabletop, TabletopState};

pub mod approach;
pub mod at_work;
mod drive;
mod fold;
pub mod line;
pub mod pick;
pub mod place;
pub mod push;
pub mod retreat;
pub mod slide;
pub mod stance;
pub mod transfer;
pub mod travel;
pub mod turned;
mod width;

/// Instances in the making: each new one starts where the last ended.
#[derive(Debug)]
pub struct Chain<M: crate::manipulator::Manipulator> {
    /// What has been put together so far.
    pub instances: Instances<Tabletop<M>>,
    /// Where it ends.
    pub end: TabletopState<M>,
}

impl<M: crate::manipulator::Manipulator> Chain<M> {
    /// An empty chain at `from`.
    pub fn at(from: &TabletopState<M>) -> Self {
        Self { instances: Vec::new(), end: from.clone() }
    }

    /// Adds an instance.
    pub fn push(&mut self, m: &Tabletop<M>, instance: darrt_core::motion::Instance<Tabletop<M>>) {
        instance.motion.at_into(m, 1.0, &mut self.end);
        self.instances.push(instance);
    }

    /// The instances, or [`Infeasible::NoProgress`] if there are none.
    ///
    /// # Errors
    /// [`Infeasible::NoProgress`] for an empty chain.
    pub fn finish(self) -> Result<Instances<Tabletop<M>>, Infeasible> {
        if self.instances.is_empty() { Err(Infeasible::NoProgress) } else { Ok(self.instances) }
    }
}
