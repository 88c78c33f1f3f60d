//! How a command ends after a signal (exit code 130).
//!
//! A run that measures looks at a flag between its blocks, keeps what is finished and says how to resume. All other work
//! looks at nothing: patches that are made, maps that are read, theory that is integrated. For that a thread of its own
//! ends the process. A file is whole or not there at any time, and what a run has measured in more than a second is kept
//! before anything else is begun. The second signal ends the process at once.

use std::io;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use super::signals;
use crate::cli::text::output;
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
    let signal = signals::register(&ASKED, INTERRUPTED)?;
    thread::Builder::new().name("signals".into()).stack_size(STACK_BYTES).spawn(|| wait(signal))?;
    Ok(())
}

/// A limit of the system on files or memory ends a command with its reason.
pub fn survive_limits() {
    signals::on_limits(i32::from(Error::Refused(String::new()).exit_code()));
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
fn wait(signal: signals::Signal) {
    signal.wait();
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
        signals::exit(i32::from(error.exit_code()));
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
