//! Promise: what clear and matt facets cannot be is refused by one line that says what to do.

use gonio::campaign::{LightSide, Optics, SensorArm, SensorSide};
use gonio::error::Error;

use crate::support::campaign_text::{GOOD, accepted, parse, with};

fn optics(text: &str) -> String {
    with("material = \"gold\"", text)
}

#[track_caller]
fn one_fault(text: &str, key: &str, phrase: &str) {
    let Err(Error::Campaign(found)) = parse(text) else { panic!("accepted: {text}") };
    assert_eq!(found.len(), 1, "{}\n{text}", Error::Campaign(found));
    assert_eq!(found[0].key, key, "{}", found[0]);
    assert!(found[0].allowed.contains(phrase), "{} lacks {phrase:?}", found[0]);
}

#[test]
fn clear_facets_need_an_index_and_nothing_else() {
    let clear = |text: &str| optics(&format!("facet = \"dielectric\"\n{text}"));
    for (text, key, phrase) in [
        ("", "optics.eta", "required"),
        ("eta = 0", "optics.eta", "must lie in (0, 100]"),
        ("eta = -1.5", "optics.eta", "must lie in (0, 100]"),
        ("eta = 1", "optics.eta", "eta = 1 with k = 0 is no surface"),
        ("eta = 1.5\nk = 0.1", "optics.k", "nothing goes through what absorbs"),
        ("f0 = 0.04", "optics.f0", "give the index"),
        ("material = \"gold\"", "optics.material", "glass, plastic, diamond, water, ice"),
        ("material = \"glass\"\neta = 1.5", "optics.eta", "ambiguous"),
        ("material = \"glass\"\nwavelength_nm = [100]", "optics.wavelength_nm", "must lie in [310, 2500]"),
        ("eta = 1.5\nfresnel = \"exact\"", "optics.fresnel", "clear facets follow Fresnel's equations"),
        ("eta = 1.5\npolarisation = \"s\"", "optics.polarisation", "\"none\" or \"mueller\""),
        ("eta = 1.5\nalbedo = 0.5", "optics.albedo", "facet = \"diffuse\""),
        ("materials = [\"glass\", \"glass\"]", "optics.materials", "is there already"),
    ] {
        one_fault(&clear(text), key, phrase);
    }
    one_fault(&optics("facet = \"clear\"\neta = 1.5"), "optics.facet", "dielectric");
}

#[test]
fn light_goes_through_nothing_else() {
    let back = GOOD.replace("aperture_deg = 0.0", "aperture_deg = 0.0\nside = \"back\"");
    one_fault(&back, "light.side", "optics.facet = \"dielectric\" lets it through");
    let below = GOOD.replace("bins = \"centred\"", "bins = \"centred\"\nside = \"both\"");
    one_fault(&below, "sensor.hemisphere.side", "must be \"reflection\"");
    let patches = GOOD.replace(
        "[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\nbins = \"centred\"",
        "[sensor.patches]\nbasis = \"klems_full\"\nside = \"transmission\"",
    );
    one_fault(&patches, "sensor.patches.side", "must be \"reflection\"");
    let matt =
        optics("facet = \"diffuse\"\nalbedo = 0.5").replace("bins = \"centred\"", "side = \"transmission\"");
    one_fault(&matt, "sensor.hemisphere.side", "must be \"reflection\"");
}

/// All faults of a file are named, and none that follows from another one.
#[test]
fn a_facet_that_cannot_be_read_hides_no_fault_and_makes_none() {
    let text = optics("facet = \"dielectic\"\neta = 1.5")
        .replace("aperture_deg = 0.0", "side = \"back\"")
        .replace("bins = \"centred\"", "side = \"bth\"");
    let Err(Error::Campaign(found)) = parse(&text) else { panic!("accepted: {text}") };
    let keys: Vec<&str> = found.iter().map(|fault| fault.key.as_str()).collect();
    assert_eq!(keys, ["sensor.hemisphere.side", "optics.facet"], "{found:?}");
    let text = optics("facet = \"dielectric\"\neta = 0").replace("aperture_deg = 0.0", "side = \"bck\"");
    let Err(Error::Campaign(found)) = parse(&text) else { panic!("accepted: {text}") };
    let keys: Vec<&str> = found.iter().map(|fault| fault.key.as_str()).collect();
    assert_eq!(keys, ["light.side", "optics.eta"], "{found:?}");
}

#[test]
fn matt_facets_have_an_albedo_alone() {
    let matt = |text: &str| optics(&format!("facet = \"diffuse\"\n{text}"));
    for (text, key, phrase) in [
        ("", "optics.albedo", "required"),
        ("albedo = 1.5", "optics.albedo", "must lie in [0, 1]"),
        ("albedo = 0.5\neta = 1.5", "optics.eta", "has no meaning with facet = \"diffuse\""),
    ] {
        one_fault(&matt(text), key, phrase);
    }
    let Optics::Diffuse { albedo } = accepted(&matt("albedo = [0.1, 0.2, 0.3]")).campaign.optics else {
        panic!()
    };
    assert_eq!(albedo, [0.1, 0.2, 0.3]);
}

