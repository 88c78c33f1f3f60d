#![no_main]
//! The table's own file. What is read is written again and read as the same.

use gonio::table::store;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some(loaded) = gonio_fuzz::format(store::decode(gonio_fuzz::path(), bytes)) else { return };
    let Ok(again) = store::encode(&loaded.table) else { return };
    let again = store::decode(gonio_fuzz::path(), &again).expect("its own bytes");
    assert!(again.table == loaded.table);
});
