//! The patches as files: which there will be, what may be replaced, and what each holds.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec2;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::certificate::{MapFigures, PatchEntry, Pooled, RayBound};
use super::roughness::RoughnessEntry;
use crate::campaign::{Campaign, SurfaceKind};
use crate::cli::text::output::{parsed_json, to_json};
use crate::cli::text::progress::RunProgress;
use crate::error::{Error, Result};
use crate::files::{self, Destination, FolderLook};
use crate::job::paths;
use crate::measure::{Patch, Patches, Specimen, patches::patch_name};
use crate::surface::io::{export, glb, import};
use crate::surface::{Certificate, SlopeCounts};

/// The plots of a measured map.
pub const ROUGHNESS: &str = "roughness.svg";

/// Everything that the patches share.
pub struct PatchJob<'a> {
    campaign: &'a Campaign,
    patches: Patches,
    pub folder: PathBuf,
    certificate: Destination,
    /// What lay there before any work.
    look: FolderLook,
    pub count: u64,
    pub pitch: [f64; 2],
    /// How the names of each patch's files end.
    pub ends: Vec<&'static str>,
    force: bool,
}

impl<'a> PatchJob<'a> {
    pub fn new(
        campaign: &'a Campaign,
        folder: PathBuf,
        ends: Vec<&'static str>,
        force: bool,
        notes: &mut Vec<String>,
    ) -> Result<Self> {
        let patches = Patches::prepare(campaign, notes)?;
        let random = campaign.surface.kind.has_random_patches();
        let alphas = campaign.alphas();
        let alpha = match (&patches, &alphas[..]) {
            (Patches::Statistical { .. }, _) => {
                let why = "a statistical Smith surface has no heights: there is no patch to write";
                return Err(Error::Usage(format!("{}: {why}", campaign.name)));
            }
            (Patches::Grains { coverages, .. }, _) if coverages.len() > 1 => {
                let why = "surface.grains.coverage is a list: patches are written for one coverage at a time";
                return Err(Error::Usage(format!("{}: {why}", campaign.name)));
            }
            (Patches::Exact { alpha, .. }, _) => [alpha.x, alpha.y],
            (Patches::Map { map, .. }, _) => [map.alpha_x, map.alpha_y],
            (_, [Some(alpha)]) => [alpha.x, alpha.y],
            _ => {
                notes.push(
                    "several roughnesses share these patches: written with pitch 1, as alpha = 1".into(),
                );
                [1.0, 1.0]
            }
        };
        if let Patches::Map { map, .. } = &patches
            && !map.field.is_periodic()
        {
            notes.push(
                "the map is open: a reader of patches would take its first and last rows for neighbours"
                    .into(),
            );
        }
        let count = if random { u64::from(campaign.surface.realisations) } else { 1 };
        let pitch = alpha.map(|alpha| 1.0 / alpha);
        let certificate = Destination::at(folder.join("certificate.json"));
        let look = FolderLook::at(&folder, |name| name.starts_with("patch_") || name == ROUGHNESS);
        Ok(PatchJob { campaign, patches, folder, certificate, look, count, pitch, ends, force })
    }

    /// The areal parameters of a measured map; `None` of another surface, or where they do not fit into memory, which `notes`
    /// then says.
    pub fn roughness(&self, notes: &mut Vec<String>) -> Result<Option<RoughnessEntry>> {
        let SurfaceKind::File(map) = &self.campaign.surface.kind else { return Ok(None) };
        match RoughnessEntry::of(&import::load_steps(map)?) {
            Ok(areal) => Ok(Some(areal)),
            Err(why) => {
                notes.push(format!("{}: no areal parameters: {why}", map.path));
                Ok(None)
            }
        }
    }

    pub fn name(&self, index: u64, end: &str) -> String {
        patch_name(index, end)
    }

    pub fn certificate(&self) -> &Destination {
        &self.certificate
    }

    /// The names of all patches that will be there.
    fn names(&self) -> Vec<String> {
        (0..self.count).flat_map(|index| self.ends.iter().map(move |end| self.name(index, end))).collect()
    }

