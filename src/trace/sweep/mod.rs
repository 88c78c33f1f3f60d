//! What a fixed direction sees of a periodic field, by a line sweep: exact along each line, no rays.
//!
//! Lines run away from the light, one cell apart, over the piecewise linear profile. In sheared height g = |d| h +
//! d_z s (s: columns travelled, |d|: the light's component along them) light runs level, so a point is lit where g
//! is at least every g before it; only the depth D = max g - g >= 0 below the light's edge is kept. Over a facet's
//! segment g changes by dg: the measure max(0, dg) turned to the light is max(0, wi.m) A per line, and of it the
//! part beyond D is lit. Source of the running maximum: Timonen, Westerholm 2010 (there with a hull, for all
//! directions). Lines share their crossings (`strip`), so one pass serves all zenith angles of an azimuth.

mod beam;
mod layout;
mod lines;
mod pass;
mod steps;
mod strip;

pub use layout::Layout;
pub use lines::Sweep;
