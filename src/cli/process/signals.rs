//! The signals that ask a process to end: SIGINT, SIGTERM and SIGHUP on Unix, Ctrl-C and SIGTERM elsewhere.

pub use system::{Signal, exit, on_limits, register};

#[cfg(unix)]
mod system {
    use std::io::{self, Read, Write};
    use std::os::unix::net::UnixStream;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::low_level::{self, pipe};

    /// The first signal, which may not have come yet.
    pub struct Signal(UnixStream);

    /// From now on a signal sets the flag, and the second one ends the process with this code.
    pub fn register(asked: &Arc<AtomicBool>, code: i32) -> io::Result<Signal> {
        let (signal, tell) = UnixStream::pair()?;
        let hang_up = (!is_hang_up_ignored()).then_some(SIGHUP);
        for number in [SIGINT, SIGTERM].into_iter().chain(hang_up) {
            // In this order: the flag is not set yet when the first signal is looked at.
            flag::register_conditional_shutdown(number, code, Arc::clone(asked))?;
            flag::register(number, Arc::clone(asked))?;
            pipe::register(number, tell.try_clone()?)?;
        }
        // A signal between a flag and its pipe has told nobody.
        if asked.load(Ordering::Relaxed) {
            (&tell).write_all(&[0])?;
        }
        Ok(Signal(signal))
    }

    impl Signal {
        /// Waits for it.
        pub fn wait(mut self) {
            // The other ends stay open as long as the process.
            self.0.read_exact(&mut [0]).ok();
        }
    }

    /// By the mask of ignored signals, where the system shows it: a SIGHUP that is ignored, as under `nohup`, stays so.
    fn is_hang_up_ignored() -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_some_and(|mask| mask >> (SIGHUP - 1) & 1 == 1)
    }

    /// A file beyond the system's limit is an error of its write instead of the end of the process. An allocation that
    /// fails aborts after a line of the standard library that says how many bytes it was: memory that was free when a
    /// reader asked for it has gone since. That is a refusal, with its `code`.
    pub fn on_limits(code: i32) {
        flag::register(SIGXFSZ, Arc::default()).ok();
        flag::register_conditional_shutdown(SIGABRT, code, Arc::new(AtomicBool::new(true))).ok();
    }

    /// Ends the process without its destructors.
    pub fn exit(code: i32) -> ! {
        low_level::exit(code)
    }
}

#[cfg(not(unix))]
mod system {
    use std::io;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;
    use std::time::Duration;

    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::flag;

    /// How often the flag is looked at.
    const TICK: Duration = Duration::from_millis(50);

    /// The first signal, which may not have come yet.
    pub struct Signal(Arc<AtomicBool>);

    /// From now on a signal sets the flag, and the second one ends the process with this code.
    pub fn register(asked: &Arc<AtomicBool>, code: i32) -> io::Result<Signal> {
        for number in [SIGINT, SIGTERM] {
            flag::register_conditional_shutdown(number, code, Arc::clone(asked))?;
            flag::register(number, Arc::clone(asked))?;
        }
        Ok(Signal(Arc::clone(asked)))
    }

    impl Signal {
        /// Waits for it.
        pub fn wait(self) {
            while !self.0.load(Ordering::Relaxed) {
                thread::sleep(TICK);
            }
        }
    }

    /// Nothing: these limits are told by signals on Unix alone.
    pub fn on_limits(_code: i32) {}

    /// Ends the process.
    pub fn exit(code: i32) -> ! {
        std::process::exit(code)
    }
}
