//! Where the eye is: a perspective camera that looks at the middle of the unit sphere, z up in the picture.

use glam::DVec3;
use serde::Serialize;

use crate::sphere;

/// A camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Camera {
    /// Azimuth of the eye, degrees.
    pub azimuth_deg: f64,
    /// Its height above the horizon, degrees, below 90.
    pub height_deg: f64,
    /// From the sphere's middle; the sphere's radius is 1.
    pub distance: f64,
    /// Tangent of half the angle that the picture is high.
    pub half: f64,
}

impl Camera {
    /// The usual one: 50 degrees to the side of the light's azimuth, a little above the horizon.
    pub fn beside(light_phi_deg: f64) -> Self {
        Camera { azimuth_deg: light_phi_deg + 50.0, height_deg: 8.0, distance: 5.2, half: 0.25 }
    }

    /// The eye.
    pub fn eye(&self) -> DVec3 {
        self.distance * self.towards()
    }

    fn towards(&self) -> DVec3 {
        sphere::direction_deg(90.0 - self.height_deg, self.azimuth_deg)
    }

    /// The unit vector of what is seen at a place of the picture: x to the right, y upwards, (-1, -1) to (1, 1).
    pub fn ray(&self, x: f64, y: f64) -> DVec3 {
        let towards = self.towards();
        let right = sphere::direction_deg(90.0, self.azimuth_deg + 90.0);
        let up = towards.cross(right);
        (self.half * (x * right + y * up) - towards).normalize()
    }

    /// Where a ray meets the sphere first.
    pub fn meets_sphere(&self, ray: DVec3) -> Option<DVec3> {
        let eye = self.eye();
        let (b, c) = (eye.dot(ray), eye.length_squared() - 1.0);
        let root = b * b - c;
        (root > 0.0).then(|| (eye + (-b - root.sqrt()) * ray).normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_picture_is_the_near_point_of_the_sphere() {
        let camera = Camera::beside(30.0);
        let place = camera.meets_sphere(camera.ray(0.0, 0.0)).expect("there");
        assert!((place - camera.eye() / camera.distance).length() < 1e-12);
        // The sphere's edge: sin of its half angle is 1/distance.
        let edge = (1.0 / camera.distance).asin().tan() / camera.half;
        assert!(camera.meets_sphere(camera.ray(0.999 * edge, 0.0)).is_some());
        assert!(camera.meets_sphere(camera.ray(0.0, 1.001 * edge)).is_none());
        // z up.
        assert!(camera.ray(0.0, 1.0).z > camera.ray(0.0, -1.0).z);
    }
}
