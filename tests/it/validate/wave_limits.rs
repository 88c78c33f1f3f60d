//! Promise: where geometric optics holds is said by figures in closed form, before and after a measurement.

use std::f64::consts::PI;
use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::instrument::grid_of;
use gonio::measure::Patches;
use gonio::optics::wave_limits::{coherent_part, kirchhoff, phase, rayleigh};
use gonio::surface::SurfaceLengths;
use gonio::validate::GeometricOptics;

use crate::support::arrays;
use crate::support::campaign_text::SMALL;
use crate::support::program::{exits, gonio, json, stdout};

fn parsed(surface: &str, optics: &str, rest: &str) -> Campaign {
    let text = format!(
        "name = \"waves\"\n[surface]\n{surface}\n[light]\ntheta_i_deg = [0, 60, 80]\naverage_azimuth = true\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 12\nbins = \"aligned\"\n{optics}\n[stop]\nsamples = 65536\n{rest}"
    );
    let parsed = campaign::parse(&text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"));
    parsed.campaign
}

fn of(campaign: &Campaign) -> GeometricOptics {
    GeometricOptics::of(campaign, &grid_of(campaign))
}

fn lengths(campaign: &Campaign) -> SurfaceLengths {
    let (law, alpha) = (Patches::law(campaign), campaign.alphas()[0]);
    SurfaceLengths::of(&campaign.surface, law, alpha, campaign.scale.pitch_um).expect("known")
}

#[test]
fn figures_are_their_closed_forms() {
    // Heights of an eighth of a wavelength are Rayleigh's limit at normal incidence; a quarter at 60 degrees.
    assert_eq!(rayleigh(0.125, 1.0, 1.0), PI / 2.0);
    assert_eq!(rayleigh(0.25, 0.5, 1.0), PI / 2.0);
    assert_eq!(phase(0.125, 0.75, 0.25, 1.0), PI / 4.0);
    assert_eq!(kirchhoff(2.0, 0.5, 4.0), PI);
    // exp(-pi^2/4), 0.0848 in many a textbook.
    assert!((coherent_part(PI / 2.0) - 0.084_805).abs() < 1e-6);
}

/// Of covariance exp(-(r/L)^2) and rms slope s = alpha/sqrt(2) the rms height is s L/sqrt(2), and the mean radius of curvature
/// L^2/(2.764 sigma) (Ulaby, Moore and Fung 1982, section 12-4).
#[test]
fn lengths_of_gaussian_heights_are_closed_forms() {
    let surface = "realisations = 4\ncells = 512\ncorrelation_cells = 16\n[surface.beckmann]\n";
    let found = lengths(&parsed(&format!("{surface}alpha = 0.2"), "", "[scale]\npitch_um = 0.5"));
    let length = 8.0;
    let sigma = 0.2 * length / 2.0;
    // Differences of neighbours are slopes less (k^2/12 = 0.5/L^2 of their square), and second ones less 1.7/L^2; the patch
    // has no wave longer than itself, 0.3 % of the variance.
    assert!((found.rms_height_um / sigma - 1.0).abs() < 0.004, "{found:?}");
    let radius = length * length / (2.0 * (2.0 / PI).sqrt() * 3f64.sqrt() * sigma);
    assert!((found.curvature_radius_um / radius - 1.0).abs() < 0.006, "{found:?} {radius}");
    assert_eq!((found.pitch_um, found.correlation_um), (0.5, Some(length)));
    // Brushed: cells along y are alpha_x/alpha_y as wide, and curvature goes as alpha_y^2/alpha_x.
    let brushed =
        lengths(&parsed(&format!("{surface}alpha_x = 0.2\nalpha_y = 0.4"), "", "[scale]\npitch_um = 0.5"));
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    assert!(same(brushed.rms_height_um, found.rms_height_um) && same(brushed.pitch_um, 0.25), "{brushed:?}");
    assert!(same(brushed.curvature_radius_um, found.curvature_radius_um / 4.0), "{brushed:?}");
}

/// GGX is made by iteration and has no closed form: the small patch that stands for it against the campaign's own.
#[test]
fn lengths_of_other_heights_are_those_of_their_patches() {
    let campaign = parsed(
        "realisations = 4\ncells = 256\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 0.3",
        "",
        "[scale]\npitch_um = 2",
    );
    let found = lengths(&campaign);
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("patches");
    let variance = |realisation| match patches.realisation(realisation).expect("a patch") {
        gonio::measure::Specimen::Patch(patch) => {
            let heights = patch.field.heights();
            heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64
        }
        _ => panic!("heights"),
    };
    let rms = 0.3 * 2.0 * (0.5 * (variance(0) + variance(1))).sqrt();
    // Bumps of 4 cells instead of 16 are resolved worse, and a patch of 32 bumps a side spreads by 3 %: 15 % for both.
    assert!((found.rms_height_um / rms - 1.0).abs() < 0.15, "{found:?} {rms}");
}

#[test]
fn the_figures_of_a_campaign_are_closed_forms() {
    let surface = "realisations = 4\ncells = 256\ncorrelation_cells = 16\n[surface.beckmann]\nalpha = 0.1";
    let rest = "[scale]\npitch_um = 0.5\nwavelength_nm = 1000\n";
    let campaign = parsed(surface, "", rest);
    let (found, lengths) = (of(&campaign), lengths(&campaign));
    // Heights of 0.4 um.
    let sigma = lengths.rms_height_um;
    assert_eq!(found.rms_height_um, Some(sigma));
    assert_eq!((found.pitch_over_wavelength, found.correlation_over_wavelength), (Some(0.5), Some(8.0)));
    for (incidence, theta) in found.incidences.iter().zip([0.0f64, 60.0, 80.0]) {
        let cos = theta.to_radians().cos();
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(same(incidence.rayleigh, 4.0 * PI * sigma * cos), "{incidence:?}");
        assert!(same(incidence.coherent, (-(4.0 * PI * sigma * cos).powi(2)).exp()));
        assert!(same(incidence.kirchhoff.expect("curved"), 4.0 * PI * lengths.curvature_radius_um * cos));
        // Rows of 10 degrees: those whose middle is so low that cos_i + cos_r < 1/(4 sigma).
        let smooth =
            (0..9).filter(|row| cos + (10.0 * f64::from(*row) + 5.0).to_radians().cos() < 0.25 / sigma);
        assert!(same(incidence.doubtful_bins, smooth.count() as f64 / 9.0), "{incidence:?}");
    }
    // 4 pi 0.4 cos 60 = 2.5, cos 80: 0.87.
    let doubtful: Vec<bool> = found.incidences.iter().map(|incidence| incidence.is_doubtful()).collect();
    assert_eq!((doubtful, found.doubtful_incidences), (vec![false, false, true], 1));
    let words = found.words().expect("known");
    assert!(words.starts_with("geometric optics is doubtful here: at 1 of 3 theta_i"), "{words}");
    // A tenth of the wavelength, and it holds.
    let rest = "[scale]\npitch_um = 0.5\nwavelength_nm = 50\n";
    let words = of(&parsed(surface, "", rest)).words().expect("known");
    assert!(words.starts_with("geometric optics holds here"), "{words}");
    // Inside glass the wave is shorter by the index.
    let glass = "[optics]\nfacet = \"dielectric\"\neta = [1.5, 1.6]\nwavelength_nm = [800, 900]\n";
    let longest = |light: &str| {
        let campaign =
            parsed(surface, &format!("{glass}[trace]\nbounces = 2\n"), "[scale]\npitch_um = 0.5\n");
        let text =
            campaign::to_toml(&campaign).replace("[light]\n", &format!("[light]\nside = \"{light}\"\n"));
        of(&campaign::parse(&text, "c.toml", Path::new("")).expect("sound").campaign).wavelength_nm
    };
    assert_eq!([longest("front"), longest("back")], [Some(900.0), Some(900.0 / 1.6)]);
}

#[test]
fn what_is_not_known_says_what_to_add() {
    let ggx = "realisations = 4\ncells = 64\n[surface.ggx]\nalpha = 0.2";
    let why = |surface: &str, optics: &str, rest: &str| {
        let found = of(&parsed(surface, optics, rest));
        assert_eq!((found.words(), found.is_doubtful()), (None, false));
        found.not_known.expect("a reason")
    };
    assert!(why(ggx, "", "").contains("add [scale] with pitch_um and wavelength_nm"));
    assert!(why(ggx, "", "[scale]\npitch_um = 1").contains("add [scale] with wavelength_nm"));
    assert!(why(ggx, "", "[scale]\nwavelength_nm = 500").contains("add [scale] with pitch_um"));
    assert!(why("[surface.mirror]", "", "[scale]\nwavelength_nm = 500").contains("no roughness"));
    assert!(why("[surface.smith]\nalpha = 0.2", "", "[scale]\nwavelength_nm = 500").contains("no heights"));
    let matt = "[optics]\nfacet = \"diffuse\"\nalbedo = 0.5";
    assert!(why(ggx, matt, "[scale]\npitch_um = 1\nwavelength_nm = 500").contains("matt facets"));
    let map = "[surface.file]\npath = \"gone.npy\"\npitch_x_um = 1\npitch_y_um = 1\nheight_unit_um = 1";
    assert!(of(&parsed_map(Path::new("nowhere"), map)).not_known.expect("a reason").contains("is not here"));
}

fn parsed_map(folder: &Path, map: &str) -> Campaign {
    let text = format!(
        "name = \"waves\"\n[surface]\n{map}\n[light]\ntheta_i_deg = [0]\naverage_azimuth = true\n\
         [sensor.hemisphere]\n[stop]\nsamples = 65536\n[scale]\nwavelength_nm = 500"
    );
    campaign::parse(&text, "c.toml", folder).unwrap_or_else(|e| panic!("{e}")).campaign
}

/// A map of straight waves z = a cos(k x): rms a/sqrt(2), mean of |z''| (2 - 2 cos(k p)) a/p^2 times that of |cos|, 2/pi.
#[test]
fn lengths_of_a_map_are_those_of_its_waves() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (columns, period) = (256, 64.0);
    let wave = |i: usize| (2.0 * PI * (i % columns) as f64 / period).cos();
    let heights: Vec<f64> = (0..columns * 64).map(wave).collect();
    std::fs::write(folder.path().join("waves.npy"), arrays::npy(&heights, columns)).expect("written");
    let map = "[surface.file]\npath = \"waves.npy\"\npitch_x_um = 2\npitch_y_um = 3\nheight_unit_um = 0.1\nperiodic = true";
    let found = lengths(&parsed_map(folder.path(), map));
    assert!((found.rms_height_um / (0.1 / 2f64.sqrt()) - 1.0).abs() < 1e-9, "{found:?}");
    let second = 2.0 - 2.0 * (2.0 * PI / period).cos();
    let radius = 4.0 / (0.1 * second * 2.0 / PI);
    // The mean of |cos| over 64 places of a period is (1 - pi^2/(3 64^2)) 2/pi; the outer columns are left out: 1 %.
    assert!((found.curvature_radius_um / radius - 1.0).abs() < 0.01, "{found:?} {radius}");
    assert_eq!(found.pitch_um, 2.0);
}

