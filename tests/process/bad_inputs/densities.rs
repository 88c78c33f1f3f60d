//! Power spectral densities that no surface has, and lengths that do not go together.

use super::row::{Row, refused, taken};
use crate::support::campaign_text::{FILE, GOOD, on, with};

pub fn rows() -> Vec<Row> {
    [models(), frequencies(), files(), scale()].into_iter().flatten().collect()
}

/// `GOOD` with Gaussian heights by the density `keys`, cells of 0.5 um.
fn by_density(keys: &str) -> String {
    let surface = format!("[surface.psd]\npitch_um = 0.5\n{keys}");
    with("correlation_cells = 8.0\n", "").replace("[surface.ggx]\nalpha = 0.2", &surface)
}

const ABC: &str = "model = \"k_correlation\"\na_um3 = 0.02\nb_um = 12\nc = 3.5";
const AFFINE: &str =
    "model = \"self_affine\"\nrms_um = 0.3\nhurst = 0.7\nf_min_per_um = 0.1\nf_max_per_um = 0.5";

fn models() -> Vec<Row> {
    let abc = |old: &str, new: &str| by_density(&ABC.replace(old, new));
    let affine = |old: &str, new: &str| by_density(&AFFINE.replace(old, new));
    vec![
        taken("density", by_density(ABC), &["K-correlation"]),
        taken("density", by_density(AFFINE), &["self-affine"]),
        refused(
            "density",
            abc("k_correlation", "abc"),
            &["surface.psd.model = \"abc\"", "\"k_correlation\" or"],
        ),
        refused("density", abc("a_um3 = 0.02", "a_um3 = -1"), &["surface.psd.a_um3 = -1", "must lie in"]),
        refused("density", abc("c = 3.5", "c = 1"), &["surface.psd.c = 1", "no finite variance"]),
        refused("density", abc("c = 3.5", "c = nan"), &["surface.psd.c = nan", "must be finite"]),
        refused("density", abc("c = 3.5", "c = 3.5\nhurst = 0.5"), &["surface.psd.hurst", "self_affine"]),
        refused("density", abc("0.02", "1e9"), &["surface.psd", "slopes of alpha", "must lie in [1e-4, 10]"]),
        refused(
            "density",
            abc("0.02", "1e-9"),
            &["surface.psd", "slopes of alpha", "must lie in [1e-4, 10]"],
        ),
        refused(
            "density",
            abc("b_um = 12", "b_um = 12\nrms_um = 5"),
            &["surface.psd.rms_um = 5", "does not agree"],
        ),
        refused(
            "rms height",
            affine("rms_um = 0.3", "rms_um = -0.3"),
            &["surface.psd.rms_um = -0.3", "(0, 1e6]"],
        ),
        refused("rms height", affine("rms_um = 0.3\n", ""), &["surface.psd.rms_um", "required"]),
        refused("Hurst", affine("hurst = 0.7", "hurst = 0"), &["surface.psd.hurst = 0", "(0, 1)"]),
        refused("Hurst", affine("hurst = 0.7", "hurst = 1"), &["surface.psd.hurst = 1", "(0, 1)"]),
        refused("Hurst", affine("hurst = 0.7", "hurst = -0.2"), &["surface.psd.hurst = -0.2", "(0, 1)"]),
        refused(
            "density",
            with("[surface.ggx]\nalpha = 0.2", &format!("[surface.psd]\npitch_um = 0.5\n{ABC}")),
            &["surface.correlation_cells", "follows from the power spectral density"],
        ),
        refused(
            "density",
            format!("{}\n[bench]\ncells = [64, 128]\n", by_density(ABC)),
            &["bench", "pitch_um"],
        ),
    ]
}

fn frequencies() -> Vec<Row> {
    let affine = |old: &str, new: &str| by_density(&AFFINE.replace(old, new));
    let beyond = "1/(2 pitch_um)";
    vec![
        refused(
            "beyond Nyquist",
            affine("f_max_per_um = 0.5", "f_max_per_um = 1.1"),
            &["f_max_per_um = 1.1", beyond],
        ),
        refused(
            "beyond Nyquist",
            affine("f_min_per_um = 0.1", "f_min_per_um = 2"),
            &["f_min_per_um = 2", beyond],
        ),
        refused(
            "beyond Nyquist",
            by_density(AFFINE).replace("pitch_um = 0.5", "pitch_um = 50"),
            &["surface.psd.f_m", beyond],
        ),
        refused("frequencies", affine("0.1", "0.5"), &["f_min_per_um = 0.5", "must be below f_max_per_um"]),
        refused("frequencies", affine("0.1", "1e-5"), &["f_min_per_um = 1e-5", "holds no longer waves"]),
        refused("frequencies", affine("f_min_per_um = 0.1\n", ""), &["f_min_per_um", "required"]),
        refused(
            "frequencies",
            affine("f_max_per_um = 0.5", "f_max_per_um = inf"),
            &["f_max_per_um", "finite"],
        ),
        refused(
            "frequencies",
            by_density(&format!("{ABC}\nf_max_per_um = 0.001")),
            &["surface.psd", "no wave on these patches"],
        ),
        refused(
            "pitch",
            by_density(ABC).replace("pitch_um = 0.5", "pitch_um = 0"),
            &["surface.psd.pitch_um = 0"],
        ),
        refused(
            "pitch",
            by_density(ABC).replace("pitch_um = 0.5\n", ""),
            &["surface.psd.pitch_um", "required"],
        ),
    ]
}

