//! The certificates of a set of patches in words: a row for each, and what all of them say together.

use serde::Serialize;

use crate::cli::text::layout::columns;
use crate::cli::text::numbers::or_na;
use crate::stats;
use crate::surface::Certificate;
use crate::surface::grains::GrainFigures;
use crate::surface::io::import::ImportedMap;

/// Level of the test for preferred azimuths, over all harmonics together.
const LEVEL: f64 = 0.01;
const HARMONICS: [&str; 4] = ["cos psi", "sin psi", "cos 2 psi", "sin 2 psi"];

/// The certificate of one patch and where it is.
#[derive(Serialize)]
pub struct PatchEntry {
    /// Its file.
    pub file: String,
    /// SHA-256 over the heights.
    pub heights_sha256: String,
    /// What it says.
    #[serde(flatten)]
    pub certificate: Certificate,
    /// Of grains, what they are before they become heights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grains: Option<GrainFigures>,
}

/// What all patches together show.
#[derive(Serialize)]
pub struct Pooled {
    /// Kolmogorov-Smirnov distance of all facets from the wanted law.
    ks: Option<f64>,
    /// Azimuth harmonics of the slopes: mean over patches, tested against 0.
    harmonics: Vec<PooledHarmonic>,
    /// Degrees of freedom of t.
    dof: usize,
    /// What |t| of an even set exceeds, in any harmonic, with probability 1 %.
    t_limit: Option<f64>,
}

#[derive(Serialize)]
struct PooledHarmonic {
    name: &'static str,
    mean: f64,
    se: Option<f64>,
    t: Option<f64>,
    rejected: Option<bool>,
}

impl Pooled {
    /// Means and tests over the patches; `ks` is that of all facets.
    pub fn of(entries: &[PatchEntry], ks: Option<f64>) -> Self {
        let dof = entries.len().saturating_sub(1);
        let level = stats::sidak(LEVEL, HARMONICS.len());
        let t_limit = (dof > 0).then(|| stats::student_limit(level, dof));
        let harmonic = |(k, &name): (usize, &&'static str)| {
            let values = entries.iter().map(|entry| entry.certificate.azimuth_harmonics.as_flattened()[k]);
            let (mean, se) = stats::mean_and_se(values);
            let t = se.filter(|se| *se > 0.0).map(|se| mean / se);
            let rejected = t.zip(t_limit).map(|(t, limit)| t.abs() > limit);
            PooledHarmonic { name, mean, se, t, rejected }
        };
        Pooled { ks, harmonics: HARMONICS.iter().enumerate().map(harmonic).collect(), dof, t_limit }
    }
}

/// How many cells a ray of the light can cross before it is above the patch.
#[derive(Serialize)]
pub struct RayBound {
    /// World slope per canonical slope; `null` of a map, which has no roughness of its own.
    alpha_x: Option<f64>,
    alpha_y: Option<f64>,
    theta_i_deg: f64,
    /// At most so many.
    cells: f64,
}

impl RayBound {
    /// For each roughness the steepest incidence: range x alpha tan(theta) + 2 edges along an axis.
    ///
    /// In canonical cells a ray that climbs by 1 runs (alpha_x tan cos phi, alpha_y tan sin phi); along each axis it
    /// crosses one edge a cell, so the two add up to at most tan hypot(alpha_x, alpha_y) at the worst azimuth, and to
    /// alpha tan along an axis. `range`: of the highest patch; `alphas`: world slope per canonical slope, which are not
    /// repeated where they are those of a `map`.
    // Tested by `the_bound_on_cells_per_ray_is_printed` (tests/it/cli.rs).
    pub fn of(range: f64, alphas: &[[f64; 2]], map: bool, theta_i_deg: &[f64]) -> Vec<Self> {
        let steepest = theta_i_deg.iter().copied().fold(0.0, f64::max);
        let tan = steepest.to_radians().tan();
        let bound = |&[alpha_x, alpha_y]: &[f64; 2]| RayBound {
            alpha_x: (!map).then_some(alpha_x),
            alpha_y: (!map).then_some(alpha_y),
            theta_i_deg: steepest,
            cells: (range * alpha_x.hypot(alpha_y) * tan + 2.0).ceil(),
        };
        alphas.iter().map(bound).collect()
    }

