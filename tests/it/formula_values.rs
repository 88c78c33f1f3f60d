//! Promise: every formula meets the reference values (20 digits, computed with 60) within the stated tolerance.

use std::collections::BTreeMap;

use glam::DVec3;
use gonio::optics::fresnel::conductor::{a_conductor, f_conductor};
use gonio::optics::fresnel::dielectric::{f_dielectric, t_dielectric};
use gonio::optics::fresnel::f_schlick;
use gonio::optics::{FacetAngle, Fresnel};
use gonio::sphere::{direction_deg, sin_cos_deg};
use gonio::theory::smith::{g2_correlated, g2_separable, visibility};
use gonio::theory::{ArmSide, Masking, Microfacet, Ndf};

struct Row<'a>(BTreeMap<&'a str, &'a str>);

impl Row<'_> {
    fn number(&self, column: &str) -> f64 {
        self.0[column].parse().unwrap_or_else(|_| panic!("{} of {}", column, self.0["id"]))
    }

    fn is_vector(&self) -> bool {
        self.0["kind"] == "vec"
    }

    /// The direction `i`, `o` or `h`, from its components or from its angles.
    fn direction(&self, arm: &str) -> DVec3 {
        if self.is_vector() {
            let name = if arm == "h" { "h".to_owned() } else { format!("w{arm}") };
            return DVec3::from(["x", "y", "z"].map(|axis| self.number(&format!("{name}_{axis}"))));
        }
        direction_deg(self.number(&format!("theta_{arm}_deg")), self.number(&format!("phi_{arm}_deg")))
    }

    fn model(&self) -> Microfacet {
        let (alpha_x, alpha_y) = (self.number("alpha_x"), self.number("alpha_y"));
        Microfacet { ndf: Ndf::Ggx, alpha_x, alpha_y, rotation: 0.0 }
    }

    fn side(&self, arm: &str) -> ArmSide {
        self.model().side(self.direction(arm))
    }

    fn fresnel(&self) -> Fresnel {
        match self.0["fresnel"] {
            "one" => Fresnel::Perfect,
            "schlick" => Fresnel::Schlick { f0: self.number("f0") },
            "dielectric" => Fresnel::Dielectric { eta: self.number("eta") },
            "conductor" => Fresnel::Conductor { eta: self.number("eta"), k: self.number("k") },
            other => panic!("unknown Fresnel {other}"),
        }
    }

    fn facet_angle(&self) -> FacetAngle {
        let (sin, cos) = sin_cos_deg(self.number("theta_i_deg"));
        FacetAngle { cos, sin2: sin * sin }
    }

    fn dielectric(&self) -> gonio::optics::Polarised {
        f_dielectric(self.facet_angle(), self.number("eta"))
    }

    fn conductor(&self) -> gonio::optics::Polarised {
        f_conductor(self.facet_angle(), self.number("eta"), self.number("k"))
    }

    fn brdf(&self, masking: Masking) -> f64 {
        self.model().brdf(self.direction("i"), self.direction("o"), masking, &self.fresnel())
    }

    fn evaluate(&self) -> f64 {
        let both = |f: fn(&ArmSide, &ArmSide) -> f64| f(&self.side("i"), &self.side("o"));
        let v = |masking| visibility(masking, &self.side("i"), &self.side("o"));
        match self.0["quantity"] {
            "D" => Ndf::Ggx.d(self.direction("h"), self.number("alpha_x"), self.number("alpha_y")),
            "Lambda" => self.side("i").lambda(),
            "G1" => self.side("i").g1(),
            "one_minus_G1" => self.side("i").one_minus_g1(),
            "G2_sep" => both(g2_separable),
            "G2_corr" => both(g2_correlated),
            "V_sep" => v(Masking::Separable),
            "V_corr" => v(Masking::HeightCorrelated),
            "brdf_sep" => self.brdf(Masking::Separable),
            "brdf_corr" => self.brdf(Masking::HeightCorrelated),
            "F_diel" => self.dielectric().mean(),
            "F_diel_s" => self.dielectric().s,
            "F_diel_p" => self.dielectric().p,
            "T_diel" => t_dielectric(self.facet_angle(), self.number("eta")),
            "F_cond" => self.conductor().mean(),
            "F_cond_s" => self.conductor().s,
            "F_cond_p" => self.conductor().p,
            "A_cond" => a_conductor(self.facet_angle(), self.number("eta"), self.number("k")),
            "F_schlick" => f_schlick(self.facet_angle(), self.number("f0")),
            other => panic!("unknown quantity {other}"),
        }
    }
}

