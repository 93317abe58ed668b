//! The colours of the picture: primitives as in the paper's figures 2, 5 and 6.

use crate::problem_file::PrimitiveName;

/// Text and frames.
pub(crate) const TEXT: &str = "#1f2933";
/// Less important text.
pub(crate) const QUIET: &str = "#5f6c7b";
/// Ground of the page.
pub(crate) const PAGE: &str = "#ffffff";
/// Ground of a panel: the floor.
pub(crate) const FLOOR: &str = "#f6f7f9";
/// Line around a panel.
pub(crate) const FRAME: &str = "#cbd2d9";
/// Table tops and what carries a support surface.
pub(crate) const TABLE: &str = "#e7d5b8";
/// Line around a table.
pub(crate) const TABLE_LINE: &str = "#a98a5b";
/// Walls and other furniture.
pub(crate) const FURNITURE: &str = "#d5dae0";
/// Line around walls and furniture.
pub(crate) const FURNITURE_LINE: &str = "#9aa5b1";
/// What stands on a table, blue as in the paper.
pub(crate) const CLUTTER: &str = "#8fb8ea";
/// Line around what stands on a table.
pub(crate) const CLUTTER_LINE: &str = "#3d6fae";
/// Objects.
pub(crate) const OBJECT: &str = "#ffffff";
/// Line around objects.
pub(crate) const OBJECT_LINE: &str = "#111827";
/// The goal.
pub(crate) const GOAL: &str = "#b91c1c";
/// The robot at rest.
pub(crate) const ROBOT: &str = "#6b7280";

/// The colour of what a primitive moves.
pub(crate) const fn of(primitive: PrimitiveName) -> &'static str {
    match primitive {
        PrimitiveName::ArmTransit | PrimitiveName::StraightLineArmTransit | PrimitiveName::BaseTransit => "#2148d8",
        PrimitiveName::ArmRigidTransfer | PrimitiveName::BaseRigidTransfer => "#c01fc0",
        PrimitiveName::Pick => "#149a3e",
        PrimitiveName::Place => "#e8590c",
        PrimitiveName::Push => "#b98900",
    }
}

/// The entries of the legend: a name for people and a colour.
pub(crate) const KINDS: [(&str, PrimitiveName); 5] = [
    ("Push", PrimitiveName::Push),
    ("Pick", PrimitiveName::Pick),
    ("Rigid transfer", PrimitiveName::BaseRigidTransfer),
    ("Place", PrimitiveName::Place),
    ("Transit", PrimitiveName::ArmTransit),
];

/// A colour written `#rrggbb`, thinned with white: 1 keeps it, 0 is white.
pub(crate) fn tint(colour: &str, share: f64) -> String {
    let [red, green, blue] = channels(colour).map(|value| (255.0 + (value - 255.0) * share.clamp(0.0, 1.0)).round());
    format!("rgb({red},{green},{blue})")
}

/// Is dark text better to read on a colour written `#rrggbb` than white text?
pub(crate) fn is_light(colour: &str) -> bool {
    // Luma of the television standard BT.601.
    let [red, green, blue] = channels(colour);
    0.299 * red + 0.587 * green + 0.114 * blue > 150.0
}

/// Red, green and blue of `#rrggbb`, 0 to 255.
fn channels(colour: &str) -> [f64; 3] {
    [1, 3, 5].map(|at| {
        let digits = colour.get(at..at + 2).unwrap_or_default();
        f64::from(u8::from_str_radix(digits, 16).unwrap_or_default())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tints_go_from_white_to_the_colour() {
        assert_eq!(tint("#204060", 1.0), "rgb(32,64,96)");
        assert_eq!(tint("#204060", 0.0), "rgb(255,255,255)");
        assert_eq!(tint("#204060", 0.5), "rgb(144,160,176)");
    }

    #[test]
    fn text_stands_out_from_its_ground() {
        assert!(is_light(PAGE) && is_light("#e59aec") && is_light("#f2a93b"));
        assert!(!is_light(TEXT) && !is_light("#2148d8") && !is_light("#a21caf"));
    }
}
