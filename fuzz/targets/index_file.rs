#![no_main]
//! Files of (n, k) over wavelengths, which a campaign names.

use std::cell::RefCell;

use gonio::campaign;
use gonio::error::Error;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

const CAMPAIGN: &str = "name = \"n\"\nseed = 1\n[surface]\nrealisations = 2\ncells = 64\ncorrelation_cells = 8.0\n\
    [surface.ggx]\nalpha = 0.2\n[light]\ntheta_i_deg = [0]\n[sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 8\n\
    [optics]\nfile = \"index.csv\"\nwavelength_nm = [550]\nfresnel = \"exact\"\n[stop]\nsamples = 65536\n";

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
