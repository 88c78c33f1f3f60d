//! The picture: radiances of all pixels, and their sRGB values in a PNG.

use rayon::prelude::*;

use super::camera::Camera;
use super::light::Lighting;
use super::material_sphere::MaterialSphere;
use crate::error::Checked;
use crate::interchange::Colour;

/// Rays along each side of a pixel that find out how much of it the sphere covers.
const SIDE: usize = 4;

/// Linear radiances, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels along a side.
    pub size: usize,
    /// Values; white is 1.
    pub pixels: Vec<Colour>,
}

/// The square picture of a sphere. Pixels within the sphere have one ray through their middle; on its edge they are means of 16.
pub fn picture(sphere: &MaterialSphere, light: &Lighting, camera: &Camera, size: usize) -> Picture {
    let at = |pixel: f64| 2.0 * pixel / size as f64 - 1.0;
    let pixel = |index: usize| {
        let (column, row) = ((index % size) as f64, (index / size) as f64);
        let ray = |x: f64, y: f64| camera.ray(at(column + x), -at(row + y));
        let seen = |ray| match camera.meets_sphere(ray) {
            Some(place) => sphere.seen(light, place, -ray),
            None => light.behind(ray),
        };
        let step = |k: usize| (k as f64 + 0.5) / SIDE as f64;
        let rays: Vec<_> = (0..SIDE * SIDE).map(|k| ray(step(k % SIDE), step(k / SIDE))).collect();
        let covered = rays.iter().filter(|ray| camera.meets_sphere(**ray).is_some()).count();
        if covered == 0 || covered == rays.len() {
            return seen(ray(0.5, 0.5));
        }
        let sum = rays.iter().fold([0.0; 3], |mut sum: Colour, &ray| {
            sum.iter_mut().zip(seen(ray)).for_each(|(sum, value)| *sum += value);
            sum
        });
        sum.map(|value| value / rays.len() as f64)
    };
    Picture { size, pixels: (0..size * size).into_par_iter().map(pixel).collect() }
}

/// The sRGB value of a linear one, both 0 to 1 (IEC 61966-2-1).
pub fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

impl Picture {
    /// The share of the pixels that are brighter than white after 2^`exposure`: they become white in their channels.
    pub fn clipped(&self, exposure: f64) -> f64 {
        let most = 2f64.powf(-exposure);
        let over = self.pixels.iter().filter(|pixel| pixel.iter().any(|value| *value > most));
        over.count() as f64 / self.pixels.len() as f64
    }

    /// The bytes of a PNG: 8 bits of sRGB of 2^`exposure` times the radiances, cut off at white.
    // Tested by `a_picture_is_srgb_of_its_radiances` (tests/it/render.rs).
    pub fn png(&self, exposure: f64) -> Checked<Vec<u8>> {
        let gain = 2f64.powf(exposure);
        let byte = |value: f64| (255.0 * srgb((gain * value).min(1.0))).round() as u8;
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|pixel| pixel.map(byte)).collect();
        let side = u32::try_from(self.size).map_err(|_| "too many pixels")?;
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, side, side);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&bytes));
        written.map_err(|why| why.to_string())?;
        Ok(out)
    }
}
