//! Valid campaigns of every kind of surface, arms, optics and rules, for property tests.

use std::collections::BTreeSet;

use gonio::campaign::materials::{CLEAR, MATERIALS, clear_rgb_of, names_with_index, rgb_of};
use gonio::campaign::*;
use gonio::psd::{Psd, PsdKind, PsdModel, PsdTable};
use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::{select, subsequence};

/// Middles of the rings of the Klems full basis, degrees.
const KLEMS_RINGS: [f64; 9] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 82.5];

/// A campaign that a file in `folder` could hold, resolved.
pub fn any_campaign() -> impl Strategy<Value = Campaign> {
    surface().prop_flat_map(|surface| {
        let (kind, light) = (surface.kind.clone(), light(&surface));
        let path = (optics(), light).prop_flat_map(move |(optics, light)| {
            (trace(&kind, &optics), sensor(&light, optics.lets_through()), Just(optics), Just(light))
        });
        let name = "[a-zA-Z0-9_][a-zA-Z0-9_.-]{0,20}";
        let rest = (name, any::<u64>(), stop(&surface), expect(), scale(), bench(&surface));
        (Just(surface.clone()), path, rest).prop_map(
            |(surface, (trace, sensor, optics, light), (name, seed, stop, expect, scale, bench))| Campaign {
                scale: known_nowhere_else(scale, &surface, &optics),
                name,
                seed,
                surface,
                light,
                sensor,
                optics,
                trace,
                stop,
                expect,
                bench,
            },
        )
    })
}

fn alpha() -> impl Strategy<Value = f64> {
    prop_oneof![1e-4..=10.0, Just(1e-4), Just(10.0)]
}

/// One roughness for each axis, or isotropic ones that increase.
fn alphas() -> impl Strategy<Value = Vec<Alpha>> {
    let several = btree_set(1u32..=100_000, 1..5);
    prop_oneof![
        (alpha(), alpha()).prop_map(|(x, y)| vec![Alpha::new(x, y)]),
        several.prop_map(|all| all.into_iter().map(|a| 1e-4 * f64::from(a)).map(isotropic).collect()),
    ]
}

fn isotropic(alpha: f64) -> Alpha {
    Alpha::isotropic(alpha)
}

fn surface() -> impl Strategy<Value = Surface> {
    let patch = (1u32..=4096, 8u32..=16384, 0.0..=1.0, any::<bool>());
    let random = (random_heights(), patch, rotation()).prop_map(|(kind, patch, rotation_deg)| {
        let (realisations, cells, share, mirror_images) = patch;
        let longest = f64::from(cells) / 8.0;
        let shortest = longest.min(2.0);
        let correlation_cells = shortest + share * (longest - shortest);
        Surface { realisations, cells, correlation_cells, rotation_deg, mirror_images, kind }
    });
    let patch = (1u32..=4096, 8u32..=16384, any::<bool>());
    let grains = (grains(), patch, rotation()).prop_map(|(kind, patch, rotation_deg)| {
        let (realisations, cells, mirror_images) = patch;
        Surface { realisations, cells, correlation_cells: 8.0, rotation_deg, mirror_images, kind }
    });
    let other = (without_heights(), 1u32..=4096, rotation()).prop_map(|(kind, groups, rotation_deg)| {
        let realisations = if let SurfaceKind::File(map) = &kind { map.tiles * map.tiles } else { groups };
        let (cells, correlation_cells) = (1024, 8.0);
        Surface { realisations, cells, correlation_cells, rotation_deg, mirror_images: false, kind }
    });
    prop_oneof![random, grains, by_density(), other]
}