    /// A line for each roughness.
    pub fn lines(bounds: &[Self]) -> Vec<String> {
        let line = |bound: &RayBound| {
            let RayBound { alpha_x, alpha_y, theta_i_deg, cells } = bound;
            let alpha = match (alpha_x, alpha_y) {
                (Some(x), Some(y)) if x == y => format!("alpha {x}, "),
                (Some(x), Some(y)) => format!("alpha {x} x {y}, "),
                _ => String::new(),
            };
            format!("rays    {alpha}light at {theta_i_deg}: at most {cells} cells")
        };
        if bounds.iter().all(|bound| bound.alpha_x.is_none()) {
            return bounds.iter().map(line).collect();
        }
        let formula =
            "rays    range x hypot(alpha_x, alpha_y) tan(theta) + 2 cells to climb over the highest patch";
        [formula.to_string()].into_iter().chain(bounds.iter().map(line)).collect()
    }
}

/// What a measured map is, in lengths and slopes that are ratios of lengths.
#[derive(Serialize)]
pub struct MapFigures {
    /// What one unit of height is; `null` where neither campaign nor file says.
    unit_um: Option<f64>,
    /// Size along x and y.
    size_um: Option<[f64; 2]>,
    /// Distance of neighbouring columns and rows, as refined.
    pitch_um: Option<[f64; 2]>,
    /// Cells for each of the file's own along a side.
    refine: usize,
    /// Root mean square height.
    sq_um: Option<f64>,
    /// Root mean square slope.
    sdq: f64,
    /// Median slope.
    median_slope: f64,
    /// Size, pitch and Sq in the unit of the heights.
    #[serde(skip)]
    own: ([f64; 2], [f64; 2], f64),
}

impl MapFigures {
    /// Of a map with this median slope.
    pub fn of(map: &ImportedMap, median_slope: f64) -> Self {
        let own = (map.size(), map.pitch(), map.sq());
        let um = |length: f64| map.unit_um.map(|unit| unit * length);
        let both = |[x, y]: [f64; 2]| um(x).zip(um(y)).map(|(x, y)| [x, y]);
        MapFigures {
            unit_um: map.unit_um,
            size_um: both(own.0),
            pitch_um: both(own.1),
            refine: map.steps,
            sq_um: um(own.2),
            sdq: map.cuts.sdq,
            median_slope,
            own,
        }
    }

    /// Two lines.
    pub fn lines(&self) -> [String; 2] {
        let (scale, unit) = self.unit_um.map_or((1.0, "in the unit of the heights"), |unit| (unit, "um"));
        let pair = |[x, y]: [f64; 2]| format!("{} x {}", Digits(scale * x), Digits(scale * y));
        let (size, pitch, sq) = &self.own;
        [
            format!("map     {} {unit}, pitch {} {unit} (refine {})", pair(*size), pair(*pitch), self.refine),
            format!(
                "map     as traced: Sq {} {unit}, Sdq (rms slope) {}, median slope {}",
                Digits(scale * sq),
                Digits(self.sdq),
                Digits(self.median_slope)
            ),
        ]
    }
}

/// A number in five digits, without a power of ten where that is short.
struct Digits(f64);

impl std::fmt::Display for Digits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-4..1e6).contains(&size) {
            let decimals = if size == 0.0 { 0.0 } else { (4.0 - size.log10().floor()).clamp(0.0, 8.0) };
            let text = format!("{:.*}", decimals as usize, self.0);
            let short =
                if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            write!(f, "{short}")
        } else {
            write!(f, "{:.4e}", self.0)
        }
    }
}