/// Before the run, and after it: `check`, the verdict, the summary and the page of one campaign; and nothing of another's.
#[test]
fn check_verdict_summary_and_page_say_where_it_is_doubtful() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let at = folder.path();
    let scaled = "[scale]\npitch_um = 0.05\nwavelength_nm = 633\n";
    std::fs::write(at.join("c.toml"), format!("{SMALL}{scaled}")).expect("written");
    let said = "geometric optics is doubtful here: at 2 of 2 theta_i";
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(stdout(&gonio(at, &["check", "c.toml"]))).contains(said));
    let before = json(&gonio(at, &["check", "c.toml", "--json"]));
    let measured = gonio(at, &["measure", "c.toml"]);
    exits(&measured, 0);
    assert!(words(stdout(&measured)).contains(said), "{}", stdout(&measured));
    let summary = std::fs::read_to_string(at.join("out/small/small.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["geometric_optics"], before["geometric_optics"]);
    assert_eq!(summary["geometric_optics"]["doubtful_incidences"], 2);
    let page = std::fs::read_to_string(at.join("out/small/small.html")).expect("a page");
    assert!(page.contains("Geometric optics is doubtful here"));
    // Without lengths nothing is said of it but by `check`, which says what to add.
    std::fs::write(at.join("c.toml"), SMALL).expect("written");
    assert!(words(stdout(&gonio(at, &["check", "c.toml"]))).contains("waves n/a: neither cells nor light"));
    let measured = gonio(at, &["measure", "c.toml", "--force"]);
    exits(&measured, 0);
    assert!(!stdout(&measured).contains("geometric optics"));
}
