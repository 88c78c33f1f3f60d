//! The table as the page's pictures and its viewer take it: half floats in base64, reduced where it is large.
//!
//! Input: a scene. Output: JSON with the axes of what is drawn and one block of halfs for each layer,
//! \[colour\]\[incidence\]\[theta_r\]\[phi_r\] or \[colour\]\[incidence\]\[direction\], values over `scale`; below 0: nothing was measured.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;
use serde_json::{Value, json};

use super::page::Page;
use super::shown::{DrawnHemisphere, Places, Raster, shown};
use crate::campaign::{Campaign, SurfaceKind};
use crate::render::shown_colours;
use crate::report::plot::plots::spread;
use crate::report::slices::Scene;
use crate::table::BrdfTable;

/// Bytes of all layers in base64 that a page holds at most: its rest is below 1 MB.
pub const LARGEST: usize = 4_500_000;
/// Bins are merged down to about so many rows and columns before incidences are left out.
const FEWEST: [usize; 2] = [24, 48];
/// Light angles and azimuths that the viewer interpolates between.
const MOST_INCIDENCES: usize = 64;
/// Stands where nothing was measured; BRDFs are not negative.
const ABSENT: f64 = -1.0;
/// Largest half float that stored values may reach.
const HALF: f64 = 32_768.0;

/// What the page holds of a table.
pub struct Inline {
    /// For the script.
    pub data: Value,
    /// What was left out, in words; empty where nothing was.
    pub notes: Vec<String>,
    /// Whether the sensor's directions are too few to make a hemisphere.
    pub spots: bool,
}

/// How a table is reduced.
#[derive(Debug, Clone, PartialEq)]
struct Reduction {
    /// Rows and columns merged into one.
    merge: [usize; 2],
    /// The light angles and azimuths that are kept.
    theta: Vec<usize>,
    phi: Vec<usize>,
    /// The maskings that are kept.
    maskings: Vec<usize>,
    /// The colours that are shown.
    colours: Vec<usize>,
}

/// The table and its models for the page in so many bytes; `None` for grids that it does not know. Where there is room for one
/// model only, it is that of the page's masking.
pub fn inline(page: &Page, largest: usize) -> Option<Inline> {
    let (scene, campaign, masking) = (&page.scene, page.campaign, page.masking_index());
    let shown =
        shown(&scene.table.grid, scene.table.gaps() > 0).filter(|shown| !shown.incidences.is_empty())?;
    let (plan, notes) = reduction(page, &shown, largest);
    let notes = [shown.notes.clone(), notes].concat();
    let layers = layers(page, &shown, &plan);
    let highest = layers.iter().flat_map(|layer| &layer.values).copied().fold(0.0, f64::max);
    let scale = if highest > HALF { 2f64.powf((highest / HALF).log2().ceil()) } else { 1.0 };
    let pick = |values: &[f64], which: &[usize]| which.iter().map(|&k| values[k]).collect::<Vec<_>>();
    let alpha = campaign.and_then(|campaign| campaign.alphas().first().copied().flatten());
    let mut data = json!({
        "colours": shown_names(scene.table, &plan.colours),
        "theta_i": pick(&shown.theta_i_deg, &plan.theta),
        "phi_i": pick(&shown.phi_i_deg, &plan.phi),
        "relative": scene.table.grid.phi_r_relative,
        "mirrored": campaign.is_some_and(|campaign| is_mirrored(campaign, &shown, scene)),
        "rotation": campaign.map_or(0.0, |campaign| campaign.surface.rotation_deg),
        "alpha": alpha.map(|alpha| [alpha.x, alpha.y]),
        "scale": scale,
        "chosen": scene.maskings().get(masking).map(|name| model_name(name)),
        "layers": layers.iter().map(|layer| layer.json(scale)).collect::<Vec<_>>(),
    });
    let spots = matches!(shown.sensor, Places::Spots { .. });
    match &shown.sensor {
        Places::Bins(raster) => {
            data["theta_edges"] = json!(merged_edges(&raster.theta_deg, plan.merge[0]));
            data["phi_edges"] = json!(merged_edges(&raster.phi_deg, plan.merge[1]));
            if let Some([theta, phi]) = raster.nodes_deg.as_ref().filter(|_| plan.merge == [1, 1]) {
                data["theta_nodes"] = json!(theta);
                data["phi_nodes"] = json!(phi);
            }
        }
        Places::Spots { directions_deg, aperture_deg, step } => {
            data["spots"] = json!({ "directions": directions_deg, "aperture": aperture_deg, "step": step });
        }
    }
    Some(Inline { data, notes, spots })
}

