//! Promise: the picture of a table is the integral of its BRDF over the light at every pixel, without noise, and the same
//! whoever makes it; what says too little of a sphere is refused.

use std::f64::consts::PI;
use std::fs;

use glam::{DQuat, DVec3};
use gonio::campaign::SensorSide;
use gonio::files::image;
use gonio::interchange::{Brdf, Colour};
use gonio::optics::facet;
use gonio::render::light::LAMP;
use gonio::render::material_sphere::Material;
use gonio::render::sky::SoftStep;
use gonio::render::{Camera, Light, Lighting, MaterialSphere, Picture, Sky, mitsuba, picture};
use gonio::sphere::direction_deg;
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, hemisphere, steps, table};
use crate::support::campaign_text::SMALL;
use crate::support::program::{done, exits, folder, gonio, json};

/// The same above the horizon, and the same below it.
struct Even([f64; 2]);

impl Brdf for Even {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, _wi: DVec3, wo: DVec3) -> Colour {
        [self.0[usize::from(wo.z < 0.0)] / PI; 3]
    }

    fn sides(&self) -> [bool; 2] {
        [true, true]
    }
}

fn even_light(radiance: f64) -> Lighting {
    Lighting { towards: DVec3::Z, sky: Some(Sky::even([radiance; 3])), lamp: None }
}

