//! Tables of albedos: what a rough surface sends back, and lets through, of the light from each side, for renderers that put
//! back the energy which single scattering loses.
//!
//! Input: axes (mu, alpha and, of clear facets, eta), and a law of normals or a campaign. Output: an [`AlbedoTable`] with
//! errors, by quadrature of the model of order 1 ([`formula`]) or by measurement at all orders ([`measured`]), as NPZ, CSV,
//! EXR or a C header ([`files`]). Measurement and theory meet here, as in `validate`.

pub mod files;
pub mod formula;
pub mod measured;
mod quantities;
pub mod setup;
pub mod table;
mod verdict;

pub use formula::{FormulaSurface, by_formula};
pub use measured::measure;
pub use setup::{Chosen, Setup, campaign_of};
pub use table::{AlbedoTable, Axes, Cell, Quantity};
pub use verdict::Certificate;