/// Whether azimuths of the light that were not measured follow from those that were: the law of the surface is its
/// own mirror image about both axes of the sample.
fn is_mirrored(campaign: &Campaign, shown: &DrawnHemisphere, scene: &Scene) -> bool {
    let symmetric = !matches!(campaign.surface.kind, SurfaceKind::File(_));
    let (first, last) = (shown.phi_i_deg[0], shown.phi_i_deg[shown.phi_i_deg.len() - 1]);
    symmetric && !scene.table.grid.phi_r_relative && last - first < 180.0
}

fn shown_names(table: &BrdfTable, colours: &[usize]) -> Vec<String> {
    match colours.len() {
        1 => vec!["Y".into()],
        3 => ["R", "G", "B"].map(String::from).to_vec(),
        _ => table.colour_names(),
    }
}

/// Merges bins, leaves out incidences, until the layers fit.
fn reduction(page: &Page, shown: &DrawnHemisphere, largest: usize) -> (Reduction, Vec<String>) {
    let (scene, masking) = (&page.scene, page.masking_index());
    let [rows, columns] = match &shown.sensor {
        Places::Bins(raster) => [raster.theta_deg.len() - 1, raster.phi_deg.len() - 1],
        Places::Spots { directions_deg, .. } => [1, directions_deg.len()],
    };
    let spots = matches!(shown.sensor, Places::Spots { .. });
    let all = |count: usize| spread(count, MOST_INCIDENCES);
    let maskings = (0..scene.maskings().len()).collect::<Vec<_>>();
    let (theta, phi) = (all(shown.theta_i_deg.len()), all(shown.phi_i_deg.len()));
    let colours = shown_colours(scene.table);
    let mut plan = Reduction { merge: [1, 1], theta, phi, maskings, colours };
    let measured = 1 + usize::from(scene.has_multiple()) + usize::from(page.best.is_some());
    let bytes = |plan: &Reduction| {
        let bins = rows.div_ceil(plan.merge[0]) * columns.div_ceil(plan.merge[1]);
        let values = bins * plan.theta.len() * plan.phi.len() * plan.colours.len();
        values * (measured + plan.maskings.len()) * 2 * 4 / 3
    };
    let mut notes = Vec::new();
    if plan.colours.len() < scene.table.colours.len() {
        let names = scene.table.colour_names();
        let shown: Vec<&str> = plan.colours.iter().map(|&colour| names[colour].as_str()).collect();
        notes.push(format!("of {} wavelengths only {}", names.len(), shown.join(", ")));
    }
    if bytes(&plan) > largest && plan.maskings.len() > 1 {
        plan.maskings = vec![masking];
        notes.push(format!("only the model with {} masking", scene.maskings()[masking]));
    }
    while bytes(&plan) > largest {
        let [merged_rows, merged_columns] = [rows.div_ceil(plan.merge[0]), columns.div_ceil(plan.merge[1])];
        if !spots && (merged_rows > FEWEST[0] || merged_columns > FEWEST[1]) {
            plan.merge[usize::from(merged_columns * FEWEST[0] >= merged_rows * FEWEST[1])] += 1;
        } else if plan.phi.len() >= plan.theta.len() && plan.phi.len() > 2 {
            plan.phi = spread(shown.phi_i_deg.len(), plan.phi.len() - 1);
        } else if plan.theta.len() > 2 {
            plan.theta = spread(shown.theta_i_deg.len(), plan.theta.len() - 1);
        } else {
            break;
        }
    }
    if plan.merge != [1, 1] {
        notes.push(format!("{} x {} bins merged into one", plan.merge[0], plan.merge[1]));
    }
    let kept = plan.theta.len() * plan.phi.len();
    if kept < shown.incidences.len() {
        notes.push(format!("{kept} of {} light directions", shown.incidences.len()));
    }
    (plan, notes)
}

