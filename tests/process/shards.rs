//! Promise: shards, measured anywhere and merged in any order, give the bytes of one run, and nothing that does not
//! belong together is merged.

use std::fs;
use std::path::{Path, PathBuf};

use gonio::campaign;
use gonio::measure::persist::shards;
use gonio::measure::{Merge, Shards};
use gonio::table::store;
use rustix::process::Signal;
use serde_json::Value;
use tempfile::TempDir;

use crate::support::failing;
use crate::support::outputs::digests;
use crate::support::program::{command, exits, gonio};

/// Ten incidences at two azimuths, two roughnesses, two orders, colours; a rule that ends incidences at different blocks.
const CAMPAIGN: &str = "\
name = \"dealt\"
seed = 3
[surface]
realisations = 2
cells = 64
correlation_cells = 4.0
[surface.ggx]
alpha = [0.3, 0.5]
[light]
theta_i_deg = [0, 20, 40, 60, 75]
azimuth = \"absolute\"
phi_i_deg = [0, 50]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[optics]
material = \"gold\"
[trace]
bounces = 2
[stop]
samples = 131_072
relative_error = 0.07
";

/// A folder with the campaign, and its shards of so many in `shards`.
fn dealt(of: u32) -> TempDir {
    dealt_as(CAMPAIGN, of)
}

/// The same of another text.
fn dealt_as(text: &str, of: u32) -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("dealt.toml"), text).expect("campaign");
    for number in (1..=of).rev() {
        // The order, and the threads, are anything.
        let (shard, threads) = (format!("{number}/{of}"), (1 + number % 3).to_string());
        let words = ["measure", "dealt.toml", "-o", "shards", "--shard", &shard, "--threads", &threads];
        exits(&gonio(folder.path(), &words), 0);
    }
    folder
}

fn shard(folder: &Path, number: u32, of: u32) -> PathBuf {
    folder.join(format!("shards/dealt.shard_{number}_of_{of}"))
}

#[test]
fn seven_shards_in_any_order_make_the_bytes_of_one_run() {
    let folder = dealt(7);
    let names: Vec<String> = digests(&folder.path().join("shards")).into_keys().collect();
    let wanted: Vec<String> = (1..=7).map(|number| format!("dealt.shard_{number}_of_7")).collect();
    assert_eq!(names, wanted, "and nothing else");
    exits(&gonio(folder.path(), &["measure", "dealt.toml", "-o", "whole"]), 0);
    exits(&gonio(folder.path(), &["merge", "shards", "-o", "merged"]), 0);
    let whole = digests(&folder.path().join("whole"));
    assert_eq!(digests(&folder.path().join("merged")), whole);
    let paths = [3, 1, 7, 2, 6, 5, 4].map(|number| shard(Path::new(""), number, 7).display().to_string());
    let words = ["merge", "-o", "again"].into_iter().chain(paths.iter().map(String::as_str));
    exits(&gonio(folder.path(), &words.collect::<Vec<_>>()), 0);
    assert_eq!(digests(&folder.path().join("again")), whole);
    // The rule ended some incidences before the others: they were dealt as they are measured, each by itself.
    let summary: Value =
        serde_json::from_slice(&fs::read(folder.path().join("whole/dealt_alpha_0.3.json")).expect("there"))
            .expect("JSON");
    let samples: Vec<u64> = summary["stops"]
        .as_array()
        .expect("stops")
        .iter()
        .filter_map(|incidence| incidence["samples"].as_u64())
        .collect();
    assert!(samples.iter().any(|&of_stop| of_stop != samples[0]), "{samples:?}");
    // Done twice, nothing is measured or merged twice.
    let again = gonio(folder.path(), &["measure", "dealt.toml", "-o", "shards", "--shard", "2/7"]);
    exits(&again, 0);
    assert!(String::from_utf8_lossy(&again.stdout).contains("is finished: nothing to do"));
    assert!(exits(&gonio(folder.path(), &["merge", "shards", "-o", "merged"]), 0).contains("nothing to do"));
}

/// Chance decides at every facet what a path does, by its number and not by its shard.
#[test]
fn shards_of_layered_facets_make_the_bytes_of_one_run() {
    let text = CAMPAIGN
        .replace("material = \"gold\"", "facet = \"layered\"\neta = 1.5\nalbedo = [0.9, 0.5, 0.0]")
        .replace("[0.3, 0.5]", "0.5");
    let folder = dealt_as(&text, 3);
    exits(&gonio(folder.path(), &["measure", "dealt.toml", "-o", "whole"]), 0);
    exits(&gonio(folder.path(), &["merge", "shards", "-o", "merged"]), 0);
    assert_eq!(digests(&folder.path().join("merged")), digests(&folder.path().join("whole")));
}

