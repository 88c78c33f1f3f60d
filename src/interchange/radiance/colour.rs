//! Linear RGB (ITU-R BT.709 primaries, white D65) and what Radiance's files hold of colour: XYZ, or Y with u' and v'.
//!
//! X, Y, Z by the matrix of IEC 61966-2-1, whose second row is the luminance; u' = 4 X/(X + 15 Y + 3 Z),
//! v' = 9 Y/(X + 15 Y + 3 Z) (CIE 1976).

use glam::{DMat3, DVec3};

use crate::interchange::Colour;

/// Rows X, Y, Z; columns R, G, B (IEC 61966-2-1).
const XYZ: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
/// u' and v' of black: those of equal X, Y and Z.
const GREY: [f64; 2] = [4.0 / 19.0, 9.0 / 19.0];

fn matrix() -> DMat3 {
    DMat3::from_cols_array_2d(&XYZ).transpose()
}

/// The XYZ of an RGB.
pub fn xyz(rgb: Colour) -> Colour {
    (matrix() * DVec3::from_array(rgb)).to_array()
}

/// The RGB of an XYZ; outside the triangle of the primaries the negative part is 0.
// Tested by `colours_come_back`.
pub fn rgb(xyz: Colour) -> Colour {
    (matrix().inverse() * DVec3::from_array(xyz)).to_array().map(|value| value.max(0.0))
}

/// Whether a colour lies outside the triangle of the primaries, by more than rounding.
pub fn is_outside(xyz: Colour) -> bool {
    let rgb = matrix().inverse() * DVec3::from_array(xyz);
    rgb.min_element() < -1e-6 * rgb.abs().max_element()
}

/// Y, u', v' of an RGB.
pub fn yuv(value: Colour) -> Colour {
    let [x, y, z] = xyz(value);
    let sum = x + 15.0 * y + 3.0 * z;
    if sum > 0.0 { [y, 4.0 * x / sum, 9.0 * y / sum] } else { [0.0, GREY[0], GREY[1]] }
}

/// The RGB of Y, u', v'; with v' = 0, which no colour has, black.
pub fn of_yuv([y, u, v]: Colour) -> Colour {
    if v <= 0.0 {
        return [0.0; 3];
    }
    // X = 9 u' Y/(4 v'), Z = (12 - 3 u' - 20 v') Y/(4 v').
    rgb([9.0 * u * y / (4.0 * v), y, (12.0 - 3.0 * u - 20.0 * v) * y / (4.0 * v)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for value in [[0.2, 0.5, 0.1], [1.0, 1.0, 1.0], [0.0, 0.0, 3.0], [30.0, 0.01, 0.0], [0.0; 3]] {
            for back in [rgb(xyz(value)), of_yuv(yuv(value))] {
                let largest = value.iter().fold(1e-300f64, |a, &b| a.max(b));
                // A matrix and its inverse, condition number below 5; the quotients add a few ulp.
                assert!(value.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-13 * largest), "{back:?}");
            }
        }
        // White D65: x = 0.3127, y = 0.3290 (BT.709), that is u' = 0.1978, v' = 0.4683 to the matrix's four digits.
        let [y, u, v] = yuv([1.0; 3]);
        assert!((y - 1.0).abs() < 1e-12 && (u - 0.1978).abs() < 1e-4 && (v - 0.4683).abs() < 1e-4, "{u} {v}");
    }
}
