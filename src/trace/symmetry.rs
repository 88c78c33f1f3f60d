//! Mirror images of a patch: (x, y) swapped, then x and y flipped.
//!
//! The image of a canonical patch under any of the eight has the same law, so each is a further sample from the
//! same heights. The arms are mirrored, not the heights.

use glam::DVec2;

/// One of the eight symmetries of the square. As a matrix on field vectors: flips after swap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PatchSymmetry {
    swap: bool,
    flip_x: bool,
    flip_y: bool,
}

impl PatchSymmetry {
    /// Image `index` in 0..8; 0 is the patch itself.
    pub fn nth(index: u64) -> Self {
        PatchSymmetry { swap: index & 4 != 0, flip_x: index & 1 != 0, flip_y: index & 2 != 0 }
    }

    /// A vector of the field as seen in the image.
    pub fn from_field(self, v: DVec2) -> DVec2 {
        self.flipped(self.swapped(v))
    }

    /// A vector of the image as seen in the field: the inverse of `from_field`.
    pub fn to_field(self, v: DVec2) -> DVec2 {
        self.swapped(self.flipped(v))
    }

    fn swapped(self, v: DVec2) -> DVec2 {
        if self.swap { DVec2::new(v.y, v.x) } else { v }
    }

    fn flipped(self, v: DVec2) -> DVec2 {
        DVec2::new(if self.flip_x { -v.x } else { v.x }, if self.flip_y { -v.y } else { v.y })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eight_images_differ_and_have_inverses() {
        let v = DVec2::new(1.0, 2.0);
        let images: Vec<DVec2> = (0..8).map(|k| PatchSymmetry::nth(k).from_field(v)).collect();
        for (k, image) in images.iter().enumerate() {
            assert_eq!(PatchSymmetry::nth(k as u64).to_field(*image), v);
            assert_eq!(images.iter().filter(|other| *other == image).count(), 1);
        }
    }
}
