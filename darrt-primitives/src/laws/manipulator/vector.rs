//! The vector of the joints.

use darrt_core::laws::{Broken, ensure, equal};

use super::VECTOR;
use crate::manipulator::JointVector;

/// Values of which no two are the same, nor one that of another vector.
fn values(count: usize, vector: u32) -> Vec<f64> {
    (0..count).map(|i| 0.1 + i as f64 + 0.001 * f64::from(vector)).collect()
}

/// All laws of a joint vector, for one of `count` joints.
///
/// # Errors
/// [`VECTOR`] with the function that is at fault.
pub fn check_joint_vector<J: JointVector>(count: usize) -> Result<(), Broken> {
    check::<J>(count).map_err(|broken| {
        broken.replayed_by(|| format!("check_joint_vector::<{}>({count})", std::any::type_name::<J>()))
    })
}

fn check<J: JointVector>(count: usize) -> Result<(), Broken> {
    let made = |of: &[f64]| {
        let made = J::from_values(of);
        made.ok_or_else(|| Broken::new(VECTOR, format!("none of {of:?}"), "a vector").of("from_values"))
    };
    let holds = |vector: &J, wanted: &[f64], call: &'static str| {
        equal(VECTOR, &vector.as_ref().to_vec(), &wanted.to_vec()).map_err(|broken| broken.of(call))
    };
    let Some(zeros) = J::zeros(count) else {
        return Err(Broken::new(VECTOR, format!("none of {count}"), "a vector").of("zeros"));
    };
    holds(&zeros, &vec![0.0; count], "zeros")?;
    let (first, second) = (values(count, 0), values(count, 1));
    let vector = made(&first)?;
    holds(&vector, &first, "from_values")?;
    let mut written = vector;
    let slots = written.as_mut();
    equal(VECTOR, &slots.to_vec(), &first).map_err(|broken| broken.of("as_mut"))?;
    slots.copy_from_slice(&second);
    holds(&written, &second, "as_mut")?;
    // A copy is one.
    holds(&vector, &first, "copy")?;
    let alike = |a: &J, b: &J, wanted: bool| {
        let text = || format!("{a:?} and {b:?}: {}", if wanted { "not equal" } else { "equal" });
        ensure(VECTOR, (a == b) == wanted, text, if wanted { "equal" } else { "not equal" }).map_err(|b| b.of("eq"))
    };
    alike(&written, &made(&second)?, true)?;
    alike(&zeros, &made(&vec![0.0; count])?, true)?;
    for joint in 0..count {
        let other = |x: f64| first.iter().enumerate().map(|(i, y)| if i == joint { x } else { *y }).collect::<Vec<_>>();
        for x in [second.get(joint).copied().unwrap_or(f64::NAN), f64::NAN] {
            alike(&vector, &made(&other(x))?, false).map_err(|broken| broken.of(format_args!("eq, joint {joint}")))?;
        }
    }
    // One of another length, or none; but none that is cut or filled up.
    for other in [count.checked_sub(1), Some(count + 1)].into_iter().flatten() {
        let wanted = values(other, 0);
        J::from_values(&wanted).map_or(Ok(()), |vector| holds(&vector, &wanted, "from_values of another number"))?;
        J::zeros(other).map_or(Ok(()), |zeros| holds(&zeros, &vec![0.0; other], "zeros of another number"))?;
    }
    Ok(())
}
