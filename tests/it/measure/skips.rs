//! Promise: what the plan leaves out changes nothing: not a byte where the samples are the same, nothing beyond the
//! errors where they differ.
//!
//! Further skips are held elsewhere: no primary rays in `fair_starts.rs`, patches shared by roughnesses and incidences in
//! `reproducibility.rs`, lanes against the f64 walk in `lanes.rs`.

use std::sync::OnceLock;
use std::time::Instant;

use glam::DVec3;
use gonio::campaign::{self, Campaign};
use gonio::instrument::Region;
use gonio::measure::cost::cpu_seconds;
use gonio::measure::{self, Measured, Patches, Plan, StartSampler};
use gonio::rng;
use gonio::sphere;
use gonio::stats::{mean, mean_and_se, sidak, student_limit};
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use gonio::trace::{
    Facet, GridTraversal, Kernel, MaxPyramid, Outcome, PatchSymmetry, SimdTraversal, SurfacePoint,
    TracedPatch, Waves,
};

use crate::support::long::or_long;
use crate::support::measuring;
use crate::support::measuring::{measured_on, test_rng};

const ISOTROPIC: &str = "alpha = 0.3";
const ANISOTROPIC: &str = "alpha_x = 0.15\nalpha_y = 0.4";
const RELATIVE: &str = "theta_i_deg = [20, 60]\nazimuth = \"relative\"";
const ABSOLUTE: &str = "theta_i_deg = [50]\nphi_i_deg = [0, 25]";
const HEMISPHERE: &str = "[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\nbins = \"aligned\"";
/// In and off the plane of incidence, two of them overlapping, one hardly above the horizon.
const ARM: &str =
    "[sensor.arm]\ntheta_r_deg = [-40, 0, 20, 23, 60, 84]\nphi_r_deg = [150, 180]\naperture_deg = 3";

/// 16 patches of 128 x 128 cells, two blocks for each incidence.
fn campaign(surface: &str, light: &str, sensor: &str, more: &str) -> String {
    format!(
        "name = \"skips\"\nseed = 5\n[surface]\nrealisations = 16\ncells = 128\ncorrelation_cells = 8.0\n\
         [surface.ggx]\n{surface}\n[light]\n{light}\n{sensor}\n{more}\n[stop]\nsamples = 131_072\n"
    )
}

/// The patches, which are the same whatever is skipped and whatever the roughness.
fn patches() -> &'static Patches {
    static PATCHES: OnceLock<Patches> = OnceLock::new();
    PATCHES.get_or_init(|| {
        let text = campaign(ISOTROPIC, RELATIVE, HEMISPHERE, "");
        let parsed = campaign::parse(&text, "c.toml", std::path::Path::new("")).expect("no faults");
        Patches::held(&parsed.campaign).expect("patches")
    })
}

/// A table by another plan than the campaign's own. A sensor that sees everything needs fewer starts in a block than an arm
/// with the same number of arrivals in its bins; the differences that are looked for are in units of their own noise.
fn measured_as(text: &str, other: impl FnOnce(&Plan, &Campaign) -> Option<Plan>) -> Measured {
    measured_on(patches(), text, |plan, campaign| {
        let mut plan = other(plan, campaign)?;
        plan.block_starts /= or_long(if text.contains(HEMISPHERE) { 8 } else { 2 }, 1);
        Some(plan)
    })
}

fn measured_with(text: &str, change: impl FnOnce(&mut Plan)) -> Measured {
    measured_as(text, |plan, _| {
        let mut plan = plan.clone();
        change(&mut plan);
        Some(plan)
    })
}

fn measured_one(text: &str) -> Measured {
    measured_with(text, |_| ())
}

/// Values of all bins of a realisation, order 1, first colour.
fn singles(measured: &Measured) -> Vec<&[f32]> {
    measured.realisations.parts.iter().map(|part| &part.single[0][..]).collect()
}

