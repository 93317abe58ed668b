//! The numbers that a configuration is made of, for those types that are known: what lets the laws feed NaN and corners
//! to a space that knows nothing of them.

use std::any::Any;

use nalgebra::{Isometry2, Isometry3, Matrix, Point2, Point3, Vector2, Vector3};

/// Calls `visit` with every number of `q`, in a fixed order: of an `f64`, an array of up to twelve, a vector of them, a pair,
/// or a point, vector or pose of nalgebra. Of other types with none.
pub fn visit_known<C: 'static>(q: &mut C, visit: &mut dyn FnMut(&mut f64)) {
    let q: &mut dyn Any = q;
    if let Some(x) = q.downcast_mut::<f64>() {
        visit(x);
    } else if let Some(all) = slice_of(q) {
        all.iter_mut().for_each(visit);
    } else if let Some((x, y)) = q.downcast_mut::<(f64, f64)>() {
        visit(x);
        visit(y);
    } else if let Some(pose) = q.downcast_mut::<Isometry3<f64>>() {
        pose.translation.vector.iter_mut().for_each(&mut *visit);
        pose.rotation.as_mut_unchecked().coords.iter_mut().for_each(visit);
    } else if let Some(pose) = q.downcast_mut::<Isometry2<f64>>() {
        pose.translation.vector.iter_mut().for_each(&mut *visit);
        let complex = pose.rotation.as_mut_unchecked();
        visit(&mut complex.re);
        visit(&mut complex.im);
    }
}

/// The numbers of what is nothing but numbers side by side.
fn slice_of(q: &mut dyn Any) -> Option<&mut [f64]> {
    macro_rules! first_of {
        ($($length:literal),+) => { $(
            if q.is::<[f64; $length]>() {
                return q.downcast_mut::<[f64; $length]>().map(|all| all.as_mut_slice());
            }
        )+ };
    }
    first_of!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12);
    if q.is::<Vec<f64>>() {
        return q.downcast_mut::<Vec<f64>>().map(Vec::as_mut_slice);
    }
    if q.is::<Point2<f64>>() {
        return q.downcast_mut::<Point2<f64>>().map(|p| p.coords.as_mut_slice());
    }
    if q.is::<Point3<f64>>() {
        return q.downcast_mut::<Point3<f64>>().map(|p| p.coords.as_mut_slice());
    }
    if q.is::<Vector2<f64>>() {
        return q.downcast_mut::<Vector2<f64>>().map(Matrix::as_mut_slice);
    }
    q.downcast_mut::<Vector3<f64>>().map(Matrix::as_mut_slice)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count<C: 'static>(mut q: C) -> usize {
        let mut count = 0;
        visit_known(&mut q, &mut |_| count += 1);
        count
    }

    #[test]
    fn known_types_show_all_their_numbers_and_others_none() {
        assert_eq!([count(1.0), count([0.0; 7]), count(vec![0.0; 3]), count((1.0, 2.0))], [1, 7, 3, 2]);
        assert_eq!([count(Isometry3::<f64>::identity()), count(Isometry2::<f64>::identity())], [7, 4]);
        assert_eq!([count(Point2::<f64>::origin()), count(Vector3::<f64>::zeros())], [2, 3]);
        assert_eq!([count("rock"), count([1.0_f32; 3])], [0, 0]);
    }

    #[test]
    fn what_is_written_stays() {
        let mut q = [1.0, 2.0];
        visit_known(&mut q, &mut |x| *x += 1.0);
        assert_eq!(q, [2.0, 3.0]);
    }
}
