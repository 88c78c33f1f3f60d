//! Promise: paths through clear facets end in the lanes as they do one by one, and light goes back the way it came.

use glam::DVec2;
use gonio::campaign::LightSide;
use gonio::measure::optics::{FacetWay, Kept, PathLight};
use gonio::optics::FacetKind;
use gonio::rng::PathDraws;
use gonio::sphere;
use gonio::surface::{SlopeLaw, Synthesiser};
use gonio::trace::{
    AreaSampler, GridTraversal, Kernel, MaxPyramid, PatchSymmetry, PathEnd, PathWaves, SimdTraversal,
    SurfacePoint, Traced, TracedPatch, View, Wave, Window,
};

use crate::support::measuring::test_rng;

#[test]
fn split_light_in_lanes_is_that_of_single_paths() {
    let field = Synthesiser::new(SlopeLaw::Ggx, 128, 8.0).patch(&mut test_rng(3));
    let under = field.upside_down();
    let pyramids = [&field, &under].map(|field| MaxPyramid::new(field).expect("lanes serve it"));
    let [above, below] = [GridTraversal::new(&field), GridTraversal::new(&under)];
    let over = [
        SimdTraversal::new(above, &pyramids[0], Kernel::widest()),
        SimdTraversal::new(below, &pyramids[1], Kernel::widest()),
    ];
    let mut paths = PathWaves::default();
    for (alpha, theta, eta) in [(0.5, 60.0, 1.5), (1.0, 20.0, 1.0 / 1.5), (0.3, 80.0, 2.4)] {
        let sample =
            TracedPatch { traversal: above, below, alpha: DVec2::splat(alpha), image: PatchSymmetry::nth(5) };
        let wi = sphere::direction_deg(theta, 77.0);
        let mut starts: Vec<SurfacePoint> = Vec::new();
        let window = Window::all(&field);
        AreaSampler::new(&field, window, sample.to_field(wi))
            .each(30_000, &mut test_rng(4), |start| starts.push(start));
        let views = [View { sample, wi }];
        let view_of = vec![0; starts.len()];
        let wave = Wave { surface_samples: &starts, view_of: &view_of, views: &views, bounces: 5 };
        let mut splits = Vec::new();
        paths.trace_split(&over, &wave, eta, &mut splits);
        let way = FacetWay { kind: FacetKind::Dielectric { eta }, light: LightSide::Front, place: 0 };
        let light = |k: usize| PathLight::new(way, PathDraws::new(9, k as u64), Kept::default());
        let mut lights: Vec<PathLight> = (0..starts.len()).map(light).collect();
        let mut endings = vec![PathEnd::Lost; starts.len()];
        paths.trace(&over, &wave, &mut lights, |path, _, ending| endings[path] = ending);
        let (mut differ, mut through) = ([0; 2], 0);
        for (k, start) in starts.iter().enumerate() {
            differ[0] += usize::from(splits[k] != sample.trace_split(start, wi, eta));
            let alone = sample.trace(*start, wi, 5, &mut light(k));
            differ[1] += usize::from(endings[k] != alone);
            through += usize::from(matches!(alone, PathEnd::Out { wo, .. } if wo.z < 0.0));
        }
        println!("alpha {alpha}, eta {eta}: {differ:?} of {} differ, {through} go through", starts.len());
        // One ray in 1e4 may be answered otherwise by f32; paths have up to six.
        assert!(differ.iter().all(|&differ| differ <= starts.len() / 1000), "{differ:?}");
        assert!(through > starts.len() / 10);
    }
}
