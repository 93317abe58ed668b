//! The watchdog: turns panics, endless drawing and calls that never come back into broken laws.
//!
//! Safe code cannot stop a thread, so what happens to a call that hangs depends on who asked. Under [`or_abandon`] (and so
//! under [`check_everything`](super::check_everything)) the check runs on a thread of its own: the law is reported as broken,
//! and the thread is left behind until the process ends. A check that was called directly cannot return while its call
//! hangs: the watchdog prints the broken law with the call, and aborts the process.
//!
//! Time is counted in ticks of the watchdog's own sleep, not read from a clock: a machine that is overloaded or suspended
//! slows both down. Every call that comes back starts the count anew, so a check may take as long as it likes.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use rand::{Rng, TryRng};

use super::Broken;
use crate::random::Stream;

/// No hang.
pub const RETURNS: &str =
    "call.returns: every call comes back, after a bounded number of random draws and within the patience of the check";
/// No panic.
pub const PANICS: &str = "call.panics: no call panics, whatever configuration it is given";

/// The laws of this file.
pub const LAWS: &[&str] = &[RETURNS, PANICS];

/// One sleep of the watchdog.
const TICK: Duration = Duration::from_millis(20);
/// Patience unless [`with_patience`] says otherwise, seconds: a call of a primitive takes milliseconds.
pub const PATIENCE_S: f64 = 10.0;
/// At most so many numbers may be drawn in one call of a sampler, goal or space.
pub(super) const MOST_DRAWS: u64 = 1_000_000;

thread_local! {
    /// The watch that this thread is under.
    static NOW: RefCell<Option<Arc<Watch>>> = const { RefCell::new(None) };
    /// Who wants to hear of a hang.
    static LISTENER: RefCell<Option<Sender<Broken>>> = const { RefCell::new(None) };
    static PATIENCE: Cell<f64> = const { Cell::new(PATIENCE_S) };
}

/// What checking thread and watchdog share.
#[derive(Debug, Default)]
struct Watch {
    /// Calls begun so far.
    calls: AtomicU64,
    /// The call that is under way.
    call: Mutex<&'static str>,
    /// The checks within the check, each with its arguments.
    within: Mutex<Vec<String>>,
    is_over: Mutex<bool>,
    over: Condvar,
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Watch {
    fn finish(&self) {
        *locked(&self.is_over) = true;
        self.over.notify_all();
    }

    /// Waits until the check is over; `false` if one call took all the patience.
    fn waits(&self, patience_s: f64) -> bool {
        let most = (patience_s / TICK.as_secs_f64()).ceil();
        let (mut ticks, mut seen) = (0.0, u64::MAX);
        let mut is_over = locked(&self.is_over);
        while !*is_over {
            is_over = self.over.wait_timeout(is_over, TICK).unwrap_or_else(PoisonError::into_inner).0;
            let calls = self.calls.load(SeqCst);
            ticks = if calls == seen { ticks + 1.0 } else { 0.0 };
            seen = calls;
            if ticks > most {
                return *is_over;
            }
        }
        true
    }

    fn hang(&self, patience_s: f64, about: &(dyn Fn() -> String + Sync)) -> Broken {
        let call = *locked(&self.call);
        let found = format!("{call} has not come back after {patience_s:?} s");
        Broken::new(RETURNS, found, "an answer").of(call).replayed_by(|| self.innermost().unwrap_or_else(about))
    }

    /// The check that has the arguments of the call.
    fn innermost(&self) -> Option<String> {
        locked(&self.within).last().cloned()
    }
}

/// Runs `work` with this patience (seconds) for every single call in it.
pub fn with_patience<T>(seconds: f64, work: impl FnOnce() -> T) -> T {
    let before = PATIENCE.replace(seconds);
    let done = work();
    PATIENCE.set(before);
    done
}

/// Tells the watchdog that the next call begins. For checks of your own as well.
pub fn entering(call: &'static str) {
    NOW.with_borrow(|now| {
        if let Some(watch) = now {
            *locked(&watch.call) = call;
            watch.calls.fetch_add(1, SeqCst);
        }
    });
}

/// Tells the watchdog what calls in `work` are asked: what it says if one of them hangs.
pub(super) fn asking<T>(about: impl FnOnce() -> String, work: impl FnOnce() -> T) -> T {
    let watch = NOW.with_borrow(Clone::clone);
    if let Some(watch) = &watch {
        locked(&watch.within).push(about());
    }
    let done = work();
    // Not after a panic: then it says where that was.
    if let Some(watch) = &watch {
        locked(&watch.within).pop();
    }
    done
}

/// Tells the watchdog of calls on other threads.
#[derive(Debug, Clone, Default)]
pub(super) struct Pulse(Option<Arc<Watch>>);

impl Pulse {
    /// Of the check that this thread makes.
    pub(super) fn of_this_thread() -> Self {
        Self(NOW.with_borrow(Clone::clone))
    }

