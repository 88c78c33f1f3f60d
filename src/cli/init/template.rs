//! The text of a campaign, put together of its parts.

use std::path::Path;

use clap::ValueEnum;

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Surface {
    /// random heights of GGX slopes, the same in all directions
    Ggx,
    /// random heights of GGX slopes, rougher across a brush than along it
    Brushed,
    /// random heights of Gaussian slopes
    Beckmann,
    /// Gaussian heights by their power spectral density, with cells of a size
    Psd,
    /// half-ellipsoids on a plane: explicit, and known in closed form
    Grains,
    /// a statistical surface on which the formula is exact
    Smith,
    /// your own heights, from a file
    Scan,
}

/// The arms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Instrument {
    /// bins over the hemisphere
    Hemisphere,
    /// a sensor in the plane of incidence
    Plane,
    /// the UTIA database's 288 x 288 directions
    Utia,
    /// what the MERL format is filled from
    Merl,
    /// what Mitsuba's `measured` is filled from
    Rgl,
    /// NIST's robotic instrument
    Rosi,
    /// Radiance's 145 patches
    KlemsFull,
}

/// What the table is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Purpose {
    /// a first look, in seconds
    Look,
    /// comparing with the formula: mirror facets, small errors
    Formula,
    /// a renderer: gold, several bounces
    Render,
    /// rough glass: what comes back and what goes through
    Glass,
}

