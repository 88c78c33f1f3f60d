//! `uncertainty.correlations`: coefficients of pairs of inputs.

use crate::campaign::parse::faults::nearest;
use crate::campaign::parse::reader::{Bounds, GivenValue};
use crate::campaign::schema::{Correlation, Distribution, InputQuantity, Quantity, Uncertainty};

const COEFFICIENT: Bounds = Bounds::closed(-1.0, 1.0);

/// Reads `[["lamp_theta_deg", "sensor_theta_deg", 0.5], ...]`.
pub(super) fn correlations(item: &GivenValue<'_>, inputs: &[InputQuantity]) -> Option<Vec<Correlation>> {
    let all = item.each(|one| correlation(one, inputs))?;
    for (k, one) in all.iter().enumerate() {
        let [a, b] = one.between;
        if all[..k].iter().any(|other| other.between == [a, b] || other.between == [b, a]) {
            return item.refuse(format!("{} and {} are there twice; each pair once", a.name(), b.name()));
        }
    }
    let whole = Uncertainty {
        inputs: inputs.to_vec(),
        correlations: all,
        at_deg: vec![],
        aperture_deg: None,
        samples: None,
        trials: 0,
    };
    match whole.correlation_factor() {
        Ok(_) => Some(whole.correlations),
        Err(quantity) => item.refuse(format!(
            "no errors have these correlations: the matrix is not positive definite from {} on; lower its coefficients",
            quantity.name()
        )),
    }
}

fn correlation(item: &GivenValue<'_>, inputs: &[InputQuantity]) -> Option<Correlation> {
    const SHAPE: &str =
        "two inputs and a coefficient, such as [\"lamp_theta_deg\", \"sensor_theta_deg\", 0.5]";
    if item.list_length() != Some(3) {
        return item.refuse(format!("must be {SHAPE}"));
    }
    let parts = item.list()?;
    let [a, b, coefficient] = &parts[..] else { return None };
    let (a, b, coefficient) = (input(a, inputs), input(b, inputs), coefficient.float(&COEFFICIENT));
    let (a, b) = (a?, b?);
    if a == b {
        return item.refuse(format!("{} is correlated with itself by 1: name two inputs", a.name()));
    }
    Some(Correlation { between: [a, b], coefficient: coefficient? })
}

fn input(item: &GivenValue<'_>, inputs: &[InputQuantity]) -> Option<Quantity> {
    let name = item.text()?;
    let Some(input) = inputs.iter().find(|input| input.quantity.name() == name) else {
        let names: Vec<&str> = inputs.iter().map(|input| input.quantity.name()).collect();
        let advice = match nearest(name, &names) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("given here: {}", names.join(", ")),
        };
        return item.refuse(format!("is no input of this table; {advice}"));
    };
    if input.distribution == Distribution::T {
        return item
            .refuse(format!("{name} has the distribution \"t\", which is drawn by itself; use \"normal\""));
    }
    Some(input.quantity)
}
