#![no_main]
//! The campaign parser. What is accepted is written as TOML and read as the same campaign.

use std::path::Path;

use gonio::campaign;
use gonio::error::Error;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let parse = |text: &[u8]| campaign::parse(text, "c.toml", Path::new("no_such_folder"));
    match parse(bytes) {
        Ok(parsed) => {
            let again = parse(campaign::to_toml(&parsed.campaign).as_bytes()).expect("its own text");
            assert!(again.campaign == parsed.campaign);
        }
        Err(Error::Campaign(faults)) => {
            assert!(!faults.is_empty());
            assert!(faults.iter().all(|fault| !fault.to_string().contains('\n')), "{faults:?}");
        }
        Err(other) => panic!("{other}"),
    }
});