    /// Something has come back, and `call` begins.
    pub(super) fn beat(&self, call: &'static str) {
        if let Some(watch) = &self.0 {
            *locked(&watch.call) = call;
            watch.calls.fetch_add(1, SeqCst);
        }
    }
}

/// Seconds that a single call may take on this thread.
pub(super) fn patience_s() -> f64 {
    PATIENCE.get()
}

/// Runs a check under the watchdog; `about` is the call that shows a hang or a panic again. A check within a check is under
/// the watchdog of the outer one. For checks of your own as well.
///
/// # Errors
/// What `work` returns, [`PANICS`], or [`RETURNS`] for endless drawing.
pub fn watched<T>(about: &(dyn Fn() -> String + Sync), work: impl FnOnce() -> Result<T, Broken>) -> Result<T, Broken> {
    if NOW.with_borrow(Option::is_some) {
        return asking(about, work);
    }
    let watch = Arc::new(Watch::default());
    let (patience_s, listener) = (PATIENCE.get(), LISTENER.with_borrow(Clone::clone));
    NOW.set(Some(Arc::clone(&watch)));
    let done = std::thread::scope(|scope| {
        let guard = || {
            if !watch.waits(patience_s) {
                report(&watch.hang(patience_s, about), listener.as_ref());
            }
        };
        // Without a thread there is no watchdog, and the check goes on.
        let _ = std::thread::Builder::new().name("watchdog".to_owned()).spawn_scoped(scope, guard);
        let done = catch_unwind(AssertUnwindSafe(work));
        watch.finish();
        done
    });
    NOW.set(None);
    done.unwrap_or_else(|payload| {
        let call = *locked(&watch.call);
        let broken = if payload.is::<Exhausted>() {
            Broken::new(RETURNS, format!("{call} draws without end"), format!("at most {MOST_DRAWS} draws"))
        } else {
            Broken::new(PANICS, message(&*payload), "no panic")
        };
        Err(broken.of(call).replayed_by(|| watch.innermost().unwrap_or_else(about)))
    })
}

/// To whom it concerns; without a listener there is nobody left who could return.
fn report(broken: &Broken, listener: Option<&Sender<Broken>>) {
    if listener.is_some_and(|listener| listener.send(broken.clone()).is_ok()) {
        return;
    }
    let text = format!("\n{broken}\nThe call cannot be stopped, so the process ends here.\n");
    // Not through the print macros: what they write is captured by test runners, and lost when the process ends.
    let _ = std::io::stderr().write_all(text.as_bytes());
    std::process::abort();
}

/// Runs `work` on a thread of its own. If a call in it hangs, the law [`RETURNS`] is broken and the thread is left behind.
///
/// # Errors
/// What `work` returns, or [`RETURNS`].
pub fn or_abandon<T: Send + 'static>(work: impl FnOnce() -> Result<T, Broken> + Send + 'static) -> Result<T, Broken> {
    let (hangs, hears) = channel();
    let (results, receives) = channel();
    let patience_s = PATIENCE.get();
    let all = move || {
        PATIENCE.set(patience_s);
        LISTENER.set(Some(hangs.clone()));
        // The checks in it are watched one by one.
        let done = guarded(PANICS, work).and_then(|done| done);
        // If nobody waits any longer, nothing is lost.
        let _ = results.send(done);
        // A hang would have been told before.
        drop(hangs);
    };
    if let Err(error) = std::thread::Builder::new().name("laws".to_owned()).spawn(all) {
        return Err(Broken::new(RETURNS, format!("no thread for the check: {error}"), "a thread"));
    }
    loop {
        if let Ok(done) = receives.recv_timeout(TICK) {
            return done;
        }
        if let Ok(broken) = hears.try_recv() {
            return Err(broken);
        }
    }
}

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

/// A draw of a sampler, goal or space: named to the watchdog, and bounded.
pub(super) fn drawing<T>(call: &'static str, rng: Stream, work: impl FnOnce(&mut dyn Rng) -> T) -> Result<T, Broken> {
    entering(call);
    bounded(PANICS, RETURNS, MOST_DRAWS, rng, work).map_err(|broken| broken.of(call))
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
