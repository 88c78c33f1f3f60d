//! Promise: what the fuzz targets of `fuzz/` have found stays found; and where they start from.

use std::fs;
use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::error::Error;
use gonio::files::image::{self, Part, Samples};
use gonio::files::sealed;
use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{self, Format, Options, foreign_table};
use gonio::measure::{self, Checkpoint, Kept, Ledger, Patches, Plan, Session};
use gonio::surface::map_file;
use gonio::table::{BrdfTable, RealisationPart, Realisations, realisations, store};

type Answer = Result<(), Box<dyn std::error::Error>>;

/// Every file of `tests/data/fuzz/<target>/` once made a reader panic, hang or speak in several lines.
#[test]
fn findings_of_the_fuzzer_are_answered_in_one_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/fuzz");
    let mut tried = 0;
    for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
        let target = entry.file_name().to_string_lossy().into_owned();
        for file in fs::read_dir(entry.path()).expect("a folder of findings").flatten() {
            let bytes = fs::read(file.path()).expect("a finding");
            if let Err(why) = read(&target, &bytes) {
                let why = Error::format(Path::new("fuzzed"), why).to_string();
                let line = !why.is_empty() && !why.contains('\n') && why.chars().count() <= 500;
                assert!(line, "{}: {why:?}", file.path().display());
            }
            tried += 1;
        }
    }
    assert!(tried > 0 || !folder.exists());
}

/// What the target's reader says.
fn read(target: &str, bytes: &[u8]) -> Result<(), String> {
    let here = Path::new("fuzzed");
    match target {
        "table" => store::decode(here, bytes).map(drop).map_err(|e| e.to_string()),
        "realisations" => realisations::decode(here, bytes).map(drop).map_err(|e| e.to_string()),
        "height_map" => map_file::read(bytes).map(drop),
        "map_gsf" => map_file::read(&[b"Gwyddion Simple Field 1.0\n", bytes].concat()).map(drop),
        "map_xyz" => map_file::read(&[b"0 0 0\n", bytes].concat()).map(drop),
        "pabopto" => interchange::pabopto::read(bytes).map(drop),
        "checkpoint" => {
            let (campaign, plan) = checkpoint_of();
            let sealed =
                sealed::seal(Checkpoint::KIND, bytes.len(), |head| Ok::<_, String>([&head, bytes].concat()))?;
            Kept::from_bytes(Checkpoint::KIND, &sealed)?.ledger(&campaign, &plan).map(drop)
        }
        "campaign" => match campaign::parse(bytes, "c.toml", here) {
            Ok(parsed) => {
                let text = campaign::to_toml(&parsed.campaign);
                let again = campaign::parse(&text, "c.toml", here).expect("its own text");
                assert!(again.campaign == parsed.campaign);
                Ok(())
            }
            Err(gonio::error::Error::Campaign(faults)) => {
                faults.iter().try_for_each(|fault| Err(fault.to_string()))
            }
            Err(other) => Err(other.to_string()),
        },
        format => {
            let format: Format = format.parse()?;
            interchange::decode(format, &Options::default(), bytes).map(drop)
        }
    }
}

#[test]
#[ignore = "writes fuzz/corpus: cargo test --test it fuzzed -- --ignored"]
fn seeds_of_the_fuzz_targets_are_written() {
    tables().expect("tables");
    formats().expect("formats");
    maps().expect("maps");
    campaigns().expect("campaigns");
    checkpoints().expect("checkpoints");
}

fn seed(target: &str, name: &str, bytes: &[u8]) -> Answer {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    fs::create_dir_all(&folder)?;
    Ok(fs::write(folder.join(name), bytes)?)
}

/// A few stops of a few bins, every value different.
fn table(colours: usize, azimuths: usize) -> Result<BrdfTable, String> {
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
    let values = grid.stops() * grid.bins();
    let colour = |c: usize| (0..values).map(|k| 0.1 + 0.01 * (k % 7 + c) as f32).collect();
    foreign_table(grid, (0..colours).map(colour).collect())
}

