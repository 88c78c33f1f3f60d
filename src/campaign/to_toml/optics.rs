//! `[optics]`.

use super::text::{Text, quoted, word, words};
use crate::campaign::parse::optics;
use crate::campaign::schema::{Medium, Optics, Polarisation, RefractiveIndex};

pub fn optics_table(text: &mut Text, optics: &Optics) {
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