fn material(table: &BrdfTable) -> Material {
    Material::new(table).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn a_lambert_sphere_in_an_even_light_is_as_bright_as_its_albedo() {
    let rho = 0.6;
    for phi_i in [None, Some(steps(45.0, 8))] {
        let material = material(&table(&Even([rho, 0.0]), &hemisphere(vec![0.0, 30.0, 60.0], phi_i, 9, 18)));
        let (camera, size) = (Camera::beside(0.0), 24);
        let found = picture(&MaterialSphere::new(&material), &even_light(2.0), &camera, size);
        // The sphere's edge in pixels from the middle.
        let edge = (1.0 / camera.distance).asin().tan() / camera.half * 0.5 * size as f64;
        for (k, pixel) in found.pixels.iter().enumerate() {
            let [x, y] = [k % size, k / size].map(|place| place as f64 + 0.5 - 0.5 * size as f64);
            let from_middle = x.hypot(y);
            if (from_middle - edge).abs() > 1.0 {
                let wanted = if from_middle < edge { 2.0 * rho } else { 2.0 };
                // The rule integrates the cosine exactly; values and weights are f32, 6e-8 each, and the interpolant takes its
                // scale from sums of some hundred of them.
                assert!(pixel.iter().all(|value| (value / wanted - 1.0).abs() < 1e-6), "{k}: {pixel:?}");
            }
        }
    }
}

#[test]
fn nearly_a_mirror_shows_the_sky_in_the_mirror_direction() {
    let table = table(&Ggx::new(0.02, 0.02), &hemisphere(steps(15.0, 6), None, 90, 180));
    let material = material(&table);
    let sphere = MaterialSphere::new(&material);
    let step = SoftStep { axis: [0.6, 0.0, 0.8], centre: 0.2, width: 0.25, colour: [1.0; 3] };
    let sky = Sky { base: [0.1; 3], steps: vec![step] };
    let light = Lighting { towards: DVec3::Z, sky: Some(sky.clone()), lamp: None };
    for (theta, phi) in [(0.0, 0.0), (20.0, 70.0), (45.0, 200.0), (65.0, 300.0)] {
        let (place, eye) = (direction_deg(40.0, 130.0), direction_deg(theta, phi));
        let eye = DQuat::from_rotation_arc(DVec3::Z, place) * eye;
        let mirror = 2.0 * place.dot(eye) * place - eye;
        let (found, wanted) = (sphere.seen(&light, place, eye)[0], sky.radiance(mirror)[0]);
        // The step's second derivative is below 0.1/width^2 = 1.6. Facets of tilt t turn the light by 2 t, and the share
        // of them beyond t is alpha^2/(alpha^2 + t^2): 1.6/2 * E[(2 t)^2 up to 1] < 0.8 * 4 alpha^2 ln(1/(2 alpha))
        // * 2 = 0.01; bins of 2 degrees add a tenth of that, and masking at 65 degrees alpha^2 tan^2/2 = 1e-3.
        assert!((found - wanted).abs() < 0.012, "theta {theta}: {found}, sky {wanted}");
    }
}

#[test]
fn an_isotropic_sphere_turns_with_its_light() {
    let table = table(&Ggx::new(0.3, 0.3), &hemisphere(steps(15.0, 6), None, 18, 36));
    let material = material(&table);
    let sphere = MaterialSphere::new(&material);
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let light = Lighting::new(Light::Both, [45.0, 20.0]);
    let mut turned = light.clone();
    turned.towards = turn * light.towards;
    if let Some(sky) = &mut turned.sky {
        sky.steps.iter_mut().for_each(|step| step.axis = (turn * DVec3::from_array(step.axis)).to_array());
    }
    for (theta, phi) in [(10.0, 0.0), (50.0, 90.0), (80.0, 250.0)] {
        let (place, eye) = (direction_deg(theta, phi), direction_deg(40.0, 60.0));
        if place.dot(eye) > 0.05 {
            let found = sphere.seen(&turned, turn * place, turn * eye);
            // Roundings of f64 in directions, 1e-15, times slopes of weights of up to 1e4.
            let off = found.iter().zip(sphere.seen(&light, place, eye)).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{theta} {phi}");
        }
    }
}

#[test]
fn the_lamp_shines_with_its_irradiance() {
    let material = material(&table(&Even([0.5, 0.0]), &hemisphere(vec![0.0, 30.0, 60.0], None, 9, 18)));
    let sphere = MaterialSphere::new(&material);
    let light = Lighting::new(Light::Lamp, [50.0, 0.0]);
    let eye = direction_deg(10.0, 90.0);
    // Lambert: rho/pi E cos, with E = pi; f32 values.
    assert_eq!(LAMP, [PI; 3]);
    let found = sphere.seen(&light, DVec3::Z, eye)[0];
    assert!((found / (0.5 * 50f64.to_radians().cos()) - 1.0).abs() < 1e-6, "{found}");
    assert_eq!(sphere.seen(&light, direction_deg(141.0, 0.0), direction_deg(141.0, 0.0)), [0.0; 3]);
}

#[test]
fn glass_shows_the_light_that_its_far_side_lets_in() {
    let grid = hemisphere(vec![0.0, 30.0, 60.0], None, 18, 36).of_side(SensorSide::Both);
    assert!(grid.looks_below());
    let (rho, tau) = (0.2, 0.7);
    let mut table = table(&Even([rho, tau]), &grid);
    table.campaign = SMALL.replace("[stop]", "[optics]\nfacet = \"dielectric\"\neta = 1.5\n[stop]") + "\n";
    let material = material(&table);
    let sphere = MaterialSphere::new(&material);
    assert!(material.in_words().contains("1.5 times the index"), "{}", material.in_words());
    let found = sphere.seen(&even_light(1.0), DVec3::Z, direction_deg(20.0, 0.0))[0];
    // Of directions by Lambert's law within, those below the critical angle bring 1 - F^3 (three turns): Simpson's rule in
    // x = sin^2, smooth but for its end, where F has a root: 400 intervals leave 1e-4.
    let clear = |x: f64| {
        let w = DVec3::new(x.sqrt(), 0.0, (1.0 - x).sqrt());
        1.0 - facet::split(w, DVec3::Z, 1.0 / 1.5).reflectance.powi(3)
    };
    let (count, end) = (400, 1.0 / 2.25);
    let rule = |k: i32| if k == 0 || k == count { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
    let sum: f64 = (0..=count).map(|k| rule(k) * clear(end * f64::from(k) / f64::from(count))).sum();
    let wanted = rho + tau * sum * end / f64::from(count) / 3.0;
    // 192 even directions of 576 meet the edge at the critical angle: one of them on the wrong side is 0.5 % of tau.
    assert!((found - wanted).abs() < 0.02 * tau, "{found}, {wanted}");
}

#[test]
fn a_picture_is_srgb_of_its_radiances() {
    let pixels = vec![[0.0, 1.0, 2.0], [0.5, 0.18, 0.002], [0.25; 3], [0.0; 3]];
    let picture = Picture { size: 2, pixels };
    let decoded = |exposure: f64| {
        let bytes = picture.png(exposure).expect("written");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let mut out = vec![0; reader.output_buffer_size().expect("small")];
        let info = reader.next_frame(&mut out).expect("one picture");
        assert_eq!((info.width, info.height, info.color_type), (2, 2, png::ColorType::Rgb));
        out
    };
    // IEC 61966-2-1 by hand: 0.5 -> 0.735357, 0.18 -> 0.461356, 0.002 -> 0.02584, 0.25 -> 0.537099, times 255.
    assert_eq!(decoded(0.0), [0, 255, 255, 188, 118, 7, 137, 137, 137, 0, 0, 0]);
    assert_eq!(decoded(2.0)[6..9], [255; 3]);
    assert_eq!(picture.clipped(0.0), 0.25);
}

#[test]
fn a_scene_for_mitsuba_is_the_picture_in_other_words() {
    let (light, camera) = (Lighting::new(Light::Both, [45.0, 0.0]), Camera::beside(0.0));
    let scene = mitsuba::scene(&light, &camera, 300);
    // 2 atan(0.25) in degrees; the lamp comes from (1, 0, 1)/sqrt 2.
    for words in [
        "name=\"fov\" value=\"28.07",
        "x=\"-0.7071",
        "y=\"-0\"",
        "3.141592653589793, 3.1",
        "value=\"300\"",
        "envmap",
    ] {
        assert!(scene.contains(words), "{words}: {scene}");
    }
    let sky = light.sky.expect("a sky");
    let part = image::decode_one(&mitsuba::sky_map(&sky).expect("a map")).expect("an EXR");
    assert_eq!(part.width, 2 * part.height);
    // Rows from the zenith; the column at a quarter is azimuth 0 (u = 0.25: 90 - 360 u), the first one 90 degrees.
    for (column, phi) in [(0.0, 90.0), (0.25, 0.0), (0.5, 270.0)] {
        let theta = 180.0 * 100.5 / part.height as f64;
        let at = 100 * part.width + (column * part.width as f64) as usize;
        let wanted = sky.radiance(direction_deg(theta, phi - 180.0 / part.width as f64));
        let image::Samples::F32(green) = &part.channels["G"] else { panic!("f32") };
        // f32.
        assert!((f64::from(green[at]) / wanted[1] - 1.0).abs() < 1e-6, "{phi}: {} {wanted:?}", green[at]);
    }
}

#[test]
fn the_command_makes_the_same_bytes_on_any_number_of_threads_and_refuses_what_is_no_sphere() {
    let folder = folder(SMALL);
    let run = |words: &[&str]| gonio(folder.path(), words);
    done(&run(&["measure", "small.toml", "-o", "out"]));
    let render = |more: &[&str]| run(&[&["render", "out/small.exr", "--size", "32"], more].concat());
    let said = done(&render(&["-o", "one.png", "--threads", "1"]));
    assert!(
        said.contains("one.png (32 x 32") && said.contains("a soft sky, brightest at theta 45"),
        "{said}"
    );
    done(&render(&["-o", "two.png", "--threads", "2"]));
    let bytes = |name: &str| fs::read(folder.path().join(name)).expect("written");
    assert!(bytes("one.png") == bytes("two.png"), "threads change the picture");
    done(&render(&["-o", "lamp.png", "--light", "lamp", "--exposure=-1"]));
    assert!(bytes("one.png") != bytes("lamp.png"));
    assert!(exits(&render(&["-o", "one.png"]), 3).contains("is there already; --force replaces it"));
    done(&render(&["-o", "one.png", "--force"]));
    assert!(exits(&render(&["-o", "out/small.exr", "--force"]), 3).contains("is the file that is read"));
    let answer = json(&render(&["-o", "one.png", "--force", "--json"]));
    assert!(
        answer["picture"] == "one.png" && answer["size"] == 32 && answer["clipped"].is_number(),
        "{answer}"
    );
    for (words, said) in [
        (&["-o", "x.png", "--at", "200,0"][..], "as 45,0"),
        (&["-o", "x.png", "--light", "sun"], "sky, lamp or both needed"),
        (&["-o", "x.png", "--exposure", "50"], "must lie in [-20, 20]"),
        (&["-o", "x.png", "--scene", "blender"], "mitsuba"),
        (&["-o", "x.jpg"], "a picture is a PNG: name it .png"),
        (&["-o", "x.png", "--scene", "mitsuba"], "a scene is a folder"),
    ] {
        let error = exits(&render(words), 2);
        assert!(error.contains(said), "{said}: {error}");
    }
    let said = done(&render(&["-o", "scene", "--scene", "mitsuba"]));
    assert!(said.contains("sky.exr, table.bsdf, scene.xml in scene"), "{said}");
    assert!(bytes("scene/table.bsdf").starts_with(b"tensor_file"));
    assert!(exits(&render(&["-o", "scene", "--scene", "mitsuba"]), 3).contains("sky.exr"));
    let arm = SMALL.replace("\"small\"", "\"arm\"").replace(
        "[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n",
        "[sensor.arm]\ntheta_r_deg = [-30, 0, 30, 50]\nphi_r_deg = [180]\naperture_deg = 5\n",
    );
    fs::write(folder.path().join("arm.toml"), arm).expect("campaign");
    done(&run(&["measure", "arm.toml", "-o", "out"]));
    let error = exits(&run(&["render", "out/arm.exr", "-o", "x.png"]), 4);
    assert!(error.contains("out/arm.exr") && error.contains("measure with [sensor.hemisphere]"), "{error}");
    assert!(!folder.path().join("x.png").exists());
}