#[test]
fn layered_facets_have_one_interface_and_a_base() {
    let layered = |text: &str| optics(&format!("facet = \"layered\"\n{text}"));
    for (text, key, phrase) in [
        ("eta = 1.5", "optics.albedo", "required; what the base reflects"),
        ("albedo = 0.5", "optics.eta", "required; the index of the interface"),
        ("eta = 1.5\nalbedo = 1.1", "optics.albedo", "must lie in [0, 1]"),
        ("eta = 1\nalbedo = 0.5", "optics.eta", "must lie in (1, 4]; the interface is denser"),
        ("eta = 0.9\nalbedo = 0.5", "optics.eta", "must lie in (1, 4]"),
        ("eta = 4.01\nalbedo = 0.5", "optics.eta", "must lie in (1, 4]"),
        ("eta = [1.5, 1.6]\nalbedo = 0.5", "optics.eta", "number"),
        ("eta = 1.5\nmaterial = \"glass\"\nalbedo = 0.5", "optics.eta", "ambiguous"),
        ("eta = 1.5\nwavelength_nm = [550]\nalbedo = 0.5", "optics.wavelength_nm", "one index"),
        ("material = \"gold\"\nalbedo = 0.5", "optics.material", "glass, plastic, diamond, water, ice"),
        (
            "material = \"glass\"\nwavelength_nm = [450, 550]\nalbedo = 0.5",
            "optics.wavelength_nm",
            "must hold one wavelength",
        ),
        ("eta = 1.5\nk = 0.1\nalbedo = 0.5", "optics.k", "has no meaning with facet = \"layered\""),
        ("eta = 1.5\nf0 = 0.1\nalbedo = 0.5", "optics.f0", "has no meaning"),
        ("eta = 1.5\nmaterials = [\"glass\"]\nalbedo = 0.5", "optics.materials", "has no meaning"),
        ("eta = 1.5\nfresnel = \"exact\"\nalbedo = 0.5", "optics.fresnel", "has no meaning"),
        ("eta = 1.5\npolarisation = \"mueller\"\nalbedo = 0.5", "optics.polarisation", "has no meaning"),
    ] {
        one_fault(&layered(text), key, phrase);
    }
    let good = layered("eta = 1.5\nalbedo = [0.1, 0.2, 0.3]");
    let back = good.replace("aperture_deg = 0.0", "aperture_deg = 0.0\nside = \"back\"");
    one_fault(&back, "light.side", "optics.facet = \"dielectric\" lets it through");
    let below = good.replace("bins = \"centred\"", "bins = \"centred\"\nside = \"transmission\"");
    one_fault(&below, "sensor.hemisphere.side", "must be \"reflection\"");
    assert_eq!(accepted(&good).campaign.optics, Optics::Layered { albedo: [0.1, 0.2, 0.3], eta: 1.5 });
    // PMMA, green unless another wavelength is given: n^2 - 1 = 1.1819 l^2/(l^2 - 0.011313) at l = 0.55 um; 1.4906 at
    // 587.56 nm (Sultanova 2009).
    for (more, eta) in [("", 1.49259), ("\nwavelength_nm = [587.56]", 1.4906)] {
        let text = layered(&format!("material = \"plastic\"{more}\nalbedo = 0.5"));
        let Optics::Layered { eta: found, .. } = accepted(&text).campaign.optics else { panic!() };
        // Four digits.
        assert!((found - eta).abs() < 6e-5, "{found}");
    }
}

#[test]
fn both_sides_of_the_light_are_tables_of_their_own() {
    let text = optics("facet = \"dielectric\"\nmaterials = [\"water\", \"ice\"]")
        .replace("aperture_deg = 0.0", "side = \"both\"")
        .replace("bins = \"centred\"", "side = \"transmission\"");
    let campaign = accepted(&text).campaign;
    let labels: Vec<String> = campaign.optics.each().iter().map(|optics| optics.label()).collect();
    assert_eq!(labels, ["water_front", "ice_front", "water_back", "ice_back"]);
    assert_eq!(campaign.optics.light_sides(), [LightSide::Front, LightSide::Back]);
    assert!(matches!(campaign.sensor, SensorArm::Hemisphere { side: SensorSide::Transmission, .. }));
}

/// n at the lines F, d and C: Schott's BK7; PMMA at d 1.4906 (Sultanova 2009); diamond at d 2.4175 (Peter 1923).
#[test]
fn clear_materials_have_the_published_indices() {
    for (name, nm, eta) in [
        ("glass", 486.13, 1.52238),
        ("glass", 587.56, 1.51680),
        ("glass", 656.27, 1.51432),
        ("plastic", 587.56, 1.4906),
        ("diamond", 587.56, 2.4175),
        ("water", 589.3, 1.33335),
        ("ice", 550.0, 1.3110),
    ] {
        let text = optics(&format!("facet = \"dielectric\"\nmaterial = \"{name}\"\nwavelength_nm = [{nm}]"));
        let Optics::Dielectric(clear) = accepted(&text).campaign.optics else { panic!("{name}") };
        // Published to five digits.
        assert!((clear.media[0].eta - eta).abs() < 6e-5, "{name}: {}", clear.media[0].eta);
        assert_eq!(clear.media[0].k, 0.0);
    }
}

#[test]
fn sensor_arms_go_below_clear_surfaces_and_not_through_the_horizon() {
    let text = optics("facet = \"dielectric\"\neta = 1.5");
    let arm = |theta: &str| {
        text.replace(
            "[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\nbins = \"centred\"",
            &format!("[sensor.arm]\naperture_deg = 2\ntheta_r_deg = {theta}"),
        )
    };
    assert!(parse(arm("[-120, 0, 30, 150, 180]")).is_ok());
    one_fault(&arm("[30, 91]"), "sensor.arm.aperture_deg", "angle less aperture must stay beyond 90");
    one_fault(&arm("[-180]"), "sensor.arm.theta_r_deg", "180 is the same direction");
    let opaque = arm("[120]").replace("facet = \"dielectric\"\neta = 1.5", "material = \"gold\"");
    one_fault(&opaque, "sensor.arm.theta_r_deg", "stops below 90");
}
