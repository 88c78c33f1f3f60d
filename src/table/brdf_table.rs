//! The result of a measurement: BRDF values, error bars and hits over (incidence, bin).

use super::gaps::NOT_KNOWN;
use crate::instrument::Grid;
use crate::stats;

/// A measured (or imported) BRDF table. Every channel is row-major: `incidence * bins + bin`.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfTable {
    /// Which incidences and bins.
    pub grid: Grid,
    /// The resolved campaign, TOML.
    pub campaign: String,
    /// Program version that made it.
    pub version: String,
    /// The campaign's seed.
    pub seed: u64,
    /// SHA-256 over the patches' heights, hex; empty where there are none.
    pub patch_digest: String,
    /// One entry per colour: one (Y), three (R, G, B), or one for each wavelength.
    pub colours: Vec<ColourChannels>,
    /// Arrivals in the bin, folded and mirrored ones once each.
    pub hits: Vec<u32>,
    /// What the table of another Schlick material follows from, where it was summed.
    pub schlick: Option<SchlickSums>,
}

/// The channels of one colour, BRDF in 1/sr without cosine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColourChannels {
    /// All orders together.
    pub total: Vec<f32>,
    /// Order 1.
    pub single: Vec<f32>,
    /// Orders above 1.
    pub multiple: Vec<f32>,
    /// Standard error of the mean of `total` over the realisations; -1: not available.
    pub stderr: Vec<f32>,
    /// The same of `single`.
    pub stderr_single: Vec<f32>,
    /// Standard error over the realisations of each incidence's albedo, all orders together. The bins of an incidence
    /// vary together: it does not follow from `stderr`. Empty where it is not known, as with one realisation.
    pub albedo_se: Vec<f32>,
    /// Orders 2, 3, ... by themselves, where they were asked for.
    pub orders: Vec<Vec<f32>>,
    /// The elements m00, m01, ... m33 of the Mueller matrix, all orders together, 1/sr like `total`; empty where they were
    /// not asked for. Frames: `optics::mueller`.
    pub mueller: Vec<Vec<f32>>,
    /// Standard errors of the mean of each element over the realisations; -1: not available.
    pub stderr_mueller: Vec<Vec<f32>>,
    /// What light over the edge of an open map may have added to `total` at most, were there nothing beyond, and all of
    /// what may go on beyond besides; empty where the surface has no edge. The errors cover it.
    pub left_map: Vec<f32>,
    /// The wavelength that names the colour; `None` for Y, R, G, B.
    pub wavelength_nm: Option<f64>,
}

/// Sums over paths as BRDFs, from which Schlick's BRDF of any F0 follows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SchlickSums {
    /// Order 1 with F = 1. Empty in files that hold `schlick` alone.
    pub unit: Vec<f32>,
    /// Order 1 times (1-c)^5.
    pub first: Vec<f32>,
    /// The parts (`optics::parts`) of orders 2, 3, ... (channels by order), or of all of them together:
    /// \[group\]\[part\].
    pub further: Vec<Vec<Vec<f32>>>,
}

/// The table of every realisation (or group of realisations), for pairing and jackknife.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Realisations {
    /// One entry per realisation.
    pub parts: Vec<RealisationPart>,
}

/// One realisation's values, a vector per colour.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RealisationPart {
    /// All orders together.
    pub total: Vec<Vec<f32>>,
    /// Order 1.
    pub single: Vec<Vec<f32>>,
    /// As in the table.
    pub schlick: Option<SchlickSums>,
}

/// Flux into bins of these projected solid angles, as a share of the incident flux.
pub fn flux(values: &[f32], sizes: &[f64]) -> f64 {
    values.iter().zip(sizes).map(|(&value, size)| f64::from(value) * size).sum()
}

