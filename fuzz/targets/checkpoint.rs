#![no_main]
//! What checkpoints, shards and finished bands hold behind their checksum, for a small campaign to resume.

use std::path::Path;
use std::sync::LazyLock;

use gonio::campaign::{self, Campaign};
use gonio::files::sealed;
use gonio::measure::persist::header::KIND;
use gonio::measure::{self, Plan, StoredRun};
use libfuzzer_sys::fuzz_target;

/// The campaign that `tests/it/fuzzed.rs` writes seeds of.
static CAMPAIGN: LazyLock<(Campaign, Plan)> = LazyLock::new(|| {
    let text = include_str!("../../tests/data/checkpoint.toml");
    let campaign = campaign::parse(text, "small.toml", Path::new("")).expect("sound").campaign;
    let plan = measure::plan(&campaign).expect("small");
    (campaign, plan)
});

fuzz_target!(|bytes: &[u8]| {
    let (campaign, plan) = &*CAMPAIGN;
    let sealed = sealed::seal(KIND, bytes.len(), |head| Ok::<_, String>([&head, bytes].concat()));
    gonio_fuzz::reason(sealed.and_then(|sealed| StoredRun::from_bytes(&sealed)).and_then(|kept| {
        kept.header.faults((campaign, None), "small.toml", "out").iter().for_each(|fault| {
            gonio_fuzz::reason::<()>(Err(fault.to_string()));
        });
        kept.run_state(campaign, plan).map(drop)
    }));
});
