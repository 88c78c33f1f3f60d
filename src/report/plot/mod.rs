//! Plots as SVG.

pub mod axis;
pub mod chart;
pub mod convergence;
pub mod drawing;
pub mod ladders;
pub mod masking;
pub mod plots;
pub mod polar;
pub mod roughness;
pub mod shares;
pub mod style;

pub use axis::ChartAxis;
pub use chart::{Chart, Series};
pub use drawing::escaped;
pub use style::{MEASURED, Marker, SeriesStyle, model_style, ratio_style, series_style};
