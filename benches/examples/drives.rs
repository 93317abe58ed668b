//! Does the base drive farther than it must? For every plan file named: metres driven, degrees turned, and the drive that is the
//! most times as long as the shortest way of the robot between its ends, by a search over a fine grid.
//!
//! ```text
//! for s in $(seq 0 49); do darrt plan plate3 --seed $s --output plate3.$s.json; done
//! cargo run --release -p darrt-benches --example drives -- plate3.*.json
//! ```
//!
//! It fails if a drive is more than 1.3 times as long.

#![allow(clippy::print_stdout, reason = "its output is what it is for")]

use std::process::ExitCode;

use darrt_benches::drives::{Drive, drives};
use darrt_primitives::testing::yardstick::Yardstick;
use darrt_task::plan_file::PlanFile;

/// A drive may be so many times as long as the shortest.
const MOST: f64 = 1.3;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() -> ExitCode {
    let files: Vec<_> = std::env::args().skip(1).collect();
    if files.is_empty() {
        println!("the arguments are plan files");
        return ExitCode::FAILURE;
    }
    let (mut metres, mut shortest, mut degrees) = (Vec::new(), Vec::new(), Vec::new());
    let (mut all, mut long, mut worst) = (0, 0, 1.0_f64);
    for file in &files {
        let found = PlanFile::read(file).map_err(|error| error.to_string());
        let found = match found.and_then(|plan| drives(&plan, &Yardstick::default())) {
            Ok(found) => found,
            Err(error) => {
                println!("{file}: {error}");
                return ExitCode::FAILURE;
            }
        };
        let sum = |of: fn(&Drive) -> f64| found.iter().map(of).sum::<f64>();
        let [driven, needed, turned] = [sum(|d| d.length_m), sum(|d| d.shortest_m), sum(|d| d.turn_deg)];
        println!("{file}: {} drives, {driven:.2} m of {needed:.2} m needed, {turned:.0} degrees", found.len());
        for drive in found.iter().filter(|drive| drive.ratio() > MOST) {
            let Drive { step, length_m, shortest_m, .. } = drive;
            println!("  step {step}: {length_m:.2} m where {shortest_m:.2} m do: {:.2} times", drive.ratio());
            long += 1;
        }
        all += found.len();
        worst = found.iter().map(Drive::ratio).fold(worst, f64::max);
        metres.push(driven);
        shortest.push(needed);
        degrees.push(turned);
    }
    println!(
        "{} plans, medians: {:.2} m driven, {:.2} m needed between the same stops, {:.0} degrees",
        files.len(),
        median(metres),
        median(shortest),
        median(degrees)
    );
    println!("{long} of {all} drives are more than {MOST} times as long as the shortest; the worst {worst:.2} times");
    if long == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
