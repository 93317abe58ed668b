use super::*;

#[test]
fn a_broken_law_reads_well() {
    let broken = Broken::new(space::SYMMETRIC, "1.0", "2.0").at(0.25).within(1e-9).of("elbow").of("robot");
    let broken = broken.replayed_by(|| "check(1)".to_owned()).replayed_by(|| "check(2)".to_owned());
    assert_eq!(broken.name(), "space.symmetric");
    let expected = "broken law space.symmetric: distance(a, b) is distance(b, a)\n  by:      robot, elbow\n  \
                    at t =   0.25\n  found:   1.0\n  against: 2.0\n  allowed: a difference of 1e-9\n  \
                    replay:  check(1)";
    assert_eq!(broken.to_string(), expected);
}

#[test]
fn laws_have_distinct_names_and_say_something() {
    let mut names: Vec<_> = all().map(name_of).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
    assert!(all().all(|law| law.split_once(": ").is_some_and(|(_, says)| says.len() > 10)));
}

#[test]
fn not_a_number_breaks_every_comparison() {
    assert!(at_most(space::FINITE, f64::NAN, 1.0, 1.0).is_err());
    assert!(measure(space::FINITE, f64::NAN).is_err());
    assert!(equal(space::SELF, &f64::NAN, &f64::NAN).is_err());
    assert!(identical(space::ENDS, &0.0, &-0.0).is_err());
}
