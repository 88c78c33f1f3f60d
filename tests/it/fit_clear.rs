//! Promise: of clear facets a fit returns the roughness and the index, from light that comes back, goes through or both,
//! from either side; a study of such light finds the sample's axes; Student's gamma is fitted with the roughness.

use gonio::fit::nodes::{IncidenceNodes, Lobe};
use gonio::fit::{self, FitData, FitLaw, MicrofacetLaw};
use gonio::instrument::{Grid, GridKind};
use gonio::optics::Fresnel;
use gonio::optics::reflectance::Reflectance;
use gonio::stats;
use gonio::table::{BrdfTable, ColourChannels, store};
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::BinMeans;

use crate::fit::holds;
use crate::support::measuring::measured_one;
use crate::support::program::{gonio, stdout};

/// Bins of `step` degrees, in azimuth twice as wide, between these multiples of it.
fn grid(theta_i_deg: &[f64], phi_i_deg: &[f64], step: f64, edges: std::ops::RangeInclusive<u32>) -> Grid {
    let azimuths = (0..=(180.0 / step) as u32).map(|k| 2.0 * step * f64::from(k));
    Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: theta_i_deg.to_vec(),
        phi_i_deg: phi_i_deg.to_vec(),
        phi_r_relative: phi_i_deg.len() == 1,
        theta_r_edges_deg: edges.map(|k| step * f64::from(k)).collect(),
        phi_r_edges_deg: azimuths.map(|phi| phi - step).collect(),
        ..Grid::default()
    }
}

/// Bin means of an interface at an incidence, by the adaptive cubature that `validate` uses.
fn means(grid: &Grid, incidence: usize, model: &Microfacet, masking: Masking, eta: f64) -> Vec<f64> {
    let reflectance = Some(Reflectance::unpolarised(Fresnel::Dielectric { eta }));
    let means = BinMeans { reflectance, ..BinMeans::new(vec![masking]) };
    let source = [(grid.wi(incidence), 1.0)];
    let of = |region: usize| match grid.regions(incidence)[region].is_below() {
        true => {
            means.evaluate_through(model, &source, &grid.regions(incidence)[region..=region], eta)[0].values
                [0]
        }
        false => means.evaluate(model, &source, &grid.regions(incidence)[region..=region])[0].schlick[0],
    };
    (0..grid.bins()).map(of).collect()
}

fn table(grid: Grid, model: &Microfacet, masking: Masking, eta: f64) -> BrdfTable {
    let values: Vec<f64> =
        (0..grid.incidences()).flat_map(|incidence| means(&grid, incidence, model, masking, eta)).collect();
    let single: Vec<f32> = values.iter().map(|&value| value as f32).collect();
    let errors: Vec<f32> = single.iter().map(|value| 1e-3 * value + 1e-7).collect();
    let colour = ColourChannels {
        multiple: vec![0.0; single.len()],
        total: single.clone(),
        stderr: errors.clone(),
        stderr_single: errors,
        single,
        ..ColourChannels::default()
    };
    BrdfTable {
        hits: vec![100_000_000; values.len()],
        grid,
        campaign: String::new(),
        version: "test".into(),
        seed: 1,
        patch_digest: String::new(),
        colours: vec![colour],
        schlick: None,
    }
}

#[test]
fn nodes_below_the_horizon_agree_with_the_adaptive_cubature() {
    // The rule is right to 1e-5 of a bin where the lobe is. Where facets end 1 - F begins like a root: a piece of a sixteenth
    // of a bin's side has it to (1/16)^1.5 = 0.016 of what it holds, which is a sixteenth of the bin, and the edge takes a
    // fifth of the light at most: 2e-4.
    for (alpha, eta) in [(0.1, 1.5), (0.5, 1.5), (0.3, 1.1), (0.1, 1.0 / 1.5), (0.5, 1.0 / 1.5)] {
        let grid = grid(&[10.0, 60.0], &[0.0], 7.5, 12..=24);
        let model = Microfacet::isotropic(Ndf::Ggx, alpha);
        let masking = Masking::HeightCorrelated;
        let (n, side) = if eta > 1.0 {
            (eta, gonio::campaign::LightSide::Front)
        } else {
            (1.0 / eta, gonio::campaign::LightSide::Back)
        };
        let law = MicrofacetLaw { clear: Some(side), ..MicrofacetLaw::new(Ndf::Ggx, masking, false) };
        let nodes = IncidenceNodes::of_grid(&grid, 0.0, Lobe { alpha, eta });
        for (incidence, nodes) in nodes.iter().enumerate() {
            let exact = means(&grid, incidence, &model, masking, eta);
            let found = law.means(&[alpha.ln(), (n - 1.0f64).ln()], nodes);
            let off: f64 = found.iter().zip(&exact).map(|(found, exact)| (found[0] - exact).abs()).sum();
            assert!(off < 2e-4 * exact.iter().sum::<f64>(), "{alpha} {eta} incidence {incidence}: {off}");
        }
    }
}

