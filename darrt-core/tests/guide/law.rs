#[test]
fn nudge_keeps_the_laws() {
    let red = Puck { name: "red".into(), radius_m: 0.12, is_graspable: false };
    let m = PuckWorld::new([4.0, 3.0], 0.15, vec![red]).unwrap();
    let (starts, free) = (Mode::resting(1), Clearance::default());
    proptest!(config(128, None), |((from, to, seed) in tasks_from(&m, valid_states(&m, starts, &free)))| {
        check_primitive(&m, &Nudge, &from, &to, seed)?;
    });
}
