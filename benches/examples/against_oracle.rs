//! The PR2 in the room of Plate3: is what the planner's check calls free also free by the exact oracle, with all margins kept? Asked are random
//! states with the plate anywhere, random states with the plate in the hand, and a tenth as many configurations on
//! motions that the planner proved free. `cargo run --release -p darrt-benches --example against_oracle -- 10000000`; the
//! default is 10,000 states.

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "its output is what it is for; its fixtures are fixed")]

use std::ops::Range;
use std::process::ExitCode;
use std::thread;

use darrt_benches::room::{HeldMotion, Room, held_motions};
use darrt_core::validity::Validity as _;
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::scene_oracle::SceneOracle;

/// Configurations of one motion.
const LOOKS: u64 = 64;
/// Where on the motion they lie: multiples of the golden ratio fill the unit interval evenly.
const APART: f64 = 0.618_033_988_749_895;

/// What was seen.
#[derive(Debug, Default)]
struct Tally {
    asked: u64,
    free: u64,
    /// Which the planner calls free and the oracle does not.
    wrong: Vec<String>,
}

impl Tally {
    fn add(mut self, other: Self) -> Self {
        self.asked += other.asked;
        self.free += other.free;
        self.wrong.extend(other.wrong);
        self
    }

    fn report(&self, what: &str) {
        println!(
            "{what}: {} asked about, {} called free, {} of these collide or come too near",
            self.asked,
            self.free,
            self.wrong.len()
        );
        self.wrong.iter().for_each(|wrong| println!("  {wrong}"));
    }
}

/// Random states of these numbers; of every two, one with the plate in the hand as in one of `motions`.
fn states(room: &Room, motions: &[HeldMotion], numbers: Range<u64>) -> Tally {
    let oracle = SceneOracle::with_margins(room.scene.bodies());
    let mut held = motions.iter().cycle();
    let mut tally = Tally::default();
    for number in numbers {
        let state = match held.next() {
            Some(motion) if number % 2 == 1 => room.state_holding(number, &motion.from),
            _ => room.state(number),
        };
        tally.asked += 1;
        if room.validity.check(&room.world, &state, &Contacts::default()).is_ok() {
            tally.free += 1;
            if let Err(blame) = oracle.check(&room.world, &state, &Contacts::default()) {
                tally.wrong.push(format!("state {number}: {blame:?}"));
            }
        }
    }
    tally
}

/// Configurations in the part of each motion that the planner proves free.
fn motions(room: &Room, motions: &[HeldMotion]) -> Tally {
    let oracle = SceneOracle::with_margins(room.scene.bodies());
    let mut tally = Tally::default();
    for (number, motion) in motions.iter().enumerate() {
        let free = room.validity.free_prefix(&room.world, &motion.instance, &motion.from).fraction;
        for look in 0..LOOKS {
            let t = free * (look as f64 * APART).fract();
            tally.asked += 1;
            tally.free += 1;
            if let Err(blame) = oracle.check(&room.world, &motion.at(room, t), &motion.instance.contacts) {
                tally.wrong.push(format!("motion {number} at {t}: {blame:?}"));
            }
        }
    }
    tally
}

fn main() -> ExitCode {
    let Ok(count) = std::env::args().nth(1).map_or(Ok(10_000), |text| text.parse::<u64>()) else {
        println!("the argument is how many states to ask about, a whole number");
        return ExitCode::FAILURE;
    };
    let all = held_motions(usize::try_from((count / 10 / LOOKS).max(1)).unwrap());
    let threads = thread::available_parallelism().map_or(1, usize::from) as u64;
    let tallies: Vec<_> = thread::scope(|scope| {
        let shares = all.chunks(all.len().div_ceil(usize::try_from(threads).unwrap()).max(1));
        let ranges = (0..threads).map(|i| count * i / threads..count * (i + 1) / threads);
        let shares = shares.chain(std::iter::repeat(&[][..]));
        let start = |(range, share)| {
            let all = &all;
            // Each thread has a room of its own: what the check remembers is not shared.
            scope.spawn(move || {
                let room = Room::new();
                (states(&room, all, range), motions(&room, share))
            })
        };
        let running: Vec<_> = ranges.zip(shares).map(start).collect();
        running.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let (in_rooms, on_motions) = tallies
        .into_iter()
        .fold((Tally::default(), Tally::default()), |(a, b), (states, motions)| (a.add(states), b.add(motions)));
    in_rooms.report("random states");
    on_motions.report("configurations on motions");
    if in_rooms.wrong.is_empty() && on_motions.wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