impl BrdfTable {
    /// Channel names of the colours: `Y`; `R G B`; or the wavelengths, as in `w550` and `w632_8` (an EXR channel name
    /// has no point but between layers).
    pub fn colour_names(&self) -> Vec<String> {
        let plain: &[&str] = if self.colours.len() == 1 { &["Y"] } else { &["R", "G", "B"] };
        let name = |(k, colour): (usize, &ColourChannels)| match colour.wavelength_nm {
            Some(nm) => wavelength_name(nm),
            // One colour too many has a name that nobody else has.
            None => plain.get(k).map_or_else(|| format!("colour{k}"), |name| name.to_string()),
        };
        self.colours.iter().enumerate().map(name).collect()
    }

    /// The same table on another grid, without its values: what it is called and made of.
    pub fn header(&self, grid: &Grid) -> Self {
        let empty = |colour: &ColourChannels| ColourChannels {
            orders: vec![Vec::new(); colour.orders.len()],
            mueller: vec![Vec::new(); colour.mueller.len()],
            stderr_mueller: vec![Vec::new(); colour.mueller.len()],
            wavelength_nm: colour.wavelength_nm,
            ..ColourChannels::default()
        };
        BrdfTable {
            grid: grid.clone(),
            campaign: self.campaign.clone(),
            version: self.version.clone(),
            seed: self.seed,
            patch_digest: self.patch_digest.clone(),
            colours: self.colours.iter().map(empty).collect(),
            hits: Vec::new(),
            schlick: None,
        }
    }

    /// The same table with the errors of its albedos, over the very values that realisations hold in their file.
    // Tested by `errors_of_albedos_do_not_change_with_a_missing_file` (tests/it/cli.rs).
    pub fn with_albedo_errors(mut self, parts: &[RealisationPart]) -> Self {
        if parts.len() < 2 {
            return self;
        }
        let bins = self.grid.bins();
        for incidence in 0..self.grid.incidences() {
            let sizes = self.grid.sizes(incidence);
            for (colour, channels) in self.colours.iter_mut().enumerate() {
                let flux =
                    |part: &RealisationPart| flux(&part.total[colour][incidence * bins..][..bins], &sizes);
                let (_, se) = stats::mean_and_se(parts.iter().map(flux));
                channels.albedo_se.extend(se.map(|se| se as f32));
            }
        }
        self
    }

    /// The table without everything but totals and hits: what readers of values alone need, a third of the memory or
    /// less. It cannot be stored, and knows no gaps.
    pub fn totals_alone(self) -> Self {
        let total = |colour: ColourChannels| ColourChannels {
            total: colour.total,
            wavelength_nm: colour.wavelength_nm,
            ..ColourChannels::default()
        };
        BrdfTable { colours: self.colours.into_iter().map(total).collect(), schlick: None, ..self }
    }

    /// Whether orders above 1 have channels of their own.
    pub fn is_by_order(&self) -> bool {
        self.colours.iter().any(|colour| !colour.orders.is_empty())
    }

    /// The wavelengths that name the colours; none for Y and R, G, B.
    pub fn wavelengths_nm(&self) -> Vec<f64> {
        self.colours.iter().filter_map(|colour| colour.wavelength_nm).collect()
    }

    /// Whether the colours are wavelengths rather than Y or R, G, B.
    pub fn is_spectral(&self) -> bool {
        self.colours.iter().any(|colour| colour.wavelength_nm.is_some())
    }
}

/// The name of the channel of a wavelength.
pub fn wavelength_name(nm: f64) -> String {
    format!("w{nm}").replace('.', "_")
}

/// The wavelength that a channel's name speaks of.
pub fn named_wavelength(name: &str) -> Option<f64> {
    let nm: f64 = name.strip_prefix('w')?.replace('_', ".").parse().ok()?;
    (nm > 0.0 && wavelength_name(nm) == name).then_some(nm)
}

/// Arrivals that a bin without any is given as its upper bound.
pub const HITS_OF_AN_EMPTY_BIN: f64 = 1.5;