/// Gaussian heights of a power spectral density, on small patches: each looks at all of its waves.
fn by_density() -> impl Strategy<Value = Surface> {
    let patch = (1u32..=4096, 64u32..=256, any::<bool>());
    let lengths = (1e-3..=1e3, alpha(), any::<bool>());
    let numbers = (0.05..=0.95, 1.01..=8.0, vec(0.1..=1.0, 2..6));
    (patch, rotation(), 0u8..4, lengths, numbers).prop_map(
        |(
            (realisations, cells, mirror_images),
            rotation_deg,
            model,
            (pitch, alpha, limited),
            (hurst, c, falls),
        )| {
            let side = f64::from(cells) * pitch;
            let psd = |strength: f64| Psd {
                model: match model {
                    0 => PsdModel::KCorrelation { a_um3: strength, b_um: 10.0 * hurst * pitch, c },
                    1 => PsdModel::SelfAffine { rms_um: strength.sqrt(), hurst },
                    _ => PsdModel::Table(psd_table(model == 2, strength, pitch, &falls)),
                },
                // So many waves are held by the patch that the rms height is as good as the integral's.
                f_min_per_um: (model == 1 || limited).then_some(8.0 / side),
                f_max_per_um: limited.then_some(0.4 / pitch),
            };
            let of = |strength: f64| PsdSurface::new(psd(strength), pitch, None, cells).expect("waves");
            // Slopes go as the root of the density. A little inside the limits of alpha.
            let wanted = alpha.clamp(1.01e-4, 9.9);
            let (surface, correlation_cells) = of((wanted / of(1.0).0.alphas[0].x).powi(2));
            let kind = SurfaceKind::Psd(surface);
            Surface { realisations, cells, correlation_cells, rotation_deg, mirror_images, kind }
        },
    )
}

/// A density that falls from 0.001 over the pitch to one over it, areal or of a profile.
fn psd_table(areal: bool, strength: f64, pitch: f64, falls: &[f64]) -> PsdTable {
    let decades = |k: usize| 3.0 * k as f64 / (falls.len() - 1) as f64;
    let frequency: Vec<f64> = (0..falls.len()).map(|k| 1e-3 * 10f64.powf(decades(k)) / pitch).collect();
    let density = falls.iter().scan(strength, |density, fall| {
        *density *= 0.9 * fall;
        Some(*density)
    });
    let kind = if areal { PsdKind::Areal } else { PsdKind::Profile };
    PsdTable::new(kind, frequency, density.collect()).expect("a density")
}

/// Lengths by which geometric optics is judged.
fn scale() -> impl Strategy<Value = PhysicalScale> {
    let lengths = (proptest::option::of(1e-6..=1e6), proptest::option::of(1.0..=1e6));
    lengths.prop_map(|(pitch_um, wavelength_nm)| PhysicalScale { pitch_um, wavelength_nm })
}

/// Those that neither surface nor optics have.
fn known_nowhere_else(scale: PhysicalScale, surface: &Surface, optics: &Optics) -> PhysicalScale {
    let own = optics.media().iter().any(|medium| medium.wavelength_nm.is_some());
    PhysicalScale {
        pitch_um: scale.pitch_um.filter(|_| surface.kind.has_own_correlation()),
        wavelength_nm: scale.wavelength_nm.filter(|_| !own),
    }
}

fn rotation() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), 0.0..360.0]
}

fn random_heights() -> impl Strategy<Value = SurfaceKind> {
    let spectrum = select(vec![HeightSpectrum::Gaussian, HeightSpectrum::Exponential]);
    prop_oneof![
        alphas().prop_map(SurfaceKind::Ggx),
        (alphas(), spectrum).prop_map(|(alphas, spectrum)| SurfaceKind::Beckmann { alphas, spectrum }),
        (alphas(), 2.0..=100.0).prop_map(|(alphas, gamma)| SurfaceKind::StudentT { alphas, gamma }),
        (alphas(), 1e-4..=0.999).prop_map(|(mut alphas, coverage)| {
            alphas.iter_mut().for_each(|alpha| alpha.coverage = Some(coverage));
            let (side, base, shape) = (None, GrainBase::Mirror, GrainShape::Heights);
            SurfaceKind::Grains(Grains { alphas, side, base, shape })
        }),
        (0.0f64..=20_000.0).prop_map(|exponent| {
            let alphas = vec![isotropic((2.0 / (exponent + 2.0)).sqrt())];
            SurfaceKind::BlinnPhong { exponent, alphas }
        }),
    ]
}

/// Grains or pits: several roughnesses or several coverages.
fn grains() -> impl Strategy<Value = SurfaceKind> {
    let coverages = btree_set(1u32..=9990, 1..5)
        .prop_map(|all| all.into_iter().map(|c| 1e-4 * f64::from(c)).collect::<Vec<f64>>());
    let side = proptest::option::of(8.0..=10_000.0);
    let base = select(vec![GrainBase::Mirror, GrainBase::Absorbing]);
    let shape = select(vec![GrainShape::Grains, GrainShape::Pits]);
    (alphas(), coverages, any::<bool>(), side, base, shape).prop_map(
        |(mut alphas, mut coverages, by_alpha, side, base, shape)| {
            if by_alpha {
                coverages.truncate(1)
            } else {
                alphas.truncate(1)
            }
            let with = |alpha: &Alpha| {
                let of = |&coverage: &f64| Alpha { coverage: Some(coverage), ..*alpha };
                coverages.iter().map(of).collect::<Vec<_>>()
            };
            let alphas = alphas.iter().flat_map(with).collect();
            SurfaceKind::Grains(Grains { alphas, side, base, shape })
        },
    )
}

