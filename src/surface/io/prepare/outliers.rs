//! Single heights of a measured map that stand far out of the rest or of their neighbours: spikes and dust, which are named
//! or taken away, and what marks missing data.
//!
//! One of them decides from which height on a ray is above everything, and so how much light leaves the map by its edge.

use rayon::prelude::*;

/// How many times farther out than 99 of 100 heights an outlier stands: 15 standard deviations of a normal law. Needles of
/// GGX heights reach 5.
const FAR: f64 = 6.0;
/// So many are named with their places.
const NAMED: usize = 3;
/// Heights from here on are none in any unit that a campaign may give: 1e15 m in the smallest. Blank cells of Surfer
/// (1.7e38), GDAL's lowest f32 (-3.4e38) and 1e30 lie beyond.
const NO_LENGTH: f64 = 1e30;
/// What programs write where there are no data, besides.
const CUSTOMARY: [f64; 8] = [-9999.0, -99_999.0, -999_999.0, 9999.0, 99_999.0, -32_768.0, 32_767.0, -1e10];
/// How many median deviations from the median a customary value must lie for it to be no height: 67 standard deviations
/// of a normal law.
const OUTSIDE: f64 = 100.0;
/// Beyond so many times the distance of 99 of 100 heights no instrument has both: dust of 1 mm on a mirror of 1 nm.
const ABSURD: f64 = 1e6;

/// How far the samples are that say what one should be: 2 on each side, in 12 pairs.
const AROUND: isize = 2;
/// How many times farther off their median than 95 of 100 samples: 12 standard deviations of a normal law, and 18 decay lengths
/// of an exponential one, beyond which one sample in 10^7 lies.
const FAR_OFF: f64 = 6.0;
/// Connected samples beyond which they are a thing of the surface: they spoil half of each other's pairs.
const LARGEST: usize = 6;

/// Takes away what marks missing data, and what is no number: those samples become NaN. Returns how many there are.
pub fn take_marks(heights: &mut [f64]) -> usize {
    for height in heights.iter_mut().filter(|height| height.abs() >= NO_LENGTH) {
        *height = f64::NAN;
    }
    if let Some(Spread { median, usual, .. }) = Spread::of(heights) {
        let is_mark = |height: f64| CUSTOMARY.contains(&height) && (height - median).abs() > OUTSIDE * usual;
        heights.iter_mut().filter(|height| is_mark(**height)).for_each(|height| *height = f64::NAN);
    }
    heights.iter().filter(|height| height.is_nan()).count()
}

/// Why a map with `columns` heights in a row cannot be measured as it is: a value that is no height, with its place.
/// `far_is_height`: whether absurdly far ones are left for `local` to find.
pub fn refused(heights: &[f64], columns: usize, far_is_height: bool) -> Option<String> {
    let told = |what: &str, remedy: &str, is_one: &dyn Fn(f64) -> bool| {
        let at = heights.iter().position(|&height| is_one(height))?;
        let count = heights.iter().filter(|&&height| is_one(height)).count();
        Some(format!(
            "height {:e} at row {}, column {} ({count} such of {}) {what}; {remedy}",
            heights[at],
            at / columns,
            at % columns,
            heights.len()
        ))
    };
    let gaps = "set surface.file.gaps = \"interpolate\" or \"exclude\", fill in their neighbours' heights, or cut the map to \
                where there are data";
    if let Some(why) =
        told("is no length: heights lie within 1e30", gaps, &|height| height.abs() >= NO_LENGTH)
    {
        return Some(why);
    }
    let Spread { median, usual, most } = Spread::of(heights)?;
    let marks = |height: f64| CUSTOMARY.contains(&height) && (height - median).abs() > OUTSIDE * usual;
    let what =
        format!("marks missing data: more than {OUTSIDE} median deviations ({usual:.3e}) from the median");
    told(&what, gaps, &marks).or_else(|| {
        let what =
            format!("is absurd: more than {ABSURD:e} times as far from the median as 99 of 100 ({most:.3e})");
        let remedy =
            "set surface.file.outliers = \"fill\" or \"exclude\", or set it to its neighbours' height";
        let absurd = |height: f64| most > 0.0 && (height - median).abs() > ABSURD * most;
        if far_is_height { None } else { told(&what, remedy, &absurd) }
    })
}

/// A sentence that names the outliers of a map with `columns` heights in a row, where there are any.
///
/// An outlier's distance from the median is above `FAR` times that of the 99th of 100 heights; where more than one
/// height in a hundred is that far out, they are the surface's own.
pub fn named(heights: &[f64], columns: usize) -> Option<String> {
    let Spread { median, most, .. } = Spread::of(heights)?;
    let limit = FAR * most;
    let mut found: Vec<usize> =
        (0..heights.len()).filter(|&at| (heights[at] - median).abs() > limit).collect();
    if found.is_empty() {
        return None;
    }
    found.sort_by(|&a, &b| (heights[b] - median).abs().total_cmp(&(heights[a] - median).abs()));
    let off: Vec<(usize, f64)> = found.iter().map(|&at| (at, heights[at] - median)).collect();
    Some(format!(
        "outlying heights ({}): {} (from the median, in the file's unit; 99 % lie within {most:.4e}): a ray is \
         clear of the map above the highest alone; set surface.file.outliers = \"fill\" or \"exclude\"",
        found.len(),
        places(&off, columns, NAMED),
    ))
}

