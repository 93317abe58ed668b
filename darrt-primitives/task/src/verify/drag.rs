//! An object under fingertips that press on it from above and draw it along: it stands to the hand as at the beginning.

use darrt_geom::Clearance;
use nalgebra::Isometry3;

use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::Robot;
use crate::problem_file::Object;

/// Standard gravity.
const GRAVITY_M_S2: f64 = 9.81;

/// Presses the hand hard enough to draw `object` along, and no harder than it can? With a force N from above the fingers hold
/// `mu_fingers N`, and the table resists `mu_table (m g + N)`.
///
/// # Errors
/// What is missing, with the numbers.
pub(super) fn check_strength(object: &Object, robot: &Robot) -> Result<(), String> {
    let (name, [fingers, table]) = (&object.name, [object.friction.fingers, object.friction.table]);
    if fingers <= table {
        return Err(format!(
            "`{name}` cannot be dragged from above: its friction with the fingers is {fingers}, with the table {table}"
        ));
    }
    let needed_n = table * object.mass_kg * GRAVITY_M_S2 / (fingers - table);
    let most_n = robot.strength.push_force_n;
    if needed_n > most_n {
        return Err(format!(
            "`{name}` cannot be dragged from above: that needs {needed_n:.1} N on top of it, the arm has {most_n} N"
        ));
    }
    Ok(())
}

/// Do the fingertips touch the top of the object, and does it stand to the hand as at the beginning?
pub(super) struct Drag<'a> {
    pub(super) name: &'a str,
    /// At the beginning.
    pub(super) tool_from_object: Isometry3<f64>,
    /// Now.
    pub(super) world_from_tool: Isometry3<f64>,
    pub(super) world_from_object: Isometry3<f64>,
    /// Of each fingertip to the object without its skin.
    pub(super) tips: [Option<Clearance>; 2],
}

impl Drag<'_> {
    pub(super) fn check(&self, site: Site<'_>, time: f64, options: &VerifyOptions) -> Result<(), Refusal> {
        let name = self.name;
        let refuse = |text: String| site.refusal(time, RefusalKind::Push, text).about("the hand", name);
        let is_above = |tip: &Clearance| {
            let way = tip.first - tip.second;
            tip.distance <= 2.0 * options.push_contact_m && way.z > 0.9 * way.norm()
        };
        if !self.tips.iter().flatten().any(is_above) {
            return Err(refuse(format!("no fingertip presses on {name} from above")));
        }
        let expected = self.world_from_tool * self.tool_from_object;
        let off_m = (expected.translation.vector - self.world_from_object.translation.vector).xy().norm();
        let off_rad = expected.rotation.angle_to(&self.world_from_object.rotation);
        if off_m > options.push_contact_m || off_rad > options.line_rad {
            let (most_m, most_rad) = (options.push_contact_m, options.line_rad);
            let text = format!(
                "{name} slides {off_m:.4} m and {off_rad:.4} rad against the hand that drags it, at most {most_m} m and \
                 {most_rad:.4} rad"
            );
            return Err(refuse(text).at(&self.world_from_object.translation.vector.into()));
        }
        Ok(())
    }
}
