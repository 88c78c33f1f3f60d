//! The tree of a tensor tree file, and where in it a pair of directions lies: Shirley-Chiu's squares.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use crate::sphere;

/// What the blocks of a coloured file are, after `Visible`.
pub(crate) const COLOURS: [&str; 2] = ["CIE-u", "CIE-v"];

/// A group of the tree.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Tree {
    /// 2^rank children.
    Branch(Vec<Tree>),
    /// A grid with so many cells a side.
    Leaf(usize, Vec<f32>),
}

/// The square's point of a point of the unit disc.
fn square(x: f64, y: f64) -> [f64; 2] {
    let (r, mut phi) = (x.hypot(y), y.atan2(x));
    if phi < -FRAC_PI_4 {
        phi += 2.0 * PI;
    }
    let (a, b) = if phi < FRAC_PI_4 {
        (r, phi * r / FRAC_PI_4)
    } else if phi < 3.0 * FRAC_PI_4 {
        (-(phi - FRAC_PI_2) * r / FRAC_PI_4, r)
    } else if phi < 5.0 * FRAC_PI_4 {
        (-r, -(phi - PI) * r / FRAC_PI_4)
    } else {
        ((phi - 1.5 * PI) * r / FRAC_PI_4, -r)
    };
    [0.5 * a + 0.5, 0.5 * b + 0.5]
}

/// The disc's point of a point of the square.
fn disc([x, y]: [f64; 2]) -> (f64, f64) {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let (r, phi) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
    (r * phi.cos(), r * phi.sin())
}

fn above(x: f64, y: f64) -> DVec3 {
    DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// The directions of a point; none for the unused half of rank 3.
pub(crate) fn directions(rank: usize, at: &[f64; 4]) -> Option<(DVec3, DVec3)> {
    if rank == 4 {
        let (to, out) = (disc([at[0], at[1]]), disc([at[2], at[3]]));
        return Some((above(-to.0, -to.1), above(out.0, out.1)));
    }
    let sin = 1.0 - 2.0 * at[0];
    let out = disc([at[1], at[2]]);
    (sin > 0.0).then(|| (above(-sin, 0.0), above(out.0, out.1)))
}

/// The point of a pair of directions. Along the first axis of rank 3 the normal is the end of the used half, which is
/// closed there: the other half is no light at all.
pub(crate) fn coordinates(rank: usize, wi: DVec3, wo: DVec3) -> [f64; 4] {
    if rank == 4 {
        let (to, out) = (square(-wi.x, -wi.y), square(wo.x, wo.y));
        return [to[0], to[1], out[0], out[1]];
    }
    let sin = wi.x.hypot(wi.y);
    let turned = if sin > 0.0 { sphere::turned(wo, (wi.y / sin, -wi.x / sin)) } else { wo };
    let out = square(turned.x, turned.y);
    [0.5 - 0.5 * sin, out[0], out[1], 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_coordinates_agree() {
        for (rank, at) in [(4, [0.1, 0.7, 0.9, 0.3]), (4, [0.5, 0.2, 0.45, 0.8]), (3, [0.3, 0.6, 0.1, 0.0])] {
            let (wi, wo) = directions(rank, &at).expect("used");
            let found = coordinates(rank, wi, wo);
            // A few operations on numbers of order 1, and a square root near the disc's edge.
            assert!(found.iter().zip(at).all(|(f, w)| (f - w).abs() < 1e-12), "{found:?}");
        }
        // The corners of the published map: +x is the middle of the right side.
        assert_eq!(square(1.0, 0.0), [1.0, 0.5]);
        assert!((square(0.0, -0.5)[0] - 0.5).abs() < 1e-15 && (square(0.0, -0.5)[1] - 0.25).abs() < 1e-15);
    }
}
