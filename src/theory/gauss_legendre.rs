//! The Gauss-Legendre rule of any order.

/// Nodes and weights of the Gauss-Legendre rule of `order` points on [0, 1]; the weights add up to 1.
///
/// Newton's iteration on P_n from Tricomi's guess (roots to a few ulp for the orders of interest, up to 100).
// Tested by `gauss_legendre_integrates_powers`.
pub fn gauss_legendre(order: usize) -> Vec<(f64, f64)> {
    let n = order as f64;
    let node = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut p, mut before) = (1.0, 0.0);
            for j in 1..=order {
                let j = j as f64;
                (p, before) = (((2.0 * j - 1.0) * x * p - (j - 1.0) * before) / j, p);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..order).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_integrates_powers() {
        for order in [1, 2, 5, 20] {
            let rule = gauss_legendre(order);
            for power in 0..2 * order as i32 {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
                // Roots and weights are right to a few ulp each.
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-13, "{order} {power}: {sum}");
            }
        }
    }
}
