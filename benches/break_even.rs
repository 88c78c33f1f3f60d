//! Question: from how many cells for each start on are rays faster than a line sweep, for one zenith angle and for
//! several that share it; and up to which share of the hemisphere does an index of the facets pay?
//!
//! Whole measurements of order 1 at alpha 0.2, processor time for each start, median of five: what `measure/plan.rs`
//! decides by. `cargo bench --bench break_even`.

use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::measure::{self, Patches, Plan};

const REPETITIONS: usize = 5;

fn campaign(cells: u32, lights: &str, sensor: &str, samples: u64) -> Campaign {
    let text = format!(
        "name = \"break_even\"\nseed = 1\n[surface]\nrealisations = 1\ncells = {cells}\n\
         correlation_cells = 8.0\n[surface.ggx]\nalpha = 0.2\n[light]\ntheta_i_deg = [{lights}]\n{sensor}\n\
         [stop]\nsamples = {samples}\n"
    );
    campaign::parse(&text, "break_even", Path::new("")).expect("a campaign").campaign
}

/// Processor nanoseconds for each start of two plans, measured alternately.
fn compare(campaign: &Campaign, patches: &Patches, changes: [&dyn Fn(&mut Plan); 2]) -> [f64; 2] {
    let mut times = [(); 2].map(|()| Vec::new());
    for _ in 0..REPETITIONS {
        for (times, change) in times.iter_mut().zip(changes) {
            let mut plan = measure::plan(campaign).expect("a plan");
            change(&mut plan);
            let (_, cost) = measure::measure(campaign, &plan, patches, &|_| {}).expect("a table");
            times.push(1e9 * cost.tracing_cpu_s / cost.samples as f64);
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[REPETITIONS / 2]
    })
}

/// Rows of cells for each start, and where the lines through neighbouring rows cross.
fn sweeps() {
    println!("zeniths  cells/start  sweep ns  rays ns  rays/sweep");
    for lights in ["60", "30, 60", "20, 40, 60", "15, 30, 45, 60", "0, 15, 30, 45, 60, 75"] {
        let zeniths = lights.split(',').count();
        let mut rows: Vec<(f64, [f64; 2])> = Vec::new();
        for side in [512, 1024, 2048] {
            let campaign = campaign(side, lights, "[sensor.hemisphere]", 4 * gonio::trace::BLOCK);
            let patches = Patches::held(&campaign).expect("patches");
            let sweep = |plan: &mut Plan| plan.most_cells_per_start = f64::INFINITY;
            let times = compare(&campaign, &patches, [&sweep, &|plan| plan.sweeps = false]);
            let cells = f64::from(side).powi(2) / gonio::trace::BLOCK as f64;
            println!(
                "{zeniths:>7}  {cells:>11}  {:>8.0}  {:>7.0}  {:>10.2}",
                times[0],
                times[1],
                times[1] / times[0]
            );
            rows.push((cells, times));
        }
        for pair in rows.windows(2) {
            let gain = |(_, [sweep, rays]): (f64, [f64; 2])| rays - sweep;
            let (near, far) = (gain(pair[0]), gain(pair[1]));
            if near > 0.0 && far <= 0.0 {
                let cells = pair[0].0 + (pair[1].0 - pair[0].0) * near / (near - far);
                println!("{zeniths:>7}  {cells:>11.0}  break-even");
            }
        }
    }
}

/// Shares of the hemisphere, as the plan counts them, and what an index gains.
fn index() {
    println!("share of the hemisphere  index ns  all facets ns  all/index");
    for (arms, half_angle) in [(1, 5), (2, 8), (3, 10), (4, 10), (6, 10), (6, 14), (8, 16), (12, 18)] {
        let azimuths: Vec<String> = (0..arms).map(|arm| (360 * arm / arms).to_string()).collect();
        let sensor = format!(
            "[sensor.arm]\ntheta_r_deg = [45]\nphi_r_deg = [{}]\naperture_deg = {half_angle}",
            azimuths.join(", ")
        );
        let campaign = campaign(1024, "45", &sensor, 16 * gonio::trace::BLOCK);
        let patches = Patches::held(&campaign).expect("patches");
        let changes: [&dyn Fn(&mut Plan); 2] = [&|plan| plan.indexed = true, &|plan| plan.indexed = false];
        let [with, without] = compare(&campaign, &patches, changes);
        let share = f64::from(arms) * 2.0 * (f64::from(half_angle) * 0.5).to_radians().sin().powi(2);
        println!("{share:>23.3}  {with:>8.0}  {without:>13.0}  {:>9.2}", without / with);
    }
}

fn main() {
    sweeps();
    index();
}
