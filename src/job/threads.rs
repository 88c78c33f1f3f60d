//! Worker threads: how many there are, and their stacks.

use crate::error::{Error, Result};

/// Stack of a worker: nested parallel loops steal work on top of waiting work.
const STACK_BYTES: usize = 16 << 20;
/// Threads for each core at most.
pub const PER_CORE: usize = 4;

/// So many worker threads, one for each core for 0, at most [`PER_CORE`] for each. The environment has no say.
///
/// Errors: `Refused` where the system does not start them.
pub fn pool(wanted: usize) -> Result<rayon::ThreadPool> {
    let threads = workers(wanted);
    rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES).build().map_err(|e| {
        Error::Refused(format!(
            "{threads} threads cannot be started: {e}; raise the limit of processes or of memory (ulimit -u, ulimit \
             -v), or give fewer --threads"
        ))
    })
}

fn workers(wanted: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    if wanted == 0 { cores } else { wanted.min(PER_CORE * cores) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_counted_by_the_caller_alone() {
        let cores = std::thread::available_parallelism().expect("known").get();
        assert_eq!((workers(0), workers(1), workers(3), workers(100_000)), (cores, 1, 3, 4 * cores));
        assert_eq!(pool(3).expect("starts").install(rayon::current_num_threads), 3);
    }
}
