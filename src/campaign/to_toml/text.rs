//! Lines of TOML, and words from the tables that the parser reads them by.

use std::fmt::{Debug, Display};

/// TOML in the making.
pub struct Text(pub String);

impl Text {
    pub fn table(&mut self, name: &str) {
        self.0.push_str(&format!("\n[{name}]\n"));
    }

    pub fn line(&mut self, key: &str, value: impl Display) {
        self.0.push_str(&format!("{key} = {value}\n"));
    }

    /// A float, or a list of floats, in the shortest digits that read back the same.
    pub fn floats(&mut self, key: &str, value: impl Debug) {
        self.line(key, format!("{value:?}"));
    }
}

pub fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The word for `value`, quoted.
pub fn word<T: PartialEq>(words: &[(&'static str, T)], value: &T) -> String {
    words.iter().find(|(_, known)| known == value).map(|(name, _)| quoted(name)).unwrap_or_default()
}

/// A list of words that are quoted already.
pub fn words(all: impl Iterator<Item = String>) -> String {
    format!("[{}]", all.collect::<Vec<_>>().join(", "))
}
