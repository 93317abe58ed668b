//! Outlines of upright objects, and the ways two fingers can close around them.

use std::f64::consts::{FRAC_PI_2, PI};

use rand::RngExt as _;

use super::{Grip, azimuths};
use crate::error::{PrimitiveError, positive};

/// Finger directions of the grid for a round object, over half a turn (the other half is the same
/// hand turned by 180 degrees).
pub(super) const GRID_OPENINGS: u32 = 12;

/// Outline of an upright object seen from above, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Footprint {
    /// A cylinder.
    Disc {
        /// Its radius.
        radius: f64,
    },
    /// A box.
    Box {
        /// Full size along the object's x.
        size_x: f64,
        /// Full size along the object's y.
        size_y: f64,
    },
}

impl Footprint {
    /// Directions of the finger opening of a grid, each with the width between the fingers and the
    /// size across; `count` directions over half a turn for a disc, two for a box.
    pub(super) fn openings(&self, count: u32) -> Vec<Opening> {
        match *self {
            Self::Disc { radius } => {
                azimuths(2 * count).take(count as usize).map(|azimuth| Opening::of_disc(radius, azimuth)).collect()
            }
            Self::Box { size_x, size_y } => {
                vec![Opening { azimuth: 0.0, width: size_x }, Opening { azimuth: FRAC_PI_2, width: size_y }]
            }
        }
    }

    /// Size across the fingers that close along the azimuth `opening`, metres; `None` for a disc, on which they lie along a
    /// line.
    pub(super) fn across(&self, opening: f64) -> Option<f64> {
        match *self {
            Self::Disc { .. } => None,
            Self::Box { size_x, size_y } => Some(if opening.cos().abs() > 0.5 { size_y } else { size_x }),
        }
    }

    /// Checks the sizes.
    pub(super) fn check(&self) -> Result<(), PrimitiveError> {
        match *self {
            Self::Disc { radius } => positive("object radius", radius).map(|_| ()),
            Self::Box { size_x, size_y } => {
                positive("object size x", size_x)?;
                positive("object size y", size_y).map(|_| ())
            }
        }
    }
}

/// One way for the fingers to close around a footprint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opening {
    /// Direction of the finger opening about the object's z, radians.
    pub(super) azimuth: f64,
    /// Width between the fingers, metres.
    pub(super) width: f64,
}

impl Opening {
    /// The opening of a disc at any azimuth.
    pub(super) fn of_disc(radius: f64, azimuth: f64) -> Self {
        Self { azimuth, width: 2.0 * radius }
    }
}

/// The openings of `footprint` whose width fits into the open gap.
///
/// # Errors
/// When a size is not positive or no width fits; the error names the narrowest.
pub(super) fn fitting_openings(footprint: &Footprint, grip: &Grip, count: u32) -> Result<Vec<Opening>, PrimitiveError> {
    footprint.check()?;
    let all = footprint.openings(count);
    let narrowest = all.iter().map(|o| o.width).fold(f64::INFINITY, f64::min);
    grip.check(narrowest)?;
    Ok(all.into_iter().filter(|opening| opening.width < grip.open_gap).collect())
}

/// Any direction for a disc, one of the fitting pair for a box.
pub(super) fn sample_opening(footprint: &Footprint, fitting: &[Opening], rng: &mut dyn rand::Rng) -> Opening {
    match *footprint {
        Footprint::Disc { radius } => Opening::of_disc(radius, rng.random_range(0.0..PI)),
        Footprint::Box { size_x, .. } => {
            // The constructor saw to it that at least one fits.
            let choice = rng.random_range(0..fitting.len().max(1));
            fitting.get(choice).copied().unwrap_or(Opening { azimuth: 0.0, width: size_x })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitting(footprint: &Footprint) -> Result<Vec<Opening>, String> {
        fitting_openings(footprint, &Grip::default(), GRID_OPENINGS).map_err(|why| why.to_string())
    }

    #[test]
    fn a_disc_is_gripped_in_directions_spread_over_half_a_turn() {
        let openings = Footprint::Disc { radius: 0.02 }.openings(4);
        let degrees: Vec<_> = openings.iter().map(|opening| opening.azimuth.to_degrees().round()).collect();
        assert_eq!(degrees, [0.0, 45.0, 90.0, 135.0]);
    }

    #[test]
    fn a_side_as_wide_as_the_open_gap_does_not_fit() {
        let narrow = Opening { azimuth: FRAC_PI_2, width: 0.04 };
        assert_eq!(fitting(&Footprint::Box { size_x: 0.05, size_y: 0.04 }), Ok(vec![narrow]));
    }

    #[test]
    fn outlines_that_cannot_be_gripped_are_refused_by_name() {
        for (footprint, why) in [
            (Footprint::Disc { radius: 0.0 }, "object radius must be above 0, found 0"),
            (Footprint::Disc { radius: 0.03 }, "held thickness must be below 0.05, found 0.06"),
            (Footprint::Box { size_x: f64::INFINITY, size_y: 0.04 }, "object size x must be finite, found inf"),
            (Footprint::Box { size_x: 0.04, size_y: f64::INFINITY }, "object size y must be finite, found inf"),
            (Footprint::Box { size_x: 0.08, size_y: 0.06 }, "held thickness must be below 0.05, found 0.06"),
        ] {
            assert_eq!(fitting(&footprint), Err(why.to_owned()));
        }
    }
}
