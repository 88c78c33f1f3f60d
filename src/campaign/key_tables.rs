//! Where the keys of a campaign belong, for those who look for one elsewhere.

/// Keys, and the table in which each is meant most often, as it is written.
const HOMES: [(&str, &str); 29] = [
    ("alpha", "[surface.ggx] or another law"),
    ("alpha_x", "[surface.ggx] or another law"),
    ("alpha_y", "[surface.ggx] or another law"),
    ("realisations", "[surface]"),
    ("cells", "[surface]"),
    ("correlation_cells", "[surface]"),
    ("rotation_deg", "[surface]"),
    ("path", "[surface.file]"),
    ("detrend", "[surface.file]"),
    ("theta_i_deg", "[light]"),
    ("phi_i_deg", "[light]"),
    ("azimuth", "[light]"),
    ("theta_r_bins", "[sensor.hemisphere]"),
    ("phi_r_bins", "[sensor.hemisphere]"),
    ("theta_r_deg", "[sensor.arm]"),
    ("phi_r_deg", "[sensor.arm]"),
    ("aperture_deg", "[sensor.arm]"),
    ("material", "[optics]"),
    ("fresnel", "[optics]"),
    ("polarisation", "[optics]"),
    ("wavelength_nm", "[optics], or [scale] where the material has none"),
    ("pitch_um", "[scale], [surface.psd]"),
    ("bounces", "[trace]"),
    ("visibility", "[trace]"),
    ("samples", "[stop]"),
    ("relative_error", "[stop]"),
    ("seconds", "[stop]"),
    ("masking", "[expect]"),
    ("l1_model", "[expect]"),
];

/// The table in which `key` is meant most often.
pub fn table_of(key: &str) -> Option<&'static str> {
    HOMES.iter().find(|(name, _)| *name == key).map(|(_, table)| *table)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::campaign;
    use crate::error::Error;

    #[test]
    fn every_key_is_known_where_it_is_said_to_belong() {
        for (key, tables) in HOMES {
            for table in tables.split(['[', ']']).skip(1).step_by(2) {
                let text = format!("[{table}]\n{key} = true\n");
                let Err(Error::Campaign(faults)) = campaign::parse(&text, "c.toml", Path::new("")) else {
                    panic!("{text} is no campaign");
                };
                let name = format!("{table}.{key}");
                let unknown =
                    faults.iter().any(|fault| fault.key == name && fault.allowed.contains("unknown"));
                assert!(!unknown, "{faults:?}");
            }
        }
    }
}