/// The printable certificate; `map`: of a measured map.
pub fn lines(entries: &[PatchEntry], pooled: &Pooled, map: bool) -> Vec<String> {
    const HEADINGS: [&str; 12] = [
        "patch", "KS", "azimuth", "|h1|", "|h2|", "r(h)", "r(h^2)", "skew", "kurt", "range", "|mean|",
        "median",
    ];
    let mut headings = HEADINGS.to_vec();
    let mut rows: Vec<Vec<String>> = entries.iter().enumerate().map(row).collect();
    // No law was wanted of a map.
    if map {
        headings.remove(1);
        rows.iter_mut().for_each(|row| drop(row.remove(1)));
    }
    let mut lines = columns(&headings, &rows);
    let units = if map {
        "slopes are ratios of lengths, range is in the unit of the heights; azimuth: least..most, 1 is even;"
    } else {
        "slopes in the patch's own unit (alpha = 1), lengths in cells; azimuth: least..most, 1 is even;"
    };
    lines.extend(
        [
            "",
            units,
            "h1, h2: harmonics of the slope azimuth psi; r: rank correlation of slope length with height,",
            "with its square; mean: of the slope; median: of its length",
        ]
        .map(String::from),
    );
    if map && entries.len() == 1 {
        return lines;
    }
    lines.extend([String::new(), format!("all patches: KS {}", or_na(pooled.ks, 5))]);
    lines.extend(columns(&["harmonic", "mean", "standard error", "t", "even?"], &harmonics(pooled)));
    lines.push(match pooled.t_limit {
        Some(limit) => {
            format!("|t| above {limit:.2} in any rejects at 1 % (Student, {} degrees, Sidak)", pooled.dof)
        }
        None => "one patch: no test".into(),
    });
    lines
}

/// What grains cover, patch by patch and in the mean.
pub fn grain_lines(entries: &[PatchEntry]) -> Vec<String> {
    let all: Vec<&GrainFigures> = entries.iter().filter_map(|entry| entry.grains.as_ref()).collect();
    let Some(first) = all.first() else { return vec![] };
    let (mean, se) = stats::mean_and_se(all.iter().map(|grains| grains.coverage));
    let ks = all.iter().map(|grains| grains.ks).fold(0.0, f64::max);
    let count: usize = all.iter().map(|grains| grains.grains).sum();
    vec![
        format!("grains  {count} in all; they cover {mean:.4} +- {} of {}", or_na(se, 4), first.wanted),
        format!("grains  heights, and with them normals: KS at most {ks:.4} from (1 - coverage)^(1 - h^2)"),
    ]
}

fn row((index, entry): (usize, &PatchEntry)) -> Vec<String> {
    let certificate = &entry.certificate;
    let (least, most) = certificate.azimuth_extremes();
    let length = |[x, y]: [f64; 2]| x.hypot(y);
    let [first, second] = certificate.azimuth_harmonics.map(length);
    vec![
        format!("{index:03}"),
        or_na(certificate.ks, 5),
        format!("{least:.3}..{most:.3}"),
        format!("{first:.4}"),
        format!("{second:.4}"),
        format!("{:.4}", certificate.rank_correlation_height),
        format!("{:.4}", certificate.rank_correlation_height_squared),
        format!("{:.3}", certificate.height_skewness),
        format!("{:.3}", certificate.height_kurtosis),
        format!("{}", ShortNumber(certificate.height_range)),
        small(length(certificate.mean_slope)),
        format!("{}", ShortNumber(certificate.median_slope)),
    ]
}

/// A number that should be 0: its size.
fn small(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.0e}") }
}

/// A number of any size in few characters.
struct ShortNumber(f64);

impl std::fmt::Display for ShortNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-2..1e3).contains(&size) {
            write!(f, "{:.3}", self.0)
        } else {
            write!(f, "{:.1e}", self.0)
        }
    }
}

fn harmonics(pooled: &Pooled) -> Vec<Vec<String>> {
    let verdict = |rejected: Option<bool>| match rejected {
        None => "n/a",
        Some(true) => "rejected",
        Some(false) => "yes",
    };
    let row = |harmonic: &PooledHarmonic| {
        vec![
            harmonic.name.into(),
            format!("{:.5}", harmonic.mean),
            or_na(harmonic.se, 5),
            or_na(harmonic.t, 2),
            verdict(harmonic.rejected).into(),
        ]
    };
    pooled.harmonics.iter().map(row).collect()
}
