//! Where the fuzz targets start from: small sound files of every kind, written to `fuzz/corpus`.

use std::fs;
use std::io::Read;
use std::path::Path;

use gonio::files::image::{self, ImagePart, Samples};
use gonio::files::sealed;
use gonio::instrument::{Grid, GridKind};
use gonio::interchange;
use gonio::interchange::foreign_table;
use gonio::interchange::mitsuba::tensor_file;
use gonio::interchange::mitsuba::tensor_file::TensorData;
use gonio::interchange::{Format, Options};
use gonio::measure::persist::header::KIND;
use gonio::measure::{self, Patches, RunState, Session};
use gonio::surface::io::map_file;
use gonio::table::{BrdfTable, RealisationPart, Realisations, realisations, store};

use super::readers::CHECKPOINTED;
use super::scans::{self, BEGINNINGS};
use crate::support::radiance;

type Answer = Result<(), Box<dyn std::error::Error>>;

/// Where seeds are written.
pub struct Corpus<'a>(pub &'a Path);

impl Corpus<'_> {
    /// Writes the seeds that are made in no time.
    pub fn write_small(&self) -> Answer {
        self.tables()?;
        self.small_formats()?;
        self.maps()?;
        self.scans()?;
        self.campaigns()?;
        self.checkpoints()
    }

    fn seed(&self, target: &str, name: &str, bytes: &[u8]) -> Answer {
        let folder = self.0.join(target);
        fs::create_dir_all(&folder)?;
        Ok(fs::write(folder.join(name), bytes)?)
    }

    /// A seed that its reader takes: a fuzzer that starts at a refusal comes no deeper.
    fn sound_seed(&self, target: &str, name: &str, bytes: &[u8]) -> Answer {
        let found = if target.starts_with("map_") {
            map_file::read(&scans::file(target, bytes)).map(drop).map_err(|why| why.to_string())
        } else {
            let read = interchange::decode(target.parse()?, &Options::default(), bytes);
            read.map(drop).map_err(|why| why.to_string())
        };
        found.map_err(|why| format!("seed {name} of {target}: {why}"))?;
        self.seed(target, name, bytes)
    }

    fn tables(&self) -> Answer {
        for (name, colours) in [("y", 1), ("rgb", 3)] {
            let table = table(colours, 1)?;
            let bytes = store::encode(&table)?;
            self.seed("table", name, &bytes)?;
            // Without its digest any change reaches what comes after it.
            let mut parts = image::decode(&bytes)?;
            parts[0].attributes.remove("gonio.digest");
            self.seed("table", &format!("{name}_undigested"), &image::encode(parts)?)?;
            let of = |pick: fn(&gonio::table::ColourChannels) -> &Vec<f32>| {
                table.colours.iter().map(|colour| pick(colour).clone()).collect()
            };
            let part = RealisationPart { total: of(|c| &c.total), single: of(|c| &c.single), schlick: None };
            let parts = Realisations { parts: vec![part.clone(), part] };
            self.seed("realisations", name, &realisations::encode(&parts, &table, 1)?)?;
        }
        Ok(())
    }

    pub fn formats(&self) -> Answer {
        let folder = tempfile::tempdir()?;
        let large = ["merl", "utia", "klems", "tensor_tree"];
        for (name, format) in Format::ALL.map(|format| (format.name(), format)) {
            if !format.is_read() {
                continue;
            }
            for (kind, azimuths) in [("isotropic", 1), ("anisotropic", 8)] {
                let path = folder.path().join(format!("{name}_{kind}"));
                // What a format refuses is no seed of it; that its directions do not hold the lobe is no reason here.
                let wavelengths_nm = if format == Format::OpenMaterial { vec![550.0] } else { vec![] };
                let options =
                    Options { albedo_error: Some(f64::INFINITY), wavelengths_nm, ..Options::default() };
                if interchange::export(&table(1, azimuths)?, format, &options, &path).is_err() {
                    continue;
                }
                let bytes = fs::read(&path)?;
                // Long files begin as they should; the rest the fuzzer finds.
                let most = if large.contains(&name) { 1 << 14 } else { 1 << 16 };
                self.seed(name, kind, &bytes[..bytes.len().min(most)])?;
            }
        }
        self.seed("pabopto", "small", b"#incident_angle 30 0\n0 0 0.1\n30 180 0.5\n")?;
        self.seed("utia", "image", &image::encode(vec![picture(2, 2)])?)?;
        Ok(())
    }

    /// Whole files of the formats whose exports are so long that their beginning alone is a seed.
    fn small_formats(&self) -> Answer {
        let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
            <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
        let bases = "<ColumnAngleBasis>B</ColumnAngleBasis><RowAngleBasis>B</RowAngleBasis>";
        let xml = |structure: &str, basis: &str, data: &str| {
            radiance::reflection(structure, basis, bases, &[("Visible", data.into())])
        };
        self.sound_seed("klems", "two_patches", xml("Columns", basis, "1, 2, 3, 4").as_bytes())?;
        let leaves = "{{1 1 1 1 2 2 2 2}{3}{4}{5}{6}{7}{8}{0}}";
        self.sound_seed("tensor_tree", "rank_3", xml("TensorTree3", "", leaves).as_bytes())?;
        let leaves = format!("{{{}}}", " 0.5".repeat(16));
        self.sound_seed("tensor_tree", "rank_4", xml("TensorTree4", "", &leaves).as_bytes())?;
        let zemax = "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n\
            SampleRotation 1\n0\nAngleOfIncidence 1\n0\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 90\n\nMonochrome\n\
            DataBegin\nTIS 0.9\n1 2\n3 4\nDataEnd\n";
        self.sound_seed("zemax", "small", zemax.as_bytes())?;
        let rotations = (0..8).map(|k| (45 * k).to_string()).collect::<Vec<_>>().join(" ");
        let rotated = zemax
            .replace("PlaneSymmetrical", "ASymmetrical4D")
            .replace("SampleRotation 1\n0", &format!("SampleRotation 8\n{rotations}"))
            .replace("TIS 0.9\n1 2\n3 4\n", &"TIS 0.9\n1 2\n3 4\n".repeat(8));
        self.sound_seed("zemax", "rotated", rotated.as_bytes())?;
        self.sound_seed(
            "csv",
            "small",
            b"theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n0,0,10,0,0.5\n30,0,10,180,0.25\n",
        )?;
        self.sound_seed(
            "astm",
            "small",
            b"NUM_POINTS 2\nVARS theta_i,phi_i,theta_s,phi_s,Y\n0,0,0.2,0,0.5\n0.5,0,0.2,0,0.25\n",
        )?;
        for (name, phi) in [("isotropic", vec![0.0f32]), ("anisotropic", vec![-3.1, -1.5, 0.0, 1.5, 3.1])] {
            self.sound_seed("rgl", &format!("{name}_rgb"), &tensors(&phi, 3, false))?;
            self.sound_seed("rgl", &format!("{name}_spectra"), &tensors(&phi, 4, true))?;
        }
        Ok(())
    }

    fn maps(&self) -> Answer {
        let mut map = ImagePart { width: 8, height: 8, ..ImagePart::default() };
        map.channels.insert("height".into(), Samples::F32((0..64).map(|k| (k as f32).sqrt()).collect()));
        let exr = image::encode(vec![map])?;
        let mut npy = Vec::new();
        gonio::files::npy::encode(&mut npy, &[8, 8], (0..64).map(f64::from))?;
        let mut gsf = b"XRes = 2\nYRes = 2\nXReal = 1e-6\nYReal = 1e-6\n\0\0".to_vec();
        while !(26 + gsf.len()).is_multiple_of(4) {
            gsf.push(0);
        }
        gsf.extend([0.0f32, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
        let xyz = b"0 1 0.1\n1 0 0.2\n1 1 0.3\n";
        self.seed("height_map", "exr", &exr)?;
        self.seed("height_map", "npy", &npy)?;
        self.seed("height_map", "gsf", &[b"Gwyddion Simple Field 1.0\n", &gsf[..]].concat())?;
        self.seed("height_map", "xyz", &[b"0 0 0\n", &xyz[..]].concat())?;
        let rays = [
            ("waves", [4, 6, 0, 3, 3, 100, 50, 200, 90, 140]),
            ("open", [9, 5, 1, 7, 2, 30, 90, 20, 200, 110]),
        ];
        for (name, ray) in rays {
            let heights = (0..200u8).flat_map(|k| [k.wrapping_mul(37), k % 16]);
            self.seed("traced_map", name, &ray.into_iter().chain(heights).collect::<Vec<u8>>())?;
        }
        self.seed("map_gsf", "gsf", &gsf)?;
        self.seed("map_xyz", "xyz", xyz)?;
        assert!(map_file::read(&exr).is_ok() && map_file::read(&npy).is_ok());
        let picture = image::encode(vec![picture(2, 2)])?;
        let length = u16::try_from(picture.len())?.to_le_bytes();
        self.seed("maps", "two", &[&length[..], &picture, &picture].concat())
    }

    /// The scans of the tests, each as its target's input.
    fn scans(&self) -> Answer {
        for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/scans"))? {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let bytes = fs::read(&path)?;
            if name.ends_with(".x3p") {
                let mut archive = zip::ZipArchive::new(std::io::Cursor::new(&bytes))?;
                let (mut main, mut data) = (Vec::new(), Vec::new());
                archive.by_name("main.xml")?.read_to_end(&mut main)?;
                if let Ok(mut member) = archive.by_name("bindata/data.bin") {
                    member.read_to_end(&mut data)?;
                }
                // An input's document is no longer.
                if let Ok(length) = u16::try_from(main.len()) {
                    self.sound_seed("map_x3p", &name, &[&length.to_le_bytes()[..], &main, &data].concat())?;
                }
            }
            for (target, begins) in BEGINNINGS {
                if let Some(which) = begins.iter().position(|begin| bytes.starts_with(begin)) {
                    let input = [&[u8::try_from(which)?], &bytes[begins[which].len()..]].concat();
                    self.sound_seed(target, &name, &input)?;
                }
            }
        }
        Ok(())
    }

    fn campaigns(&self) -> Answer {
        let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
        for entry in fs::read_dir(configs)? {
            let path = entry?.path();
            if path.extension().is_some_and(|end| end == "toml") {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                self.seed("campaign", &name, &fs::read(&path)?)?;
            }
        }
        self.seed("index_file", "gold", b"wavelength_nm,n,k\n500,0.9,1.8\n550,0.4,2.4\n600,0.2,2.9\n")
    }

    /// A run at its beginning and at its end.
    fn checkpoints(&self) -> Answer {
        let (campaign, plan) = &*CHECKPOINTED;
        let patches = Patches::prepare(campaign, &mut Vec::new())?;
        let empty = RunState::new(campaign, plan);
        let whole =
            measure::measure_missing(campaign, plan, &patches, empty.clone(), &Session::plain(&|_| ()))?;
        for (name, run_state) in [("empty", empty), ("whole", whole)] {
            let bytes = run_state.to_bytes(1, campaign, plan)?;
            self.seed("checkpoint", name, sealed::open(KIND, &bytes)?)?;
        }
        Ok(())
    }
}