/// The first of some samples, each with how far off it is.
pub fn places(off: &[(usize, f64)], columns: usize, most: usize) -> String {
    let place =
        |&(at, off): &(usize, f64)| format!("{off:.4e} at row {}, column {}", at / columns, at % columns);
    let named: Vec<String> = off.iter().take(most).map(place).collect();
    let more = off.len().saturating_sub(most);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", named.join("; "))
}

/// The samples that stand out of those around them, each with how far it is off their median, the farthest first. NaN are
/// no samples.
///
/// The median is that of the means of opposite samples, so that no slope shows in it; where a sample has none opposite, two in a
/// row continue to it. Off by more than `FAR_OFF` times as far as 95 of 100 samples are, and with at most `LARGEST` such samples
/// connected: scratches and ridges are larger, and stay.
pub fn local(heights: &[f64], columns: usize) -> Vec<(usize, f64)> {
    let rows = heights.len() / columns;
    let at = |x: isize, y: isize| {
        let within = (0..columns as isize).contains(&x) && (0..rows as isize).contains(&y);
        within.then(|| heights[y as usize * columns + x as usize]).filter(|height| !height.is_nan())
    };
    let opposite: Vec<(isize, isize)> = (0..=AROUND)
        .flat_map(|dy| (-AROUND..=AROUND).map(move |dx| (dx, dy)))
        .filter(|&(dx, dy)| dy > 0 || dx > 0)
        .collect();
    let of_row = |y: usize| {
        let (opposite, mut wanted) = (&opposite, Vec::with_capacity(opposite.len()));
        let mut off = Vec::with_capacity(columns);
        for x in 0..columns {
            let (x, y) = (x as isize, y as isize);
            wanted.clear();
            wanted.extend(opposite.iter().filter_map(|&(dx, dy)| {
                match (at(x + dx, y + dy), at(x - dx, y - dy)) {
                    (Some(a), Some(b)) => Some(0.5 * (a + b)),
                    (Some(a), None) => Some(2.0 * a - at(x + 2 * dx, y + 2 * dy)?),
                    (None, Some(b)) => Some(2.0 * b - at(x - 2 * dx, y - 2 * dy)?),
                    (None, None) => None,
                }
            }));
            let height = at(x, y).filter(|_| !wanted.is_empty());
            off.push(height.map_or(0.0, |height| height - quantile(&mut wanted, 0.5)));
        }
        off
    };
    let off: Vec<f64> = (0..rows).into_par_iter().flat_map_iter(of_row).collect();
    let mut distances: Vec<f64> = off.iter().map(|off| off.abs()).collect();
    let limit = FAR_OFF * quantile(&mut distances, 0.95);
    let stands_out: Vec<bool> = off.iter().map(|off| off.abs() > limit).collect();
    let mut found: Vec<(usize, f64)> = small_groups(&stands_out, columns).map(|at| (at, off[at])).collect();
    found.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    found
}

/// The samples of the groups, connected along sides and corners, of at most `LARGEST`.
fn small_groups(marked: &[bool], columns: usize) -> impl Iterator<Item = usize> {
    let rows = marked.len() / columns;
    let mut seen = vec![false; marked.len()];
    let mut found = Vec::new();
    for first in 0..marked.len() {
        if !marked[first] || seen[first] {
            continue;
        }
        seen[first] = true;
        let mut group = vec![first];
        let mut next = 0;
        while next < group.len() {
            let (x, y) = (group[next] % columns, group[next] / columns);
            for y in y.saturating_sub(1)..=(y + 1).min(rows - 1) {
                for x in x.saturating_sub(1)..=(x + 1).min(columns - 1) {
                    let at = y * columns + x;
                    if marked[at] && !std::mem::replace(&mut seen[at], true) {
                        group.push(at);
                    }
                }
            }
            next += 1;
        }
        if group.len() <= LARGEST {
            found.extend(group);
        }
    }
    found.into_iter()
}

/// Where the heights of a map lie.
struct Spread {
    median: f64,
    /// Half of the heights are as near to the median.
    usual: f64,
    /// So are 99 of 100.
    most: f64,
}

impl Spread {
    /// `None` of a map without heights.
    fn of(heights: &[f64]) -> Option<Self> {
        let mut known: Vec<f64> = heights.iter().copied().filter(|height| !height.is_nan()).collect();
        if known.is_empty() {
            return None;
        }
        let median = quantile(&mut known, 0.5);
        known.iter_mut().for_each(|height| *height = (*height - median).abs());
        Some(Spread { median, usual: quantile(&mut known, 0.5), most: quantile(&mut known, 0.99) })
    }
}

