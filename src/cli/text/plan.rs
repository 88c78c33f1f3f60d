//! A campaign and its plan in words: what `check` shows and `measure` begins with.

use super::layout::{columns, wrapped};
use super::numbers::{bytes, duration, grouped, or_na};
use crate::campaign::{
    Alpha, Azimuth, BinLayout, Campaign, CampaignRun, GrainBase, GrainShape, HeightSpectrum, PhiFrom, Preset,
    PsdSurface, SensorArm, SensorSide, SmithHeights, SmithNdf, Surface, SurfaceKind, Uncertainty,
};
use crate::measure::{Disk, Plan, Saving};
use crate::psd::{PsdModel, PsdMoments};
use crate::validate::geometric::{GeometricIncidence, GeometricOptics};
use crate::validate::prediction::aperture::ApertureBias;

/// Room for the words on the left.
const HEAD: usize = 14;

/// The plan, a line or two for each question.
pub fn facts(campaign: &Campaign, plan: &Plan, disk: Disk) -> Vec<String> {
    let trace = &campaign.trace;
    let apart = if trace.by_order { ", each by itself" } else { "" };
    let orders = match trace.bounces {
        1 => "order 1".into(),
        bounces => format!("orders up to {bounces}{apart}"),
    };
    let sight = if trace.visibility { "shadowing and masking" } else { "no shadowing or masking" };
    let samples = format!(
        "{} for each incidence and realisation ({} blocks), {} in all",
        grouped(plan.samples),
        grouped(plan.blocks),
        grouped(plan.total_samples)
    );
    let bands = match plan.bands().len() {
        1 => String::new(),
        bands => format!(", in {bands} bands of up to {} incidences", plan.band_incidences),
    };
    let facts = [
        ("campaign", format!("{}, seed {}", campaign.name, campaign.seed)),
        ("surface", surface(campaign)),
        ("optics", campaign.optics.described()),
        ("trace", format!("{orders}; {sight}")),
        ("incidences", incidences(campaign, plan)),
        ("bins", format!("{} at each incidence: {}", grouped(plan.bins as u64), sensor(campaign))),
        ("tables", plan.tables.to_string()),
        ("realisations", plan.realisations.to_string()),
        ("samples", samples),
        ("memory", format!("about {}{bands}", bytes(plan.memory_bytes))),
        ("disk", self::disk(disk, plan)),
        ("time", format!("about {} on two cores", duration(plan.estimated_s))),
    ];
    facts.iter().flat_map(|(head, text)| line(head, text)).collect()
}

/// The runs of a campaign with a list of seeds or correlation lengths, each as planned above; nothing of a single one.
pub fn runs(runs: &[CampaignRun], plan: &Plan) -> Vec<String> {
    let labels: Vec<&str> = runs.iter().filter_map(|run| run.label.as_deref()).collect();
    let (Some(first), Some(last)) = (labels.first(), labels.last()) else { return Vec::new() };
    let count = labels.len();
    let text = format!(
        "{count}, {first} to {last}, each as above with patches of its own: {} tables, about {} on two cores in all",
        count * plan.tables,
        duration(count as f64 * plan.estimated_s)
    );
    line("runs", &text)
}

fn disk(disk: Disk, plan: &Plan) -> String {
    let what = if plan.bands().len() > 1 { "checkpoints and finished bands" } else { "checkpoints" };
    let (results, kept) = (bytes(disk.results_bytes), bytes(disk.until_then_bytes));
    format!("results up to about {results}; {what} up to about {kept} until these are there")
}

/// The instrument that the arms are taken from.
pub fn preset(preset: &Preset) -> Vec<String> {
    let facts = [
        ("preset", format!("{}; {}", preset.name, preset.source)),
        ("", format!("emulated: {}", preset.emulated)),
        ("", format!("not emulated: {}", preset.left_out)),
    ];
    facts.iter().flat_map(|(head, text)| line(head, text)).collect()
}

