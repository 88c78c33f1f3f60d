//! The first key in which two resolved campaigns differ.

use super::quoted;

/// A key with other values in two campaigns, as messages quote them; no value where it is not there.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyDifference {
    /// Dotted key, as `surface.ggx.alpha`.
    pub key: String,
    /// Its value in the first campaign.
    pub first: Option<String>,
    /// Its value in the second.
    pub second: Option<String>,
}

/// The keys in which two resolved campaigns ([`to_toml`](super::to_toml)) differ, in the order of the second.
pub fn differences(first: &str, second: &str) -> Vec<KeyDifference> {
    let [first, second] = [first, second].map(leaves);
    let value = |leaves: &[(String, String)], key: &str| {
        leaves.iter().find(|(other, _)| other == key).map(|(_, value)| value.clone())
    };
    let gone = first.iter().filter(|(key, _)| value(&second, key).is_none());
    let keys = second.iter().chain(gone).map(|(key, _)| key);
    let differing = keys.filter_map(|key| {
        let (a, b) = (value(&first, key), value(&second, key));
        let [first, second] = [&a, &b].map(|value| value.as_deref().map(quoted));
        (a != b).then(|| KeyDifference { key: quoted(key), first, second })
    });
    differing.collect()
}

/// All values by their dotted keys, of a text that this program wrote: a heading or `key = value` on each line.
fn leaves(text: &str) -> Vec<(String, String)> {
    let mut heading = String::new();
    let mut leaves: Vec<(String, String)> = Vec::new();
    for line in text.lines() {
        if let Some((key, value)) = line.split_once(" = ") {
            let same = |(other, _): &&(String, String)| *other == format!("{heading}{key}");
            // The tables of a list have the same heading.
            let nth = leaves.iter().filter(same).count();
            let number = if nth == 0 { String::new() } else { format!("[{nth}]") };
            leaves.push((format!("{heading}{key}{number}"), value.to_string()));
        } else if let Some(inner) = line.strip_prefix('[') {
            heading = format!("{}.", inner.trim_matches(['[', ']']));
        }
    }
    leaves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differing_keys_are_named_with_both_values() {
        let first = "seed = 1\n[surface]\ncells = 64\n[surface.ggx]\nalpha = 0.2\n[stop]\nsamples = 5\n";
        let second =
            "seed = 1\n[surface]\ncells = 64\n[surface.beckmann]\nalpha = 0.2\n[stop]\nsamples = 6\n";
        let found = differences(first, second);
        let all: Vec<_> =
            found.iter().map(|d| (d.key.as_str(), d.first.as_deref(), d.second.as_deref())).collect();
        assert_eq!(
            all,
            [
                ("surface.beckmann.alpha", None, Some("0.2")),
                ("stop.samples", Some("5"), Some("6")),
                ("surface.ggx.alpha", Some("0.2"), None),
            ]
        );
        assert!(differences(first, first).is_empty());
        // Seeds that other TOML readers refuse, and lists of tables.
        let lists = |last: &str| {
            format!("seed = 18446744073709551615\n[[optics]]\nf0 = 1\n[[optics]]\nf0 = {last}\n")
        };
        let found = differences(&lists("2"), &lists("3"));
        assert_eq!(found.iter().map(|d| d.key.as_str()).collect::<Vec<_>>(), ["optics.f0[1]"]);
    }
}