/// The value below which the share `p` of the values lies.
fn quantile(values: &mut [f64], p: f64) -> f64 {
    let at = ((values.len() - 1) as f64 * p).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of amplitude 1, 64 x 64.
    fn smooth() -> Vec<f64> {
        (0..64 * 64).map(|at| ((at % 64) as f64 * 0.3).sin()).collect()
    }

    #[test]
    fn a_spike_and_a_pit_are_named_with_their_places() {
        let mut heights = smooth();
        (heights[5 * 64 + 7], heights[9 * 64 + 3]) = (30.0, -1e5);
        let said = named(&heights, 64).expect("two outliers");
        assert!(said.starts_with("outlying heights (2): -1.0000e5 at row 9, column 3; "), "{said}");
        assert!(said.contains("at row 5, column 7"), "{said}");
    }

    #[test]
    fn what_is_no_height_is_refused_with_its_place() {
        for (value, what) in [
            (-9999.0, "marks missing data"),
            (f64::from(f32::MIN), "is no length"),
            (1e30, "is no length"),
            (1.7e308, "is no length"),
            (1e7, "is absurd"),
        ] {
            let mut heights = smooth();
            heights[5 * 64 + 7] = value;
            let why = refused(&heights, 64, false).unwrap_or_else(|| panic!("{value} is taken"));
            assert!(why.contains("at row 5, column 7 (1 such of 4096)") && why.contains(what), "{why}");
            // A third of the map, too.
            heights[..1365].fill(value);
            assert_eq!(refused(&heights, 64, false).is_some(), what != "is absurd", "{value}");
        }
    }

    #[test]
    fn marks_become_gaps_and_absurd_heights_may_stay() {
        let mut heights = smooth();
        (heights[7], heights[8], heights[70], heights[71]) = (-9999.0, f64::NAN, 1.7e38, f64::INFINITY);
        assert_eq!(take_marks(&mut heights), 4);
        assert!([7, 8, 70, 71].iter().all(|at| heights[*at].is_nan()));
        heights[3] = 1e7;
        assert!(
            refused(&heights, 64, false)
                .is_some_and(|why| why.contains("is absurd") && why.contains("outliers"))
        );
        assert_eq!(refused(&heights, 64, true), None);
    }

    #[test]
    fn what_stands_out_of_its_neighbours_is_found_and_a_scratch_is_not() {
        // Spikes of a tenth of the height of the whole, between its own crests.
        let mut heights = smooth();
        let rough = |at: usize| 1e-3 * ((at as f64 * 12.9898).sin() * 43758.5453).fract();
        heights.iter_mut().enumerate().for_each(|(at, height)| *height += rough(at));
        let spikes = [5 * 64 + 7, 9 * 64 + 3, 0, 63 * 64 + 63, 30 * 64 + 31];
        spikes.iter().enumerate().for_each(|(k, at)| heights[*at] += [0.9, -0.8, 0.7, -0.6, 0.5][k]);
        // A scratch of 60 samples, a piece of dust of 2 x 3, and a gap in it.
        (0..60).for_each(|x| heights[40 * 64 + x] -= 1.0);
        let dust: Vec<usize> = (0..6).map(|k| (50 + k / 3) * 64 + 20 + k % 3).collect();
        dust.iter().for_each(|at| heights[*at] += 2.0);
        heights[51 * 64 + 21] = f64::NAN;
        let mut found: Vec<usize> = local(&heights, 64).into_iter().map(|(at, _)| at).collect();
        found.sort_unstable();
        let mut wanted = [&spikes[..], &dust[..]].concat();
        wanted.retain(|at| *at != 51 * 64 + 21);
        wanted.sort_unstable();
        assert_eq!(found, wanted);
        let farthest = local(&heights, 64)[5];
        assert!(farthest.0 == spikes[0] && (farthest.1 - 0.9).abs() < 0.2, "{farthest:?}");
        assert_eq!(places(&[(65, 2.5)], 64, 1), "2.5000e0 at row 1, column 1");
    }

    #[test]
    fn spikes_and_round_numbers_are_heights() {
        let mut heights = smooth();
        heights[3] = -1e5;
        assert_eq!(refused(&heights, 64, false), None);
        // Counts of a converter around one of the marks.
        assert_eq!(
            refused(
                &smooth().iter().map(|h| (32_000.0 + 900.0 * h).round().min(32_767.0)).collect::<Vec<_>>(),
                64,
                false
            ),
            None
        );
        assert_eq!(refused(&[0.25; 64], 8, false), None);
    }

    #[test]
    fn a_surface_of_its_own_law_has_no_outliers() {
        assert_eq!(named(&smooth(), 64), None);
        assert_eq!(named(&[0.25; 64], 8), None);
        // Normal heights by their own quantiles: the largest of 4096 stands 3.5 deviations out, the limit is 15.
        let normal = statrs::distribution::Normal::standard();
        let quantile =
            |k: usize| statrs::distribution::ContinuousCDF::inverse_cdf(&normal, (k as f64 + 0.5) / 4096.0);
        assert_eq!(named(&(0..4096).map(quantile).collect::<Vec<_>>(), 64), None);
    }
}
