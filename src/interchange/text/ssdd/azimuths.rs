//! Azimuths that go round: each once, increasing from 0, with the places that a list has for it.

use crate::interchange::Checked;
use crate::interchange::text::samples::alike;

/// Angles nearer than this are one, degrees.
const SAME: f64 = 1e-6;
/// The widest step between azimuths of the light that is interpolated over, degrees.
const WIDEST_GAP: f64 = 90.0;

/// Azimuths in [0, turn).
pub struct Azimuths {
    pub angles: Vec<f64>,
    /// Of each angle, where the list has it: several of an angle that is there at both ends.
    pub places: Vec<Vec<usize>>,
}

impl Azimuths {
    /// The azimuths of a list; of a mirrored one also those on the other side of 0.
    pub fn of(list: &[f64], turn: f64, mirrored: bool) -> Self {
        let reduced = |angle: f64| {
            let angle = angle.rem_euclid(turn);
            if turn - angle < SAME { 0.0 } else { angle }
        };
        let mut nodes: Vec<(f64, usize)> = list.iter().map(|&angle| reduced(angle)).zip(0..).collect();
        if mirrored {
            nodes.extend(list.iter().map(|&angle| reduced(-angle)).zip(0..));
        }
        nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut angles, mut places) = (Vec::<f64>::new(), Vec::<Vec<usize>>::new());
        for (angle, place) in nodes {
            match (angles.last(), places.last_mut()) {
                (Some(last), Some(here)) if angle - last < SAME => {
                    if !here.contains(&place) {
                        here.push(place);
                    }
                }
                _ => {
                    angles.push(angle);
                    places.push(vec![place]);
                }
            }
        }
        Azimuths { angles, places }
    }

    /// Refuses azimuths of the light or the half vector that leave out more than the specification's own example; a single
    /// one stands for all.
    pub fn go_round(&self) -> Checked<()> {
        let gap = self.widest_gap(360.0);
        if gap > WIDEST_GAP + SAME {
            return Err(format!(
                "PARAM1_LIST: {gap} degrees without an azimuth; steps of at most 90 are read"
            )
            .into());
        }
        Ok(())
    }

    /// Refuses azimuths of the sensor that leave out half of `turn`: two opposite ones are a scan in a plane, of more a
    /// forgotten symmetry.
    pub fn is_whole(&self, turn: f64) -> Checked<()> {
        let (gap, half) = (self.widest_gap(turn), 0.5 * turn);
        if gap > if self.angles.len() == 2 { half + SAME } else { half - SAME } {
            return Err(format!(
                "PARAM3_LIST: {gap} degrees without an azimuth; half of {turn} is what a REDUCTION_TYPE leaves out"
            ).into());
        }
        Ok(())
    }

    /// The largest step, round the turn too; 0 of a single azimuth.
    fn widest_gap(&self, turn: f64) -> f64 {
        match self.angles[..] {
            [first, .., last] => {
                let inner = self.angles.windows(2).map(|pair| pair[1] - pair[0]);
                inner.fold(first + turn - last, f64::max)
            }
            _ => 0.0,
        }
    }
}

/// The values over [a][azimuth][b][azimuth], the mean where an azimuth has several places. Returns the largest difference
/// of such values, as a share of the largest value, where they are not alike.
pub fn merged(
    values: &[f32],
    [n0, n1, n2, n3]: [usize; 4],
    outer: &Azimuths,
    inner: &Azimuths,
) -> (Vec<f32>, f64) {
    let (mut all, mut off) = (Vec::with_capacity(values.len()), 0.0f64);
    for i0 in 0..n0 {
        for first in &outer.places {
            for i2 in 0..n2 {
                for second in &inner.places {
                    let at = |i1: usize, i3: usize| f64::from(values[((i0 * n1 + i1) * n2 + i2) * n3 + i3]);
                    let found = || first.iter().flat_map(|&i1| second.iter().map(move |&i3| at(i1, i3)));
                    let (least, most) =
                        found().fold((f64::INFINITY, 0.0f64), |(l, m), value| (l.min(value), m.max(value)));
                    if alike(least, most) {
                        all.push(at(first[0], second[0]) as f32);
                    } else {
                        off = off.max(most - least);
                        all.push((found().sum::<f64>() / found().count() as f64) as f32);
                    }
                }
            }
        }
    }
    let largest = values.iter().fold(f32::MIN_POSITIVE, |most, &value| most.max(value));
    (all, off / f64::from(largest))
}

/// What is to be said of values that differ so much.
pub fn seam_note(off: f64) -> Option<String> {
    (off > 0.0).then(|| {
        format!(
            "values of one direction under two azimuths differ by up to {:.1} % of the largest: their mean is taken",
            100.0 * off
        )
    })
}