/// A campaign with comments; what does not go together is the parser's to say.
pub fn campaign(
    name: &str,
    surface: Surface,
    instrument: Instrument,
    purpose: Purpose,
    map: &Path,
) -> String {
    let parts = [
        format!(
            "# What every key means: docs/guide.md, Campaigns. `gonio check` lists all faults, and what a run would take.\n\
             name = {}\nseed = 1                    # everything random follows from it\n",
            toml(name)
        ),
        of_surface(surface, purpose, map),
        of_instrument(surface, instrument, purpose),
        of_purpose(purpose),
        of_stop(purpose),
        of_uncertainty(instrument).into(),
    ];
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// What geometric optics is judged by.
const SCALE: &str =
    "\n[scale]\nwavelength_nm = 550         # `gonio check` says where geometric optics holds\n";

fn of_surface(surface: Surface, purpose: Purpose, map: &Path) -> String {
    let (realisations, cells) = if purpose == Purpose::Look { (8, 256) } else { (16, 1024) };
    let patches = format!(
        "[surface]\nrealisations = {realisations:<12} # independent patches: error bars come from their spread\n"
    );
    let heights = format!(
        "{patches}cells = {cells:<19} # per side of a patch\ncorrelation_cells = 8.0     # how wide the bumps are, in cells\n\n"
    );
    match surface {
        Surface::Ggx => {
            heights + "[surface.ggx]\nalpha = 0.3                 # a list gives one table each\n"
        }
        Surface::Brushed => {
            heights
                + "[surface.ggx]\nalpha_x = 0.1               # along x\nalpha_y = 0.3               # along y\n"
        }
        Surface::Beckmann => {
            heights + "[surface.beckmann]\nalpha = 0.3                 # sqrt 2 times the rms slope\n"
        }
        Surface::Psd => format!(
            "{patches}cells = {cells:<19} # per side of a patch\n\n[surface.psd]\nmodel = \"k_correlation\"    # or \
             \"self_affine\", \"table\"\npitch_um = 0.5              # of the cells\na_um3 = 20.0                # of a \
             profile's A/(1 + (B f)^2)^(C/2), one-sided\nb_um = 60.0\nc = 3.2\nf_max_per_um = 0.3          # no shorter \
             waves\n{}",
            // Glass has wavelengths of its own.
            if purpose == Purpose::Glass { "" } else { SCALE }
        ),
        Surface::Grains => {
            patches
                + "\n[surface.grains]\ncoverage = 0.5              # of the plane\nalpha = 0.5                 # height \
                   over radius of a grain\nbase = \"mirror\"             # the plane between; or \"absorbing\"\n"
        }
        Surface::Smith => patches + "\n[surface.smith]\nalpha = 0.3\n",
        Surface::Scan => format!(
            "[surface.file]\npath = {}\npitch_x_um = 1.0            # between samples\npitch_y_um = 1.0\n\
             height_unit_um = 1.0        # of a height of 1\nperiodic = false\ndetrend = \"plane\"           # takes a \
             tilt away\ntiles = 4                   # 4 x 4 regions: error bars come from their spread\n",
            toml(&map.to_string_lossy())
        ),
    }
}

fn of_instrument(surface: Surface, instrument: Instrument, purpose: Purpose) -> String {
    let isotropic = !matches!(surface, Surface::Brushed | Surface::Scan);
    let azimuth = if isotropic {
        "azimuth = \"relative\"        # averaged over all; \"absolute\" with phi_i_deg = [...] keeps them apart\n"
    } else {
        "azimuth = \"absolute\"\nphi_i_deg = [0, 45, 90]     # the light's azimuths, from the sample's x axis\n"
    };
    let glass = purpose == Purpose::Glass;
    let light_side =
        if glass { "side = \"both\"               # a table each: from outside, from inside\n" } else { "" };
    let light = format!(
        "[light]\ntheta_i_deg = [0, 30, 60]   # from the normal; or {{ from = 0, to = 75, step = 15 }}\n{azimuth}{light_side}\n"
    );
    let both = if glass {
        "side = \"both\"               # theta_r below 90 comes back, beyond 90 goes through\n"
    } else {
        ""
    };
    match instrument {
        Instrument::Hemisphere => format!(
            "{light}[sensor.hemisphere]\ntheta_r_bins = 18           # 5 degrees\nphi_r_bins = 36             # 10 \
             degrees\nbins = \"centred\"            # the mirror direction in the middle of a bin\n{both}"
        ),
        Instrument::Plane => format!(
            "{light}[sensor.arm]\ntheta_r_deg = {{ from = -85, to = 85, step = 2 }}    # negative: the light's side\n\
             phi_r_deg = [180]           # the plane of incidence\n{}aperture_deg = 1.0          # half-angle of the sensor\n",
            if isotropic { "" } else { "phi_r_from = \"light\"        # counted from the light\n" }
        ),
        Instrument::KlemsFull if glass => {
            "[preset]\nname = \"klems_full\"         # `gonio presets` says what it emulates\nside = \"both\"\n\
             light_side = \"both\"\n"
                .into()
        }
        other => {
            let name = other.to_possible_value().map(|value| value.get_name().replace('-', "_"));
            let name = toml(&name.unwrap_or_default());
            let pairs = if other == Instrument::Rosi {
                "theta_i_deg = [45]          # pairs of directions\ntheta_r_deg = [45]\n"
            } else {
                ""
            };
            let chooses = matches!(other, Instrument::Rosi | Instrument::Rgl) && !isotropic;
            let azimuths = if chooses { "phi_i_deg = [0, 45, 90]     # the light's azimuths\n" } else { "" };
            format!("[preset]\nname = {name:<20} # the arms; `gonio presets` says what is emulated\n{pairs}{azimuths}")
        }
    }
}

fn of_purpose(purpose: Purpose) -> String {
    match purpose {
        Purpose::Look | Purpose::Formula => {
            "# [optics]                  # left out: every facet is a perfect mirror\n# material = \"gold\"         # \
             `gonio materials` lists the names\n"
        }
        Purpose::Render => {
            "[optics]\nmaterial = \"gold\"           # `gonio materials` lists the names\n\n[trace]\nbounces = 4\n\n\
             # gonio export TABLE.exr -o table.bsdf --to rgl    (`gonio formats` lists the others)\n"
        }
        Purpose::Glass => {
            "[optics]\nfacet = \"dielectric\"\nmaterial = \"glass\"          # BK7; or eta = 1.5\n\n[trace]\n\
             bounces = 8                 # facets that a path may meet\n"
        }
    }
    .into()
}

fn of_stop(purpose: Purpose) -> String {
    let (samples, error) = match purpose {
        Purpose::Look => ("262_144", ""),
        Purpose::Glass => ("1_048_576", ""),
        Purpose::Formula | Purpose::Render => (
            "4_194_304",
            "relative_error = 0.01       # an incidence ends at this median error of its bright bins\n",
        ),
    };
    format!("[stop]\nsamples = {samples:<17} # per incidence and patch\n{error}")
}

/// Of an arm, whose positions a budget is made of.
fn of_uncertainty(instrument: Instrument) -> &'static str {
    if instrument != Instrument::Plane {
        return "";
    }
    "# [uncertainty]             # what an instrument is known to: `gonio budget` (docs/budget.md)\n\
     # reading = { u = 0.002 }   # a part of each reading\n\
     # sensor_theta_deg = { half_width = 0.05 }\n"
}

/// A string of TOML.
fn toml(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign;

    /// What cannot be: MERL's files are isotropic.
    fn cannot_be(surface: Surface, instrument: Instrument) -> bool {
        instrument == Instrument::Merl && matches!(surface, Surface::Brushed | Surface::Scan)
    }

    #[test]
    fn every_campaign_has_no_fault_or_one_that_is_known() {
        for &surface in Surface::value_variants() {
            for &instrument in Instrument::value_variants() {
                for &purpose in Purpose::value_variants() {
                    let text = campaign("a_name", surface, instrument, purpose, Path::new("a.npy"));
                    let parsed = campaign::parse(&text, "campaign", Path::new(""));
                    let case = format!("{surface:?} {instrument:?} {purpose:?}");
                    assert_eq!(
                        parsed.is_err(),
                        cannot_be(surface, instrument),
                        "{case}:\n{text}\n{:?}",
                        parsed.err()
                    );
                    assert!(text.lines().all(|line| line.chars().count() <= 120), "{case}:\n{text}");
                }
            }
        }
    }
}
