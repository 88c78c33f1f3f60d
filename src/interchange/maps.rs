//! Maps of GGX parameters over a surface, as OpenSVBRDF and its kin publish them: a texel becomes a campaign.
//!
//! A folder with `ax_ay.exr` (R: alpha_x, G: alpha_y) and `ps.exr` (R, G, B: specular reflectance, taken as F0).
//! Other maps of the folder (diffuse, normal, tangent) say nothing of the microsurface and are left alone.

use std::path::Path;

use super::{Checked, needed};
use crate::campaign;
use crate::error::{ContentError, Error, Result, wrong};
use crate::files::image::{self, ImagePart};
use crate::files::{self, memory};

/// The maps' files in their folder.
pub const FILES: [&str; 2] = ["ax_ay.exr", "ps.exr"];

/// Roughness and F0 by texel; row 0 is the top of the images.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    alpha: [Vec<f32>; 2],
    f0: [Vec<f32>; 3],
}

/// Reads the two maps of a folder.
pub fn load(folder: &Path) -> Result<Maps> {
    let [alpha, f0] = FILES.map(|name| folder.join(name));
    let (alpha, f0) = (files::read(&alpha)?, files::read(&f0)?);
    let wrong = |why: ContentError| Error::format(folder, why);
    let bytes = needed::image(&alpha).map_err(wrong)?.saturating_add(needed::image(&f0).map_err(wrong)?);
    // The images and their channels as floats.
    memory::check_file(folder, bytes.saturating_mul(3))?;
    read(&alpha, &f0).map_err(wrong)
}

/// The maps in the bytes of `ax_ay.exr` and `ps.exr`, which must have one size.
// Tested by `a_texel_becomes_a_campaign`, `damaged_maps_are_refused` (tests/it/interchange/interchange_maps.rs).
pub fn read(alpha: &[u8], f0: &[u8]) -> Checked<Maps> {
    let part = |name: &str, bytes: &[u8]| image::decode_one(bytes).map_err(|why| why.at(name));
    let (mut alpha, mut f0) = (part(FILES[0], alpha)?, part(FILES[1], f0)?);
    let (width, height) = (alpha.width, alpha.height);
    if (f0.width, f0.height) != (width, height) {
        return Err(wrong!(
            "{} is {width} x {height}, {} {} x {}: one size needed",
            FILES[0],
            FILES[1],
            f0.width,
            f0.height
        ));
    }
    let [x, y] = ["R", "G"].map(|name| channel(FILES[0], &mut alpha, name));
    let [r, g, b] = ["R", "G", "B"].map(|name| channel(FILES[1], &mut f0, name));
    Ok(Maps { width, height, alpha: [x?, y?], f0: [r?, g?, b?] })
}

fn channel(file: &str, part: &mut ImagePart, name: &str) -> Checked<Vec<f32>> {
    part.take_floats(name).ok_or_else(|| wrong!("{file}: no channel `{name}` of floats"))
}

impl Maps {
    /// The campaign of a texel, as the text of its file. Equal roughnesses make a 3-D campaign, others a 4-D one.
    ///
    /// A texel whose values no campaign may have (roughness outside [1e-4, 10], F0 outside [0, 1], not finite) is
    /// refused.
    pub fn campaign(&self, column: usize, row: usize) -> Checked<String> {
        if column >= self.width || row >= self.height {
            return Err(wrong!("texel {column},{row} lies outside {} x {}", self.width, self.height));
        }
        let at = row * self.width + column;
        let [x, y] = [0, 1].map(|k| self.alpha[k][at]);
        let [r, g, b] = [0, 1, 2].map(|k| self.f0[k][at]);
        let roughness =
            if x == y { format!("alpha = {x:?}") } else { format!("alpha_x = {x:?}\nalpha_y = {y:?}") };
        let azimuth = if x == y {
            "azimuth = \"relative\""
        } else {
            "azimuth = \"absolute\"\nphi_i_deg = { from = 0, to = 345, step = 15 }"
        };
        let text = format!(
            "name = \"texel_{column}_{row}\"\nseed = 1\n\n[surface]\nrealisations = 16\ncells = 1024\n\
             correlation_cells = 8.0\n[surface.ggx]\n{roughness}\n\n[light]\n\
             theta_i_deg = {{ from = 0, to = 75, step = 15 }}\n{azimuth}\n\n[sensor.hemisphere]\ntheta_r_bins = 18\n\
             phi_r_bins = 36\nbins = \"centred\"\n\n[optics]\nf0 = [{r:?}, {g:?}, {b:?}]\n\n[stop]\nsamples = 1_000_000\n"
        );
        let parsed = campaign::parse(&text, &format!("texel {column},{row}"), Path::new(""));
        Ok(parsed.map(|_| text).map_err(|fault| fault.to_string().replace('\n', "; "))?)
    }
}
