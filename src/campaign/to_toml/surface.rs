//! `[surface]`.

use super::text::{Text, quoted, word};
use crate::campaign::parse::{grains, height_map, surface};
use crate::campaign::schema::{
    Alpha, Detrend, Gaps, GrainShape, Grains, HeightMap, Outliers, Preparation, PsdSurface, Surface,
    SurfaceKind,
};
use crate::psd::{Psd, PsdKind, PsdModel};

pub fn surface_table(text: &mut Text, surface: &Surface) {
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
