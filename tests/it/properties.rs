//! Promises for any input, with the smallest input that breaks one: sums do not depend on their order, lossless formats give
//! back any table, and exchanged arms have the same bits.

use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{exr_parts, numpy::npz, text::astm, text::csv};
use gonio::measure::accumulate::fresnel_sums::FresnelSums;
use gonio::measure::accumulate::tally::{FluxCount, Tally};
use gonio::optics::Fresnel;
use gonio::sphere;
use gonio::table::{BrdfTable, ColourChannels};
use gonio::theory::{Masking, Microfacet, Ndf};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use crate::support::campaign_text::{accepted, with};

/// Bins of a tally.
const BINS: usize = 5;

fn config(cases: u32) -> ProptestConfig {
    // A failing case is printed; nothing is written next to the sources.
    ProptestConfig { failure_persistence: None, cases, ..ProptestConfig::default() }
}

/// Sums that a block may have: each below 2^100, so that a hundred of them stay within 2^128.
fn tally() -> impl Strategy<Value = Tally> {
    let units = || 0..1u128 << 100;
    let fate = || (0..1u64 << 20, units()).prop_map(|(count, flux)| FluxCount { count, flux });
    let by_bin = (vec(units(), BINS), vec(0..1u64 << 20, BINS), vec(units(), BINS));
    (by_bin, [fate(), fate(), fate()], vec((-5.0..5.0, any::<bool>()), 0..8)).prop_map(
        |((single, hits, multiple), [cut, hidden, outside], slopes)| {
            let mut tally = Tally::new(BINS, &sums());
            (tally.single, tally.hits) = (single, hits);
            tally.multiple.iter_mut().for_each(|sum| sum.clone_from(&multiple));
            (tally.cut, tally.hidden, tally.outside) = (cut, hidden, outside);
            for order in &mut tally.orders {
                (order.count, order.flux) = (cut.count, hidden.flux);
                order.weighted.iter_mut().for_each(|weighted| *weighted = outside.flux);
            }
            slopes.into_iter().for_each(|(slope, seen)| tally.seen.count(slope, seen));
            tally
        },
    )
}

/// Of two bounces with Schlick's sums.
fn sums() -> FresnelSums {
    let text = with("material = \"gold\"", "f0 = [0.9, 0.6, 0.3]").replace("bounces = 1", "bounces = 2");
    FresnelSums::of(&accepted(&text).campaign)
}

fn merged<'a>(tallies: impl IntoIterator<Item = &'a Tally>) -> Tally {
    let mut all = Tally::new(BINS, &sums());
    tallies.into_iter().for_each(|tally| all.merge(tally));
    all
}

/// A table of any finite values that are not negative, subnormal ones among them; errors may be unknown.
fn table() -> impl Strategy<Value = BrdfTable> {
    let shape = (1..4usize, 1..3usize, 1..4usize, 1..4usize, select(vec![1, 3]));
    shape
        .prop_flat_map(|(thetas, phis, rings, sectors, colours)| {
            let entries = thetas * phis * rings * sectors;
            let value = || prop_oneof![0f32..=10.0, Just(0.0), Just(f32::MIN_POSITIVE / 4.0), Just(1e30)];
            let stderr = || prop_oneof![0f32..=1.0, Just(-1.0)];
            let colour = (vec(value(), entries), vec(value(), entries), vec(stderr(), entries));
            let grid = Grid {
                kind: GridKind::Hemisphere,
                theta_i_deg: (0..thetas).map(|k| 80.0 * k as f64 / 3.0).collect(),
                phi_i_deg: (0..phis).map(|k| 360.0 * k as f64 / 7.0).collect(),
                theta_r_edges_deg: (0..=rings).map(|k| 90.0 * k as f64 / rings as f64).collect(),
                phi_r_edges_deg: (0..=sectors).map(|k| 360.0 * k as f64 / sectors as f64).collect(),
                ..Grid::default()
            };
            (Just(grid), vec(colour, colours), vec(any::<u32>(), entries))
        })
        .prop_map(|(grid, colours, hits)| {
            let channels = |(single, multiple, stderr): (Vec<f32>, Vec<f32>, Vec<f32>)| ColourChannels {
                total: single.iter().zip(&multiple).map(|(a, b)| a + b).collect(),
                stderr_single: stderr.clone(),
                single,
                multiple,
                stderr,
                ..ColourChannels::default()
            };
            let colours = colours.into_iter().map(channels).collect();
            BrdfTable { grid, hits, colours, ..empty() }
        })
}

