//! Options of `darrt why-not`.

use std::f64::consts::TAU;

use clap::Args;
use darrt_primitives::kinematics::limit::wrap_to_pi;

use super::{any_count, positive};

const WHY_NOT_EXAMPLES: &str = "\
Examples:
  darrt why-not plate3 --tool 0.9,0.1,0.85,0,1.2,0
      may the hand be there, and where would the robot stand?
  darrt why-not bowl --tool 0.6,0,0.9,0,1.57,0 --take bowl
      may the hand take the bowl so?
  darrt why-not mine.toml --base 0.5,0.2,1.57
      may the robot stand there, its arm as at the start?
  darrt why-not mine.plan.json
      what is wrong with a plan, or what its beginning still lacks

Metres and radians, as in problem and plan files; a rotation is roll, pitch, yaw about the fixed axes x, y, z.
The other things are where the problem starts. A plan is planned on from the last step that is right.
The same question has the same answer. Exit code 1: something is wrong.";

/// Options of `darrt why-not`.
#[derive(Debug, Args)]
#[command(after_help = WHY_NOT_EXAMPLES)]
pub struct WhyNotOptions {
    /// Name of a built-in problem, a problem file, or a plan file
    pub source: String,
    /// The frame of the tool in the world: x out of the hand, y across the fingers
    #[arg(long, value_name = "X,Y,Z,ROLL,PITCH,YAW", value_parser = six, allow_hyphen_values = true)]
    pub tool: Option<[f64; 6]>,
    /// The hand is there to take this object
    #[arg(long, value_name = "OBJECT", requires = "tool")]
    pub take: Option<String>,
    /// The base [default: where the problem starts]
    #[arg(long, value_name = "X,Y,YAW", value_parser = three, allow_hyphen_values = true, conflicts_with = "tool")]
    pub base: Option<[f64; 3]>,
    /// The joints of the arm, from the base outwards [default: as the problem starts]
    #[arg(long, value_name = "J1,J2,...", value_delimiter = ',', value_parser = joint, allow_hyphen_values = true, conflicts_with = "tool")]
    pub joints: Option<Vec<f64>>,
    /// Seed for planning on from a plan
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub seed: u64,
    /// Iterations for planning on from a plan
    #[arg(long, default_value_t = 1000, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub iterations: u64,
    /// Print the answer about a state, a place or a grasp as JSON
    #[arg(long)]
    pub json: bool,
}

/// A length or an angle.
fn coordinate(text: &str) -> Result<f64, String> {
    const MOST: f64 = 1e6;
    let value = text.trim().parse().ok().filter(|value: &f64| value.abs() <= MOST);
    value.ok_or_else(|| format!("must be a number, at most {MOST:e} in size; `{text}` is not"))
}

/// So many numbers with commas between.
fn coordinates<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let values = text.split(',').map(coordinate).collect::<Result<Vec<_>, _>>()?;
    let found = values.len();
    values.try_into().map_err(|_| format!("must be {N} numbers with commas between, not {found}"))
}

/// More than a turn was meant in degrees.
fn check_angle(value: f64) -> Result<(), String> {
    if value.abs() <= TAU {
        return Ok(());
    }
    Err(format!("{value} is an angle in radians, at most a full turn of {TAU:.3}"))
}

/// A joint turns, or slides by less than robots are long.
fn joint(text: &str) -> Result<f64, String> {
    let value = coordinate(text)?;
    check_angle(value).map(|()| value)
}

/// A base: headings are wrapped.
fn three(text: &str) -> Result<[f64; 3], String> {
    let [x, y, yaw] = coordinates(text)?;
    check_angle(yaw)?;
    Ok([x, y, wrap_to_pi(yaw)])
}

fn six(text: &str) -> Result<[f64; 6], String> {
    let values: [f64; 6] = coordinates(text)?;
    values.iter().skip(3).try_for_each(|angle| check_angle(*angle))?;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_have_as_many_finite_numbers_as_they_need() {
        assert_eq!((three("1, -2,0.5"), coordinate("-0")), (Ok([1.0, -2.0, 0.5]), Ok(-0.0)));
        assert_eq!(six("1,2,3").unwrap_err(), "must be 6 numbers with commas between, not 3");
        let [_, _, yaw] = three("0,0,3.5").unwrap();
        assert!((yaw - (3.5 - TAU)).abs() < 1e-12);
        assert!(three("0,0,90").unwrap_err().contains("90 is an angle in radians"));
        assert!(six("0.6,0,0.9,0,90,0").is_err() && six("-90,90,0.9,0,1.57,0").is_ok() && joint("-90").is_err());
        for bad in ["", "1,2,", "1,2,nan", "inf,0,0", "1e7,0,0", "a,b,c"] {
            assert!(three(bad).is_err(), "{bad}");
        }
    }
}
