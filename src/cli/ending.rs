//! How a process ends that SIGINT, SIGTERM or SIGHUP asks to.
//!
//! A run that measures looks at a flag between its blocks, keeps what is finished and says how to go on. All other work
//! looks at nothing: patches that are made, maps that are read, theory that is integrated. For that a thread of its own
//! ends the process. A file is whole or not there at any time, and what a run has measured in more than a second is kept
//! before anything else is begun. The second signal ends the process at once.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::low_level::{self, pipe};
use signal_hook::{SigId, flag};

use super::text::output;
use crate::error::{Error, Result};
use crate::files;
use crate::measure::ProcessEnd;

/// How long the work has to end by itself.
const GRACE: Duration = Duration::from_millis(300);
/// Exit code after a second signal.
const INTERRUPTED: i32 = 130;
/// Of the thread that waits for a signal: it prints a line and removes files.
const STACK_BYTES: usize = 1 << 18;

/// Set by the first signal.
static ASKED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Whether signals are listened to, which they are from the first command of a process on.
static LISTENS: Mutex<bool> = Mutex::new(false);
/// Whether a run measures now: it keeps its blocks, and ends the process itself.
static HELD: Mutex<bool> = Mutex::new(false);
static RELEASED: Condvar = Condvar::new();
/// Whether the command is over. Who ends the process before that keeps this lock to the end, so that no other thread says
/// what became of it.
static OVER: Mutex<bool> = Mutex::new(false);
/// What there is to say of a command that is ended before it is over.
static ADVICE: Mutex<Option<Box<dyn Fn() -> String + Send>>> = Mutex::new(None);

fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on the process answers signals. A SIGHUP that is ignored, as under `nohup`, stays so.
pub fn listen() -> Result<()> {
    *locked(&OVER) = false;
    *locked(&ADVICE) = None;
    let mut listens = locked(&LISTENS);
    if !*listens {
        start().map_err(|e| {
            Error::Refused(format!(
                "the thread that answers signals cannot be started: {e}; raise the limit of processes, of files or of \
                 memory (ulimit -u, ulimit -n, ulimit -v)"
            ))
        })?;
        *listens = true;
    }
    Ok(())
}

fn start() -> io::Result<()> {
    let (asked, tell) = UnixStream::pair()?;
    thread::Builder::new().name("signals".into()).stack_size(STACK_BYTES).spawn(|| wait(asked))?;
    let hang_up = (!is_hang_up_ignored()).then_some(SIGHUP);
    for signal in [SIGINT, SIGTERM].into_iter().chain(hang_up) {
        register(signal, &tell)?;
    }
    // A signal between a flag and its pipe has told nobody.
    if ASKED.load(Ordering::Relaxed) { (&tell).write_all(&[0]) } else { Ok(()) }
}

fn register(signal: i32, tell: &UnixStream) -> io::Result<SigId> {
    // In this order: the flag is not set yet when the first signal is looked at.
    flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&ASKED))?;
    flag::register(signal, Arc::clone(&ASKED))?;
    pipe::register(signal, tell.try_clone()?)
}

/// By the mask of ignored signals, where the system shows it.
fn is_hang_up_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (SIGHUP - 1) & 1 == 1)
}

/// The flag that the first signal sets.
pub fn asked() -> &'static AtomicBool {
    &ASKED
}

/// What is to be said when the command is ended from here on.
pub fn advise(advice: impl Fn() -> String + Send + 'static) {
    *locked(&ADVICE) = Some(Box::new(advice));
}

/// The command is over: what became of it is said by the caller, who comes back from here only where nobody ends the
/// process.
pub fn done() {
    *locked(&OVER) = true;
}

/// Waits for a signal and ends the process, unless it ends by itself in a while.
fn wait(mut asked: UnixStream) {
    if asked.read_exact(&mut [0]).is_err() {
        return;
    }
    loop {
        thread::sleep(GRACE);
        let mut held = locked(&HELD);
        if !*held {
            break;
        }
        // Its own end comes first; afterwards it has the same while.
        while *held {
            held = RELEASED.wait(held).unwrap_or_else(PoisonError::into_inner);
        }
    }
    let advice = locked(&ADVICE).as_ref().map_or_else(|| "before its end".into(), |advice| advice());
    leave(&Error::Interrupted(advice));
}

/// Ends the process, unless its command is over.
fn leave(error: &Error) {
    let over = locked(&OVER);
    if !*over {
        files::abandon();
        output::print_error(error);
        low_level::exit(i32::from(error.exit_code()));
    }
}

/// Ends the process for a run that measures; the function makes of the run's error what is said.
pub struct Leaving<F>(pub F);

impl<F: Fn(Error) -> Error + Sync> ProcessEnd for Leaving<F> {
    fn hold(&self) {
        *locked(&HELD) = true;
    }

    fn leave(&self, error: Error) {
        leave(&(self.0)(error));
    }

    fn release(&self) {
        *locked(&HELD) = false;
        RELEASED.notify_all();
    }
}