    /// Before any work: what lies in the folder must be of these patches, or be replaced by --force.
    pub fn check_folder(&self, file: &Path) -> Result<()> {
        let mut outputs: Vec<PathBuf> = self.names().iter().map(|name| self.folder.join(name)).collect();
        outputs.push(self.certificate().to_path_buf());
        if self.campaign.surface.kind.is_map() {
            outputs.push(self.folder.join(ROUGHNESS));
        }
        let paths: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
        paths::spare_inputs(&paths, file, self.campaign)?;
        if !self.force {
            let strange = self.patches_there()?.into_iter().find(|(index, _)| *index >= self.count);
            if let Some((_, path)) = strange {
                return Err(paths::already_exists(&path, "is there, a patch more than this campaign has"));
            }
            return self.check_certificate();
        }
        let certified = self.certified()?;
        for (_, path) in self.patches_there()? {
            // Patches of the certificate that are not about to be replaced: what is left is of one run.
            if !outputs.contains(&path) {
                let stem =
                    path.with_extension("exr").file_name().map(|name| name.to_string_lossy().into_owned());
                if !stem.is_some_and(|name| certified.contains(&name)) {
                    let what = "is there, a patch that no certificate names; move it, or choose another -o";
                    return Err(Error::format(&path, what));
                }
                paths::spare_inputs(&[&path], file, self.campaign)?;
                self.look.destination(&path).remove()?;
            }
        }
        files::remove(self.certificate())?;
        Ok(())
    }

    /// The patches that the certificate names which is there.
    fn certified(&self) -> Result<Vec<String>> {
        let old = self.certificate_there()?.unwrap_or_default();
        let names = old["patches"].as_array().into_iter().flatten();
        Ok(names.filter_map(|entry| entry["file"].as_str().map(String::from)).collect())
    }

    /// The certificate that is there; null if it is no JSON.
    fn certificate_there(&self) -> Result<Option<Value>> {
        let path = self.certificate();
        let read = || Ok(parsed_json(&files::read(path)?).unwrap_or_default());
        files::is_there(path).then(read).transpose()
    }

    /// A certificate that is there must be of the same surface and seed.
    fn check_certificate(&self) -> Result<()> {
        let Some(old) = self.certificate_there()? else { return Ok(()) };
        let same = old["seed"] == json!(self.campaign.seed)
            && old["surface"] == surface_of(self.campaign)?
            && old["pitch"] == json!(self.pitch);
        if same { Ok(()) } else { Err(paths::already_exists(self.certificate(), "is of other patches")) }
    }

    /// Files in the folder that are named as patches are, with their numbers.
    fn patches_there(&self) -> Result<Vec<(u64, PathBuf)>> {
        let mut found = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(|e| Error::io(&self.folder, e))? {
            let entry = entry.map_err(|e| Error::io(&self.folder, e))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let digits = name.strip_prefix("patch_").and_then(|rest| rest.split_once('.'));
            if let Some((digits, "exr" | "npy" | "glb")) = digits
                && digits.len() >= 3
                && let Ok(index) = digits.parse()
            {
                found.push((index, self.folder.join(name)));
            }
        }
        found.sort();
        Ok(found)
    }

    /// Makes, certifies and writes all patches, as many at a time as there are threads.
    pub fn make_all(&self, progress: &RunProgress) -> Result<(Vec<PatchEntry>, Option<SlopeCounts>)> {
        let mut all = Patches::law(self.campaign).map(SlopeCounts::new);
        let mut entries = Vec::new();
        let indices: Vec<u64> = (0..self.count).collect();
        for group in indices.chunks(rayon::current_num_threads()) {
            let make = |&index: &u64| {
                let made = self.make(index);
                progress.add(1);
                made
            };
            for (entry, slopes) in group.par_iter().map(make).collect::<Result<Vec<_>>>()? {
                entries.push(entry);
                if let (Some(all), Some(slopes)) = (&mut all, slopes) {
                    all.merge(&slopes);
                }
            }
        }
        Ok((entries, all))
    }

