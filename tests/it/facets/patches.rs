//! Promise: a sensor of Klems patches on both sides of a clear surface loses no light between them: what bins over whole
//! hemispheres collect, its patches do, from the pole above to the pole below.

use gonio::campaign::{LightSide, SensorArm, SensorSide};
use gonio::measure::Measured;

use crate::support::campaign_text::accepted;
use crate::support::measuring::measured;

fn text(surface: &str, thetas: &str, sensor: &str) -> String {
    format!(
        "name = \"patches\"\n[surface]\n{surface}\n[optics]\nfacet = \"dielectric\"\neta = 1.5\n[light]\n\
         theta_i_deg = {thetas}\nazimuth = \"absolute\"\nphi_i_deg = [17, 140]\nside = \"both\"\n[sensor.{sensor}\n\
         side = \"both\"\n[trace]\nbounces = 3\n[stop]\nsamples = 8192\n"
    )
}

/// Flux into the bins above, or below, at each incidence.
fn fluxes(measured: &Measured, below: bool) -> Vec<f64> {
    let half = measured.table.half(below).expect("both sides");
    let flux = |incidence: usize| -> f64 {
        let sizes = half.grid.sizes(incidence);
        let values = &half.colours[0].total[incidence * sizes.len()..];
        sizes.iter().zip(values).map(|(size, &value)| size * f64::from(value)).sum()
    };
    (0..half.grid.incidences()).map(flux).collect()
}

#[test]
fn patches_collect_what_hemispheres_do() {
    let ggx = "realisations = 2\ncells = 64\n[surface.ggx]\nalpha = 0.5";
    for (surface, thetas) in [(ggx, "[0, 40, 80]"), ("[surface.mirror]", "[0, 3, 44, 86]")] {
        let [patches, bins] = ["patches]\nbasis = \"klems_full\"", "hemisphere]"]
            .map(|sensor| measured(&text(surface, thetas, sensor)));
        assert_eq!((patches.len(), patches[0].table.grid.bins()), (2, 290));
        for (patches, bins) in patches.iter().zip(&bins) {
            for below in [false, true] {
                let pairs = fluxes(patches, below).into_iter().zip(fluxes(bins, below));
                for (incidence, (found, wanted)) in pairs.enumerate() {
                    // The same paths; values in f32, half an ulp of 1.2e-7 each.
                    let off = (found - wanted).abs();
                    assert!(
                        off <= 1e-6 * wanted.max(1e-6),
                        "{surface} {incidence} {below}: {found} {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_preset_has_both_sides_of_light_and_sensor() {
    let text = |optics: &str, more: &str| {
        format!(
            "name = \"klems\"\n[surface.ggx]\nalpha = 0.3\n[optics]\n{optics}\n[preset]\nname = \"klems_full\"\n{more}\n\
             [stop]\nsamples = 1\n"
        )
    };
    let clear = "facet = \"dielectric\"\neta = 1.5";
    let campaign = accepted(&text(clear, "side = \"both\"\nlight_side = \"both\"")).campaign;
    assert_eq!(campaign.sensor, SensorArm::KlemsFull { side: SensorSide::Both });
    assert_eq!(campaign.optics.light_sides(), [LightSide::Front, LightSide::Back]);
    // Written out and read again: arms instead of the preset.
    let written = gonio::campaign::to_toml(&campaign);
    assert_eq!(accepted(&written).campaign, campaign, "{written}");
    let plain = accepted(&text("material = \"gold\"", "")).campaign;
    assert_eq!(plain.sensor, SensorArm::KlemsFull { side: SensorSide::Reflection });
    for (more, key) in [("side = \"both\"", "preset.side"), ("light_side = \"back\"", "preset.light_side")] {
        let Err(gonio::error::Error::Campaign(found)) =
            crate::support::campaign_text::parse(text("material = \"gold\"", more))
        else {
            panic!("accepted {more}")
        };
        assert_eq!((found.len(), found[0].key.as_str()), (1, key), "{found:?}");
        assert!(found[0].allowed.contains("optics.facet = \"dielectric\""), "{}", found[0]);
    }
}
