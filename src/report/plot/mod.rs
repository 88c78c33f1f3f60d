//! Plots as SVG.

pub mod chart;
pub mod convergence;
pub mod ladders;
pub mod masking;
pub mod plots;
pub mod polar;
