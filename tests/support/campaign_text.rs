//! A campaign text without faults, and variations of it.

use std::path::Path;

use gonio::campaign::{self, Parsed};
use gonio::error::Error;

/// A campaign without faults.
pub const GOOD: &str = "\
name = \"good\"
seed = 7

[surface]
realisations = 4
cells = 256
correlation_cells = 8.0
rotation_deg = 0.0
[surface.ggx]
alpha = 0.2

[light]
theta_i_deg = [0, 15, 30]
aperture_deg = 0.0

[sensor.hemisphere]
theta_r_bins = 18
phi_r_bins = 36
bins = \"centred\"

[optics]
material = \"gold\"

[trace]
bounces = 1
visibility = true

[stop]
samples = 1_000_000

[expect]
masking = \"direction_correlated\"
l1_model = 0.04
";

/// A campaign of a fraction of a second.
pub const SMALL: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 4
cells = 32
correlation_cells = 4.0
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 50]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[stop]
samples = 65_536
";

/// A measured height map.
pub const FILE: &str =
    "[surface.file]\npath = \"scan.npy\"\npitch_x_um = 1\npitch_y_um = 1\nheight_unit_um = 1\n";

/// Single sensor positions.
pub const ARM: &str = "[sensor.arm]\ntheta_r_deg = [-60, 0, 60]\naperture_deg = 1\n";

/// Parses as `folder/c.toml` would be.
pub fn parse(text: impl AsRef<[u8]>) -> Result<Parsed, Error> {
    campaign::parse(text, "c.toml", Path::new("folder"))
}

/// Parses what must have no faults.
pub fn accepted(text: &str) -> Parsed {
    parse(text).unwrap_or_else(|e| panic!("refused: {e}\n{text}"))
}

/// `GOOD` with one piece of text replaced.
pub fn with(old: &str, new: &str) -> String {
    assert_eq!(GOOD.matches(old).count(), 1, "{old:?} must occur once");
    GOOD.replace(old, new)
}

/// `GOOD` on a surface without random heights.
pub fn on(kind: &str) -> String {
    let random = "realisations = 4\ncells = 256\ncorrelation_cells = 8.0\n";
    with(random, "").replace("[surface.ggx]\nalpha = 0.2\n", kind)
}

/// `GOOD` with single sensor positions.
pub fn with_arm(arm: &str) -> String {
    with("[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\nbins = \"centred\"\n", arm)
}