#[test]
fn shards_merged_in_bands_have_the_bytes_of_one_run() {
    // Stops that weigh enough for a budget in MiB to tell bands apart.
    let text = CAMPAIGN
        .replace("theta_r_bins = 6", "theta_r_bins = 36")
        .replace("phi_r_bins = 12", "phi_r_bins = 72");
    let text = text.replace("relative_error = 0.07\n", "").replace("131_072", "16_384");
    let text = text.replace("[0.3, 0.5]", "0.3").replace("[0, 20, 40, 60, 75]", "[0, 40, 75]");
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("dealt.toml"), text).expect("campaign");
    for shard in ["1/3", "2/3", "3/3"] {
        exits(&gonio(folder.path(), &["measure", "dealt.toml", "-o", "shards", "--shard", shard]), 0);
    }
    exits(&gonio(folder.path(), &["measure", "dealt.toml", "-o", "whole"]), 0);
    let headers = || {
        let files = shards::find(&folder.path().join("shards")).expect("shards");
        let opened = files.iter().map(|path| shards::open(path).expect("whole"));
        Shards::new(opened.collect()).expect("of one run")
    };
    let campaign = campaign::parse(headers().campaign(), "shards", Path::new("")).expect("sound").campaign;
    // Threads are those of this process, and of the program.
    let bands = |mb: u64| {
        Merge::of_shards(headers(), &campaign, mb << 20).map_or(0, |merge| merge.plan().bands().len())
    };
    let least = (1..1000).find(|&mb| bands(mb) > 0).expect("a budget for one incidence");
    assert!(bands(least) > 2, "{} bands within {least} MiB", bands(least));
    let (enough, less) = (least.to_string(), (least - 1).to_string());
    let refused = gonio(folder.path(), &["merge", "shards", "-o", "merged", "--memory-mb", &less]);
    let said = exits(&refused, 4);
    assert!(said.contains(&format!("need about {least} MiB of memory, {less} MiB may be used")), "{said}");
    assert!(!folder.path().join("merged").exists(), "nothing is written");
    exits(&gonio(folder.path(), &["merge", "shards", "-o", "merged", "--memory-mb", &enough]), 0);
    let of = |name: &str| {
        let mut files = digests(&folder.path().join(name));
        // Summaries and pages tell how many incidences were taken at a time.
        let file = "dealt.json";
        let bytes = fs::read(folder.path().join(name).join(file)).expect("there");
        let mut summary: Value = serde_json::from_slice(&bytes).expect("JSON");
        let plan = summary["plan"].take();
        summary["cost"].take();
        files.insert(file.into(), summary.to_string());
        (files, plan)
    };
    let ((merged, plan), (whole, _)) = (of("merged"), of("whole"));
    assert_eq!(merged, whole);
    assert!(plan["band_stops"].as_u64().is_some_and(|incidences| incidences < 3), "{plan:?}");
    // Some of the shards, too.
    fs::remove_file(shard(folder.path(), 2, 3)).expect("there");
    for words in [&["-o", "part"][..], &["-o", "part_in_bands", "--memory-mb", &enough]] {
        exits(&gonio(folder.path(), &[&["merge", "shards", "--partial"], words].concat()), 0);
    }
    assert_eq!(of_tables(folder.path(), "part"), of_tables(folder.path(), "part_in_bands"));
}

/// Tables and realisations in a folder.
fn of_tables(folder: &Path, name: &str) -> Vec<(String, String)> {
    let files: Vec<_> =
        digests(&folder.join(name)).into_iter().filter(|(name, _)| name.ends_with(".exr")).collect();
    assert_eq!(files.len(), 2);
    files
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let folder = dealt(3);
    let merge =
        |words: &[&str]| gonio(folder.path(), &[&["merge", "shards", "-o", "merged"], words].concat());
    let refused = |said: &[&str]| {
        let text = exits(&merge(&[]), 3);
        assert!(said.iter().all(|word| text.contains(word)) && text.lines().count() == 1, "{said:?}: {text}");
        assert!(!folder.path().join("merged").exists(), "nothing is written");
    };
    let second = shard(folder.path(), 2, 3);
    let kept = fs::read(&second).expect("readable");
    fs::remove_file(&second).expect("there");
    refused(&["2 of 3 shards are there", "2/3 is missing", "--partial"]);
    let double = folder.path().join("shards/copy.shard_2_of_3");
    for path in [&second, &double] {
        fs::write(path, &kept).expect("written");
    }
    refused(&["dealt.shard_2_of_3", "copy.shard_2_of_3", "shard 2/3"]);
    fs::remove_file(&double).expect("there");
    // Damage, another campaign, another dealing, other patches.
    let mut damaged = kept.clone();
    damaged[kept.len() / 2] ^= 1;
    fs::write(&second, damaged).expect("written");
    refused(&["dealt.shard_2_of_3", "damaged"]);
    let foreign = |change: [&str; 2], words: &[&str], said: &[&str]| {
        fs::write(folder.path().join("other.toml"), CAMPAIGN.replace(change[0], change[1]))
            .expect("campaign");
        exits(
            &gonio(folder.path(), &[&["measure", "other.toml", "-o", "shards", "--force"], words].concat()),
            0,
        );
        refused(said);
    };
    foreign(["seed = 3", "seed = 4"], &["--shard", "2/3"], &["dealt.shard_2_of_3: seed = 4", "it is 3"]);
    foreign(
        ["[0, 50]", "[0, 45]"],
        &["--shard", "2/3"],
        &["light.phi_i_deg = [0.0, 45.0]", "it is [0.0, 50.0]"],
    );
    exits(&gonio(folder.path(), &["surface", "other.toml", "-o", "patches", "--seed", "77"]), 0);
    let patches = &["--shard", "2/3", "--patches", "patches"];
    foreign(["", ""], patches, &["dealt.shard_2_of_3: patch 0 is not that of", "--patches"]);
    fs::remove_file(&second).expect("there");
    foreign(["", ""], &["--shard", "2/4"], &["dealt.shard_2_of_4: shard = 2/4", "it is 1/3"]);
    fs::remove_file(shard(folder.path(), 2, 4)).expect("there");
    fs::write(&second, &kept).expect("written");
    exits(&merge(&[]), 0);
}

