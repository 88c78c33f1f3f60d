//! `gonio render`: a sphere of a table's material in a light, as a picture or as a scene for another program.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::export::check_output;
use super::streams::Place;
use super::table_file;
use super::text::numbers::bytes;
use super::text::output::{Output, warn};
use super::text::progress::Stage;
use crate::error::{ContentError, Error, Result};
use crate::files::{self, Destination, STANDARD};
use crate::interchange::Options;
use crate::interchange::codec::{Codec, FileContent};
use crate::interchange::mitsuba::rgl;
use crate::render::light::TOWARDS_DEG;
use crate::render::material_sphere::Material;
use crate::render::{Camera, Light, Lighting, MaterialSphere, in_shown_colours, mitsuba, picture};
use crate::table::BrdfTable;

/// Show a sphere of a table's material under a soft sky, as a PNG or as a scene for Mitsuba
#[derive(Args)]
#[command(
    after_help = "The light is the same for every table: a sky by formula (docs/guide.md) whose bright place is where\n\
    the lamp is. Radiances become sRGB as they are, cut off at white; no noise, no random numbers.\n\n\
    Example: gonio render out/quickstart/quickstart.exr -o sphere.png"
)]
pub struct Arguments {
    /// The table
    table: PathBuf,
    /// The picture, PNG; with --scene a folder
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// What is switched on
    #[arg(long, value_name = "sky|lamp|both", default_value = "sky", value_parser = light)]
    light: Light,
    /// Polar angle and azimuth of lamp and bright place [default: 45,0]
    #[arg(long, value_name = "THETA,PHI", value_parser = angles, allow_hyphen_values = true)]
    at: Option<Angles>,
    /// Pixels along a side, 16 to 4096
    #[arg(long, value_name = "PX", default_value_t = 512, value_parser = clap::value_parser!(u16).range(16..=4096))]
    size: u16,
    /// Radiances times 2^EV, -20 to 20
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f64,
    /// A folder with scene.xml, sky.exr, table.bsdf instead
    #[arg(long, value_name = "mitsuba", value_parser = ["mitsuba"], hide_possible_values = true)]
    scene: Option<String>,
    /// Replace what is there
    #[arg(long)]
    force: bool,
    /// Print one JSON document: picture, size, shows, light, clipped; or scene and files
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let (path, output) = (&arguments.table, &arguments.output);
    let at = arguments.at.map_or(TOWARDS_DEG, |angles| angles.0);
    if !(-20.0..=20.0).contains(&arguments.exposure) {
        return Err(Error::Usage(format!("--exposure {}: must lie in [-20, 20]", arguments.exposure)));
    }
    let (light, camera) = (Lighting::new(arguments.light, at), Camera::beside(at[1]));
    if arguments.scene.is_some() {
        let scene = mitsuba::scene(&light, &camera, arguments.size.into());
        return write_scene(arguments, &light, &scene);
    }
    let place = Place::of(output, arguments.json)?;
    check_output(path, place.path(), arguments.force)?;
    if output.extension().is_some() && !is_png(output) {
        return Err(Error::Usage(format!("-o {}: a picture is a PNG: name it .png", output.display())));
    }
    let table = table_file::load(path)?;
    let material = Material::new(&table).map_err(|why| no_sphere(path, why))?;
    for note in &material.notes {
        warn(format_args!("{}: {note}", output.display()));
    }
    let stage = Stage::begin("rendering");
    let picture = picture(&MaterialSphere::new(&material), &light, &camera, arguments.size.into());
    drop(stage);
    let png = picture.png(arguments.exposure).map_err(|why| Error::format(output, why))?;
    files::write_atomically(place.path(), &png)?;
    let mut out = Output::default();
    let (size, length) = (arguments.size, bytes(png.len() as u64));
    if arguments.json {
        out.json(&json!({
            "picture": output,
            "size": size,
            "shows": material.in_words(),
            "light": arguments.light_in_words(at),
            "clipped": picture.clipped(arguments.exposure),
        }))?;
        return place.done().map(|()| 0);
    }
    out.line(format_args!("picture     {} ({size} x {size}, {length})", output.display()))?;
    out.line(format_args!("shows       {}", material.in_words()))?;
    out.line(format_args!("light       {}", arguments.light_in_words(at)))?;
    let clipped = 100.0 * picture.clipped(arguments.exposure);
    out.line(format_args!(
        "too bright  {clipped:.1} % of the pixels, at an exposure of {} EV",
        arguments.exposure
    ))?;
    place.done().map(|()| 0)
}