#[test]
fn every_reference_value_is_met() {
    let mut reader = csv::Reader::from_path("tests/data/reference_values.csv").expect("the reference file");
    let header = reader.headers().expect("a header").clone();
    let (mut rows, mut quantities, mut failures) = (0, BTreeMap::<String, (usize, f64)>::new(), vec![]);
    for record in reader.records() {
        let record = record.expect("a row");
        let row = Row(header.iter().zip(record.iter()).collect());
        let (expected, found) = (row.number("value"), row.evaluate());
        // tol_f64 = 2^-52 (16 + 4 cond); where the value is 0 by nature (a zero of r_p, an underflow) it is absolute.
        let (error, tolerance) = if expected.abs() < 1e-30 {
            (found.abs(), 1e-15)
        } else {
            // Rows without a condition number (zeros, total reflection, closed forms) are held to 64 ulp.
            let stated =
                if row.0["tol_f64"].is_empty() { 64.0 * f64::EPSILON } else { row.number("tol_f64") };
            ((found - expected).abs() / expected.abs(), stated)
        };
        rows += 1;
        let entry = quantities.entry(row.0["quantity"].to_owned()).or_default();
        *entry = (entry.0 + 1, entry.1.max(error / tolerance));
        if error.is_nan() || error > tolerance {
            failures.push(format!(
                "{}: {found:e} for {expected:e}, error {error:e} > {tolerance:e}",
                row.0["id"]
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // The file's own size: no row and no quantity is passed over.
    assert_eq!((rows, quantities.len()), (5799, 19), "{quantities:?}");
    let worst = quantities.values().fold(0.0, |worst: f64, entry| worst.max(entry.1));
    assert!(worst < 0.5, "the stable forms stay within half of the tolerance: {quantities:?}");
}

#[test]
fn the_law_of_grains_meets_its_reference() {
    let mut reader = csv::Reader::from_path("tests/data/grains_digits.csv").expect("the reference file");
    let header = reader.headers().expect("a header").clone();
    let mut rows = 0;
    for record in reader.records() {
        let record = record.expect("a row");
        let row = Row(header.iter().zip(record.iter()).collect());
        let [wi, wo] = ["i", "r"].map(|arm| {
            direction_deg(row.number(&format!("theta_{arm}_deg")), row.number(&format!("phi_{arm}_deg")))
        });
        let (alpha_x, alpha_y, coverage) =
            (row.number("alpha_x"), row.number("alpha_y"), row.number("coverage"));
        let model = Microfacet { ndf: Ndf::Grains { coverage }, alpha_x, alpha_y, rotation: 0.0 };
        let g2 = |masking| 4.0 * wi.z * wo.z * visibility(masking, &model.side(wi), &model.side(wo));
        let steepest = (alpha_x * wi.x).hypot(alpha_y * wi.y).max((alpha_x * wo.x).hypot(alpha_y * wo.y));
        // Areas are some 1/cos large, in the canonical frame, and right to 1e-14 of that; so are angles, of which slopes
        // are 1/alpha. The masking's logarithm has that error, times ln(1 - coverage)/pi <= 2.2.
        let grazing = (1.0 + steepest / wi.z.min(wo.z)) / alpha_x.min(alpha_y).min(1.0);
        let tolerance = 1e-13 * grazing;
        let values = [
            ("D", model.ndf.d_of_sum(wi + wo, alpha_x, alpha_y)),
            ("G2", g2(Masking::Grains)),
            ("G1_G1", g2(Masking::GrainsProduct)),
            ("f", model.brdf(wi, wo, Masking::Grains, &Fresnel::Perfect)),
        ];
        for (name, found) in values {
            let expected = row.number(name);
            assert!(
                (found - expected).abs() <= tolerance * expected,
                "{name} of row {rows}: {found:e} for {expected:e}, {:e} off, may be {tolerance:e}",
                found / expected - 1.0
            );
        }
        rows += 1;
    }
    assert_eq!(rows, 94);
}

#[test]
fn the_closed_forms_of_the_lobe_hold_at_normal_incidence() {
    // f(n, n) = D(n) V with D = 1/(pi alpha^2) and V = 1/4: five roundings.
    for alpha in [1e-4, 0.1, 1.0, 10.0] {
        for ndf in [Ndf::Ggx, Ndf::Beckmann] {
            for masking in Masking::ALL {
                let model = Microfacet::isotropic(ndf, alpha);
                let found = model.brdf(DVec3::Z, DVec3::Z, masking, &Fresnel::Perfect);
                let expected = 0.25 / (std::f64::consts::PI * alpha * alpha);
                assert!((found - expected).abs() < 5.0 * f64::EPSILON * expected, "{ndf:?} {alpha}");
            }
        }
    }
}
