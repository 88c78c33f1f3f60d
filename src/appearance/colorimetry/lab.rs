//! CIE 1976 L*a*b*.

/// L*, a*, b* of X, Y, Z under the white point of the same light.
///
/// L* = 116 f(Y/Yn) - 16, a* = 500 (f(X/Xn) - f(Y/Yn)), b* = 200 (f(Y/Yn) - f(Z/Zn)); f(t) = t^(1/3) above (24/116)^3, else
/// (841/108) t + 16/116. Source: CIE 015:2018, 8.2.1. Y above Yn, as of a metal's lobe, gives L* above 100.
// Tested by `lab_is_that_of_colour_science` (tests/it/appearance/colours.rs).
pub fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|c| cube_root_or_line(xyz[c] / white[c]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn cube_root_or_line(t: f64) -> f64 {
    if t > (24.0f64 / 116.0).powi(3) { t.cbrt() } else { 841.0 / 108.0 * t + 16.0 / 116.0 }
}
