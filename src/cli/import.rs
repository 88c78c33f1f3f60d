//! `gonio import`: a table from another program's file, or campaigns from maps of GGX parameters.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::export::{check_output, format_of, only, options_of};
use super::streams::Place;
use super::text::layout::wrapped;
use super::text::output::{Output, to_json, warn};
use super::text::progress::Stage;
use crate::campaign::parse::height_map;
use crate::error::{Error, Result};
use crate::files::{self, Destination, STANDARD};
use crate::instrument::GridKind;
use crate::interchange::radiance::sample_side::SampleSide;
use crate::interchange::{self, Format, Options, maps};
use crate::job::paths::already_exists;
use crate::table::{TableRows, store};

/// Campaigns that are written at once.
const MOST_CAMPAIGNS: usize = 10_000;

/// Make a table of another program's file
#[derive(Args)]
#[command(
    after_help = "Formats: npz csv merl rgl utia exr_parts klems tensor_tree zemax astm ssdd openmaterial bird fred\n\
    and maps (GGX parameters); utia: .bin or the image form; merl: half/difference angles unless --like\n\n\
    Example: gonio import gold.binary --from merl -o gold.exr"
)]
pub struct Arguments {
    /// The file
    file: PathBuf,
    /// One of the formats below; left out: by the file
    #[arg(long, value_name = "FORMAT")]
    from: Option<String>,
    /// The table (maps: the folder) to write
    #[arg(short, long, value_name = "TABLE.exr")]
    output: PathBuf,
    /// Average over this table's incidences and bins
    #[arg(long, value_name = "TABLE.exr")]
    like: Option<PathBuf>,
    /// The single azimuth of the light stands for all
    #[arg(long)]
    isotropic: bool,
    /// MERL: values at the cells' centres
    #[arg(long)]
    merl_centre: bool,
    /// Klems, tensor tree: the blocks of light from +z (`Back`) or -z (`Front`)
    #[arg(long, value_name = "back|front")]
    side: Option<SampleSide>,
    /// Maps: a texel that becomes a campaign; several times for several
    #[arg(long, value_name = "X,Y")]
    texel: Vec<String>,
    /// Maps: every N-th texel of both axes instead
    #[arg(long, value_name = "N")]
    every: Option<usize>,
    /// Replace the table if it is there
    #[arg(long)]
    force: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    if arguments.from.as_deref() == Some("maps") {
        return campaigns(arguments);
    }
    let format = match &arguments.from {
        Some(name) => format_of("--from", name)?,
        None => guessed(&arguments.file)?,
    };
    if !arguments.texel.is_empty() || arguments.every.is_some() {
        return Err(Error::Usage(format!(
            "--texel and --every choose texels of maps, not of {}",
            format.name()
        )));
    }
    let place = Place::of(&arguments.output, arguments.json)?;
    check_output(&arguments.file, place.path(), arguments.force)?;
    if let Some(like) = &arguments.like {
        check_output(like, place.path(), arguments.force)?;
    }
    if arguments.side.is_some() && !matches!(format, Format::Klems | Format::TensorTree) {
        return Err(Error::Usage(format!(
            "--side chooses a block of klems and tensor_tree, not of {}",
            format.name()
        )));
    }
    let (side, isotropic) = (arguments.side, arguments.isotropic);
    let options = Options { side, isotropic, ..options_of(arguments.merl_centre, &[]) };
    let like = arguments.like.as_ref().map(|path| TableRows::open(path)).transpose()?;
    let grid = like.as_ref().map(TableRows::grid);
    if let Some((path, _)) =
        arguments.like.as_ref().zip(grid).filter(|(_, grid)| grid.kind == GridKind::HalfDifference)
    {
        return Err(Error::format(
            path,
            "has half/difference angles; --like needs a table of incidences and bins",
        ));
    }
    let stage = Stage::begin("reading the file");
    let (table, notes) = interchange::import(&arguments.file, format, &options, grid)?;
    store::save(place.path(), &table)?;
    drop(stage);
    for note in &notes {
        warn(format_args!("{}: {note}", arguments.file.display()));
    }
    let (incidences, bins, colours) = (table.grid.incidences(), table.grid.bins(), table.colours.len());
    let kind = to_json(&table.grid.kind)?;
    let mut out = Output::default();
    if arguments.json {
        let table = arguments.output.display().to_string();
        let sizes = json!({ "table": table, "kind": kind, "stops": incidences, "bins": bins, "colours": colours, "notes": notes });
        out.json(&sizes)?;
    } else {
        let kind = kind.as_str().unwrap_or_default();
        let text = format!(
            "{} ({kind}): {incidences} incidences of {bins} bins, {colours} colour{}; no error bars unless the file has them",
            arguments.output.display(),
            if colours == 1 { "" } else { "s" },
        );
        out.lines(wrapped("table  ", &text))?;
    }
    place.done().map(|()| 0)
}

