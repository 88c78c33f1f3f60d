//! Angles as text: no more decimals than it takes to tell them apart.

use super::grid::Grid;

/// The decimals that a list of angles is printed with: `fewest`, and more where different ones would look the same or one
/// below 90 would read 90.
pub fn angle_decimals(fewest: usize, angles: impl IntoIterator<Item = f64>) -> usize {
    let mut angles: Vec<f64> = angles.into_iter().chain([90.0]).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let text = |angle: f64, decimals: usize| format!("{angle:.decimals$}");
    let differ =
        |decimals: &usize| angles.windows(2).all(|pair| text(pair[0], *decimals) != text(pair[1], *decimals));
    // 17 digits tell any two numbers between 10 and 100 apart.
    (fewest..15).find(differ).unwrap_or(15)
}

/// The angles of an incidence as text, with the same decimals for all of a grid.
pub struct IncidenceAngles {
    angles: Vec<(f64, f64)>,
    decimals: [usize; 2],
}

impl IncidenceAngles {
    /// The incidences of `grid`, with two decimals at least.
    pub fn of(grid: &Grid) -> Self {
        IncidenceAngles::new((0..grid.incidences()).map(|incidence| grid.incidence_deg(incidence)))
    }

    /// The same of these (theta_i, phi_i).
    pub fn new(angles: impl Iterator<Item = (f64, f64)>) -> Self {
        let angles: Vec<(f64, f64)> = angles.collect();
        let theta = angle_decimals(2, angles.iter().map(|angle| angle.0));
        let phi = angle_decimals(2, angles.iter().map(|angle| angle.1));
        IncidenceAngles { angles, decimals: [theta, phi] }
    }

    /// theta_i and phi_i.
    pub fn texts(&self, incidence: usize) -> [String; 2] {
        let ((theta, phi), [of_theta, of_phi]) = (self.angles[incidence], self.decimals);
        [format!("{theta:.of_theta$}"), format!("{phi:.of_phi$}")]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_differ_look_different() {
        let two = |angles: &[f64]| angle_decimals(2, angles.iter().copied());
        assert_eq!(two(&[0.0, 30.0, 60.0]), 2);
        assert_eq!(two(&[90.0, 100.0 / 3.0]), 2);
        assert_eq!(two(&[89.99, 89.999]), 3);
        assert_eq!(two(&[89.99999]), 5);
        assert_eq!(two(&[90f64.next_down()]), 14);
        assert_eq!(two(&[45.0, 45f64.next_up()]), 14);
        assert_eq!(angle_decimals(1, [89.99]), 2);
    }
}