fn without_heights() -> impl Strategy<Value = SurfaceKind> {
    let ndf = select(vec![SmithNdf::Ggx, SmithNdf::Beckmann]);
    let heights = select(vec![SmithHeights::Correlated, SmithHeights::Independent]);
    prop_oneof![
        Just(SurfaceKind::Mirror),
        alpha().prop_map(|slope| SurfaceKind::VGroove { slope }),
        (ndf, alphas(), heights).prop_map(|(ndf, alphas, heights)| SurfaceKind::Smith(Smith {
            ndf,
            alphas,
            heights
        })),
        height_map().prop_map(SurfaceKind::File),
    ]
}

fn height_map() -> impl Strategy<Value = HeightMap> {
    let length = || 1e-9..=1e9;
    let name = "([a-z é]{1,6}/)?[a-z \"'\\\\é]{1,12}\\.(exr|gsf|xyz|txt|asc|npy|x3p|csv)";
    let detrend = select(vec![
        Detrend::Plane,
        Detrend::None,
        Detrend::Polynomial(2),
        Detrend::Polynomial(10),
        Detrend::Sphere,
        Detrend::Cylinder,
    ]);
    let refine = proptest::option::of((0u32..=6).prop_map(|power| 1 << power));
    let lengths = proptest::option::of([length(), length(), length()]);
    let channel = proptest::option::of("[A-Za-z0-9 \"\\\\é]{1,12}");
    (name, channel, lengths, any::<bool>(), detrend, refine, 1u32..=64, preparation()).prop_map(
        |(path, channel, lengths, periodic, detrend, refine, tiles, preparation)| {
            // An NPY file has no pitches of its own.
            let lengths = lengths.or(path.ends_with(".npy").then_some([0.5, 0.25, 1e-3]));
            let [pitch_x_um, pitch_y_um, height_unit_um] = [0, 1, 2].map(|k| lengths.map(|all| all[k]));
            let resolved_path = std::path::Path::new("folder").join(&path);
            let resolved_path = resolved_path.components().filter(|part| part.as_os_str() != ".").collect();
            HeightMap {
                path,
                resolved_path,
                channel,
                pitch_x_um,
                pitch_y_um,
                height_unit_um,
                periodic,
                detrend,
                refine,
                tiles,
                preparation,
            }
        },
    )
}

fn preparation() -> impl Strategy<Value = Preparation> {
    let gaps = select(vec![Gaps::Refuse, Gaps::Interpolate, Gaps::Exclude]);
    let outliers = select(vec![Outliers::Keep, Outliers::Fill, Outliers::Exclude]);
    let cut_offs = (proptest::option::of(0.1..=10.0), proptest::option::of(10.5..=1e3));
    (gaps, outliers, cut_offs).prop_map(|(gaps, outliers, (s_filter_um, l_filter_um))| Preparation {
        gaps,
        outliers,
        s_filter_um,
        l_filter_um,
    })
}

/// Angles that increase, in steps of 1e-4 degrees.
fn angles(range: std::ops::Range<i32>) -> impl Strategy<Value = Vec<f64>> {
    let degrees = |all: BTreeSet<i32>| all.into_iter().map(|angle| f64::from(angle) / 1e4).collect();
    btree_set(range, 1..8).prop_map(degrees)
}

/// A half-angle that leaves cones about all of `angles` above the horizon; `share` in [0, 1) of the largest.
fn aperture(angles: &[f64], share: f64) -> f64 {
    let widest = angles.iter().fold(0.0, |widest: f64, angle| widest.max(angle.abs()));
    share * (90.0 - widest).min(45.0)
}