impl Arguments {
    fn light_in_words(&self, [theta, phi]: [f64; 2]) -> String {
        let place = format!("at theta {theta}, phi {phi} degrees");
        match self.light {
            Light::Sky => format!("a soft sky, brightest {place}"),
            Light::Lamp => format!("a lamp {place}"),
            Light::Both => format!("a soft sky and a lamp, both {place}"),
        }
    }
}

fn is_png(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"))
}

/// A polar angle and an azimuth, degrees.
#[derive(Clone, Copy)]
struct Angles([f64; 2]);

fn angles(words: &str) -> std::result::Result<Angles, String> {
    let numbers: Option<Vec<f64>> = words.split(',').map(|word| word.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[theta, phi]) if (0.0..=180.0).contains(&theta) && (-360.0..=360.0).contains(&phi) => {
            Ok(Angles([theta, phi]))
        }
        _ => Err("a polar angle of 0 to 180 degrees and an azimuth of -360 to 360 needed, as 45,0".into()),
    }
}

/// The lights that can be asked for.
fn light(word: &str) -> std::result::Result<Light, String> {
    match word {
        "sky" => Ok(Light::Sky),
        "lamp" => Ok(Light::Lamp),
        "both" => Ok(Light::Both),
        _ => Err("sky, lamp or both needed".into()),
    }
}

/// A table that says too little for a sphere.
fn no_sphere(path: &Path, why: ContentError) -> Error {
    match why {
        ContentError::Wrong(why) => Error::Refused(format!(
            "{}: {why}; a sphere shows the surface to light and eye from all directions: measure with [sensor.hemisphere], \
             and with azimuths all round where the surface is not isotropic",
            path.display()
        )),
        why => Error::format(path, why),
    }
}

/// The scene, the sky and the table in a folder.
fn write_scene(arguments: &Arguments, light: &Lighting, scene: &str) -> Result<u8> {
    let (path, folder) = (&arguments.table, &arguments.output);
    if is_png(folder) || *folder == Path::new(STANDARD) {
        return Err(Error::Usage(format!("-o {}: a scene is a folder", folder.display())));
    }
    let names = [mitsuba::SKY, mitsuba::TABLE, mitsuba::SCENE];
    let [sky_file, bsdf_file, scene_file] = names.map(|name| Destination::at(folder.join(name)));
    for place in [&sky_file, &bsdf_file, &scene_file] {
        check_output(path, place, arguments.force)?;
    }
    let table = table_file::load(path)?;
    if table.grid.looks_below() {
        return Err(Error::Refused(format!(
            "{}: holds light that goes through, for which Mitsuba's `measured` has no place; without --scene the picture shows \
             it",
            path.display()
        )));
    }
    let bsdf = measured(&table).map_err(|why| no_sphere(path, why))?;
    let sky =
        light.sky.as_ref().map(mitsuba::sky_map).transpose().map_err(|why| Error::format(folder, why))?;
    let _claim = files::create_folder(folder)?;
    let mut written = vec![mitsuba::TABLE, mitsuba::SCENE];
    if let Some(sky) = sky {
        files::write_atomically(&sky_file, &sky)?;
        written.insert(0, mitsuba::SKY);
    }
    files::write_atomically(&bsdf_file, &bsdf)?;
    // Last: where it is, all of it is.
    files::write_atomically(&scene_file, scene.as_bytes())?;
    let mut out = Output::default();
    if arguments.json {
        out.json(&json!({ "scene": folder.join(mitsuba::SCENE), "files": written }))?;
        return Ok(0);
    }
    out.line(format_args!("scene       {} in {}", written.join(", "), folder.display()))?;
    out.line(format_args!("look        mitsuba {}", folder.join(mitsuba::SCENE).display()))?;
    Ok(0)
}

/// The table as Mitsuba's `measured` reads it.
fn measured(table: &BrdfTable) -> std::result::Result<Vec<u8>, ContentError> {
    let (rgb, _) = in_shown_colours(table);
    match rgl::RglFile.encode(&rgb, &Options::default())?.content {
        FileContent::Bytes(bytes) => Ok(bytes),
        _ => Err("no bytes".to_string().into()),
    }
}
