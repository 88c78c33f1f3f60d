//! A campaign back into the TOML it could have been read from, with nothing left to defaults.

use std::fmt::{Debug, Display};

use super::parse::{arms, campaign, grains, height_map, optics, surface};
use super::schema::{
    Alpha, Azimuth, Campaign, Detrend, Expect, Gaps, GrainShape, Grains, HeightMap, LightArm, LightSide,
    Medium, Optics, Outliers, PhysicalScale, Polarisation, Preparation, PsdSurface, RefractiveIndex,
    SensorArm, SensorSide, Surface, SurfaceKind,
};
use crate::psd::{Psd, PsdKind, PsdModel};

/// The campaign as resolved, in the schema that [`parse`](super::parse()) reads: parsing it gives the campaign again.
///
/// Stored in every table. Keys that would have no effect are left out. Seeds above 2^63 - 1 are written as plain
/// integers, which this reader takes and other TOML readers may not. A random surface has either roughnesses that
/// are equal along x and y, or a single one that is not.
// By hand: checkpoints and digests of tables depend on these bytes, and the `toml` crate writes 1e-7 as 0.0000001. The
// `Serialize` of a `Campaign` is that of JSON reports, which have another shape.
pub fn to_toml(campaign: &Campaign) -> String {
    let mut text = Text(String::new());
    text.line("name", quoted(&campaign.name));
    text.line("seed", campaign.seed);
    surface_table(&mut text, &campaign.surface);
    light_table(&mut text, &campaign.light, &campaign.optics.light_sides());
    sensor_table(&mut text, &campaign.sensor);
    optics_table(&mut text, &campaign.optics);
    text.table("trace");
    text.line("bounces", campaign.trace.bounces);
    text.line("visibility", campaign.trace.visibility);
    text.line("fold", campaign.trace.fold);
    if campaign.trace.by_order {
        text.line("by_order", true);
    }
    text.table("stop");
    text.line("samples", campaign.stop.samples);
    let rules = [("relative_error", campaign.stop.relative_error), ("seconds", campaign.stop.seconds)];
    for (key, rule) in rules {
        if let Some(rule) = rule {
            text.floats(key, rule);
        }
    }
    expect_table(&mut text, &campaign.expect);
    scale_table(&mut text, &campaign.scale);
    if let Some(bench) = &campaign.bench {
        text.table("bench");
        text.floats("cells", &bench.cells);
        if campaign.surface.kind.is_random_heights() {
            text.floats("correlation_cells", &bench.correlation_cells);
        }
    }
    text.0
}

/// TOML in the making.
struct Text(String);

impl Text {
    fn table(&mut self, name: &str) {
        self.0.push_str(&format!("\n[{name}]\n"));
    }

    fn line(&mut self, key: &str, value: impl Display) {
        self.0.push_str(&format!("{key} = {value}\n"));
    }

