//! What a run wrote, told by digests.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use gonio::files::sha256_hex;
use serde_json::Value;

/// Names and SHA-256 of all files in a folder; of summaries, pages and cards, without the lines on costs.
pub fn digests(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).expect("readable").map(|entry| entry.expect("entry").path());
    let entries = entries.filter(|path| path.is_file());
    entries
        .map(|path| (path.file_name().expect("name").to_string_lossy().into_owned(), digest(&path)))
        .collect()
}

/// Makes the folder `to` a copy of a folder of files.
pub fn copied(from: &Path, to: &Path) {
    fs::remove_dir_all(to).ok();
    fs::create_dir(to).expect("a folder");
    for entry in fs::read_dir(from).expect("readable") {
        let path = entry.expect("entry").path();
        fs::copy(&path, to.join(path.file_name().expect("name"))).expect("copied");
    }
}

fn digest(path: &Path) -> String {
    let bytes = fs::read(path).expect("readable");
    match path.extension().and_then(|end| end.to_str()) {
        Some("json") => {
            let mut summary: Value = serde_json::from_slice(&bytes).expect("a summary");
            if let Some(summary) = summary.as_object_mut() {
                summary.remove("cost");
            }
            // Larger for more threads.
            if let Some(plan) = summary.get_mut("plan").and_then(Value::as_object_mut) {
                plan.remove("memory_bytes");
            }
            sha256_hex(summary.to_string().as_bytes())
        }
        Some("html" | "md") => {
            let text = String::from_utf8(bytes).expect("UTF-8");
            let kept = |line: &&str| !line.contains("id=\"cost\"") && !line.starts_with("| time |");
            sha256_hex(text.lines().filter(kept).collect::<Vec<_>>().join("\n").as_bytes())
        }
        _ => sha256_hex(&bytes),
    }
}
