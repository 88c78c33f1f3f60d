//! The materials of a campaign, checked: `[optics]`.

use serde::Serialize;

/// What a facet does to light.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Optics {
    /// F = 1.
    PerfectMirror,
    /// Schlick's Fresnel from the reflectance of R, G and B at normal incidence.
    Schlick {
        /// The material's name, where one was given.
        material: Option<String>,
        /// Reflectance at normal incidence for R, G, B, each in [0, 1].
        f0: [f64; 3],
    },
    /// A material whose index of refraction is known.
    Index(RefractiveIndex),
    /// Clear facets: what Fresnel's equations do not reflect goes through.
    Dielectric(Dielectric),
    /// Facets that scatter light evenly (Lambert's law).
    Diffuse {
        /// Reflectance of a facet for R, G, B, each in [0, 1].
        albedo: [f64; 3],
    },
    /// Facets of a matt base under a smooth clear interface.
    Layered {
        /// Reflectance of the base for R, G, B, each in [0, 1].
        albedo: [f64; 3],
        /// Index of the interface's inside over the outside, (1, 4].
        eta: f64,
    },
    /// Several materials, each with a table of its own, from the same paths. Never one of these inside; all with the
    /// same law.
    Several(Vec<Optics>),
}

/// A material by its index of refraction, at one or more wavelengths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RefractiveIndex {
    /// The material's name, where one was given.
    pub material: Option<String>,
    /// One colour of the table each, in the order of their wavelengths.
    pub media: Vec<Medium>,
    /// How the reflectance follows from the index.
    pub law: FresnelLaw,
    /// What light is counted.
    pub polarisation: Polarisation,
}

/// A clear material, at one or more wavelengths, and where the light comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dielectric {
    /// The material's name, where one was given.
    pub material: Option<String>,
    /// One colour of the table each, in the order of their wavelengths; k = 0, eta of the inside over the outside.
    pub media: Vec<Medium>,
    /// The side that the light comes from.
    pub light: LightSide,
    /// What light is counted: `None` or `Mueller`.
    pub polarisation: Polarisation,
}

/// A side of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LightSide {
    /// From outside, above the surface.
    Front,
    /// From inside the material, below it.
    Back,
}

/// An index of refraction eta + i k, relative to the outer medium.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Medium {
    /// Wavelength in nm, 1 to 1e6; `None` where a single index stands for all.
    pub wavelength_nm: Option<f64>,
    /// Real part, (0, 100].
    pub eta: f64,
    /// Imaginary part, [0, 100]; eta = 1 with k = 0 is no surface and refused.
    pub k: f64,
}

/// How the reflectance of a facet follows from its material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FresnelLaw {
    /// Schlick's approximation from the reflectance at normal incidence.
    Schlick,
    /// Fresnel's equations.
    Exact,
}

/// Light by its field against the plane of wi and wo.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Polarisation {
    /// Unpolarised.
    None,
    /// Across the plane.
    S,
    /// In the plane.
    P,
    /// Unpolarised, with the Mueller matrix beside it.
    Mueller,
}

impl Optics {
    /// The materials, one table each.
    pub fn each(&self) -> Vec<&Optics> {
        match self {
            Optics::Several(all) => all.iter().collect(),
            one => vec![one],
        }
    }

    /// The indices of all materials.
    pub fn media(&self) -> Vec<Medium> {
        let of = |one: &&Optics| match one {
            Optics::Index(index) => index.media.clone(),
            Optics::Dielectric(clear) => clear.media.clone(),
            _ => vec![],
        };
        self.each().iter().flat_map(of).collect()
    }

    /// The wavelengths of the table's colours, where they are told by them: with two, or with more than three. One
    /// colour is `Y`; three are R, G and B, the longest wavelength first.
    pub fn wavelengths_nm(&self) -> Vec<f64> {
        match self {
            Optics::Index(RefractiveIndex { media, .. }) | Optics::Dielectric(Dielectric { media, .. })
                if !matches!(media.len(), 1 | 3) =>
            {
                media.iter().filter_map(|medium| medium.wavelength_nm).collect()
            }
            _ => vec![],
        }
    }

    /// The sides that light comes from, each once.
    pub fn light_sides(&self) -> Vec<LightSide> {
        let side = |one: &&Optics| match one {
            Optics::Dielectric(clear) => clear.light,
            _ => LightSide::Front,
        };
        let all: Vec<LightSide> = self.each().iter().map(side).collect();
        [LightSide::Front, LightSide::Back].into_iter().filter(|side| all.contains(side)).collect()
    }

    /// Whether facets send light into the mirror direction alone.
    pub fn mirrors(&self) -> bool {
        let scatters = |one: &&Optics| {
            matches!(one, Optics::Dielectric(_) | Optics::Diffuse { .. } | Optics::Layered { .. })
        };
        !self.each().iter().any(scatters)
    }

    /// Whether light goes through the facets.
    pub fn lets_through(&self) -> bool {
        self.each().iter().any(|one| matches!(one, Optics::Dielectric(_)))
    }

