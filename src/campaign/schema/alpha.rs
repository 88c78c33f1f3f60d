//! A roughness.

use serde::Serialize;

/// Slope scales of a surface along its own x and y, each in [1e-4, 10].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alpha {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// What goes with them on a surface of grains: the share of the plane that these cover, 1e-4 to 0.999.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<f64>,
}

impl Alpha {
    /// The same along x and y.
    pub fn isotropic(alpha: f64) -> Self {
        Alpha::new(alpha, alpha)
    }

    /// Of a surface without grains.
    pub fn new(x: f64, y: f64) -> Self {
        Alpha { x, y, coverage: None }
    }

    /// As a report says it: one number where it is the same along x and y.
    pub fn text(&self) -> String {
        let alpha = if self.x == self.y {
            self.x.to_string()
        } else {
            format!("{} along x, {} along y", self.x, self.y)
        };
        self.coverage.map_or(alpha.clone(), |coverage| format!("{alpha}, coverage {coverage}"))
    }

    /// How a table is told from those of the other roughnesses of its campaign.
    pub fn label(&self) -> String {
        self.coverage.map_or_else(
            || format!("alpha_{}", self.x),
            |coverage| format!("alpha_{}_coverage_{coverage}", self.x),
        )
    }
}
