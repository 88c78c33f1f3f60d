//! The goniometer: from where light comes, and which sensor bins a direction falls into.

pub mod alike;
pub mod angle_text;
pub mod arms;
pub mod bin_edges;
pub mod bins;
pub mod cone;
pub mod grid;
pub mod halves;
pub mod klems;
pub mod region;
pub mod symmetry;

pub use alike::{AlikeBins, SurfaceSymmetry};
pub use angle_text::{IncidenceAngles, angle_decimals};
pub use arms::grid_of;
pub use bins::Sensor;
pub use cone::direction_in_cone;
pub use grid::{Grid, GridKind};
pub use region::Region;
pub use symmetry::folded_incidences;