    /// Whether Mueller matrices are measured; never of some materials alone.
    pub fn has_mueller(&self) -> bool {
        self.each().iter().any(|one| match one {
            Optics::Index(index) => index.polarisation == Polarisation::Mueller,
            Optics::Dielectric(clear) => clear.polarisation == Polarisation::Mueller,
            _ => false,
        })
    }

    /// The material's name, where it has one.
    pub fn material(&self) -> Option<&str> {
        match self {
            Optics::Schlick { material, .. } => material.as_deref(),
            Optics::Index(index) => index.material.as_deref(),
            Optics::Dielectric(clear) => clear.material.as_deref(),
            Optics::PerfectMirror | Optics::Diffuse { .. } | Optics::Layered { .. } | Optics::Several(_) => {
                None
            }
        }
    }

    /// Number of colours of its table; of all its tables together for several.
    pub fn colours(&self) -> usize {
        match self {
            Optics::PerfectMirror => 1,
            Optics::Schlick { .. } | Optics::Diffuse { .. } | Optics::Layered { .. } => 3,
            Optics::Index(index) => index.media.len(),
            Optics::Dielectric(clear) => clear.media.len(),
            Optics::Several(all) => all.iter().map(Optics::colours).sum(),
        }
    }

    /// What tells this material's files from those of the others.
    pub fn label(&self) -> String {
        match self {
            Optics::Index(index) => {
                let polarisation = match index.polarisation {
                    Polarisation::None | Polarisation::Mueller => None,
                    Polarisation::S => Some("s"),
                    Polarisation::P => Some("p"),
                };
                let parts = [index.material.as_deref(), polarisation];
                parts.into_iter().flatten().collect::<Vec<_>>().join("_")
            }
            Optics::Dielectric(clear) => {
                let side = if clear.light == LightSide::Front { "front" } else { "back" };
                let parts = [clear.material.as_deref(), Some(side)];
                parts.into_iter().flatten().collect::<Vec<_>>().join("_")
            }
            other => other.material().unwrap_or_default().to_string(),
        }
    }
}

impl Optics {
    /// In words, for the plan and the page.
    pub fn described(&self) -> String {
        match self {
            Optics::PerfectMirror => "F = 1".into(),
            Optics::Schlick { material: Some(name), f0 } => format!("{name}, Schlick, F0 {f0:?}"),
            Optics::Schlick { material: None, f0 } => format!("Schlick, F0 {f0:?}"),
            Optics::Index(index) => index.described(),
            Optics::Dielectric(clear) => clear.described(),
            Optics::Diffuse { albedo } => format!("facets scatter evenly, albedo {albedo:?}"),
            Optics::Layered { albedo, eta } => {
                format!("a matt base of albedo {albedo:?} under an interface of n = {eta}")
            }
            Optics::Several(all) => {
                let each: Vec<String> = all.iter().map(Optics::described).collect();
                format!("a table each for {}", each.join("; "))
            }
        }
    }
}

impl RefractiveIndex {
    fn described(&self) -> String {
        let material = self.material.as_ref().map_or(String::new(), |name| format!("{name}, "));
        let law =
            if self.law == FresnelLaw::Exact { "Fresnel's equations" } else { "Schlick from the index" };
        let at = described(&self.media);
        let polarised = match self.polarisation {
            Polarisation::None => "",
            Polarisation::S => ", s-polarised about the plane of wi and wo",
            Polarisation::P => ", p-polarised about the plane of wi and wo",
            Polarisation::Mueller => WITH_MUELLER,
        };
        format!("{material}{law}, {at}{polarised}")
    }

    /// The media in the order of the table's colours: R, G, B where there are three.
    pub fn by_colour(&self) -> Vec<Medium> {
        by_colour(&self.media)
    }
}

impl Dielectric {
    fn described(&self) -> String {
        let material = self.material.as_ref().map_or(String::new(), |name| format!("{name}, "));
        let side = if self.light == LightSide::Front { "" } else { ", light from inside" };
        let mueller = if self.polarisation == Polarisation::Mueller { WITH_MUELLER } else { "" };
        format!("{material}clear, {}{side}{mueller}", described(&self.media))
    }

    /// The media in the order of the table's colours: R, G, B where there are three.
    pub fn by_colour(&self) -> Vec<Medium> {
        by_colour(&self.media)
    }
}

const WITH_MUELLER: &str = ", with Mueller matrices";

fn described(media: &[Medium]) -> String {
    let index = |medium: &Medium| match medium.k {
        0.0 => format!("n = {}", medium.eta),
        k => format!("n = {} + {k} i", medium.eta),
    };
    let nm: Vec<f64> = media.iter().filter_map(|medium| medium.wavelength_nm).collect();
    match nm[..] {
        [] => index(&media[0]),
        [one] => format!("{} at {one} nm", index(&media[0])),
        [first, .., last] => {
            let what = if media.iter().all(|medium| medium.k == 0.0) { "n" } else { "n and k" };
            if let [b, g, r] = nm[..] {
                return format!("{what} at {b}, {g} and {r} nm, which become B, G and R");
            }
            format!("{what} at {} wavelengths from {first} to {last} nm", nm.len())
        }
    }
}

fn by_colour(media: &[Medium]) -> Vec<Medium> {
    let mut media = media.to_vec();
    if media.len() == 3 {
        media.reverse();
    }
    media
}