fn light(surface: &Surface) -> impl Strategy<Value = LightArm> + use<> {
    let isotropic = surface.kind.is_isotropic();
    let azimuth = prop_oneof![
        any::<bool>().prop_map(move |average| (Azimuth::Relative, average || !isotropic)),
        angles(0..3_600_000).prop_map(|phis| (Azimuth::Absolute(phis), false)),
        Just((Azimuth::KlemsFull, false)),
    ];
    let share = prop_oneof![Just(0.0), 0.0..1.0];
    (angles(0..900_000), azimuth, share).prop_map(|(angles, (azimuth, average_azimuth), share)| {
        let theta_i_deg = if azimuth == Azimuth::KlemsFull { KLEMS_RINGS.to_vec() } else { angles };
        let aperture_deg = aperture(&theta_i_deg, share);
        LightArm { theta_i_deg, azimuth, average_azimuth, aperture_deg }
    })
}

fn sensor(light: &LightArm, through: bool) -> impl Strategy<Value = SensorArm> + use<> {
    let bins = select(vec![BinLayout::Centred, BinLayout::Aligned]);
    let origins = if light.azimuth == Azimuth::Relative {
        vec![PhiFrom::Light]
    } else {
        vec![PhiFrom::Light, PhiFrom::Sample]
    };
    let sides = [SensorSide::Reflection, SensorSide::Transmission, SensorSide::Both];
    let sides = select(if through { sides.to_vec() } else { sides[..1].to_vec() });
    let patches = sides.clone();
    let polar = prop_oneof![angles(-899_999..899_999), angles(900_001..1_800_000)];
    let polar = if through { polar.boxed() } else { angles(-899_999..899_999).boxed() };
    let arm = (polar, angles(0..3_600_000), 0.1..1.0, select(origins));
    prop_oneof![
        (sides, 1u32..=900, 1u32..=3600, bins).prop_map(|(side, theta_r_bins, phi_r_bins, bins)| {
            SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins }
        }),
        arm.prop_map(|(theta_r_deg, phi_r_deg, share, phi_r_from)| {
            let from_pole: Vec<f64> =
                theta_r_deg.iter().map(|t| f64::min(t.abs(), 180.0 - t.abs())).collect();
            let aperture_deg = aperture(&from_pole, share);
            SensorArm::Arm { theta_r_deg, phi_r_deg, aperture_deg, phi_r_from }
        }),
        patches.prop_map(|side| SensorArm::KlemsFull { side }),
    ]
}

fn optics() -> impl Strategy<Value = Optics> {
    let named = |(name, f0): (&str, [f64; 3])| Optics::Schlick { material: Some(name.into()), f0 };
    let all = subsequence(MATERIALS.to_vec(), 1..=MATERIALS.len());
    prop_oneof![
        Just(Optics::PerfectMirror),
        [0.0..=1.0, 0.0..=1.0, 0.0..=1.0].prop_map(|f0| Optics::Schlick { material: None, f0 }),
        all.prop_map(move |all| one_or_several(all.into_iter().map(named).collect())),
        indices(),
        clear(),
        [0.0..=1.0, 0.0..=1.0, 0.0..=1.0].prop_map(|albedo| Optics::Diffuse { albedo }),
        ([0.0..=1.0, 0.0..=1.0, 0.0..=1.0], 1.000_001..=4.0)
            .prop_map(|(albedo, eta)| Optics::Layered { albedo, eta }),
    ]
}

/// Clear materials under light from each of some sides.
fn clear() -> impl Strategy<Value = Optics> {
    let medium = |wavelength_nm, eta| Medium { wavelength_nm, eta, k: 0.0 };
    let eta = || prop_oneof![1e-2..=0.999, 1.001..=100.0];
    let listed = (btree_set(1u32..=1_000_000, 1..6), vec(eta(), 6)).prop_map(move |(nm, etas)| {
        let media = nm.into_iter().zip(etas).map(|(nm, eta)| medium(Some(f64::from(nm)), eta));
        vec![(None, media.collect())]
    });
    let single = eta().prop_map(move |eta| vec![(None, vec![medium(None, eta)])]);
    let names = CLEAR.map(|(name, ..)| name).to_vec();
    let named = subsequence(names, 1..=CLEAR.len()).prop_map(|names| {
        let media = |name: &str| clear_rgb_of(name).expect("an index");
        names.into_iter().map(|name| (Some(name.to_string()), media(name))).collect()
    });
    let sides = subsequence(vec![LightSide::Front, LightSide::Back], 1..=2);
    (prop_oneof![listed, single, named], sides).prop_map(|(materials, sides)| {
        let of_side = |&light: &LightSide| {
            let all = materials.iter().map(move |(material, media): &(Option<String>, Vec<Medium>)| {
                Optics::Dielectric(Dielectric {
                    material: material.clone(),
                    media: media.clone(),
                    light,
                    polarisation: Polarisation::None,
                })
            });
            all.collect::<Vec<_>>()
        };
        one_or_several(sides.iter().flat_map(of_side).collect())
    })
}

