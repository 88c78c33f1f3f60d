//! `gonio bench --scene`: the ray kernels on given heights and rays.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::output::{Output, columns};
use crate::bench::{Scene, SceneRow, Workload};
use crate::error::{Error, Result};
use crate::trace::Kernel;

/// Timed repetitions; one more goes before.
const REPETITIONS: usize = 5;

/// What belongs to a scene.
#[derive(Args)]
pub struct SceneArguments {
    /// Time the ray kernels on a folder of heights and rays (.npy)
    #[arg(long, value_name = "DIR", conflicts_with_all = ["campaign", "against", "cells", "truth", "from", "to", "realisations_to", "replicates", "output", "force"])]
    pub scene: Option<PathBuf>,
    /// Cells a side of the scene
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(8..=16_384), requires = "scene")]
    n: u32,
    /// Of the scene: w0 mask, w1 shadow, w2 full, w3 path [default: all]
    #[arg(long, value_name = "LIST", default_value = "w0,w1,w2,w3", hide_default_value = true, value_delimiter = ',', value_parser = workload, requires = "scene")]
    work: Vec<Workload>,
    /// Vectors: avx512, avx2 or scalar [default: the widest there is]
    #[arg(long, value_name = "KIND", value_parser = kernel, requires = "scene", hide_short_help = true)]
    lanes: Option<Kernel>,
}

fn workload(text: &str) -> std::result::Result<Workload, String> {
    let found = Workload::ALL.into_iter().find(|work| work.name() == text.trim());
    found.ok_or_else(|| "one of w0, w1, w2, w3".into())
}

fn kernel(text: &str) -> std::result::Result<Kernel, String> {
    let found = Kernel::ALL.into_iter().find(|kernel| kernel.name() == text);
    found.ok_or_else(|| "one of avx512, avx2, scalar".into())
}

/// Times the kernels on the scene in `folder`.
pub fn run(folder: &Path, arguments: &SceneArguments, json: bool) -> Result<u8> {
    let kernel = arguments.lanes.unwrap_or_else(Kernel::widest);
    if !kernel.available() {
        return Err(Error::Usage(format!("--lanes {}: this processor has none", kernel.name())));
    }
    let scene = Scene::read(folder, arguments.n as usize)?;
    let rows: Vec<SceneRow> =
        arguments.work.iter().map(|&work| scene.run(work, kernel, REPETITIONS)).collect::<Result<_>>()?;
    let mut out = Output::default();
    if json {
        let rows: Vec<_> = rows.iter().map(|row| json_row(row, arguments.n, kernel)).collect();
        out.json(&json!({ "rows": rows }))?;
        return Ok(0);
    }
    const HEADINGS: [&str; 11] = [
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
        "differs",
    ];
    let cells: Vec<Vec<String>> = rows.iter().map(|row| cells(row, arguments.n, kernel)).collect();
    out.lines(columns(&HEADINGS, &cells))?;
    Ok(0)
}

fn cells(row: &SceneRow, n: u32, kernel: Kernel) -> Vec<String> {
    vec![
        format!("gonio-{}", kernel.name()),
        n.to_string(),
        row.work.to_string(),
        "1".into(),
        format!("{:.2}", row.rate()),
        format!("{:.1}", row.nanoseconds(row.median_seconds())),
        format!("{:.1}", row.nanoseconds(row.seconds[0])),
        format!(
            "{:.0}",
            100.0 * (row.seconds[row.seconds.len() - 1] - row.seconds[0]) / row.median_seconds()
        ),
        format!("{:.5}", row.escaped),
        format!("{:.3}", row.rays_per_sample),
        format!("{:.1e}", row.differs),
    ]
}

fn json_row(row: &SceneRow, n: u32, kernel: Kernel) -> serde_json::Value {
    json!({
        "tracer": format!("gonio-{}", kernel.name()),
        "n": n,
        "work": row.work.name(),
        "mray_per_cpu_s": row.rate(),
        "seconds": row.seconds,
        "samples": row.samples,
        "rays_per_sample": row.rays_per_sample,
        "escaped": row.escaped,
        "differs": row.differs,
    })
}