/// A few incidences of a few bins, every value different.
fn table(colours: usize, azimuths: usize) -> interchange::Checked<BrdfTable> {
    let phi_i_deg: Vec<f64> = (0..azimuths).map(|k| 360.0 * k as f64 / azimuths as f64).collect();
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![0.0, 30.0, 60.0],
        phi_r_relative: azimuths == 1,
        phi_i_deg,
        theta_r_edges_deg: vec![0.0, 30.0, 60.0, 90.0],
        phi_r_edges_deg: (0..=8).map(|k| 45.0 * f64::from(k)).collect(),
        ..Grid::default()
    };
    let values = grid.incidences() * grid.bins();
    let colour = |c: usize| (0..values).map(|k| 0.1 + 0.01 * (k % 7 + c) as f32).collect();
    foreign_table(grid, (0..colours).map(colour).collect())
}

/// An RGL file of two polar angles and two values a side.
fn tensors(phi: &[f32], channels: usize, spectral: bool) -> Vec<u8> {
    let theta = [0.1f32, 1.2];
    let ones = |count: usize| TensorData::F32((0..count).map(|k| 1.0 + (k % 5) as f32).collect());
    let slices = [phi.len(), theta.len()];
    let sides = |rest: &[usize]| [&slices[..], rest].concat();
    let count = slices[0] * slices[1];
    let name = if spectral { "spectra" } else { "rgb" };
    let mut fields = vec![
        ("theta_i", vec![theta.len()], TensorData::F32(theta.to_vec())),
        ("phi_i", vec![phi.len()], TensorData::F32(phi.to_vec())),
        ("ndf", vec![2, 2], ones(4)),
        ("sigma", vec![2, 2], ones(4)),
        ("vndf", sides(&[2, 2]), ones(4 * count)),
        (name, sides(&[channels, 2, 2]), ones(4 * channels * count)),
    ];
    if spectral {
        let nm = (0..channels).map(|k| 450.0 + 50.0 * k as f32).collect();
        fields.push(("wavelengths", vec![channels], TensorData::F32(nm)));
    }
    tensor_file::encode(&fields)
}

fn picture(width: usize, height: usize) -> ImagePart {
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    for name in ["B", "G", "R"] {
        part.channels.insert(name.into(), Samples::F32(vec![0.25; width * height]));
    }
    part
}
