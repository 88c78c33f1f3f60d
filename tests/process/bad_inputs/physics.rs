//! Materials, lengths and surfaces outside physics.

use super::row::{Row, refused, taken};
use crate::support::campaign_text::{FILE, on, with};

const GOLD: &str = "material = \"gold\"";

pub fn rows() -> Vec<Row> {
    [optics(), lengths()].into_iter().flatten().collect()
}

fn optics() -> Vec<Row> {
    let optics = |text: &str| with(GOLD, text);
    let in_range = "must lie in [0, 1]";
    vec![
        refused("f0 out of range", optics("f0 = -0.1"), &["optics.f0 = -0.1", in_range]),
        refused("f0 out of range", optics("f0 = 1.5"), &["optics.f0 = 1.5", in_range]),
        refused("f0 out of range", optics("f0 = [0.1, nan, 0.1]"), &["optics.f0 = nan", "must be finite"]),
        taken("f0 out of range", optics("f0 = 0"), &["incidences"]),
        taken("f0 out of range", optics("f0 = 1.0"), &["incidences"]),
        refused("eta out of range", optics("eta = 0"), &["optics.eta"]),
        refused("eta out of range", optics("eta = -1.5"), &["optics.eta"]),
        refused("eta out of range", optics("eta = nan"), &["optics.eta"]),
        refused(
            "indices out of order",
            optics("eta = [0.2, 0.3]\nk = [3.0]\nwavelength_nm = [500, 600]"),
            &["optics."],
        ),
        refused(
            "indices out of order",
            optics("eta = [0.2, 0.3]\nk = [3, 3]\nwavelength_nm = [600, 500]"),
            &["optics."],
        ),
        refused(
            "indices out of order",
            optics("eta = [0.2, 0.3]\nk = [3, 3]\nwavelength_nm = [-600, 500]"),
            &["optics."],
        ),
        refused(
            "material unknown",
            optics("material = \"unobtainium\""),
            &["optics.material = \"unobtainium\"", "known: gold, silver"],
        ),
        refused(
            "material unknown",
            optics("material = \"Gold\""),
            &["optics.material", "did you mean `gold`?"],
        ),
        refused(
            "polarisation out of range",
            optics("material = \"gold\"\npolarisation = 2"),
            &["optics.polarisation = 2"],
        ),
        refused(
            "polarisation out of range",
            optics("material = \"gold\"\npolarisation = nan"),
            &["optics.polarisation = nan"],
        ),
        refused(
            "polarisation out of range",
            optics("material = \"gold\"\npolarisation = \"x\""),
            &["optics.polarisation = \"x\""],
        ),
    ]
}

fn lengths() -> Vec<Row> {
    let pitch = |value: &str| {
        on(&FILE.replace("pitch_x_um = 1", &format!("pitch_x_um = {value}")))
            .replace("[light]", "[light]\naverage_azimuth = true")
    };
    let row = |value: &str, says: &'static str| {
        refused("pitch out of range", pitch(value), &[says, "lie in [1e-9, 1e9]"])
    };
    vec![
        row("0", "surface.file.pitch_x_um = 0"),
        row("-1", "surface.file.pitch_x_um = -1"),
        row("1e-300", "surface.file.pitch_x_um = 1e-300"),
        row("1e300", "surface.file.pitch_x_um = 1e300"),
        row("nan", "surface.file.pitch_x_um = nan"),
    ]
}