fn one_or_several(mut all: Vec<Optics>) -> Optics {
    if all.len() == 1 { all.remove(0) } else { Optics::Several(all) }
}

/// Materials by their index, each in each of some polarisations.
fn indices() -> impl Strategy<Value = Optics> {
    let number = || (0.01..=100.0, 1e-3..=100.0);
    let medium = |wavelength_nm, (eta, k)| Medium { wavelength_nm, eta, k };
    let listed = (btree_set(1u32..=1_000_000, 1..6), vec(number(), 6)).prop_map(move |(nm, numbers)| {
        let media = nm.into_iter().zip(numbers).map(|(nm, number)| medium(Some(f64::from(nm)), number));
        vec![(None, media.collect())]
    });
    let single = number().prop_map(move |number| vec![(None, vec![medium(None, number)])]);
    let named = subsequence(names_with_index().to_vec(), 1..=8).prop_map(|names| {
        let media = |name: &str| rgb_of(name).expect("an index").into_iter().rev().collect::<Vec<Medium>>();
        names.into_iter().map(|name| (Some(name.to_string()), media(name))).collect()
    });
    let polarisations = vec![Polarisation::None, Polarisation::S, Polarisation::P];
    let exact = subsequence(polarisations, 1..=3).prop_map(|some| (FresnelLaw::Exact, some));
    let laws = prop_oneof![exact, Just((FresnelLaw::Schlick, vec![Polarisation::None]))];
    (prop_oneof![listed, single, named], laws).prop_map(|(materials, (law, polarisations))| {
        // Schlick's law takes the F0 of a name.
        let law = if materials[0].0.is_some() { FresnelLaw::Exact } else { law };
        let all = materials.iter().flat_map(|(material, media): &(Option<String>, Vec<Medium>)| {
            polarisations.iter().map(move |&polarisation| {
                let (material, media) = (material.clone(), media.clone());
                Optics::Index(RefractiveIndex { material, media, law, polarisation })
            })
        });
        one_or_several(all.collect())
    })
}

fn trace(kind: &SurfaceKind, optics: &Optics) -> impl Strategy<Value = Trace> + use<> {
    let statistical = matches!(kind, SurfaceKind::Smith(_));
    let polarised = optics
        .each()
        .iter()
        .any(|one| matches!(one, Optics::Index(index) if index.polarisation != Polarisation::None));
    let orders = if polarised { 1..=1 } else { 1..=10_000u32 };
    (prop_oneof![Just(1), orders], any::<[bool; 3]>()).prop_map(move |(bounces, [visible, fold, apart])| {
        let visibility = visible || statistical || bounces > 1;
        Trace { bounces, visibility, fold, by_order: apart && (2..=16).contains(&bounces) }
    })
}

fn stop(surface: &Surface) -> impl Strategy<Value = Stop> + use<> {
    let may_spread = surface.realisations > 1;
    let rules = (proptest::option::of(1e-4..=1.0), proptest::option::of(1.0..=1e6));
    (1u64..=1 << 40, rules).prop_map(move |(samples, (relative_error, seconds))| Stop {
        samples,
        relative_error: relative_error.filter(|_| may_spread),
        seconds,
    })
}

fn expect() -> impl Strategy<Value = Expect> {
    let maskings =
        [ExpectedMasking::Separable, ExpectedMasking::HeightCorrelated, ExpectedMasking::DirectionCorrelated];
    let masking = proptest::option::of(select(maskings.to_vec()));
    (masking, proptest::option::of(1e-9..=10.0)).prop_map(|(masking, l1_model)| Expect { masking, l1_model })
}

fn bench(surface: &Surface) -> impl Strategy<Value = Option<Resolution>> + use<> {
    let resolution = (vec(8u32..=16384, 1..4), vec(0.0..=1.0, 1..4)).prop_map(|(cells, shares)| {
        let longest = f64::from(cells.iter().copied().min().expect("one at least")) / 8.0;
        let shortest = longest.min(2.0);
        let between = |share: f64| shortest + share * (longest - shortest);
        Resolution { cells, correlation_cells: shares.into_iter().map(between).collect() }
    });
    let varied = surface.kind.has_own_correlation();
    proptest::option::of(resolution).prop_map(move |resolution| resolution.filter(|_| varied))
}
