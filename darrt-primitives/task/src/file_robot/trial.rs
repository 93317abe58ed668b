//! A first problem for a robot: a table where its hand reaches, and a cup to be set down elsewhere on it.

use super::inspect::Inspection;

/// Height of the table where the robot's hand, pointing down, reaches nowhere, metres.
const NOWHERE_M: f64 = 0.4;
/// How far the tool stays above the table at least, metres.
const ABOVE_M: f64 = 0.15;
/// So much of the table lies nearer to the robot than the cup, metres.
const NEAR_M: f64 = 0.1;

/// The text of the problem. `robot` are the lines that name the robot in the table `[robot]`; `drives` says whether its base does.
pub fn problem(inspection: &Inspection, robot: &str, drives: bool) -> String {
    let ([low, high], ahead) = inspection.reach_down.unwrap_or(([NOWHERE_M; 2], 0.6));
    // Where there is room above it to lift, and the robot's arm is not stretched.
    let top = (f64::midpoint(low, high) - ABOVE_M).clamp((low - 0.05).max(0.1), 0.9);
    let top = (top * 100.0).round() / 100.0;
    let (name, postures) = (&inspection.name, &inspection.postures);
    let driving = if drives { "\n  \"Base-Transit\",\n  \"Base-Rigid-Transfer\"," } else { "" };
    let (left, right) = (ahead - 2.5, ahead + 2.5);
    let middle = ahead - NEAR_M + 0.25;
    let under = top - 0.02;
    format!(
        r#"format = "darrt-problem"
version = 1
name = "first-{name}"
title = "First: a cup on a table is set down elsewhere"

primitives = [
  "Arm-Transit",
  "Straight-Line-Arm-Transit",
  "Arm-Rigid-Transfer",{driving}
  "Pick",
  "Place",
]

[robot]
{robot}
base = [0, 0, 0]

[bounds]
base_x = [-2.5, 2.5]
base_y = [-2.5, 2.5]
object_x = [{left:.3}, {right:.3}]
object_y = [-2.5, 2.5]
object_z = [0.0, 2.0]

[[obstacle]]
name = "table top"
shape = {{ box = {{ size = [0.5, 0.9, 0.04] }} }}
at = [{middle:.3}, 0, {under:.3}]

[[surface]]
name = "table"
top_of = "table top"

[[object]]
name = "cup"
shape = {{ cylinder = {{ radius = 0.02, height = 0.1 }} }}
mass_kg = 0.1
friction = {{ table = 0.3, fingers = 0.5 }}
symmetry = "z"
on = "table"
at = [{ahead:.3}, -0.15]
grasps = ["overhead", "side"]

[[goal.object]]
object = "cup"
on = "table"
at = [{ahead:.3}, 0.2]
tolerance_m = 0.01
state = "released"

[transit]
postures = {postures:?}

[budget]
time_limit_s = 60
restart_iterations = 2000
"#
    )
}
