#[test]
fn everything_keeps_the_laws() -> Result<(), Box<Report>> {
    let problem = problems::graspable().unwrap();
    let subjects = Subjects::of(&problem)
        .strategy(paper_strategy().unwrap())
        .oracle(free)
        .regressions("tests/regressions/everything.txt");
    println!("{}", check_everything(problem.shared_domain(), subjects)?);
    Ok(())
}