#[test]
fn an_analytic_interface_returns_its_roughness_and_its_index() {
    let cases = [
        (Ndf::Ggx, 0.3, 1.5, 0..=12, &[10.0, 30.0][..]),
        (Ndf::Beckmann, 0.2, 1.33, 6..=12, &[10.0, 30.0]),
        // Beyond total reflection.
        (Ndf::Ggx, 0.2, 1.0 / 1.5, 0..=12, &[45.0]),
    ];
    for (ndf, alpha, eta, edges, light) in cases {
        let masking = Masking::HeightCorrelated;
        // One side of the plane of incidence: the other has its mirror image.
        let phi_r_edges_deg = (0..=6).map(|k| 30.0 * f64::from(k)).collect();
        let grid = Grid { phi_r_edges_deg, ..grid(light, &[0.0], 15.0, edges) };
        let table = table(grid, &Microfacet::isotropic(ndf, alpha), masking, eta);
        let data = FitData::new(&table, None, None);
        // A table of nobody knows which side its light came from. From the back, where its own law is tried from both sides
        // and by every masking, others take most of the time.
        let laws = if eta > 1.0 { FitLaw::all(&data) } else { FitLaw::of_normals(ndf, &data) };
        let fits = fit::fit(&data, &laws);
        let best = &fits.fits[0];
        assert_eq!(best.model, ndf.name(), "{fits:?}");
        // Beckmann's normals of 0.2 hide nothing at these angles.
        assert!(ndf == Ndf::Beckmann || best.masking == Some(masking.name()), "{fits:?}");
        // Nodes are right to 2e-4 of the light; alpha and n - 1 take it one to one at most.
        holds(best, "alpha", alpha, 2e-4 * alpha);
        let n = if eta > 1.0 { eta } else { 1.0 / eta };
        holds(best, "eta", n, 2e-4 * (n - 1.0));
    }
}

/// Glass of a statistical surface: the models are exact.
const GLASS: &str = "name = \"g\"\nseed = 4\n[surface]\nrealisations = 8\n[surface.smith]\nalpha = 0.3\n\
    [optics]\nfacet = \"dielectric\"\neta = 1.5\n[light]\ntheta_i_deg = [0, 30, 60]\n\
    [sensor.hemisphere]\ntheta_r_bins = 12\nphi_r_bins = 24\nside = \"both\"\n[stop]\nsamples = 32_768\n";

#[test]
fn measured_glass_returns_its_roughness_and_its_index() {
    for (light, side) in
        [("front", "both"), ("front", "transmission"), ("front", "reflection"), ("back", "both")]
    {
        let text = GLASS
            .replace("side = \"both\"", &format!("side = \"{side}\""))
            .replace("theta_i_deg = [0, 30, 60]", &format!("theta_i_deg = [0, 30]\nside = \"{light}\""));
        let measured = measured_one(&text);
        let data = FitData::new(&measured.table, Some(&measured.campaign), Some(&measured.realisations));
        let masking = Masking::HeightCorrelated;
        let law = FitLaw::of_normals(Ndf::Ggx, &data);
        let law = law.into_iter().find(|law| law.masking() == Some(masking.name())).expect("the walk's own");
        let best = fit::best(&data, &[law]);
        for (name, truth) in [("alpha", 0.3), ("eta", 1.5)] {
            let se = best.standard_errors.get(name).expect("an error");
            // Student's limit of one in a thousand for eight realisations; errors that mean something.
            holds(&best, name, truth, stats::student_limit(1e-3, 7) * se);
            assert!(se < 0.04 * truth, "{light} {side} {name}: {se}");
        }
        // A model that is exact leaves the noise alone.
        assert!(best.chi2_per_dof.expect("errors") < 1.2, "{light} {side}: {:?}", best.chi2_per_dof);
    }
}

#[test]
fn the_command_says_the_index_and_refuses_models_that_know_no_refraction() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let table = measured_one(&GLASS.replace("32_768", "16_384")).table;
    store::save(&folder.path().join("g.exr"), &table).expect("saved");
    let text = stdout(&gonio(folder.path(), &["fit", "g.exr"]));
    assert!(text.starts_with("best: ggx ") && text.contains("eta 1."), "{text}");
    assert!(!text.contains("lambert"), "{text}");
    let refused = gonio(folder.path(), &["fit", "g.exr", "--model", "lambert"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("g.exr: --model lambert knows no light that has gone through"), "{said}");
}

#[test]
fn students_gamma_is_fitted_with_the_roughness() {
    for gamma in [2.5, 6.0] {
        let grid = grid(&[10.0, 50.0], &[0.0], 15.0, 0..=6);
        let model = Microfacet::isotropic(Ndf::StudentT { gamma }, 0.3);
        let masking = Masking::HeightCorrelated;
        let mut table = table(grid.clone(), &model, masking, 1.5);
        // A mirror: the mean with F = 1.
        let unit = |incidence| {
            let means = BinMeans::new(vec![masking]).evaluate(
                &model,
                &[(grid.wi(incidence), 1.0)],
                &grid.regions(incidence),
            );
            means.into_iter().map(|mean| mean.unit[0] as f32).collect::<Vec<f32>>()
        };
        table.colours[0].single = (0..grid.incidences()).flat_map(unit).collect();
        let data = FitData::new(&table, None, None);
        let laws = FitLaw::student_t(&data);
        let own = laws.into_iter().filter(|law| law.masking() == Some(masking.name()));
        let fits = fit::fit(&data, &own.collect::<Vec<_>>());
        // Nodes are right to 2e-5 of a bin; gamma is told by the tails, where errors of bins weigh ten times as much.
        holds(&fits.fits[0], "alpha", 0.3, 1e-3 * 0.3);
        holds(&fits.fits[0], "gamma", gamma, 5e-3 * gamma);
    }
}