fn files() -> Vec<Row> {
    let csv = |name: &'static str, text: &str, says: &[&'static str]| {
        refused(name, by_density("model = \"table\"\nfile = \"psd.csv\""), says).file("psd.csv", text)
    };
    let at = "surface.psd.file";
    let head = "frequency_per_um,psd_um4\n";
    let lists = |keys: &str| by_density(&format!("model = \"table\"\n{keys}"));
    vec![
        taken("table of a density", by_density("model = \"table\"\nfile = \"psd.csv\""), &["a table of 3"])
            .file("psd.csv", format!("# a scan\n{head}0.01,0.9\n0.1,0.5\n1,1e-4\n")),
        csv(
            "gap in a density",
            &format!("{head}0.01,0.9\n0.1,\n1,1e-4\n"),
            &[at, "line 3", "not a frequency and"],
        ),
        csv("gap in a density", &format!("{head}0.01,0.9\n0.1,nan\n1,1e-4\n"), &[at, "NaN at 0.1 /um"]),
        csv(
            "gap in a density",
            &format!("{head}0.01,0.9\n0.1,0\n1,1e-4\n"),
            &[at, "0 at 0.1 /um", "above 0"],
        ),
        csv("table of a density", &format!("{head}0,0.9\n0.1,1\n"), &[at, "frequency 0", "above 0"]),
        csv("table of a density", &format!("{head}0.2,0.9\n0.1,1\n"), &[at, "0.1 after 0.2", "increase"]),
        csv("table of a density", head, &[at, "two at least"]),
        csv("table of a density", "f,psd\n0.1,1\n0.2,1\n", &[at, "heading frequency_per_um,psd_um4"]),
        csv("table of a density", "", &[at, "heading"]),
        csv(
            "table of a density",
            "frequency_per_um,psd_um3\n0.1,1\n0.2,2\n",
            &[at, "does not fall", "no areal PSD"],
        ),
        refused(
            "table of a density",
            by_density("model = \"table\"\nfile = \"gone.csv\""),
            &[at, "cannot be read"],
        ),
        refused(
            "table of a density",
            by_density("model = \"table\"\nfile = \".\""),
            &[at, "not a regular file"],
        ),
        refused("table of a density", lists(""), &[at, "required"]),
        refused(
            "table of a density",
            lists("frequency_per_um = [0.1, 0.2]\npsd_um4 = [1, 2, 3]"),
            &["psd_um4", "as many densities"],
        ),
        refused(
            "table of a density",
            lists("frequency_per_um = [0.1, 0.2]\npsd_um4 = [1, 2]\npsd_um3 = [1, 2]"),
            &["psd_um3", "ambiguous"],
        ),
        refused("table of a density", lists("psd_um4 = [1, 2]"), &["frequency_per_um", "required"]),
    ]
}

/// `[scale]`, and what `check` says of it.
fn scale() -> Vec<Row> {
    let scaled = |text: &str, scale: &str| format!("{text}\n[scale]\n{scale}\n");
    let map = on(FILE).replace("[light]", "[light]\naverage_azimuth = true");
    let own = "has a pitch of its own";
    vec![
        taken("scale", GOOD, &["waves", "n/a", "add [scale] with pitch_um"]),
        taken(
            "scale",
            scaled(GOOD, "pitch_um = 0.01\nwavelength_nm = 633"),
            &["geometric optics is doubtful here"],
        ),
        taken("scale", scaled(GOOD, "pitch_um = 5\nwavelength_nm = 633"), &["geometric optics holds here"]),
        taken(
            "scale",
            scaled(&by_density(ABC), "wavelength_nm = 1e6"),
            &["geometric optics is doubtful here"],
        ),
        refused("scale", scaled(GOOD, "pitch_um = -1"), &["scale.pitch_um = -1", "must lie in"]),
        refused("scale", scaled(GOOD, "wavelength_nm = 0"), &["scale.wavelength_nm = 0", "must lie in"]),
        refused("scale", scaled(&map, "pitch_um = 1"), &["scale.pitch_um = 1", own]),
        refused("scale", scaled(&by_density(ABC), "pitch_um = 1"), &["scale.pitch_um = 1", own]),
        refused(
            "scale",
            scaled(&on("[surface.mirror]\n"), "pitch_um = 1"),
            &["scale.pitch_um", "random heights"],
        ),
        refused(
            "scale",
            scaled(
                &with("material = \"gold\"", "material = \"gold\"\nfresnel = \"exact\""),
                "wavelength_nm = 500",
            ),
            &["scale.wavelength_nm = 500", "[optics] has wavelengths"],
        ),
    ]
}
