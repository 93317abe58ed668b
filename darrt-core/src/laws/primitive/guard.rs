//! Turns panics and endless drawing into broken laws.

use std::any::Any;
use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use rand::{Rng, TryRng};

use crate::laws::Broken;
use crate::random::Stream;

/// `work`, or `law` with the message of its panic.
pub(super) fn guarded<T>(law: &'static str, work: impl FnOnce() -> T) -> Result<T, Broken> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|payload| Broken::new(law, message(&*payload), "no panic"))
}

/// Like [`guarded`], with a generator that gives at most `most` numbers; one more breaks the law `ends`.
pub(super) fn bounded<T>(
    law: &'static str,
    ends: &'static str,
    most: u64,
    rng: Stream,
    work: impl FnOnce(&mut dyn Rng) -> T,
) -> Result<T, Broken> {
    let mut rng = Bounded { rng, left: most };
    catch_unwind(AssertUnwindSafe(|| work(&mut rng))).map_err(|payload| {
        if payload.is::<Exhausted>() {
            Broken::new(ends, format!("more than {most} draws"), format!("at most {most} draws"))
        } else {
            Broken::new(law, message(&*payload), "no panic")
        }
    })
}

fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    text.map_or_else(|| "a panic without a message".to_owned(), |s| format!("panic: {s}"))
}

/// Thrown when the draws are used up; never printed, because it does not go through the panic hook.
struct Exhausted;

struct Bounded {
    rng: Stream,
    left: u64,
}

impl Bounded {
    fn draw(&mut self) -> &mut Stream {
        match self.left.checked_sub(1) {
            Some(left) => self.left = left,
            None => resume_unwind(Box::new(Exhausted)),
        }
        &mut self.rng
    }
}

impl TryRng for Bounded {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.draw().try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.draw().try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.draw().try_fill_bytes(bytes)
    }
}
