//! Promise: patches made from a power spectral density have it: its rms height, its slopes, and the density itself; and a
//! table of them is that of Gaussian slopes.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use gonio::campaign::PsdSurface;
use gonio::psd::{Psd, PsdKind, PsdModel, PsdMoments, PsdTable};
use gonio::rng::{self, Purpose, StreamId};
use gonio::surface::areal::Roughness;
use gonio::surface::io::prepare::MapGrid;
use gonio::surface::{Heightfield, Synthesiser};
use gonio::validate::examine;

use crate::support::measuring::measured_one;

const CELLS: u32 = 256;
const PITCH: f64 = 0.5;
const PATCHES: u64 = 8;

fn unlimited(model: PsdModel) -> Psd {
    Psd { model, f_min_per_um: None, f_max_per_um: None }
}

fn k_correlation(a_um3: f64, b_um: f64, c: f64) -> Psd {
    unlimited(PsdModel::KCorrelation { a_um3, b_um, c })
}

fn self_affine() -> Psd {
    let model = PsdModel::SelfAffine { rms_um: 0.3, hurst: 0.7 };
    Psd { model, f_min_per_um: Some(0.06), f_max_per_um: Some(0.5) }
}

/// Heights in um of some patches, as a campaign has them.
fn patches(psd: &Psd) -> Vec<Vec<f64>> {
    let synthesiser = Synthesiser::with_psd(psd, PITCH, CELLS as usize);
    let (surface, _) = PsdSurface::new(psd.clone(), PITCH, None, CELLS).expect("waves");
    let unit = surface.alphas[0].x * PITCH;
    let patch = |realisation: u64| {
        let id = StreamId { seed: 11, purpose: Purpose::Test, realisation, incidence: 0, block: 0 };
        let field: Heightfield = synthesiser.patch(&mut rng::stream(id));
        field.heights().iter().map(|height| unit * height).collect()
    };
    (0..PATCHES).map(patch).collect()
}

/// Sum of `of(S df^2, kx, ky)` over all waves of a patch, kx and ky in radians a cell, without any symmetry.
fn over_waves(psd: &Psd, of: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let n = CELLS as i32;
    let step = 1.0 / (f64::from(CELLS) * PITCH);
    let wave = |i: i32, j: i32| {
        let power = psd.areal(f64::from(i).hypot(f64::from(j)) * step, PITCH) * step * step;
        of(power, TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(n))
    };
    let line = |i: i32| (1 - n / 2..=n / 2).filter(|j| (i, *j) != (0, 0)).map(|j| wave(i, j)).sum::<f64>();
    (1 - n / 2..=n / 2).map(line).sum()
}

/// Quadrature of 30 digits, from the profile's density alone (`tests/data/psd_values.py`).
#[test]
fn areal_densities_of_k_correlation_are_the_inverse_of_their_profiles() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/psd_values.csv");
    let text = fs::read_to_string(path).expect("readable");
    let mut rows = 0;
    for line in text.lines().skip(1) {
        let [a, b, c, f, wanted] =
            line.split(',').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>()[..]
        else {
            panic!("{line}")
        };
        let found = k_correlation(a, b, c).areal(f, 1e-3);
        // ln Gamma to 1e-14 or so, and a power of up to 3 of a number of few ulp.
        assert!((found / wanted - 1.0).abs() < 1e-12, "{line}: {found}");
        rows += 1;
    }
    assert_eq!(rows, 12);
}

