//! What the comments above a matrix say: Gwyddion's `# Width: 12.00 µm`, `# Height: ...`, `# Value units: m`, and SPIP's
//! `# x-pixels = 512`, `# x-length = 2000`, `# z-unit = nm`.
//!
//! SPIP's lengths are nm; without a `z-unit` its heights are steps of `Bit2nm` nm. Source: SPIP's ASCII files as
//! `SurfaceTopography` and Gwyddion read them.

use super::fields::is_passed_over;
use crate::surface::io::readers::units;

/// Size of a map along x and y in the unit of its heights, and that unit in um.
pub type Sizes = ([f64; 2], f64);

/// The comments above the first row, as names and values.
pub struct Head<'a> {
    named: Vec<(&'a str, &'a str)>,
}

impl<'a> Head<'a> {
    pub fn of(text: &'a str) -> Self {
        let comments = text.lines().take_while(|line| is_passed_over(line));
        let part = |line: &'a str| {
            let line = line.trim().trim_start_matches('#');
            line.split_once([':', '=']).map(|(name, value)| (name.trim(), value.trim()))
        };
        Head { named: comments.filter_map(part).collect() }
    }

    fn value(&self, name: &str) -> Option<&'a str> {
        self.named.iter().find(|(key, _)| *key == name).map(|(_, value)| *value)
    }

    /// A number by its name; `None` where it is not there.
    fn number(&self, name: &str) -> Result<Option<f64>, String> {
        let Some(text) = self.value(name) else { return Ok(None) };
        let number: Option<f64> = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.map(Some).ok_or_else(|| format!("{name} = {text:.40}: must be a number"))
    }

    /// Whether there are as many rows and columns as SPIP says.
    pub fn check(&self, columns: usize, rows: usize) -> Result<(), String> {
        for (name, found, what) in [("x-pixels", columns, "columns"), ("y-pixels", rows, "rows")] {
            match self.number(name)? {
                Some(said) if said != found as f64 => {
                    return Err(format!(
                        "its head says {name} = {said}, but {found} {what} follow: the file is cut off or was changed; export \
                         it again"
                    ));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The points that SPIP calls void; which ones, the file does not say.
    pub fn voids(&self) -> Option<f64> {
        self.number("voidpixels").ok().flatten().filter(|count| *count > 0.0)
    }

    /// Sizes and unit; `None` where nothing is said of them.
    pub fn sizes(&self) -> Result<Option<Sizes>, String> {
        match ["Width", "Height"].map(|name| self.value(name)) {
            [Some(width), Some(height)] => self.of_gwyddion([("Width", width), ("Height", height)]).map(Some),
            _ => self.of_spip(),
        }
    }

    fn of_gwyddion(&self, lengths: [(&str, &str); 2]) -> Result<Sizes, String> {
        let unit = self.value("Value units").ok_or("no line `# Value units:`")?;
        let unit_um =
            1e6 * units::metres(unit).ok_or_else(|| format!("Value units `{unit:.40}` is no length"))?;
        let length = |(name, text): (&str, &str)| -> Result<f64, String> {
            let (number, lateral) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
            let number: f64 =
                number.parse().map_err(|_| format!("{name} `{text:.40}` is no number and unit"))?;
            Ok(number
                * units::ratio(lateral.trim(), unit).map_err(|why| format!("{name} `{text:.40}`: {why}"))?)
        };
        let [width, height] = lengths;
        Ok(([length(width)?, length(height)?], unit_um))
    }

    fn of_spip(&self) -> Result<Option<Sizes>, String> {
        let (Some(x), Some(y)) = (self.number("x-length")?, self.number("y-length")?) else {
            return Ok(None);
        };
        if x <= 0.0 || y <= 0.0 {
            return Err(format!("x-length = {x}, y-length = {y}: not positive"));
        }
        // A unit of height, nm.
        let unit = match (self.value("z-unit"), self.number("Bit2nm")?) {
            (Some(name), _) => {
                1e9 * units::metres(name).ok_or_else(|| format!("z-unit `{name:.40}` is no length"))?
            }
            (None, Some(step)) if step > 0.0 => step,
            (None, _) => return Err("no line `# z-unit =`".into()),
        };
        Ok(Some(([x / unit, y / unit], 1e-3 * unit)))
    }
}