fn same_bytes(a: &Measured, b: &Measured) -> bool {
    let bits = |m: &Measured| -> Vec<u32> { singles(m).concat().iter().map(|v| v.to_bits()).collect() };
    a.table.hits == b.table.hits && bits(a) == bits(b)
}

/// Starts = hidden + orders + cut + left map + outside (+ lost = 0), as integers.
fn starts_close(measured: &Measured) {
    for incidence in &measured.incidences {
        let seen = incidence.orders.iter().sum::<u64>()
            + incidence.cut
            + incidence.hidden
            + incidence.left_map
            + incidence.outside;
        assert_eq!(seen, incidence.samples * measured.realisations.parts.len() as u64);
    }
}

/// Bin by bin, two measurements of the same patches: t of the differences over the realisations. Bins with fewer than
/// 400 arrivals are left out, for their differences are not normal.
///
/// Family level 1 % for the largest |t|. All bins together: the mean of t^2 (dof-2)/dof is 1 with a standard deviation
/// of sqrt(2.9/bins) at 15 degrees of freedom, three times that for bins that hang together; four of these.
/// Power: a fault of d standard errors in every bin adds d^2 to the mean, so that with 20 bins half an error bar more
/// or less everywhere stays hidden, two do not; in a single bin 7 do not.
fn agree(what: &str, a: &Measured, b: &Measured) {
    let (a_parts, b_parts) = (singles(a), singles(b));
    let dof = a_parts.len() - 1;
    let bins: Vec<usize> =
        (0..a_parts[0].len()).filter(|&bin| a.table.hits[bin].min(b.table.hits[bin]) >= 400).collect();
    let t = |&bin: &usize| {
        let differences = a_parts.iter().zip(&b_parts).map(|(a, b)| f64::from(a[bin]) - f64::from(b[bin]));
        let (mean, se) = mean_and_se(differences);
        mean / se.expect("several realisations")
    };
    let t: Vec<f64> = bins.iter().map(t).collect();
    let largest = t.iter().fold(0.0f64, |largest, t| largest.max(t.abs()));
    let limit = student_limit(sidak(0.01, t.len()), dof);
    let squares: Vec<f64> = t.iter().map(|t| t * t * (dof as f64 - 2.0) / dof as f64).collect();
    let spread = 4.0 * 3.0 * (2.9 / t.len() as f64).sqrt();
    println!(
        "{what}: {} bins, largest |t| {largest:.2} of {limit:.2}, mean t^2 {:.2}",
        t.len(),
        mean(&squares)
    );
    assert!(t.len() >= 8, "{what}: too few bins with light");
    assert!(largest < limit, "{what}: |t| = {largest}");
    assert!(mean(&squares) < 1.0 + spread, "{what}: mean t^2 {}", mean(&squares));
}

