//! The polar plot: every lobe of one azimuth of the light over a half circle, each to its own peak.

use super::drawing::{Drawing, escaped, metadata, path, picture};
use super::style::{MEASURED, model_style};
use crate::report::slices::Scene;

const RADIUS: f64 = 200.0;
const CENTRE: [f64; 2] = [240.0, 262.0];
const HEIGHT: f64 = 330.0;

/// The picture; `None` where fewer than two bins lie in the plane. The model is the one with the masking `masking`.
pub fn polar(scene: &Scene, incidences: &[usize], masking: usize) -> Option<String> {
    let lobes: Vec<PolarLobe> =
        incidences.iter().filter_map(|&incidence| PolarLobe::of(scene, incidence, masking)).collect();
    let first = *incidences.first()?;
    if lobes.is_empty() {
        return None;
    }
    let (_, phi) = scene.table.grid.incidence_deg(first);
    let azimuth = if scene.has_azimuths() { format!(", phi_i {phi}°") } else { String::new() };
    let title = format!("Polar plot in the plane of incidence{azimuth}");
    let mut out = Drawing::default();
    out.add(format_args!("<g transform=\"translate({} {})\">", CENTRE[0], CENTRE[1]));
    rings(&mut out);
    lobes.iter().for_each(|lobe| lobe.draw(&mut out));
    out.add("</g>");
    let model = scene.maskings().get(masking).cloned();
    legend(&mut out, model.as_deref());
    let data: Vec<String> = lobes.iter().flat_map(PolarLobe::data).collect();
    let data = metadata(&[vec!["theta_i_deg,series,theta_r_deg,share of the peak".into()], data].concat());
    Some(picture(&title, [480.0, HEIGHT], &(data + &out.text())))
}

/// A place from signed polar angle and radius.
fn place(theta_deg: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    [radius * sin, -radius * cos]
}

fn rings(out: &mut Drawing) {
    for part in [0.25, 0.5, 0.75, 1.0] {
        let r = RADIUS * part;
        out.add(format_args!(
            "<path class=\"grid\" fill=\"none\" d=\"M{:.1} 0A{r:.1} {r:.1} 0 0 1 {r:.1} 0\"/>",
            -r
        ));
    }
    for theta in (-90..=90).step_by(30) {
        let [x, y] = place(f64::from(theta), RADIUS);
        let [u, v] = place(f64::from(theta), RADIUS + 14.0);
        out.add(format_args!(
            "<path class=\"grid\" d=\"M0 0L{x:.1} {y:.1}\"/>\
             <text x=\"{u:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{theta}°</text>",
            v + 5.0
        ));
    }
}

struct PolarLobe {
    theta_i_deg: f64,
    /// (theta_r, share of the peak).
    measured: Vec<[f64; 2]>,
    model: Vec<[f64; 2]>,
    peak_deg: f64,
}

impl PolarLobe {
    fn of(scene: &Scene, incidence: usize, masking: usize) -> Option<PolarLobe> {
        let cuts = scene.in_plane(incidence);
        let peak = cuts
            .iter()
            .max_by(|a, b| scene.single(incidence, a.bin).total_cmp(&scene.single(incidence, b.bin)))?;
        let highest = scene.single(incidence, peak.bin);
        if cuts.len() < 2 || highest <= 0.0 {
            return None;
        }
        let curve = |value: &dyn Fn(usize) -> Option<f64>| {
            cuts.iter().filter_map(|cut| Some([cut.theta_deg, value(cut.bin)? / highest])).collect::<Vec<_>>()
        };
        Some(PolarLobe {
            theta_i_deg: scene.table.grid.incidence_deg(incidence).0,
            measured: curve(&|bin| Some(scene.single(incidence, bin))),
            model: curve(&|bin| scene.model(masking, incidence, bin)),
            peak_deg: peak.theta_deg,
        })
    }

    /// Lines of CSV.
    fn data(&self) -> Vec<String> {
        let of = |name: &'static str, points: &[[f64; 2]]| {
            let line = |&[theta, share]: &[f64; 2]| {
                format!("{},{name},{},{}", self.theta_i_deg, theta as f32, share as f32)
            };
            points.iter().map(line).collect::<Vec<_>>()
        };
        [of("measured", &self.measured), of("model", &self.model)].concat()
    }

    fn draw(&self, out: &mut Drawing) {
        let curve = |points: &[[f64; 2]]| {
            let point = |&[theta, share]: &[f64; 2]| place(theta, RADIUS * share.min(1.2));
            path(&points.iter().map(point).collect::<Vec<_>>())
        };
        let (measured, model) = (curve(&self.measured), curve(&self.model));
        let style = model_style(1);
        out.add(format_args!(
            "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" points=\"{measured}\"/>",
            MEASURED.colour
        ));
        if !self.model.is_empty() {
            out.add(format_args!(
                "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"{}\" points=\"{model}\"/>",
                style.colour, style.dashes
            ));
        }
        let [x, y] = place(self.peak_deg, RADIUS - 16.0);
        out.add(format_args!(
            "<text class=\"halo\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-size=\"12\">{}</text>",
            self.theta_i_deg
        ));
    }
}

fn legend(out: &mut Drawing, model: Option<&str>) {
    let y = HEIGHT - 34.0;
    out.add(format_args!(
        "<path stroke=\"{}\" stroke-width=\"1.6\" d=\"M12 {y}h34\"/><text x=\"54\" y=\"{}\">measured</text>",
        MEASURED.colour,
        y + 5.0
    ));
    if let Some(model) = model {
        let style = model_style(1);
        out.add(format_args!(
            "<path stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"{}\" d=\"M150 {y}h34\"/>\
             <text x=\"192\" y=\"{}\">{}</text>",
            style.colour,
            style.dashes,
            y + 5.0,
            escaped(model)
        ));
    }
    out.add(format_args!(
        "<text x=\"12\" y=\"{}\">radius: share of the lobe's own peak; numbers: theta_i</text>",
        y + 27.0
    ));
}