/// Every `merge`th edge, and the last.
fn merged_edges(edges: &[f64], merge: usize) -> Vec<f64> {
    let last = edges.len() - 1;
    let mut kept: Vec<f64> = edges[..last].iter().step_by(merge).copied().collect();
    kept.push(edges[last]);
    kept
}

fn model_name(masking: &str) -> String {
    format!("model, {masking}")
}

struct Layer {
    name: String,
    kind: &'static str,
    values: Vec<f64>,
}

impl Layer {
    fn json(&self, scale: f64) -> Value {
        let halfs = self.values.iter().map(|value| f16::from_f64(value / scale));
        let bytes: Vec<u8> = halfs.flat_map(f16::to_le_bytes).collect();
        json!({ "name": self.name, "kind": self.kind, "data": STANDARD.encode(bytes) })
    }
}

fn layers(page: &Page, shown: &DrawnHemisphere, plan: &Reduction) -> Vec<Layer> {
    let scene = &page.scene;
    let table = scene.table;
    let bins = table.grid.bins();
    let stored = |pick: &dyn Fn(usize, usize) -> f32| {
        let value = |colour: usize, entry: usize| {
            if table.is_gap(entry) { ABSENT } else { f64::from(pick(colour, entry)) }
        };
        reduced(shown, plan, &|colour, incidence, bin| value(colour, incidence * bins + bin))
    };
    let single = stored(&|colour, at| table.colours[colour].single[at]);
    let mut layers = vec![Layer { name: "measured".into(), kind: "measured", values: single }];
    if scene.has_multiple() {
        layers[0].name = "measured, order 1".into();
        let values = stored(&|colour, at| table.colours[colour].total[at]);
        layers.push(Layer { name: "measured, all orders".into(), kind: "measured", values });
    }
    if let Some(prediction) = scene.prediction {
        for &index in &plan.maskings {
            let value = |colour: usize, incidence: usize, bin: usize| {
                prediction.means[incidence].values[index][colour][bin]
            };
            let name = model_name(&scene.maskings()[index]);
            layers.push(Layer { name, kind: "model", values: reduced(shown, plan, &value) });
        }
    }
    if let Some(best) = &page.best {
        let value = |colour: usize, incidence: usize, bin: usize| best.means[colour][incidence * bins + bin];
        let name = format!("best fit, {}", best.name);
        layers.push(Layer { name, kind: "fit", values: reduced(shown, plan, &value) });
    }
    layers
}

/// [colour][stop][bin] after the reduction.
fn reduced(
    shown: &DrawnHemisphere,
    plan: &Reduction,
    value: &dyn Fn(usize, usize, usize) -> f64,
) -> Vec<f64> {
    let columns = shown.phi_i_deg.len();
    let incidences = plan.theta.iter().flat_map(|t| plan.phi.iter().map(move |p| t * columns + p));
    let incidences: Vec<usize> = incidences.map(|place| shown.incidences[place]).collect();
    let mut values = Vec::new();
    for &colour in &plan.colours {
        for &incidence in &incidences {
            let here = |bin: usize| value(colour, incidence, bin);
            match &shown.sensor {
                Places::Bins(raster) => values.extend(merged(raster, plan.merge, &here)),
                Places::Spots { directions_deg, .. } => values.extend((0..directions_deg.len()).map(here)),
            }
        }
    }
    values
}

/// Means over merged cells by projected solid angle; `ABSENT` where nothing was measured.
fn merged(raster: &Raster, [by_row, by_column]: [usize; 2], value: &dyn Fn(usize) -> f64) -> Vec<f64> {
    let sizes = raster.sizes();
    let [rows, columns] = [raster.theta_deg.len() - 1, raster.phi_deg.len() - 1];
    let mut values = Vec::new();
    for row in (0..rows).step_by(by_row) {
        for column in (0..columns).step_by(by_column) {
            let (mut flux, mut size) = (0.0, 0.0);
            for r in row..(row + by_row).min(rows) {
                for c in column..(column + by_column).min(columns) {
                    let value = raster.source[r * columns + c].map(value).filter(|&value| value != ABSENT);
                    if let Some(value) = value {
                        flux += sizes[r * columns + c] * value;
                        size += sizes[r * columns + c];
                    }
                }
            }
            values.push(if size > 0.0 { flux / size } else { ABSENT });
        }
    }
    values
}