    /// A float, or a list of floats, in the shortest digits that read back the same.
    fn floats(&mut self, key: &str, value: impl Debug) {
        self.line(key, format!("{value:?}"));
    }
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The word for `value`, quoted.
fn word<T: PartialEq>(words: &[(&'static str, T)], value: &T) -> String {
    words.iter().find(|(_, known)| known == value).map(|(name, _)| quoted(name)).unwrap_or_default()
}

fn surface_table(text: &mut Text, surface: &Surface) {
    text.table("surface");
    let random = surface.kind.has_random_patches();
    if !matches!(surface.kind, SurfaceKind::File(_)) {
        text.line("realisations", surface.realisations);
    }
    if random {
        text.line("cells", surface.cells);
    }
    if surface.kind.has_own_correlation() {
        text.floats("correlation_cells", surface.correlation_cells);
    }
    text.floats("rotation_deg", surface.rotation_deg);
    if random {
        text.line("mirror_images", surface.mirror_images);
    }
    match &surface.kind {
        SurfaceKind::Ggx(alphas) => alpha_table(text, "surface.ggx", alphas),
        SurfaceKind::Beckmann { alphas, spectrum } => {
            alpha_table(text, "surface.beckmann", alphas);
            text.line("spectrum", word(&surface::SPECTRA, spectrum));
        }
        SurfaceKind::StudentT { alphas, gamma } => {
            alpha_table(text, "surface.student_t", alphas);
            text.floats("gamma", gamma);
        }
        SurfaceKind::BlinnPhong { exponent, .. } => {
            text.table("surface.blinn_phong");
            text.floats("exponent", exponent);
        }
        SurfaceKind::Psd(psd) => psd_table(text, psd),
        SurfaceKind::Smith(smith) => {
            alpha_table(text, "surface.smith", &smith.alphas);
            text.line("ndf", word(&surface::SMITH_NDF, &smith.ndf));
            text.line("heights", word(&surface::SMITH_HEIGHTS, &smith.heights));
        }
        SurfaceKind::Grains(grains) => grains_table(text, grains),
        SurfaceKind::Mirror => text.table("surface.mirror"),
        SurfaceKind::VGroove { slope } => {
            text.table("surface.v_groove");
            text.floats("slope", slope);
        }
        SurfaceKind::File(map) => file_table(text, map),
    }
}

fn alpha_table(text: &mut Text, name: &str, alphas: &[Alpha]) {
    text.table(name);
    match alphas {
        [alpha] if alpha.x == alpha.y => text.floats("alpha", alpha.x),
        [alpha] => {
            text.floats("alpha_x", alpha.x);
            text.floats("alpha_y", alpha.y);
        }
        several => text.floats("alpha", several.iter().map(|alpha| alpha.x).collect::<Vec<_>>()),
    }
}

/// The numbers of a table themselves: a table of a BRDF needs no other file.
fn psd_table(text: &mut Text, surface: &PsdSurface) {
    text.table("surface.psd");
    let Psd { model, f_min_per_um, f_max_per_um } = &surface.psd;
    text.floats("pitch_um", surface.pitch_um);
    let mut rms = surface.rms_um;
    match model {
        PsdModel::KCorrelation { a_um3, b_um, c } => {
            text.line("model", quoted("k_correlation"));
            text.floats("a_um3", a_um3);
            text.floats("b_um", b_um);
            text.floats("c", c);
        }
        PsdModel::SelfAffine { rms_um, hurst } => {
            text.line("model", quoted("self_affine"));
            text.floats("hurst", hurst);
            rms = Some(*rms_um);
        }
        PsdModel::Table(table) => {
            text.line("model", quoted("table"));
            text.floats("frequency_per_um", &table.frequency_per_um);
            let density = if table.kind == PsdKind::Areal { "psd_um4" } else { "psd_um3" };
            text.floats(density, &table.density);
        }
    }
    for (key, value) in [("rms_um", rms), ("f_min_per_um", *f_min_per_um), ("f_max_per_um", *f_max_per_um)] {
        if let Some(value) = value {
            text.floats(key, value);
        }
    }
}

fn grains_table(text: &mut Text, grains: &Grains) {
    let mut alphas = grains.alphas.clone();
    alphas.dedup_by_key(|alpha| [alpha.x, alpha.y]);
    alpha_table(text, "surface.grains", &alphas);
    let mut coverages: Vec<f64> = grains.alphas.iter().filter_map(|alpha| alpha.coverage).collect();
    coverages.dedup();
    match coverages[..] {
        [coverage] => text.floats("coverage", coverage),
        _ => text.floats("coverage", coverages),
    }
    if let Some(side) = grains.side {
        text.floats("side", side);
    }
    if grains.shape != GrainShape::Heights {
        text.line("base", word(&grains::BASES, &grains.base));
    }
    text.line("shape", word(&grains::SHAPES, &grains.shape));
}

fn file_table(text: &mut Text, map: &HeightMap) {
    text.table("surface.file");
    text.line("path", quoted(&map.path));
    if let Some(channel) = &map.channel {
        text.line("channel", quoted(channel));
    }
    let lengths = [
        ("pitch_x_um", map.pitch_x_um),
        ("pitch_y_um", map.pitch_y_um),
        ("height_unit_um", map.height_unit_um),
    ];
    for (key, length) in lengths {
        if let Some(length) = length {
            text.floats(key, length);
        }
    }
    text.line("periodic", map.periodic);
    if let Detrend::Polynomial(degree) = map.detrend {
        text.line("detrend", quoted("polynomial"));
        text.line("degree", degree);
    } else {
        text.line("detrend", word(&height_map::DETREND, &map.detrend));
    }
    text.line("refine", map.refine.map_or(quoted("auto"), |steps| steps.to_string()));
    text.line("tiles", map.tiles);
    preparation(text, &map.preparation);
}

/// What is done to a map besides: keys that say nothing new are left out, as in files from before they were there.
fn preparation(text: &mut Text, steps: &Preparation) {
    if steps.gaps != Gaps::default() {
        text.line("gaps", word(&height_map::GAPS, &steps.gaps));
    }
    if steps.outliers != Outliers::default() {
        text.line("outliers", word(&height_map::OUTLIERS, &steps.outliers));
    }
    for (key, cut_off) in [("s_filter_um", steps.s_filter_um), ("l_filter_um", steps.l_filter_um)] {
        if let Some(cut_off) = cut_off {
            text.floats(key, cut_off);
        }
    }
}

fn light_table(text: &mut Text, light: &LightArm, sides: &[LightSide]) {
    text.table("light");
    if light.azimuth != Azimuth::KlemsFull {
        text.floats("theta_i_deg", &light.theta_i_deg);
    }
    match &light.azimuth {
        Azimuth::KlemsFull => text.line("azimuth", quoted("klems_full")),
        Azimuth::Relative => text.line("azimuth", quoted("relative")),
        Azimuth::Absolute(phis) => {
            text.line("azimuth", quoted("absolute"));
            text.floats("phi_i_deg", phis);
        }
    }
    if light.azimuth != Azimuth::KlemsFull {
        text.line("average_azimuth", light.average_azimuth);
    }
    text.floats("aperture_deg", light.aperture_deg);
    if sides != [LightSide::Front] {
        text.line("side", word(&arms::LIGHT_SIDES, &sides));
    }
}

fn sensor_table(text: &mut Text, sensor: &SensorArm) {
    match sensor {
        SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins } => {
            text.table("sensor.hemisphere");
            text.line("theta_r_bins", theta_r_bins);
            text.line("phi_r_bins", phi_r_bins);
            text.line("bins", word(&arms::LAYOUTS, bins));
            side_line(text, side);
        }
        SensorArm::Arm { theta_r_deg, phi_r_deg, aperture_deg, phi_r_from } => {
            text.table("sensor.arm");
            text.floats("theta_r_deg", theta_r_deg);
            text.floats("phi_r_deg", phi_r_deg);
            text.floats("aperture_deg", aperture_deg);
            text.line("phi_r_from", word(&arms::PHI_FROM, phi_r_from));
        }
        SensorArm::KlemsFull { side } => {
            text.table("sensor.patches");
            text.line("basis", quoted("klems_full"));
            side_line(text, side);
        }
    }
}

/// Left out where it is the usual one.
fn side_line(text: &mut Text, side: &SensorSide) {
    if *side != SensorSide::Reflection {
        text.line("side", word(&arms::SENSOR_SIDES, side));
    }
}

fn optics_table(text: &mut Text, optics: &Optics) {
    if *optics == Optics::PerfectMirror {
        return;
    }
    text.table("optics");
    match optics.each()[0] {
        Optics::Dielectric(_) => return clear_lines(text, optics),
        Optics::Diffuse { albedo } => {
            text.line("facet", quoted("diffuse"));
            return text.floats("albedo", albedo);
        }
        Optics::Layered { albedo, eta } => {
            text.line("facet", quoted("layered"));
            text.floats("eta", eta);
            return text.floats("albedo", albedo);
        }
        _ => {}
    }
    match optics {
        Optics::Schlick { material: Some(name), .. } => text.line("material", quoted(name)),
        Optics::Schlick { material: None, f0 } => text.floats("f0", f0),
        Optics::Index(index) => index_lines(text, index),
        Optics::PerfectMirror | Optics::Dielectric(_) | Optics::Diffuse { .. } | Optics::Layered { .. } => {}
        Optics::Several(all) => several_lines(text, all),
    }
    let (law, polarisations) = optics::law_of(optics);
    text.line("fresnel", word(&optics::LAWS, &law));
    match polarisations[..] {
        [one] => text.line("polarisation", word(&optics::POLARISATIONS, &one)),
        _ => text.line("polarisation", words(polarisations.iter().map(|p| word(&optics::POLARISATIONS, p)))),
    }
}

/// Clear materials; the sides of the light stand in `[light]`.
fn clear_lines(text: &mut Text, optics: &Optics) {
    text.line("facet", quoted("dielectric"));
    let each = optics.each();
    let mut clear =
        each.iter().filter_map(|one| if let Optics::Dielectric(clear) = one { Some(clear) } else { None });
    let Some(first) = clear.next() else { return };
    let mut names: Vec<&str> = Vec::new();
    for name in each.iter().filter_map(|one| one.material()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    if first.polarisation != Polarisation::None {
        text.line("polarisation", word(&optics::POLARISATIONS, &first.polarisation));
    }
    let nm: Vec<f64> = first.media.iter().filter_map(|medium| medium.wavelength_nm).collect();
    match names[..] {
        [] if nm.is_empty() => return text.floats("eta", first.media[0].eta),
        [] => text.floats("eta", first.media.iter().map(|medium| medium.eta).collect::<Vec<f64>>()),
        [name] => text.line("material", quoted(name)),
        _ => text.line("materials", words(names.iter().map(|name| quoted(name)))),
    }
    text.floats("wavelength_nm", nm);
}

/// The numbers themselves for an index that came from a file or the campaign: a table needs no other file.
fn index_lines(text: &mut Text, index: &RefractiveIndex) {
    let nm: Vec<f64> = index.media.iter().filter_map(|medium| medium.wavelength_nm).collect();
    if let Some(name) = &index.material {
        text.line("material", quoted(name));
        return text.floats("wavelength_nm", nm);
    }
    let part = |pick: fn(&Medium) -> f64| index.media.iter().map(pick).collect::<Vec<f64>>();
    let (eta, k) = (part(|medium| medium.eta), part(|medium| medium.k));
    if nm.is_empty() {
        text.floats("eta", eta[0]);
        return text.floats("k", k[0]);
    }
    text.floats("eta", eta);
    text.floats("k", k);
    text.floats("wavelength_nm", nm);
}

/// Several names, or one material in several polarisations.
fn several_lines(text: &mut Text, all: &[Optics]) {
    let mut names: Vec<&str> = all.iter().filter_map(Optics::material).collect();
    names.dedup();
    match (&all[0], &names[..]) {
        (Optics::Index(index), [] | [_]) => index_lines(text, index),
        (first, _) => {
            text.line("materials", words(names.iter().map(|name| quoted(name))));
            if let Optics::Index(index) = first {
                let nm: Vec<f64> = index.media.iter().filter_map(|medium| medium.wavelength_nm).collect();
                text.floats("wavelength_nm", nm);
            }
        }
    }
}

/// A list of words that are quoted already.
fn words(all: impl Iterator<Item = String>) -> String {
    format!("[{}]", all.collect::<Vec<_>>().join(", "))
}

fn expect_table(text: &mut Text, expect: &Expect) {
    if *expect == (Expect { masking: None, l1_model: None }) {
        return;
    }
    text.table("expect");
    if let Some(masking) = &expect.masking {
        text.line("masking", word(&campaign::MASKINGS, masking));
    }
    if let Some(l1_model) = expect.l1_model {
        text.floats("l1_model", l1_model);
    }
}

fn scale_table(text: &mut Text, scale: &PhysicalScale) {
    if *scale == PhysicalScale::default() {
        return;
    }
    text.table("scale");
    for (key, length) in [("pitch_um", scale.pitch_um), ("wavelength_nm", scale.wavelength_nm)] {
        if let Some(length) = length {
            text.floats(key, length);
        }
    }
}
