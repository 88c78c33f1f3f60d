//! The same scene for Mitsuba 3: the sphere with the table as `measured`, the sky as a map, lamp and camera.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::camera::Camera;
use super::light::Lighting;
use super::sky::Sky;
use crate::error::Checked;
use crate::files::image::{self, ImagePart, Samples};

/// Rows of the sky's map, half as many as columns: its softest edges are three rows wide.
const ROWS: usize = 512;
/// Rays for each pixel.
const SAMPLES: usize = 256;
/// Names of the files that belong together.
pub const SCENE: &str = "scene.xml";
/// The sky.
pub const SKY: &str = "sky.exr";
/// The table.
pub const TABLE: &str = "table.bsdf";

/// The sky over (azimuth, polar angle), EXR. The column u of [0, 1) has the azimuth 90 degrees - 360 u, as Mitsuba's
/// `envmap` has it when its y axis is turned to z; pixels hold the values at their middles.
pub fn sky_map(sky: &Sky) -> Checked<Vec<u8>> {
    let columns = 2 * ROWS;
    let at = |pixel: usize| {
        let theta = PI * ((pixel / columns) as f64 + 0.5) / ROWS as f64;
        let phi = TAU * ((pixel % columns) as f64 + 0.5) / columns as f64;
        let (sin, cos) = theta.sin_cos();
        sky.radiance(DVec3::new(sin * phi.sin(), sin * phi.cos(), cos))
    };
    let values: Vec<[f64; 3]> = (0..columns * ROWS).map(at).collect();
    let channel = |c: usize| Samples::F32(values.iter().map(|value| value[c] as f32).collect());
    let channels = ["R", "G", "B"].iter().enumerate().map(|(c, name)| (name.to_string(), channel(c)));
    let part = ImagePart {
        width: columns,
        height: ROWS,
        channels: channels.collect::<BTreeMap<_, _>>(),
        ..ImagePart::default()
    };
    Ok(image::encode(vec![part])?)
}

/// The scene that names the sky's map and the table next to it. The sphere is convex: one scattering is all there is.
// Tested by `a_scene_for_mitsuba_is_the_picture_in_other_words` (tests/it/render.rs), and against the picture in tests/interop.
pub fn scene(light: &Lighting, camera: &Camera, size: usize) -> String {
    let eye = camera.eye();
    let fov = 2.0 * camera.half.atan().to_degrees();
    let mut lights = String::new();
    if light.sky.is_some() {
        lights += &format!(
            "    <emitter type=\"envmap\">\n        <string name=\"filename\" value=\"{SKY}\"/>\n        \
             <transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/></transform>\n    </emitter>\n"
        );
    }
    if let Some([r, g, b]) = light.lamp {
        let DVec3 { x, y, z } = -light.towards;
        lights += &format!(
            "    <emitter type=\"directional\">\n        <vector name=\"direction\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>\n        \
             <rgb name=\"irradiance\" value=\"{r}, {g}, {b}\"/>\n    </emitter>\n"
        );
    }
    format!(
        r#"<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <float name="fov" value="{fov}"/>
        <transform name="to_world">
            <lookat origin="{}, {}, {}" target="0, 0, 0" up="0, 0, 1"/>
        </transform>
        <sampler type="independent"><integer name="sample_count" value="{SAMPLES}"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="{size}"/>
            <integer name="height" value="{size}"/>
            <string name="pixel_format" value="rgb"/>
            <rfilter type="box"/>
        </film>
    </sensor>
{lights}    <shape type="sphere">
        <bsdf type="measured"><string name="filename" value="{TABLE}"/></bsdf>
    </shape>
</scene>
"#,
        eye.x, eye.y, eye.z
    )
}