fn empty() -> BrdfTable {
    BrdfTable {
        grid: Grid::default(),
        campaign: String::new(),
        version: "0.1.0".into(),
        seed: 0,
        patch_digest: String::new(),
        colours: Vec::new(),
        hits: Vec::new(),
        schlick: None,
    }
}

fn totals(table: &BrdfTable) -> Vec<Vec<u32>> {
    table.colours.iter().map(|colour| colour.total.iter().map(|value| value.to_bits()).collect()).collect()
}

fn written(write: impl FnOnce(&mut dyn std::io::Write) -> gonio::interchange::Checked<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).expect("written");
    bytes
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn tallies_merge_to_the_same_in_any_order_and_grouping(
        tallies in vec(tally(), 1..7),
        order in Just((0..6usize).collect::<Vec<_>>()).prop_shuffle(),
        cut in 0..7usize,
    ) {
        let one_by_one = merged(&tallies);
        let shuffled = merged(order.iter().filter_map(|&k| tallies.get(k)));
        let (left, right) = tallies.split_at(cut.min(tallies.len()));
        let in_two = merged(&[merged(left), merged(right)]);
        prop_assert_eq!(&one_by_one, &shuffled);
        prop_assert_eq!(&one_by_one, &in_two);
    }

    #[test]
    fn lossless_formats_give_back_any_table(table in table()) {
        let whole = npz::read(&written(|out| npz::write(&table, out))).expect("its own");
        prop_assert_eq!(&whole, &table);
        let parts = exr_parts::read(&exr_parts::write(&table).expect("written")).expect("its own");
        prop_assert_eq!(totals(&parts), totals(&table));
        prop_assert_eq!(&parts.hits, &table.hits);
        let lines = csv::read(&written(|out| csv::write(&table, out))).expect("its own");
        prop_assert_eq!(totals(&lines), totals(&table));
        let pairs = astm::read(&written(|out| astm::write(&table, out))).expect("its own");
        prop_assert_eq!(totals(&pairs), totals(&table));
    }
}

proptest! {
    #![proptest_config(config(4096))]

    #[test]
    fn exchanged_arms_have_the_same_bits(
        angles in [0.0..=90.0, 0.0..=90.0, 0.0..=360.0, 0.0..=360.0],
        (alpha_x, alpha_y) in (1e-4..=10.0, 1e-4..=10.0),
        rotation in 0.0..std::f64::consts::TAU,
        (ndf, masking) in (select(vec![Ndf::Ggx, Ndf::Beckmann]), select(Masking::ALL.to_vec())),
        fresnel in select(vec![
            Fresnel::Perfect, Fresnel::Schlick { f0: 0.04 }, Fresnel::Conductor { eta: 0.18, k: 3.4 },
        ]),
    ) {
        let [theta_i, theta_o, phi_i, phi_o] = angles;
        let (wi, wo) = (sphere::direction_deg(theta_i, phi_i), sphere::direction_deg(theta_o, phi_o));
        let model = Microfacet { ndf, alpha_x, alpha_y, rotation };
        let there = model.brdf(wi, wo, masking, &fresnel);
        prop_assert_eq!(there.to_bits(), model.brdf(wo, wi, masking, &fresnel).to_bits());
    }
}