/// How much of a file is looked at to tell formats whose names end alike: an XML file may begin with a geometry.
const HEAD: u64 = 1 << 20;

/// The format of a file by its name and its first bytes.
fn guessed(file: &Path) -> Result<Format> {
    let mut possible = Format::of_name(file);
    possible.retain(|format| format.is_read());
    if possible.len() > 1 {
        let mut head = Vec::new();
        files::open(file)?.take(HEAD).read_to_end(&mut head).map_err(|e| Error::io(file, e))?;
        possible.retain(|format| format.begins(&head));
    }
    if possible.is_empty() && height_map::is_map_name(&file.to_string_lossy()) {
        return Err(Error::Usage(format!(
            "{0}: no table by its name; a height map is a surface: gonio init --surface scan --map {0}",
            file.display()
        )));
    }
    only("--from", file, &possible)
}

/// A campaign for each wanted texel, all checked before the first is written. Of a grid, texels that no campaign may
/// have (background, mostly) are left out.
fn campaigns(arguments: &Arguments) -> Result<u8> {
    let own = arguments.merl_centre || arguments.side.is_some() || arguments.isotropic;
    if arguments.like.is_some() || own {
        let why = "--like, --isotropic, --merl-centre and --side say nothing of --from maps";
        return Err(Error::Usage(why.into()));
    }
    if arguments.output == Path::new(STANDARD) {
        return Err(Error::Usage("-o -: a campaign for each texel is written: a folder is needed".into()));
    }
    let maps = maps::load(&arguments.file)?;
    let texels = texels(arguments, &maps)?;
    if texels.len() > MOST_CAMPAIGNS {
        return Err(Error::Refused(format!(
            "{} texels of {} x {}: at most {MOST_CAMPAIGNS} campaigns at once; take a larger --every",
            texels.len(),
            maps.width,
            maps.height
        )));
    }
    let (mut campaigns, mut left_out) = (Vec::new(), Vec::new());
    for &(column, row) in &texels {
        match maps.campaign(column, row) {
            Ok(text) => {
                let path = arguments.output.join(format!("texel_{column}_{row}.toml"));
                campaigns.push((Destination::at(path), text));
            }
            Err(why) => left_out.push(Error::format(&arguments.file, why)),
        }
    }
    let skipped = left_out.len();
    let all_needed = campaigns.is_empty() || arguments.every.is_none();
    let why = match left_out.into_iter().next() {
        Some(why) if all_needed => return Err(why),
        why => why,
    };
    if let Some((path, _)) = campaigns.iter().find(|(path, _)| files::is_there(path) && !arguments.force) {
        return Err(already_exists(path, "is there already"));
    }
    if let Some(why) = why {
        warn(format_args!("{skipped} of {} texels left out, the first: {why}", texels.len()));
    }
    let _claim = files::create_folder(&arguments.output)?;
    for (path, text) in &campaigns {
        files::write_atomically(path, text.as_bytes())?;
    }
    let paths: Vec<String> = campaigns.iter().map(|(path, _)| path.display().to_string()).collect();
    let mut out = Output::default();
    if arguments.json {
        out.json(&json!({ "campaigns": paths, "left_out": skipped }))?
    } else {
        out.lines(paths)?
    }
    Ok(0)
}

/// The texels of the command line, or every N-th.
fn texels(arguments: &Arguments, maps: &maps::Maps) -> Result<Vec<(usize, usize)>> {
    let pair = |text: &String| {
        let numbers =
            text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
        numbers.ok_or_else(|| Error::Usage(format!("--texel {text}: COLUMN,ROW needed")))
    };
    match arguments.every {
        Some(0) => Err(Error::Usage("--every 0: 1 or more needed".into())),
        Some(step) if arguments.texel.is_empty() => {
            let columns = |row| (0..maps.width).step_by(step).map(move |column| (column, row));
            Ok((0..maps.height).step_by(step).flat_map(columns).collect())
        }
        None if !arguments.texel.is_empty() => arguments.texel.iter().map(pair).collect(),
        _ => Err(Error::Usage("--from maps: either --texel X,Y or --every N needed".into())),
    }
}
