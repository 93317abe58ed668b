//! The colours of the picture: steps as in the paper's figures 2, 5 and 6.

use super::act::Act;

/// Text and frames.
pub const TEXT: &str = "#1f2933";
/// Less important text.
pub const QUIET: &str = "#5f6c7b";
/// Ground of the page.
pub const PAGE: &str = "#ffffff";
/// Ground of a panel: the floor.
pub const FLOOR: &str = "#f6f7f9";
/// Line around a panel.
pub const FRAME: &str = "#cbd2d9";
/// Table tops and what carries a support surface.
pub const TABLE: &str = "#e7d5b8";
/// Line around a table.
pub const TABLE_LINE: &str = "#a98a5b";
/// Walls and other furniture.
pub const FURNITURE: &str = "#d5dae0";
/// Line around walls and furniture.
pub const FURNITURE_LINE: &str = "#9aa5b1";
/// What stands on a table, blue as in the paper.
pub const CLUTTER: &str = "#8fb8ea";
/// Line around what stands on a table.
pub const CLUTTER_LINE: &str = "#3d6fae";
/// Objects.
pub const OBJECT: &str = "#ffffff";
/// Line around objects.
pub const OBJECT_LINE: &str = "#111827";
/// The goal.
pub const GOAL: &str = "#b91c1c";
/// The robot at rest.
pub const ROBOT: &str = "#6b7280";

/// The colour of what a step moves.
pub const fn of(act: Act) -> &'static str {
    match act {
        Act::Transit => "#2148d8",
        Act::Transfer => "#c01fc0",
        Act::Pick => "#149a3e",
        Act::Place => "#e8590c",
        Act::Push => "#b98900",
    }
}

/// The entries of the legend: a name for people and a colour.
pub const KINDS: [(&str, Act); 5] = [
    ("Push", Act::Push),
    ("Pick", Act::Pick),
    ("Rigid transfer", Act::Transfer),
    ("Place", Act::Place),
    ("Transit", Act::Transit),
];

/// A colour written `#rrggbb`, thinned with white: 1 keeps it, 0 is white.
pub fn tint(colour: &str, share: f64) -> String {
    let [red, green, blue] = channels(colour).map(|value| (255.0 + (value - 255.0) * share.clamp(0.0, 1.0)).round());
    format!("rgb({red},{green},{blue})")
}

/// Is dark text better to read on a colour written `#rrggbb` than white text?
pub fn is_light(colour: &str) -> bool {
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