#[test]
fn what_is_there_can_be_merged_and_says_what_is_missing() {
    let folder = dealt(5);
    exits(&gonio(folder.path(), &["merge", "shards", "-o", "out"]), 0);
    for number in [2, 5] {
        fs::remove_file(shard(folder.path(), number, 5)).expect("there");
    }
    let said = exits(&gonio(folder.path(), &["merge", "shards", "-o", "out", "--partial"]), 0);
    assert!(said.contains("6 of 10 incidences: 2/5, 5/5 are missing"), "{said}");
    let load = |name: &str| store::load(&folder.path().join("out").join(name)).expect("a table").table;
    let (part, whole) = (load("dealt_partial_alpha_0.3.exr"), load("dealt_alpha_0.3.exr"));
    let bins = whole.grid.bins();
    assert_eq!((part.grid.incidences(), whole.grid.incidences()), (6, 10));
    for incidence in 0..6 {
        let same = (0..10)
            .find(|&of| whole.grid.incidence_deg(of) == part.grid.incidence_deg(incidence))
            .expect("an incidence");
        let (here, there) = (incidence * bins..(incidence + 1) * bins, same * bins..(same + 1) * bins);
        // Each incidence has all that it has in the whole, errors included.
        assert_eq!(part.hits[here.clone()], whole.hits[there.clone()]);
        assert_eq!(part.colours[0].total[here.clone()], whole.colours[0].total[there.clone()]);
        assert_eq!(part.colours[0].stderr[here], whole.colours[0].stderr[there]);
    }
}

#[test]
fn a_killed_shard_goes_on_and_a_wrong_dealing_is_refused() {
    let folder = tempfile::tempdir().expect("temporary folder");
    // Long enough for a checkpoint, which is kept after every 0.02 s of processor time.
    let text = CAMPAIGN.replace("relative_error = 0.07", "").replace("131_072", "200_000");
    fs::write(folder.path().join("dealt.toml"), &text).expect("campaign");
    let words = ["measure", "dealt.toml", "-o", "shards", "--shard", "2/3"];
    let shards = folder.path().join("shards");
    fs::create_dir(&shards).expect("folder");
    let mut shard = command(folder.path(), &words);
    shard.env("GONIO_CHECKPOINT_S", "0.02");
    let killed =
        failing::preloaded().ended(shard, &shards, Signal::KILL, "dealt.shard_2_of_3.checkpoint_", 1);
    assert_eq!(killed.status.code(), None, "ended before it was killed");
    assert!(exits(&gonio(folder.path(), &words), 3).contains("--resume"));
    assert!(
        exits(&gonio(folder.path(), &[&words[..], &["--resume"]].concat()), 0).contains("note: resumes ")
    );
    exits(&gonio(folder.path(), &["measure", "dealt.toml", "-o", "fresh", "--shard", "2/3"]), 0);
    // The file of a shard also says what it cost: its tables are compared.
    for (from, to) in [("shards", "a"), ("fresh", "b")] {
        exits(&gonio(folder.path(), &["merge", from, "-o", to, "--partial"]), 0);
    }
    assert_eq!(digests(&folder.path().join("a")), digests(&folder.path().join("b")));
    for (shard, said) in [("2/11", "10 incidences"), ("0/3", "K/N"), ("4/3", "K/N")] {
        let wrong = gonio(folder.path(), &["measure", "dealt.toml", "-o", "none", "--shard", shard]);
        assert!(exits(&wrong, 2).contains(said), "{shard}");
    }
    fs::write(folder.path().join("dealt.toml"), format!("{text}seconds = 60\n")).expect("campaign");
    assert!(
        exits(&gonio(folder.path(), &words), 2).contains("stop.seconds = 60: no budget of time with --shard")
    );
}