    fn make(&self, index: u64) -> Result<(PatchEntry, Option<SlopeCounts>)> {
        let cells = self.campaign.surface.cells as usize;
        let (patch, grains) = match self.patches.realisation(index)? {
            Specimen::Patch(patch) => (patch, None),
            Specimen::Grains(fields) => {
                let (coverage, grains) = &fields[0];
                (Patch::of_grains(grains, cells), Some(grains.figures(*coverage, cells)))
            }
            Specimen::Statistical { .. } => {
                return Err(Error::Internal("a statistical surface reached the writer of patches".into()));
            }
        };
        let [pitch_x, pitch_y] = self.pitch;
        let file = |end: &str| self.folder.join(self.name(index, end));
        for end in &self.ends {
            let bytes = match *end {
                "npy" => export::encode_npy(&patch.field)?,
                "glb" => glb::encode(&patch.field, self.pitch)?,
                _ => export::encode_exr(&patch.field, pitch_x, pitch_y)?,
            };
            self.put(&file(end), &bytes)?;
        }
        let law = Patches::law(self.campaign);
        let slopes = law.map(|law| {
            let mut slopes = SlopeCounts::new(law);
            slopes.add(&patch.field);
            slopes
        });
        let certificate = match &self.patches {
            Patches::Map { map, .. } => {
                Certificate::of_map(&patch.field, DVec2::new(map.alpha_x, map.alpha_y))
            }
            _ => Certificate::of(&patch.field, law),
        };
        let heights_sha256 = files::hex(&Patch::digest(&patch));
        Ok((PatchEntry { file: self.name(index, "exr"), heights_sha256, certificate, grains }, slopes))
    }

    /// Writes a file, unless the same bytes are there already.
    pub fn put(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        if !self.force && files::is_there(path) {
            let same = files::read(path)? == bytes;
            return if same { Ok(()) } else { Err(paths::already_exists(path, "is another patch")) };
        }
        files::write_atomically(self.look.destination(path), bytes)
    }

    /// What a ray of the campaign's light costs at most, for each of its roughnesses.
    pub fn ray_bounds(&self, entries: &[PatchEntry]) -> Vec<RayBound> {
        let range = entries.iter().map(|entry| entry.certificate.height_range).fold(0.0, f64::max);
        let own = self.pitch.map(|pitch| 1.0 / pitch);
        let alphas = self.campaign.alphas();
        let alphas: Vec<[f64; 2]> = alphas.iter().map(|a| a.map_or(own, |a| [a.x, a.y])).collect();
        let map = matches!(self.patches, Patches::Map { .. });
        RayBound::of(range, &alphas, map, &self.campaign.light.theta_i_deg)
    }

    /// Size, pitch and slopes of a measured map; `None` of other surfaces.
    pub fn figures(&self, entries: &[PatchEntry]) -> Option<MapFigures> {
        match (&self.patches, entries) {
            (Patches::Map { map, .. }, [entry, ..]) => {
                Some(MapFigures::of(map, entry.certificate.median_slope))
            }
            _ => None,
        }
    }

    pub fn document(
        &self,
        entries: &[PatchEntry],
        pooled: &Pooled,
        (bounds, map): (&[RayBound], Option<&MapFigures>),
        notes: &[String],
    ) -> Result<Value> {
        Ok(json!({
            "schema": 1,
            "name": self.campaign.name,
            "seed": self.campaign.seed,
            "version": env!("CARGO_PKG_VERSION"),
            "surface": surface_of(self.campaign)?,
            "pitch": self.pitch,
            "map": to_json(&map)?,
            "patches": to_json(&entries)?,
            "all": to_json(pooled)?,
            "ray_bounds": to_json(&bounds)?,
            "notes": notes,
        }))
    }
}

/// What of the surface decides the patches: not how it is turned or mirrored.
fn surface_of(campaign: &Campaign) -> Result<Value> {
    let surface = &campaign.surface;
    Ok(match &surface.kind {
        kind if kind.is_random_heights() => json!({
            "realisations": surface.realisations,
            "cells": surface.cells,
            "correlation_cells": surface.correlation_cells,
            "kind": to_json(&surface.kind)?,
        }),
        kind if kind.has_random_patches() => json!({
            "realisations": surface.realisations,
            "cells": surface.cells,
            "kind": to_json(kind)?,
        }),
        kind => json!({ "kind": to_json(kind)? }),
    })
}