fn tables() -> Answer {
    for (name, colours) in [("y", 1), ("rgb", 3)] {
        let table = table(colours, 1)?;
        let bytes = store::encode(&table)?;
        seed("table", name, &bytes)?;
        // Without its digest any change reaches what comes after it.
        let mut parts = image::decode(&bytes)?;
        parts[0].attributes.remove("gonio.digest");
        seed("table", &format!("{name}_undigested"), &image::encode(parts)?)?;
        let of = |pick: fn(&gonio::table::ColourChannels) -> &Vec<f32>| {
            table.colours.iter().map(|colour| pick(colour).clone()).collect()
        };
        let part = RealisationPart { total: of(|c| &c.total), single: of(|c| &c.single), schlick: None };
        let parts = Realisations { parts: vec![part.clone(), part] };
        seed("realisations", name, &realisations::encode(&parts, &table, 1)?)?;
    }
    Ok(())
}

fn formats() -> Answer {
    let folder = tempfile::tempdir()?;
    let large = ["merl", "utia", "klems", "tensor_tree"];
    for (name, format) in Format::ALL {
        if format == Format::Pabopto || format == Format::Npy {
            continue;
        }
        for (kind, azimuths) in [("isotropic", 1), ("anisotropic", 8)] {
            let path = folder.path().join(format!("{name}_{kind}"));
            // What a format refuses is no seed of it; that its directions do not hold the lobe is no reason here.
            let options = Options { albedo_error: Some(f64::INFINITY), ..Options::default() };
            if interchange::export(&table(1, azimuths)?, format, &options, &path).is_err() {
                continue;
            }
            let bytes = fs::read(&path)?;
            // Long files begin as they should; the rest the fuzzer finds.
            let most = if large.contains(&name) { 1 << 14 } else { 1 << 16 };
            seed(name, kind, &bytes[..bytes.len().min(most)])?;
        }
    }
    seed("pabopto", "small", b"#incident_angle 30 0\n0 0 0.1\n30 180 0.5\n")?;
    seed("utia", "image", &image::encode(vec![picture(2, 2)])?)?;
    Ok(())
}

/// The campaign whose checkpoints are read.
fn checkpoint_of() -> (Campaign, Plan) {
    let text = include_str!("../data/checkpoint.toml");
    let campaign = campaign::parse(text, "small.toml", Path::new("")).expect("sound").campaign;
    let plan = measure::plan(&campaign).expect("small");
    (campaign, plan)
}

/// A run at its beginning and at its end.
fn checkpoints() -> Answer {
    let (campaign, plan) = checkpoint_of();
    let patches = Patches::prepare(&campaign, &mut Vec::new())?;
    let empty = Ledger::new(&campaign, &plan);
    let whole = measure::go_on(&campaign, &plan, &patches, empty.clone(), &Session::plain(&|_| ()))?;
    for (name, ledger) in [("empty", empty), ("whole", whole)] {
        let bytes = Checkpoint::bytes(&ledger, 1, &campaign, &plan)?;
        seed("checkpoint", name, sealed::open(Checkpoint::KIND, &bytes)?)?;
    }
    Ok(())
}

fn picture(width: usize, height: usize) -> Part {
    let mut part = Part { width, height, ..Part::default() };
    for name in ["B", "G", "R"] {
        part.channels.insert(name.into(), Samples::F32(vec![0.25; width * height]));
    }
    part
}

fn maps() -> Answer {
    let mut map = Part { width: 8, height: 8, ..Part::default() };
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
    seed("height_map", "exr", &exr)?;
    seed("height_map", "npy", &npy)?;
    seed("height_map", "gsf", &[b"Gwyddion Simple Field 1.0\n", &gsf[..]].concat())?;
    seed("height_map", "xyz", &[b"0 0 0\n", &xyz[..]].concat())?;
    seed("map_gsf", "gsf", &gsf)?;
    seed("map_xyz", "xyz", xyz)?;
    assert!(map_file::read(&exr).is_ok() && map_file::read(&npy).is_ok());
    let picture = image::encode(vec![picture(2, 2)])?;
    let length = u16::try_from(picture.len())?.to_le_bytes();
    seed("maps", "two", &[&length[..], &picture, &picture].concat())
}

fn campaigns() -> Answer {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    for entry in fs::read_dir(configs)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "toml") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            seed("campaign", &name, &fs::read(&path)?)?;
        }
    }
    seed("index_file", "gold", b"wavelength_nm,n,k\n500,0.9,1.8\n550,0.4,2.4\n600,0.2,2.9\n")
}
