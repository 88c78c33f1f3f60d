//! Question: how fast are the ray kernels on the heights and rays that other tracers were timed on?
//!
//! `cargo bench -p gonio-benches --bench peers -- --scene DIR --n 1024 --work w0,w1,w2,w3`: a folder of `hf_N.npy`, `w0_N.npy`,
//! `w1_N.npy`, `w2_N.npy` (f32; rays as ox oy oz dx dy dz, lengths in cells). Workloads: w0 mask, w1 shadow, w2 full,
//! w3 path. `Mray/cpu-s` is the median rate by processor time of one thread.

mod array;
mod scene;
mod work;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use gonio::trace::Kernel;
use scene::{Row, Scene, Workload};

/// Timed repetitions; one more goes before.
const REPETITIONS: usize = 5;

#[derive(Parser)]
struct Arguments {
    /// Folder of the heights and rays
    #[arg(long, value_name = "DIR")]
    scene: PathBuf,
    /// Cells a side
    #[arg(long, value_name = "N", default_value_t = 1024)]
    n: usize,
    /// Workloads
    #[arg(long, value_name = "LIST", default_value = "w0,w1,w2,w3", value_delimiter = ',', value_parser = workload)]
    work: Vec<Workload>,
    /// Kernel [default: the widest]
    #[arg(long, value_name = "NAME", value_parser = kernel)]
    lanes: Option<Kernel>,
    /// Said by cargo
    #[arg(long, hide = true)]
    bench: bool,
}

fn workload(text: &str) -> Result<Workload, String> {
    let found = Workload::ALL.into_iter().find(|work| work.name() == text.trim());
    found.ok_or_else(|| "one of w0, w1, w2, w3".into())
}

fn kernel(text: &str) -> Result<Kernel, String> {
    let found = Kernel::ALL.into_iter().find(|kernel| kernel.name() == text && kernel.available());
    found.ok_or_else(|| "one of avx512, avx2, scalar that this processor has".into())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let kernel = arguments.lanes.unwrap_or_else(Kernel::widest);
    let scene = Scene::read(&arguments.scene, arguments.n)?;
    println!(
        "{:<13} {:>5} {:>4} {:>3} {:>10} {:>7} {:>7} {:>7} {:>8} {:>8} {:>8}",
        "tracer",
        "n",
        "work",
        "thr",
        "Mray/cpu-s",
        "ns/smp",
        "best",
        "spread%",
        "escaped",
        "rays/smp",
        "differs"
    );
    for &work in &arguments.work {
        let row = scene.run(work, kernel, REPETITIONS)?;
        print(&row, arguments.n, kernel);
    }
    Ok(())
}

fn print(row: &Row, n: usize, kernel: Kernel) {
    let (best, worst) = (row.seconds[0], row.seconds[row.seconds.len() - 1]);
    println!(
        "{:<13} {n:>5} {:>4} {:>3} {:>10.2} {:>7.1} {:>7.1} {:>7.0} {:>8.5} {:>8.3} {:>8.1e}",
        format!("gonio-{}", kernel.name()),
        row.work.name(),
        1,
        row.rate(),
        row.nanoseconds(row.median_seconds()),
        row.nanoseconds(best),
        100.0 * (worst - best) / row.median_seconds(),
        row.escaped,
        row.rays_per_sample,
        row.differs,
    );
}
