#![no_main]
//! Files of (n, k) over wavelengths, which a campaign names.

use std::cell::RefCell;

use gonio::campaign;
use gonio::error::Error;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

const CAMPAIGN: &str = include_str!("../src/index_file.toml");

thread_local! {
    static FOLDER: RefCell<TempDir> = RefCell::new(tempfile::tempdir().expect("a folder"));
}

fuzz_target!(|bytes: &[u8]| {
    FOLDER.with_borrow(|folder| {
        std::fs::write(folder.path().join("index.csv"), bytes).expect("written");
        match campaign::parse(CAMPAIGN, "c.toml", folder.path()) {
            Ok(_) => {}
            Err(Error::Campaign(faults)) => {
                assert!(faults.iter().all(|fault| fault.key.starts_with("optics.")), "{faults:?}");
                assert!(faults.iter().all(|fault| !fault.to_string().contains('\n')), "{faults:?}");
            }
            Err(other) => panic!("{other}"),
        }
    });
});
