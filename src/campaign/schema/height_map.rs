//! A measured height map, and what is done to its samples.

use serde::Serialize;

/// A measured height map: `[surface.file]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeightMap {
    /// The file as the campaign names it.
    pub path: String,
    /// The file as it is opened: `path` relative to the campaign file's folder.
    #[serde(skip)]
    pub resolved_path: std::path::PathBuf,
    /// Which map of a file of several: a title, a number or a channel's name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// Distance of neighbouring columns, um. `None`: the file's own `pitch_x`.
    pub pitch_x_um: Option<f64>,
    /// Distance of neighbouring rows, um. `None`: the file's own `pitch_y`.
    pub pitch_y_um: Option<f64>,
    /// Height in um of one unit of the file. `None`: heights and the file's own pitches share one unit.
    pub height_unit_um: Option<f64>,
    /// Whether the map continues itself.
    pub periodic: bool,
    /// The form that is taken off.
    pub detrend: Detrend,
    /// What else is done to the heights.
    #[serde(flatten)]
    pub preparation: Preparation,
    /// Cells for each of the file's own along a side, a power of two. `None`, "auto": as many as it takes until it no
    /// longer shows along which diagonal cells are cut.
    pub refine: Option<u32>,
    /// tiles x tiles regions of the map are the groups for the error bars, 1 to 64.
    pub tiles: u32,
}

/// The form that is taken off a measured height map, by least squares of the heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detrend {
    /// A plane.
    Plane,
    /// Nothing but the mean.
    None,
    /// A polynomial of x and y of this total degree, 2 to 10.
    Polynomial(u32),
    /// A sphere of any radius.
    Sphere,
    /// A circular cylinder of any radius, azimuth and tilt.
    Cylinder,
}

/// What is done to the samples of a height map besides taking its form off, in the order of these keys; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Preparation {
    /// Samples without data.
    #[serde(skip_serializing_if = "is_default")]
    pub gaps: Gaps,
    /// Single heights far from those around them.
    #[serde(skip_serializing_if = "is_default")]
    pub outliers: Outliers,
    /// Cut-off of the S-filter, um: shorter waves are damped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub s_filter_um: Option<f64>,
    /// Cut-off of the L-filter, um: longer waves are damped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub l_filter_um: Option<f64>,
}

/// What becomes of samples without data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gaps {
    /// The map is refused.
    #[default]
    Refuse,
    /// A harmonic surface through the heights around them.
    Interpolate,
    /// The same, but no path starts on it.
    Exclude,
}

/// What becomes of single heights far from those around them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outliers {
    /// They are named and stay.
    #[default]
    Keep,
    /// As gaps that are interpolated.
    Fill,
    /// As gaps that are excluded.
    Exclude,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
