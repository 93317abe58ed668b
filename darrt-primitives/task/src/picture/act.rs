//! What a step does, as pictures tell it: the kinds of the paper's figures.

use darrt_primitives::contract::{Contract, HandUse};

/// The kinds of steps that have a colour of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Act {
    /// The robot moves alone.
    Transit,
    /// It moves with an object in the hand.
    Transfer,
    /// It takes an object.
    Pick,
    /// It sets one down.
    Place,
    /// It slides one along.
    Push,
}

impl Act {
    /// What steps that keep to this contract do.
    pub const fn of(contract: &Contract) -> Self {
        match contract.hand {
            HandUse::Takes => Self::Pick,
            HandUse::LetsGo => Self::Place,
            HandUse::Carries => Self::Transfer,
            HandUse::Empty if contract.slides() => Self::Push,
            HandUse::Empty => Self::Transit,
        }
    }

    /// Does it change where an object stands, or whether it is held?
    pub const fn manipulates(self) -> bool {
        matches!(self, Self::Push | Self::Pick | Self::Place)
    }
}
