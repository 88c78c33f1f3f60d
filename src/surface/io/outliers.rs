//! Single heights of a measured map that stand far out of the rest: spikes and dust, which are named, and what marks
//! missing data, which is refused.
//!
//! One of them decides from which height on a ray is above everything, and so how much light leaves the map by its edge.

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

/// Why a map with `columns` heights in a row cannot be measured as it is: a value that is no height, with its place.
pub fn refused(heights: &[f64], columns: usize) -> Option<String> {
    let told = |what: &str, is_one: &dyn Fn(f64) -> bool| {
        let at = heights.iter().position(|&height| is_one(height))?;
        let count = heights.iter().filter(|&&height| is_one(height)).count();
        Some(format!(
            "height {:e} at row {}, column {} ({count} such of {}) {what}; fill in their neighbours' heights, or cut the map \
             to where there are data",
            heights[at],
            at / columns,
            at % columns,
            heights.len()
        ))
    };
    if let Some(why) = told("is no length: heights lie within 1e30", &|height| height.abs() >= NO_LENGTH) {
        return Some(why);
    }
    let median = quantile(&mut heights.to_vec(), 0.5);
    let mut distances: Vec<f64> = heights.iter().map(|height| (height - median).abs()).collect();
    let (usual, most) = (quantile(&mut distances, 0.5), quantile(&mut distances, 0.99));
    let marks = |height: f64| CUSTOMARY.contains(&height) && (height - median).abs() > OUTSIDE * usual;
    let what =
        format!("marks missing data: more than {OUTSIDE} median deviations ({usual:.3e}) from the median");
    told(&what, &marks).or_else(|| {
        let what =
            format!("is absurd: more than {ABSURD:e} times as far from the median as 99 of 100 ({most:.3e})");
        told(&what, &|height| most > 0.0 && (height - median).abs() > ABSURD * most)
    })
}

/// A sentence that names the outliers of a map with `columns` heights in a row, where there are any.
///
/// An outlier's distance from the median is above `FAR` times that of the 99th of 100 heights; where more than one
/// height in a hundred is that far out, they are the surface's own.
pub fn named(heights: &[f64], columns: usize) -> Option<String> {
    let median = quantile(&mut heights.to_vec(), 0.5);
    let mut distances: Vec<f64> = heights.iter().map(|height| (height - median).abs()).collect();
    let limit = FAR * quantile(&mut distances, 0.99);
    let mut found: Vec<usize> =
        (0..heights.len()).filter(|&at| (heights[at] - median).abs() > limit).collect();
    if found.is_empty() {
        return None;
    }
    found.sort_by(|&a, &b| (heights[b] - median).abs().total_cmp(&(heights[a] - median).abs()));
    let place = |&at: &usize| {
        let (row, column) = (at / columns, at % columns);
        format!("{:.4e} at row {row}, column {column}", heights[at] - median)
    };
    let places: Vec<String> = found.iter().take(NAMED).map(place).collect();
    let more = found.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(format!(
        "outlying heights ({}): {}{more} (from the median, in the file's unit; 99 % lie within {:.4e}): a ray is \
         clear of the map above the highest alone; set them to their neighbours' height in the scan",
        found.len(),
        places.join("; "),
        limit / FAR
    ))
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
            let why = refused(&heights, 64).unwrap_or_else(|| panic!("{value} is taken"));
            assert!(why.contains("at row 5, column 7 (1 such of 4096)") && why.contains(what), "{why}");
            // A third of the map, too.
            heights[..1365].fill(value);
            assert_eq!(refused(&heights, 64).is_some(), what != "is absurd", "{value}");
        }
    }

    #[test]
    fn spikes_and_round_numbers_are_heights() {
        let mut heights = smooth();
        heights[3] = -1e5;
        assert_eq!(refused(&heights, 64), None);
        // Counts of a converter around one of the marks.
        assert_eq!(
            refused(
                &smooth().iter().map(|h| (32_000.0 + 900.0 * h).round().min(32_767.0)).collect::<Vec<_>>(),
                64
            ),
            None
        );
        assert_eq!(refused(&[0.25; 64], 8), None);
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
