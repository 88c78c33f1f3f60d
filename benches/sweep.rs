//! Question: what does visibility towards a fixed direction cost per cell, alone, at grazing light, on larger
//! patches, and when zenith angles share a pass?

#[path = "common/patches.rs"]
mod patches;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use gonio::trace::{BLOCK, Layout, Sweep};
use patches::{ProcessorTime, light, patch};

const ALPHA: f64 = 0.5;
/// Along no axis; lines run along x.
const PHI_DEG: f64 = 20.0;

fn lights(thetas: &[f64], phi: f64) -> Vec<DVec3> {
    thetas.iter().map(|&theta| light(theta, phi, ALPHA)).collect()
}

fn zeniths() -> Vec<(String, Vec<f64>)> {
    let one = [0.0, 60.0, 75.0, 85.0, 89.0].iter().map(|theta| (format!("{theta}"), vec![*theta]));
    let several = ("0-75 in 6".into(), vec![0.0, 15.0, 30.0, 45.0, 60.0, 75.0]);
    one.chain([several]).collect()
}

fn visible(c: &mut Criterion<ProcessorTime>) {
    for cells in [1024, 2048] {
        let field = patch(cells);
        let layout = Layout::new(&field).expect("a periodic field");
        let mut group = c.benchmark_group(format!("{cells}"));
        group.throughput(Throughput::Elements((cells * cells) as u64));
        for (name, thetas) in zeniths() {
            let lights = lights(&thetas, PHI_DEG);
            let heading = light(60.0, PHI_DEG, ALPHA).truncate();
            group.bench_function(BenchmarkId::new("visible", &name), |b| {
                b.iter(|| black_box(Sweep::new(&layout, heading, &lights, 0.3).visible()));
            });
            let offsets = vec![0.4; lights.len()];
            group.bench_function(BenchmarkId::new("starts", &name), |b| {
                b.iter(|| {
                    let mut lit = 0;
                    let sweep = Sweep::new(&layout, heading, &lights, 0.3);
                    sweep.each(BLOCK, &offsets, |_, place, sees| {
                        black_box(place);
                        lit += u64::from(sees);
                    });
                    lit
                });
            });
        }
    }
}

fn layout(c: &mut Criterion<ProcessorTime>) {
    let field = patch(1024);
    let mut group = c.benchmark_group("1024");
    group.throughput(Throughput::Elements(1 << 20));
    group.bench_function("layout", |b| b.iter(|| black_box(Layout::new(&field).is_some())));
}

criterion_group! { name = benches; config = patches::criterion(); targets = visible, layout }
criterion_main!(benches);