/// What the apertures are predicted to do.
pub fn aperture(bias: &ApertureBias) -> Vec<String> {
    let percent = |bias: f64| {
        let percent = 100.0 * bias;
        // Three digits, however small.
        let digits = (2.0 - percent.abs().max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{percent:+.digits$} %")
    };
    let angle = |angle: f64| (angle * 1e4).round() / 1e4;
    let text = format!(
        "{} on the value at theta_i {}, theta_r {}, phi_r {} from the light (model: mean over the cones against the \
         value at their axes; the largest of {} incidences); with half the apertures {}, extrapolated from both {}",
        percent(bias.bias),
        bias.theta_i_deg,
        angle(bias.theta_r_deg),
        angle(bias.phi_r_deg),
        bias.incidences,
        percent(bias.bias_of_half),
        percent(bias.bias_extrapolated)
    );
    line("apertures", &text)
}

/// What `[uncertainty]` is there for: it changes nothing that is measured.
pub fn uncertainty(given: &Uncertainty) -> Vec<String> {
    let inputs = given.inputs.len();
    let plural = if inputs == 1 { "" } else { "s" };
    line("uncertainty", &format!("{inputs} input{plural}, for gonio budget"))
}

/// Where geometric optics holds, before anything is measured: in a line, then each polar angle of the light below a limit.
pub fn waves(geometric: &GeometricOptics) -> Vec<String> {
    let known = geometric.words().or_else(|| geometric.not_known.as_ref().map(|why| format!("n/a: {why}")));
    let mut lines: Vec<String> = known.iter().flat_map(|text| line("waves", text)).collect();
    let doubtful: Vec<_> = geometric.incidences.iter().filter(|incidence| incidence.is_doubtful()).collect();
    let rows: Vec<Vec<String>> = doubtful.iter().map(|incidence| waves_row(incidence)).collect();
    if !rows.is_empty() {
        let headings = ["theta_i", "4 pi s cos/l", "in step", "4 pi r cos/l", "smooth bins"];
        lines.extend(columns(&headings, &rows));
        lines.extend(wrapped("", LIMITS_OF_RAYS));
    }
    lines
}

/// What the columns of `waves` mean.
const LIMITS_OF_RAYS: &str = "s: rms height, r: mean radius of curvature, l: wavelength; limits pi/2 (Rayleigh) and 10. Below \
    them light keeps step, or sees no flat facets: take a shorter wavelength, or wave optics (docs/physics.md)";

fn waves_row(incidence: &GeometricIncidence) -> Vec<String> {
    vec![
        incidence.theta_i_deg.to_string(),
        format!("{:.3}", incidence.rayleigh),
        format!("{:.2} %", 100.0 * incidence.coherent),
        or_na(incidence.kirchhoff, 1),
        format!("{:.1} %", 100.0 * incidence.doubtful_bins),
    ]
}

/// What is skipped, in a few words each.
pub fn skipped(plan: &Plan) -> Vec<String> {
    let what: Vec<&str> = plan.skipped.iter().map(|skip| skip.what.as_str()).collect();
    if what.is_empty() {
        vec![]
    } else {
        line("skipped", &format!("{} (why, and what it saves: -v)", what.join("; ")))
    }
}

/// What is skipped, why, and what that saves.
pub fn reasons(plan: &Plan) -> Vec<String> {
    let text = |skip: &Saving| format!("{}: {}; saves {}", skip.what, skip.why, skip.saves);
    plan.skipped.iter().flat_map(|skip| line("skipped", &text(skip))).collect()
}

fn line(head: &str, text: &str) -> Vec<String> {
    wrapped(&format!("{head:<HEAD$}"), text)
}

fn surface(campaign: &Campaign) -> String {
    let surface = &campaign.surface;
    let random = |law: &str, alphas: &[Alpha]| {
        format!(
            "{law}, alpha {}; patches of {} x {} cells, correlation {} cells",
            listed(alphas.iter().map(Alpha::text)),
            surface.cells,
            surface.cells,
            surface.correlation_cells
        )
    };
    let what = match &surface.kind {
        SurfaceKind::Ggx(alphas) => random("ggx", alphas),
        SurfaceKind::Beckmann { alphas, spectrum: HeightSpectrum::Gaussian } => random("beckmann", alphas),
        SurfaceKind::Beckmann { alphas, spectrum: HeightSpectrum::Exponential } => {
            random("beckmann, heights of exponential covariance", alphas)
        }
        SurfaceKind::Psd(psd) => by_density(surface, psd),
        SurfaceKind::StudentT { alphas, gamma } => random(&format!("student_t, gamma {gamma}"), alphas),
        SurfaceKind::BlinnPhong { alphas, exponent } => {
            random(&format!("blinn_phong, exponent {exponent}"), alphas)
        }
        SurfaceKind::Smith(smith) => {
            let ndf = if smith.ndf == SmithNdf::Ggx { "ggx" } else { "beckmann" };
            let alphas = listed(smith.alphas.iter().map(Alpha::text));
            let rule = if smith.heights == SmithHeights::Correlated { "correlated" } else { "independent" };
            format!("statistical Smith surface, {ndf}, alpha {alphas}, heights {rule}")
        }
        SurfaceKind::Grains(grains) => {
            let alphas = listed(grains.alphas.iter().map(Alpha::text));
            let base = if grains.base == GrainBase::Mirror { "a mirror" } else { "absorbing" };
            match grains.shape {
                GrainShape::Grains => format!("grains, alpha {alphas}; the plane between them is {base}"),
                GrainShape::Pits => format!("pits, alpha {alphas}; the plane between them is {base}"),
                GrainShape::Heights => random("heights with the normals of grains", &grains.alphas),
            }
        }
        SurfaceKind::Mirror => "a flat mirror".into(),
        SurfaceKind::VGroove { slope } => format!("v-grooves along y, slope {slope}"),
        SurfaceKind::File(map) => {
            let refine = map.refine.map_or("auto".into(), |steps| steps.to_string());
            format!("{}, refine {refine}, {} x {} start regions", map.path, map.tiles, map.tiles)
        }
    };
    if surface.rotation_deg == 0.0 {
        what
    } else {
        format!("{what}; turned by {} degrees", surface.rotation_deg)
    }
}

/// Gaussian heights by their density: what the patches have of it.
fn by_density(surface: &Surface, psd: &PsdSurface) -> String {
    let moments = PsdMoments::of(&psd.psd, surface.cells, psd.pitch_um);
    let model = match &psd.psd.model {
        PsdModel::KCorrelation { a_um3, b_um, c } => {
            format!("K-correlation, A {a_um3} um^3, B {b_um} um, C {c}")
        }
        PsdModel::SelfAffine { hurst, .. } => format!("self-affine, Hurst {hurst}"),
        PsdModel::Table(table) => format!("a table of {} frequencies", table.frequency_per_um.len()),
    };
    format!(
        "Gaussian heights by power spectral density: {model}; rms height {:.4e} um, rms slope {:.4} along an axis (alpha \
         {:.4}), correlation {:.1} cells; patches of {} x {} cells of {} um",
        moments.rms_um,
        moments.facet_slope,
        psd.alphas[0].x,
        moments.correlation_um() / psd.pitch_um,
        surface.cells,
        surface.cells,
        psd.pitch_um
    )
}

fn incidences(campaign: &Campaign, plan: &Plan) -> String {
    let thetas = listed_angles(&campaign.light.theta_i_deg);
    let phis = match &campaign.light.azimuth {
        Azimuth::KlemsFull => "the middles of the patches of the Klems full basis".into(),
        Azimuth::Relative => "azimuth averaged".into(),
        Azimuth::Absolute(phis) => format!("phi_i {}", listed_angles(phis)),
    };
    let aperture = match campaign.light.aperture_deg {
        0.0 => String::new(),
        half_angle => format!("; a cone of half-angle {half_angle} degrees"),
    };
    format!("{}: theta_i {thetas}; {phis}{aperture}", plan.incidences)
}

fn sensor(campaign: &Campaign) -> String {
    match &campaign.sensor {
        SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins } => {
            let layout = match bins {
                BinLayout::Centred => "centred on",
                BinLayout::Aligned => "edges on",
            };
            let step = |whole: f64, count: u32| (whole / f64::from(count) * 1e4).round() / 1e4;
            let (theta, phi) = (step(90.0, *theta_r_bins), step(360.0, *phi_r_bins));
            format!("{layout} multiples of {theta} (theta_r) and {phi} degrees (phi_r){}", which_light(side))
        }
        SensorArm::Arm { aperture_deg, theta_r_deg, phi_r_deg, phi_r_from } => {
            let from = if *phi_r_from == PhiFrom::Light { "the light" } else { "the sample" };
            format!(
                "arm positions, half-angle {aperture_deg} degrees; theta_r {}; phi_r {} from {from}",
                listed_angles(theta_r_deg),
                listed_angles(phi_r_deg)
            )
        }
        SensorArm::KlemsFull { side } => format!("the patches of the Klems full basis{}", which_light(side)),
    }
}

fn which_light(side: &SensorSide) -> &'static str {
    match side {
        SensorSide::Reflection => "",
        SensorSide::Transmission => "; light that has gone through alone",
        SensorSide::Both => "; light that comes back and that has gone through",
    }
}

/// Angles to a ten thousandth of a degree.
fn listed_angles(degrees: &[f64]) -> String {
    listed(degrees.iter().map(|degrees| (degrees * 1e4).round() / 1e4))
}

/// A list with its middle left out where it is long.
fn listed<T: ToString>(values: impl Iterator<Item = T>) -> String {
    let mut texts: Vec<String> = values.map(|value| value.to_string()).collect();
    if texts.len() > 10 {
        texts.splice(5..texts.len() - 2, ["...".to_string()]);
    }
    texts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_keep_their_ends() {
        assert_eq!(listed([1.5, 2.0].iter()), "1.5, 2");
        assert_eq!(listed(0..20), "0, 1, 2, 3, 4, ..., 18, 19");
    }
}
