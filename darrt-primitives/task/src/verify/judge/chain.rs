//! Where one step hands over to the next.

use crate::plan_file::Waypoint;

/// The first thing in which two waypoints differ, in words.
pub(super) fn difference(a: &Waypoint, b: &Waypoint) -> String {
    if a.base != b.base {
        return format!("the base was at {:?} and is at {:?}", a.base, b.base);
    }
    if let Some((name, value)) = b.joints.iter().find(|(name, value)| a.joints.get(*name) != Some(*value)) {
        let before = a.joints.get(name).map_or_else(|| "missing".to_owned(), f64::to_string);
        return format!("`{name}` was {before} and is {value}");
    }
    if let Some((name, pose)) = b.objects.iter().find(|(name, pose)| a.objects.get(*name) != Some(*pose)) {
        let before = a.objects.get(name).map_or_else(|| "missing".to_owned(), |p| format!("{:?}", p.position));
        return format!("{name} was at {before} and is at {:?}", pose.position);
    }
    "something is missing".to_owned()
}
