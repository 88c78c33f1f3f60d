//! Question: what do the start points of a block cost, with and without the sums over the patch?

#[path = "common/patches.rs"]
mod patches;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gonio::trace::{AreaSampler, BLOCK, Window};
use patches::{ProcessorTime, light, numbers, patch};

/// Per start of a block.
fn block(c: &mut Criterion<ProcessorTime>) {
    for cells in [1024, 2048] {
        let field = patch(cells);
        let mut group = c.benchmark_group(format!("starts {cells}"));
        group.throughput(Throughput::Elements(BLOCK));
        for theta in [0.0, 60.0, 85.0] {
            let light = light(theta, 20.0, 0.5);
            group.bench_function(format!("one block {theta}"), |b| {
                b.iter(|| {
                    let starts = AreaSampler::new(&field, Window::all(&field), light);
                    starts.each(BLOCK, &mut numbers(1), |place| {
                        black_box(place);
                    });
                });
            });
            let starts = AreaSampler::new(&field, Window::all(&field), light);
            group.bench_function(format!("further block {theta}"), |b| {
                b.iter(|| {
                    starts.each(BLOCK, &mut numbers(1), |place| {
                        black_box(place);
                    });
                });
            });
        }
    }
}

criterion_group! { name = benches; config = patches::criterion(); targets = block }
criterion_main!(benches);
