//! Question: up to which fraction of the hemisphere does an index of the facets pay?
//!
//! Whole measurements of order 1 at alpha 0.2, processor time for each surface sample, median of five: what
//! `measure/start_sampler.rs` decides by. `cargo bench -p gonio-benches --bench index`.

use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::measure::{self, Patches, Plan};

const REPETITIONS: usize = 5;

fn campaign(sensor: &str) -> Campaign {
    let samples = 16 * gonio::trace::BLOCK;
    let text = format!(
        "name = \"index\"\nseed = 1\n[surface]\nrealisations = 1\ncells = 1024\ncorrelation_cells = 8.0\n\
         [surface.ggx]\nalpha = 0.2\n[light]\ntheta_i_deg = [45]\n{sensor}\n[stop]\nsamples = {samples}\n"
    );
    campaign::parse(&text, "index", Path::new("")).expect("a campaign").campaign
}

/// Processor nanoseconds for each sample of two plans, measured alternately.
fn compare(campaign: &Campaign, plans: [&Plan; 2]) -> [f64; 2] {
    let patches = Patches::held(campaign).expect("patches");
    let mut times = [(); 2].map(|()| Vec::new());
    for _ in 0..REPETITIONS {
        for (times, plan) in times.iter_mut().zip(plans) {
            let (_, cost) = measure::measure(campaign, plan, &patches, &|_| {}).expect("a table");
            times.push(1e9 * cost.tracing_cpu_s / cost.samples as f64);
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[REPETITIONS / 2]
    })
}

fn main() {
    println!("fraction of the hemisphere  index ns  all facets ns  all/index");
    for (arms, half_angle) in [(1, 5), (2, 8), (3, 10), (4, 10), (6, 10), (6, 14)] {
        let azimuths: Vec<String> = (0..arms).map(|arm| (360 * arm / arms).to_string()).collect();
        let campaign = campaign(&format!(
            "[sensor.arm]\ntheta_r_deg = [45]\nphi_r_deg = [{}]\naperture_deg = {half_angle}",
            azimuths.join(", ")
        ));
        let plan = measure::plan(&campaign).expect("a plan");
        let Some(all) = plan.by_place(&campaign) else { continue };
        let [with, without] = compare(&campaign, [&plan, &all]);
        let fraction = f64::from(arms) * 2.0 * (f64::from(half_angle) * 0.5).to_radians().sin().powi(2);
        println!("{fraction:>26.3}  {with:>8.0}  {without:>13.0}  {:>9.2}", without / with);
    }
}