/// Standard error over the realisations, median over the bins with light.
fn median_error(measured: &Measured) -> f64 {
    let channel = &measured.table.colours[0];
    let bright = |k: &usize| measured.table.hits[*k] >= 400;
    let mut errors: Vec<f64> = (0..channel.stderr_single.len())
        .filter(bright)
        .map(|k| f64::from(channel.stderr_single[k] / channel.single[k]))
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

#[test]
fn starts_that_miss_every_aperture_change_no_byte() {
    let cases = [
        campaign(ISOTROPIC, RELATIVE, ARM, ""),
        campaign(ANISOTROPIC, ABSOLUTE, ARM, ""),
        campaign(ANISOTROPIC, ABSOLUTE, ARM, "[trace]\nvisibility = false"),
        campaign(ISOTROPIC, RELATIVE, ARM, "[optics]\nmaterial = \"gold\""),
    ];
    // Bytes have no noise: a sixteenth of the starts is as good.
    let fewer = |plan: Plan| Some(Plan { block_starts: plan.block_starts / or_long(16, 1), ..plan });
    for text in &cases {
        let few = measured_as(text, |plan, campaign| plan.by_place(campaign).and_then(fewer));
        let all = measured_as(text, |plan, campaign| {
            plan.by_place(campaign)?.all_directions(campaign).and_then(fewer)
        });
        assert!(same_bytes(&all, &few), "{text}");
        assert!(few.incidences.iter().all(|incidence| incidence.outside > 0 && incidence.closure.is_empty()));
        assert!(all.incidences.iter().all(|incidence| incidence.outside == 0));
        starts_close(&all);
        starts_close(&few);
    }
}

/// The same patches with all starts made, and with those on wanted facets only.
#[test]
fn the_facet_index_changes_nothing_but_noise() {
    let cone = "theta_i_deg = [20, 60]\nazimuth = \"relative\"\naperture_deg = 4";
    for (what, text) in [
        ("isotropic", campaign(ISOTROPIC, RELATIVE, ARM, "")),
        ("anisotropic, images, half folded", campaign(ANISOTROPIC, ABSOLUTE, ARM, "")),
        ("light cone", campaign(ISOTROPIC, cone, ARM, "")),
        ("no visibility", campaign(ISOTROPIC, RELATIVE, ARM, "[trace]\nvisibility = false")),
    ] {
        let full = measured_as(&text, |plan, campaign| plan.by_place(campaign));
        let sparse = measured_with(&text, |plan| assert_eq!(plan.start_sampler.name(), "into_apertures"));
        agree(&format!("facet index, {what}"), &full, &sparse);
        starts_close(&sparse);
        // The same density of starts: counts of arrivals agree to the noise of some ten thousand and to the 3 % by
        // which the index knows the turned area.
        let arrivals = |m: &Measured| m.table.hits.iter().map(|&hits| f64::from(hits)).sum::<f64>();
        let ratio = arrivals(&sparse) / arrivals(&full);
        assert!((ratio - 1.0).abs() < 0.05, "{what}: {ratio}");
    }
}

/// Starts from facet to facet of like slope, or from place to place; with and without shadows, one order and several.
#[test]
fn starts_by_slope_change_nothing_but_noise() {
    for (what, surface, light, trace) in [
        ("isotropic", ISOTROPIC, RELATIVE, ""),
        ("anisotropic, images", ANISOTROPIC, ABSOLUTE, ""),
        ("light cone", ISOTROPIC, "theta_i_deg = [20, 60]\nazimuth = \"relative\"\naperture_deg = 4", ""),
        ("no visibility", ISOTROPIC, RELATIVE, "[trace]\nvisibility = false"),
        ("four orders", ANISOTROPIC, ABSOLUTE, "[trace]\nbounces = 4"),
    ] {
        let text = campaign(surface, light, HEMISPHERE, trace);
        let by_slope = measured_with(&text, |plan| assert_eq!(plan.start_sampler, StartSampler::BySlope));
        let by_place = measured_as(&text, |plan, campaign| plan.by_place(campaign));
        agree(&format!("by slope, {what}"), &by_slope, &by_place);
        starts_close(&by_slope);
    }
}

/// Samples on all that grains show by themselves, or where rays from above meet them; several orders, either plane.
#[test]
fn both_ways_of_starting_on_grains_agree() {
    let heights = "cells = 128\ncorrelation_cells = 8.0\n[surface.ggx]\nalpha = 0.3";
    for (coverage, base, chosen) in
        [(0.3, "mirror", "on_grains"), (0.9, "absorbing", "from_above"), (0.9, "mirror", "from_above")]
    {
        let grains = format!("[surface.grains]\ncoverage = {coverage}\nbase = \"{base}\"\nalpha = 0.3");
        let text =
            campaign(ISOTROPIC, RELATIVE, HEMISPHERE, "[trace]\nbounces = 3").replace(heights, &grains);
        let [on_grains, above] = [false, true].map(|above| {
            measuring::measured_with(&text, |plan| {
                assert_eq!(plan.start_sampler.name(), chosen);
                plan.start_sampler = StartSampler::Grains { from_above: vec![vec![above; plan.incidences]] };
                plan.block_starts /= or_long(8, 1);
            })
        });
        agree(&format!("grains, coverage {coverage}, {base}"), &on_grains, &above);
        // From above every sample is lit.
        assert!(
            above
                .incidences
                .iter()
                .all(|incidence| incidence.hidden == 0 && incidence.seen_by_slope.is_none())
        );
    }
}

/// One block of few incidences on a large patch is not worth a sort of its facets.
#[test]
fn facets_are_sorted_where_the_starts_are_worth_it() {
    let of = |cells: u32| {
        let text = campaign(ISOTROPIC, "theta_i_deg = [60]\nazimuth = \"relative\"", HEMISPHERE, "");
        let parsed = campaign::parse(&text, "c.toml", std::path::Path::new("")).expect("no faults");
        let mut campaign = parsed.campaign;
        campaign.surface.cells = cells;
        measure::plan(&campaign).expect("a plan").start_sampler == StartSampler::BySlope
    };
    assert!(of(512) && !of(4096));
}

/// A folded bin has the arrivals of the bin and of its mirror image, of the very same paths.
#[test]
fn folding_counts_every_arrival_on_both_sides() {
    let folded = measured_one(&campaign(ISOTROPIC, RELATIVE, HEMISPHERE, ""));
    let plain = measured_one(&campaign(ISOTROPIC, RELATIVE, HEMISPHERE, "[trace]\nfold = false"));
    let columns = 12;
    for (entry, &hits) in folded.table.hits.iter().enumerate() {
        let (row, column) = (entry / columns, entry % columns);
        let mirrored = row * columns + columns - 1 - column;
        assert_eq!(hits, plain.table.hits[entry] + plain.table.hits[mirrored]);
    }
}

/// Mirror images and azimuths of their own for the blocks give other samples of the same law.
#[test]
fn images_and_azimuths_are_samples_of_the_same_law() {
    let of = |light: &str, images: bool| {
        let text = campaign(ISOTROPIC, light, HEMISPHERE, "");
        measured_one(&text.replace("[surface.ggx]", &format!("mirror_images = {images}\n[surface.ggx]")))
    };
    let one = "theta_i_deg = [60]\nphi_i_deg = [0]\n";
    let averaged = "theta_i_deg = [60]\nazimuth = \"relative\"\n";
    let plain = of(one, false);
    agree("mirror images", &plain, &of(one, true));
    agree("azimuths", &plain, &of(averaged, false));
}

#[test]
fn counts_with_f_of_one_are_sums_with_a_reflectance_of_one() {
    for trace in ["[trace]\nbounces = 1\n", "[trace]\nbounces = 3\n"] {
        let counted = measured_one(&campaign(ISOTROPIC, RELATIVE, HEMISPHERE, trace));
        let one = format!("{trace}[optics]\nf0 = [1.0, 1.0, 1.0]\n");
        let summed = measured_one(&campaign(ISOTROPIC, RELATIVE, HEMISPHERE, &one));
        assert!(same_bytes(&counted, &summed));
        let totals =
            |m: &Measured| -> Vec<u32> { m.table.colours[0].total.iter().map(|v| v.to_bits()).collect() };
        assert_eq!(totals(&counted), totals(&summed));
    }
}

/// Order 1 with Fresnel carried along every path (which is what the albedos are made of) against the bins, in which it
/// is put in afterwards.
#[test]
fn a_material_put_in_afterwards_is_the_one_traced() {
    let gold = "[optics]\nmaterial = \"gold\"\n";
    let measured = measured_one(&campaign(ISOTROPIC, RELATIVE, HEMISPHERE, gold));
    for (incidence, result) in measured.incidences.iter().enumerate() {
        let sizes: Vec<f64> =
            measured.table.grid.regions(incidence).iter().map(Region::projected_solid_angle).collect();
        let colour = |colour: &gonio::table::ColourChannels| {
            let values = &colour.single[incidence * sizes.len()..][..sizes.len()];
            values.iter().zip(&sizes).map(|(&f, w)| f64::from(f) * w).sum::<f64>()
        };
        let afterwards = mean(&measured.table.colours.iter().map(colour).collect::<Vec<_>>());
        let traced = mean(&result.albedo_by_order[0]);
        // Values are stored, and averaged over the realisations, in f32: 2^-24 each time.
        assert!((afterwards / traced - 1.0).abs() < 4.0 * 2f64.powi(-24), "{afterwards} {traced}");
    }
}

/// Order 1 asks only whether a ray is blocked; with further orders the hit is looked for. Not a byte differs.
#[test]
fn the_last_order_needs_no_hit() {
    let of = |trace: &str| measured_one(&campaign(ANISOTROPIC, ABSOLUTE, HEMISPHERE, trace));
    let (one, two) = (of("[trace]\nbounces = 1"), of("[trace]\nbounces = 2"));
    let bits = |m: &Measured| -> Vec<u32> { singles(m).concat().iter().map(|v| v.to_bits()).collect() };
    assert_eq!(bits(&one), bits(&two));
}

fn patch() -> Heightfield {
    Synthesiser::new(SlopeLaw::Beckmann, 64, 6.0).patch(&mut test_rng(3))
}

fn a_place(field: &Heightfield, rng: &mut rand_pcg::Pcg64Dxsm) -> SurfacePoint {
    let mut whole = || (rng::uniform(rng) * 64.0) as usize;
    let facet = Facet { x: whole(), y: whole(), upper: whole() % 2 == 1 };
    let (a, b) = (0.5 * rng::uniform(rng), 0.5 * rng::uniform(rng));
    let (u, v) = if facet.upper { (1.0 - a, 1.0 - b) } else { (a, b) };
    SurfacePoint::on(field, facet, u, v)
}

/// Below and above the bound, so that both sides of the decision are taken; the f64 walk knows of no bound.
#[test]
fn rays_steeper_than_every_slope_escape() {
    let field = patch();
    let traversal = GridTraversal::new(&field);
    let lanes = MaxPyramid::new(&field).expect("a power of two");
    let heights = field.heights();
    let steepest = (0..4096).map(|k| {
        let right = heights[k / 64 * 64 + (k + 1) % 64];
        (heights[(k + 64) % 4096] - heights[k]).abs().max((right - heights[k]).abs())
    });
    let steepest = steepest.fold(0.0, f64::max);
    let mut rng = test_rng(4);
    let rays: Vec<(SurfacePoint, DVec3)> = (0..20_000)
        .map(|_| {
            let (sin, cos) = sphere::sin_cos_deg(360.0 * rng::uniform(&mut rng));
            let rise = (0.3 + rng::uniform(&mut rng)) * steepest * (sin.abs() + cos.abs());
            (a_place(&field, &mut rng), DVec3::new(cos, sin, rise).normalize())
        })
        .collect();
    let over = SimdTraversal::new(traversal, &lanes, Kernel::widest());
    let mut waves = Waves::default();
    let fates = waves.any_hit(&over, rays.len(), |k| (&rays[k].0, rays[k].1));
    let (mut steep, mut blocked) = (0, 0);
    for ((start, d), fate) in rays.iter().zip(fates) {
        let free = traversal.traverse(start, *d) == Outcome::Escaped;
        let steeper = d.z > steepest * (d.x.abs() + d.y.abs());
        assert!(free || !steeper);
        // Rays that are decided by the bound must be right; the others may touch an edge within f32's rounding.
        if steeper {
            assert_eq!(*fate, gonio::trace::RayOutcome::Escaped);
            steep += 1;
        }
        blocked += u32::from(!free);
    }
    assert!(steep > 2000 && blocked > 200, "{steep} {blocked}");
}

/// What goes down from a facet of a torus hits it again.
#[test]
fn paths_that_go_down_hit_again() {
    let field = patch();
    let sample =
        TracedPatch::opaque(GridTraversal::new(&field), glam::DVec2::splat(2.0), PatchSymmetry::default());
    let mut rng = test_rng(5);
    let mut down = 0;
    for _ in 0..20_000 {
        let wi = sphere::direction_deg(75.0 * rng::uniform(&mut rng), 360.0 * rng::uniform(&mut rng));
        let start = a_place(&field, &mut rng);
        let corners = field.corners(start.facet.x, start.facet.y);
        let light = sample.to_field(wi);
        let lit = light.z > light.truncate().dot(corners.slope(start.facet.upper));
        let wo = sample.reflected(wi, &start);
        if lit && wo.z <= 0.0 {
            assert!(matches!(sample.traversal.traverse(&start, sample.to_field(wo)), Outcome::Hit(_)));
            down += 1;
        }
    }
    assert!(down > 1000, "{down}");
}

/// What the facet index gains on `configs/in_plane_scan.toml`: processor time without synthesis against the same
/// campaign with all starts and rays, and with a hemisphere in place of the arm.
#[test]
#[ignore = "a measurement of a minute: cargo test --release --test it skips -- --ignored --nocapture"]
fn gain_of_the_facet_index() {
    let text = std::fs::read_to_string("configs/in_plane_scan.toml").expect("the campaign");
    let folder = tempfile::tempdir().expect("a folder");
    let parse =
        |text: &str| campaign::parse(text, "c.toml", std::path::Path::new("")).expect("no faults").campaign;
    let scan = parse(&text.replace("realisations = 16", "realisations = 4"));
    let arm = text.find("[sensor.arm]").expect("an arm")..text.find("[stop]").expect("a stop");
    let mut hemisphere = text.replace("realisations = 16", "realisations = 4");
    let shift = hemisphere.len() - text.len();
    let arm = arm.start.wrapping_add(shift)..arm.end.wrapping_add(shift);
    hemisphere.replace_range(arm, "[sensor.hemisphere]\n");
    let hemisphere = parse(&hemisphere);
    let synthesiser = Synthesiser::new(SlopeLaw::Ggx, 1024, 8.0);
    for k in 0..4 {
        let field = synthesiser.patch(&mut test_rng(k));
        let path = folder.path().join(measure::patches::patch_name(k, "exr"));
        let bytes = gonio::surface::io::export::encode_exr(&field, 1.0, 1.0).expect("encoded");
        std::fs::write(path, bytes).expect("written");
    }
    let run = |campaign: &campaign::Campaign, plan: Plan| {
        let patches = Patches::from_folder(campaign, folder.path()).expect("patches");
        let (clock, cpu) = (Instant::now(), cpu_seconds());
        let (mut tables, cost) = measure::measure(campaign, &plan, &patches, &|_| ()).expect("measured");
        let table = tables.pop().expect("a table");
        println!(
            "{} blocks, {}: cpu {:.2} s, wall {:.2} s, {} rays, median error {:.5}",
            plan.blocks,
            plan.start_sampler.name(),
            cpu_seconds() - cpu,
            clock.elapsed().as_secs_f64(),
            cost.rays_traced,
            median_error(&table)
        );
        (cpu_seconds() - cpu, median_error(&table))
    };
    for blocks in [16, 153] {
        let planned = |campaign, blocks| Plan { blocks, ..measure::plan(campaign).expect("a plan") };
        let on = run(&scan, planned(&scan, blocks));
        let off = run(&scan, planned(&scan, blocks).all_directions(&scan).expect("an arm"));
        let full = run(&hemisphere, planned(&hemisphere, blocks));
        let load = run(&hemisphere, planned(&hemisphere, 1));
        println!(
            "{blocks} blocks: all rays / index {:.1}, hemisphere / index {:.1}, less loading {:.1}; errors {:.3}",
            off.0 / on.0,
            full.0 / on.0,
            (full.0 - load.0) / (on.0 - load.0),
            on.1 / off.1
        );
    }
}