impl ColourChannels {
    /// Mean and standard error over the realisations of one colour, of the very f32 values that their file holds.
    ///
    /// `empty` is the error of a bin without light: the BRDF of [`HITS_OF_AN_EMPTY_BIN`]. With one realisation there
    /// are no errors.
    pub fn of_realisations(parts: &[RealisationPart], colour: usize, hits: &[u32], empty: &[f32]) -> Self {
        let mut channels = ColourChannels::default();
        for (entry, &hits) in hits.iter().enumerate() {
            let of = |pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| {
                let values = parts.iter().map(move |part| f64::from(pick(part)[colour][entry]));
                let (mean, se) = stats::mean_and_se(values);
                // No light of the asked-for orders in any realisation, though others may have hit: as in an empty bin.
                let se = if hits == 0 || mean == 0.0 {
                    empty[entry]
                } else {
                    se.map_or(NOT_KNOWN, |se| se as f32)
                };
                (mean, if parts.len() > 1 { se } else { NOT_KNOWN })
            };
            let (total, stderr) = of(|part| &part.total);
            let (single, stderr_single) = of(|part| &part.single);
            channels.total.push(total as f32);
            channels.single.push(single as f32);
            channels.multiple.push((total - single) as f32);
            channels.stderr.push(stderr);
            channels.stderr_single.push(stderr_single);
        }
        channels
    }
}

impl Realisations {
    /// Adds the incidences of the next band to every part.
    pub fn append(&mut self, next: Realisations) {
        if self.parts.is_empty() {
            *self = next;
            return;
        }
        for (mine, theirs) in self.parts.iter_mut().zip(next.parts) {
            let lists = mine.total.iter_mut().chain(&mut mine.single);
            lists.zip(theirs.total.into_iter().chain(theirs.single)).for_each(|(a, b)| a.extend(b));
            if let (Some(mine), Some(theirs)) = (&mut mine.schlick, theirs.schlick) {
                mine.append(theirs);
            }
        }
    }
}

impl SchlickSums {
    /// Adds the sums of further incidences.
    fn append(&mut self, next: SchlickSums) {
        self.unit.extend(next.unit);
        self.first.extend(next.first);
        let parts = self.further.iter_mut().flatten();
        parts.zip(next.further.into_iter().flatten()).for_each(|(a, b)| a.extend(b));
    }

    /// The channels that hold the sums: `schlick`, `unit`, and `parts.0`, ... of all orders above 1 together, or
    /// `order2.parts.0`, ... of each.
    pub fn channels(&self, by_order: bool) -> Vec<(String, &Vec<f32>)> {
        let mut all = vec![("schlick".to_string(), &self.first)];
        all.extend((!self.unit.is_empty()).then(|| ("unit".into(), &self.unit)));
        for (group, parts) in self.further.iter().enumerate() {
            let named = |(part, sums)| (further_name(by_order, group, part), sums);
            all.extend(parts.iter().enumerate().map(named));
        }
        all
    }

    /// The sums from their channels; `take` gives one by its name, where it is there. `None` without `schlick`.
    pub fn gathered<E>(mut take: impl FnMut(&str) -> Result<Option<Vec<f32>>, E>) -> Result<Option<Self>, E> {
        let Some(first) = take("schlick")? else { return Ok(None) };
        let mut sums = SchlickSums { first, unit: take("unit")?.unwrap_or_default(), further: vec![] };
        for by_order in [false, true] {
            while let Some(first) = take(&further_name(by_order, sums.further.len(), 0))? {
                let mut parts = vec![first];
                while let Some(part) = take(&further_name(by_order, sums.further.len(), parts.len()))? {
                    parts.push(part);
                }
                sums.further.push(parts);
                if !by_order {
                    return Ok(Some(sums));
                }
            }
        }
        Ok(Some(sums))
    }
}

fn further_name(by_order: bool, group: usize, part: usize) -> String {
    if by_order { format!("order{}.parts.{part}", group + 2) } else { format!("parts.{part}") }
}
