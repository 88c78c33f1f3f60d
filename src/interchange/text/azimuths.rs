//! Azimuths that go round: each once, increasing from 0, with the places that a list has for it.

/// Angles nearer than this are one, degrees.
pub const SAME: f64 = 1e-6;

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

    /// `values[outer][place][inner]` as `[outer][angle][inner]`, the mean where an angle has several places; and the
    /// largest difference of such values that are not the `same`.
    pub fn merged(
        &self,
        values: &[f64],
        [outer, listed, inner]: [usize; 3],
        same: fn(f64, f64) -> bool,
    ) -> (Vec<f64>, f64) {
        let (mut all, mut off) = (Vec::with_capacity(values.len()), 0.0f64);
        for o in 0..outer {
            for places in &self.places {
                for k in 0..inner {
                    let found = || places.iter().map(|place| values[(o * listed + place) * inner + k]);
                    let (least, most) = found().fold((f64::INFINITY, 0.0), |(l, m), v| (v.min(l), v.max(m)));
                    if same(least, most) {
                        all.push(values[(o * listed + places[0]) * inner + k]);
                    } else {
                        off = off.max(most - least);
                        all.push(found().sum::<f64>() / places.len() as f64);
                    }
                }
            }
        }
        (all, off)
    }
}

/// The largest step between angles, round the turn too; 0 of a single one.
pub fn widest_gap(angles: &[f64], turn: f64) -> f64 {
    match angles {
        [first, .., last] => {
            let inner = angles.windows(2).map(|pair| pair[1] - pair[0]);
            inner.fold(first + turn - last, f64::max)
        }
        _ => 0.0,
    }
}
