//! Question: how long does one core make a patch?

#[path = "common/patches.rs"]
mod patches;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use gonio::surface::{SlopeLaw, Synthesiser};
use patches::{ProcessorTime, numbers};

fn patch(c: &mut Criterion<ProcessorTime>) {
    let mut group = c.benchmark_group("patch");
    group.sample_size(10);
    for (name, law) in [("ggx", SlopeLaw::Ggx), ("beckmann", SlopeLaw::Beckmann)] {
        for cells in [512, 1024] {
            let synthesiser = Synthesiser::new(law, cells, 8.0);
            group.throughput(Throughput::Elements((cells * cells) as u64));
            group.bench_function(BenchmarkId::new(name, cells), |bencher| {
                bencher.iter(|| synthesiser.patch(&mut numbers(1)));
            });
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = patches::criterion(); targets = patch }
criterion_main!(benches);