/// The closed forms: of K-correlation 2 pi S(0)/(B^2 (C - 1)) (1 - U^(-(C - 1)/2)), U = 1 + (B F)^2, up to the frequency F;
/// of a self-affine surface the rms height squared.
#[test]
fn densities_integrate_to_their_closed_forms() {
    // Simpson's rule over the logarithm of f; below the lowest limit nothing is left.
    let variance = |psd: &Psd, low: f64, high: f64| {
        let (steps, width) = (4000, (high / low).ln() / 4000.0);
        let at = |k: i32| {
            let f = low * (f64::from(k) * width).exp();
            TAU * f * f * psd.areal(f, PITCH)
        };
        let weight = |k: i32| if k == 0 || k == steps { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
        (0..=steps).map(|k| weight(k) * at(k)).sum::<f64>() * width / 3.0
    };
    let (a, b, c, high) = (0.02, 12.0, 4.0, 0.5 / PITCH);
    // Gamma(5/2)/Gamma(2) = 3 sqrt(pi)/4.
    let at_zero = 3.0 * a * b / 8.0;
    let wanted =
        TAU * at_zero / (b * b * (c - 1.0)) * (1.0 - (1.0 + (b * high).powi(2)).powf(-0.5 * (c - 1.0)));
    // What lies below 1e-6 /um is 1e-10 of it; Simpson's error goes as width^4 = 1e-10.
    let found = variance(&k_correlation(a, b, c), 1e-6, high);
    assert!((found / wanted - 1.0).abs() < 1e-8, "{found} {wanted}");
    let found = variance(&self_affine(), 0.06, 0.5);
    assert!((found / 0.09 - 1.0).abs() < 1e-8, "{found}");
}

/// A profile's table against the areal density of the same surface, C = 2: A B/4 (1 + (B f)^2)^(-3/2).
#[test]
fn a_profile_s_density_becomes_the_areal_one() {
    let (a, b) = (0.02, 12.0);
    let count = 400;
    let step = 1e4f64.ln() / f64::from(count - 1);
    let frequency: Vec<f64> = (0..count).map(|k| 1e-4 * (f64::from(k) * step).exp()).collect();
    let profile = frequency.iter().map(|f| a / (1.0 + (b * f).powi(2))).collect();
    let table = PsdTable::new(PsdKind::Profile, frequency.clone(), profile).expect("falls");
    for f in frequency.iter().step_by(7).map(|f| 1.01 * f).filter(|f| *f < 0.9) {
        let wanted = 0.25 * a * b * (1.0 + (b * f).powi(2)).powf(-1.5);
        // Between two frequencies the profile's slope is its mean: off by half a step times d ln p/d ln f, 2 at most.
        assert!((table.areal(f) / wanted - 1.0).abs() < step, "{f}: {} {wanted}", table.areal(f));
    }
    assert_eq!([table.areal(0.99e-4), table.areal(1.01)], [0.0, 0.0]);
    // What no isotropic surface has.
    let rises = PsdTable::new(PsdKind::Profile, vec![0.1, 0.2, 0.3], vec![1.0, 0.5, 2.0]);
    assert!(rises.expect_err("rises").contains("does not fall"));
    let step = PsdTable::new(PsdKind::Profile, vec![0.1, 0.2, 0.3, 0.4], vec![1e-6, 1.0, 0.9, 0.1]);
    assert!(step.expect_err("rises").contains("rises too steeply"));
}

/// Moments by all waves of the patch, by closed forms, and by patches within chance.
#[test]
fn patches_have_the_moments_of_their_psd() {
    for psd in [k_correlation(0.02, 10.0, 4.0), self_affine()] {
        let moments = PsdMoments::of(&psd, CELLS, PITCH);
        let versine = |k: f64| (2.0 * (0.5 * k).sin()).powi(2);
        let sums = [
            (moments.rms_um.powi(2), over_waves(&psd, |s, _, _| s)),
            ((moments.facet_slope * PITCH).powi(2), over_waves(&psd, |s, kx, _| s * versine(kx))),
            ((moments.wave_slope * PITCH).powi(2), over_waves(&psd, |s, kx, _| s * kx * kx)),
            (
                (moments.curvature_per_um * PITCH * PITCH).powi(2),
                over_waves(&psd, |s, kx, _| s * versine(kx).powi(2)),
            ),
        ];
        for (k, (found, wanted)) in sums.into_iter().enumerate() {
            // Sums of 2^16 terms in another order.
            assert!((found / wanted - 1.0).abs() < 1e-11, "{k}: {found} {wanted}");
        }
        let squares = over_waves(&psd, |s, _, _| s * s);
        let side = f64::from(CELLS) * PITCH;
        let area = side * side * squares / moments.rms_um.powi(4);
        assert!((moments.correlation_area_um2 / area - 1.0).abs() < 1e-11);
        // A wave and its conjugate have one amplitude, whose square is as spread as it is large: the variance of a sum of w S
        // over all waves is 2 sum (w S)^2.
        let all = patches(&psd);
        let spread = |of: &dyn Fn(f64, f64) -> f64| {
            let mean = over_waves(&psd, |s, kx, ky| s * of(kx, ky));
            (2.0 * over_waves(&psd, |s, kx, ky| (s * of(kx, ky)).powi(2)) / PATCHES as f64).sqrt() / mean
        };
        let n = CELLS as usize;
        let mean_of = |f: &dyn Fn(&[f64], usize) -> f64| {
            let of_patch = |heights: &Vec<f64>| (0..n * n).map(|at| f(heights, at)).sum::<f64>();
            all.iter().map(of_patch).sum::<f64>() / (all.len() * n * n) as f64
        };
        let found = mean_of(&|heights, at| heights[at].powi(2)) / moments.rms_um.powi(2) - 1.0;
        // Five standard deviations.
        assert!(found.abs() < 5.0 * spread(&|_, _| 1.0), "variance off by {found}");
        let along = |heights: &[f64], at: usize| heights[at / n * n + (at % n + 1) % n] - heights[at];
        let slope2 = mean_of(&|heights, at| (along(heights, at) / PITCH).powi(2));
        let found = slope2 / moments.facet_slope.powi(2) - 1.0;
        assert!(found.abs() < 5.0 * spread(&|kx, _| versine(kx)), "slopes off by {found}");
    }
}

/// Waves of K-correlation, C = 4: the patch is 13 B, and all but 1e-5 of the variance lies below half a wave a cell, so that sums
/// are integrals but for what lies about f = 0.
#[test]
fn rms_height_and_slope_of_k_correlation_are_closed_forms() {
    let (a, b, c) = (0.02, 10.0, 4.0);
    let moments = PsdMoments::of(&k_correlation(a, b, c), CELLS, PITCH);
    let (high, step) = (0.5 / PITCH, 1.0 / (f64::from(CELLS) * PITCH));
    let at_zero = 3.0 * a * b / 8.0;
    let u = 1.0 + (b * high).powi(2);
    let variance = TAU * at_zero / (b * b * (c - 1.0)) * (1.0 - u.powf(-1.5)) - at_zero * step * step;
    // Places of a square grid in a circle of radius R = 128 are pi R^2 within 2 R; S at its rim.
    let rim = |weight: f64| 2.0 * 128.0 * step * step * weight * at_zero * u.powf(-2.5);
    assert!((moments.rms_um.powi(2) - variance).abs() < rim(1.0) + 1e-9 * variance);
    // Half of (2 pi f)^2 S over the plane: 4 pi^3 S(0) integral of f^3 (1 + (B f)^2)^(-5/2) df.
    let cubic = (2.0 - 2.0 * u.powf(-0.5) + (u.powf(-1.5) - 1.0) / 1.5) / (2.0 * b.powi(4));
    let slope2 = 4.0 * PI.powi(3) * at_zero * cubic;
    let rim = rim(0.5 * (TAU * high).powi(2));
    assert!(
        (moments.wave_slope.powi(2) - slope2).abs() < rim + 1e-9 * slope2,
        "{} {slope2}",
        moments.wave_slope.powi(2)
    );
    // One number for any number of threads.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
    assert_eq!(pool.install(|| PsdMoments::of(&k_correlation(a, b, c), CELLS, PITCH)), moments);
}

#[test]
fn the_density_of_a_patch_is_the_one_asked_for() {
    let grid = MapGrid { columns: CELLS as usize, pitch: [PITCH; 2], periodic: true };
    for psd in [k_correlation(0.02, 10.0, 2.5), self_affine()] {
        let all: Vec<Vec<[f64; 2]>> =
            patches(&psd).iter().map(|heights| Roughness::of(heights, &grid).expect("room").psd).collect();
        // What was asked for, ring by ring as they are measured: means over the same waves.
        let step = 1.0 / (f64::from(CELLS) * PITCH);
        let n = CELLS as i32;
        let rings = all[0].len();
        let mut wanted = vec![(0.0, 0.0); rings + 1];
        for (i, j) in (1 - n / 2..=n / 2).flat_map(|i| (1 - n / 2..=n / 2).map(move |j| (i, j))) {
            let f = f64::from(i).hypot(f64::from(j));
            if let Some((sum, count)) = wanted.get_mut(f.round() as usize) {
                (*sum, *count) = (*sum + psd.areal(f * step, PITCH), *count + 1.0);
            }
        }
        for ring in 1..rings {
            let found = all.iter().map(|psd| psd[ring - 1][1]).sum::<f64>() / all.len() as f64;
            let (sum, count) = wanted[ring];
            if sum == 0.0 {
                // Heights are f32: 2^-24 of the rms, white.
                assert!(found < 1e-12 * wanted[8].0, "ring {ring}: {found}");
                continue;
            }
            // Half as many independent waves, each spread as much as it is large, in 8 patches; on the rim of the band a ring has
            // but some of them, at least an eighth. Six standard deviations for 250 rings.
            let few = if wanted[ring - 1].0 == 0.0 || ring + 1 < rings && wanted[ring + 1].0 == 0.0 {
                8.0
            } else {
                1.0
            };
            let spread = (2.0 * few / (count * PATCHES as f64)).sqrt();
            let off = found / (sum / count) - 1.0;
            assert!(off.abs() < 6.0 * spread, "ring {ring}: off by {off}, spread {spread}");
        }
    }
}

/// The table of a surface by its density and Beckmann's formula at its own slopes: as near as `[surface.beckmann]` is known to be.
#[test]
fn a_table_by_density_agrees_with_beckmann_of_its_slopes() {
    let measured = measured_one(
        "name = \"by_density\"\nseed = 5\n[surface]\nrealisations = 8\ncells = 256\n\
         [surface.psd]\nmodel = \"self_affine\"\npitch_um = 0.5\nrms_um = 0.42\nhurst = 0.8\nf_min_per_um = 0.06\n\
         f_max_per_um = 0.3\n[light]\ntheta_i_deg = [0, 30, 60]\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 18\n[stop]\nsamples = 131_072\n",
    );
    let alpha = measured.campaign.alphas()[0].expect("a roughness");
    assert!(alpha.x == alpha.y && (0.15..0.35).contains(&alpha.x), "{alpha:?}");
    let verdict = examine(&measured.table, &measured.campaign, Some(&measured.realisations));
    let model = verdict.judgements.iter().find(|judgement| judgement.law == "model").expect("judged");
    assert_eq!(model.ruling, gonio::validate::Ruling::Passed, "{}", model.reason);
    assert!(model.reason.starts_with("beckmann"), "{}", model.reason);
}
