//! Time of the ray kernels: any hit and closest hit, from random places of a GGX patch.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use gonio::rng::{self, Purpose, StreamId};
use gonio::sphere;
use gonio::surface::{SlopeLaw, Synthesiser};
use gonio::trace::{Facet, HitBuffer, Kernel, MaxPyramid, RayBatch, SurfacePoint};

const CELLS: usize = 256;
const RAYS: u64 = 16_384;

fn kernels(criterion: &mut Criterion) {
    let id = StreamId { seed: 1, purpose: Purpose::Bench, realisation: 0, incidence: 0, block: 0 };
    let mut rng = rng::stream(id);
    let field = Synthesiser::new(SlopeLaw::Ggx, CELLS, 8.0).patch(&mut rng);
    let Some(lanes) = MaxPyramid::new(&field) else { return };
    let mut rays = RayBatch::default();
    for _ in 0..RAYS {
        let mut cell = || (rng::uniform(&mut rng) * CELLS as f64) as usize;
        let facet = Facet { x: cell(), y: cell(), upper: false };
        let start = SurfacePoint::on(&field, facet, 0.3, 0.3);
        let w = sphere::direction_deg(80.0 * rng::uniform(&mut rng), 360.0 * rng::uniform(&mut rng));
        rays.push(&start, DVec3::new(0.5 * w.x, 0.5 * w.y, w.z));
    }
    let mut hits = HitBuffer::default();
    let mut group = criterion.benchmark_group("kernel");
    group.sample_size(20).throughput(Throughput::Elements(RAYS));
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.available()) {
        group.bench_function(BenchmarkId::new("any_hit", kernel.name()), |bencher| {
            bencher.iter(|| kernel.any_hit(&lanes, &rays, &mut hits));
        });
        group.bench_function(BenchmarkId::new("closest_hit", kernel.name()), |bencher| {
            bencher.iter(|| kernel.closest_hit(&lanes, &rays, &mut hits));
        });
    }
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
