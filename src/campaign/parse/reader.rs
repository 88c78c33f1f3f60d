//! Reads TOML tables with all their faults: a parsed table goes in, typed and range-checked values come out.
//!
//! A reader that finds a fault records it and answers `None`; the others go on. `None` thus always means that the
//! report holds at least one fault.

use std::ops::{Range, RangeInclusive};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

pub(crate) use super::bounds::{Bounds, plain};
use super::faults::{Report, nearest};
use crate::campaign::key_tables::table_of;

/// Largest float that stands for a whole number: beyond 2^53 neighbouring whole numbers share a float.
const WHOLE_FLOATS: f64 = 9_007_199_254_740_992.0;

/// A dotted key and the byte where it is in the file.
#[derive(Clone)]
pub(crate) struct KeyPath<'a> {
    report: &'a Report<'a>,
    key: String,
    at: Option<usize>,
}

impl<'a> KeyPath<'a> {
    fn child(&self, name: &str, at: Option<usize>) -> Self {
        let key = if self.key.is_empty() { name.to_string() } else { format!("{}.{name}", self.key) };
        KeyPath { report: self.report, key, at }
    }
}

/// A TOML table whose keys have not been looked at.
pub(crate) struct TableReader<'a> {
    place: KeyPath<'a>,
    entries: Option<&'a DeTable<'a>>,
}

impl<'a> TableReader<'a> {
    /// The table of the whole file.
    pub fn root(report: &'a Report<'a>, entries: &'a DeTable<'a>) -> Self {
        TableReader { place: KeyPath { report, key: String::new(), at: None }, entries: Some(entries) }
    }

    /// One slot for each of `names`, given or not. Every other key of the table is a fault.
    pub fn keys<const N: usize>(self, names: [&'static str; N]) -> [Slot<'a>; N] {
        let entries = self.entries.into_iter().flatten();
        for (key, value) in entries.filter(|(key, _)| !names.contains(&key.get_ref().as_ref())) {
            let place = self.place.child(key.get_ref(), Some(key.span().start));
            // Looking for the nearest name is the slow part, and a file may hold a million wrong keys.
            let full = place.report.is_full();
            let advice =
                if full { String::new() } else { self.advice(key.get_ref(), value.get_ref(), &names) };
            place.report.fault(&place.key, place.at, None, format!("unknown key; {advice}"));
        }
        names.map(|name| self.slot(name))
    }

    /// What was meant by a key that is none of `names`: one spelt nearly so, one that its text names (`model = "ggx"` for
    /// `[surface.ggx]`), or one of another table. The first two count as given from now on.
    fn advice(&self, key: &str, value: &DeValue<'_>, names: &[&'static str]) -> String {
        let named = value.as_str().and_then(|text| names.iter().find(|name| **name == text));
        if let Some(name) = named.copied().or_else(|| nearest(key, names)) {
            let meant = self.place.child(name, None).key;
            let advice = if named.is_some() { format!("[{meant}]") } else { format!("`{name}`") };
            self.place.report.misspelt(meant);
            return format!("did you mean {advice}?");
        }
        let known = match names {
            [] => "this table has no keys".to_string(),
            names => format!("known here: {}", names.join(", ")),
        };
        match table_of(key) {
            Some(table) => format!("{known}; {key} belongs in {table}"),
            None => known,
        }
    }

    /// The slot of one key, the others not looked at.
    pub fn slot(&self, name: &str) -> Slot<'a> {
        match self.entries.and_then(|entries| entries.get_key_value(name)) {
            Some((key, value)) => {
                let place = self.place.child(name, Some(key.span().start));
                Slot { item: Some(GivenValue { place: place.clone(), value }), place }
            }
            None => Slot { place: self.place.child(name, self.place.at), item: None },
        }
    }
}

/// A key that a table may have, given or not.
pub(crate) struct Slot<'a> {
    place: KeyPath<'a>,
    item: Option<GivenValue<'a>>,
}

impl<'a> Slot<'a> {
    /// What was given.
    pub fn given(&self) -> Option<&GivenValue<'a>> {
        self.item.as_ref()
    }

    /// What was given; a fault where nothing was.
    pub fn required(&self, what: &str) -> Option<&GivenValue<'a>> {
        if self.item.is_none() {
            return self.refuse(format!("required; {what}"));
        }
        self.given()
    }

    /// Whether a wrong key stands for this one.
    pub fn is_misspelt(&self) -> bool {
        self.item.is_none() && self.place.report.is_misspelt(&self.place.key)
    }

    /// What `read` makes of the given value, or `default`.
    pub fn or<T>(&self, default: T, read: impl FnOnce(&GivenValue<'a>) -> Option<T>) -> Option<T> {
        self.item.as_ref().map_or(Some(default), read)
    }

    /// The given table; an empty one where none was given, so that its required keys are named.
    pub fn table(&self) -> Option<TableReader<'a>> {
        match &self.item {
            Some(item) => item.table(),
            None => Some(TableReader { place: self.place.clone(), entries: None }),
        }
    }

    /// A fault of this key, whether it was given or not; none where another key stands for it, which is a fault already.
    pub fn refuse<T>(&self, allowed: impl Into<String>) -> Option<T> {
        match &self.item {
            Some(item) => item.refuse(allowed),
            None if self.is_misspelt() => None,
            None => {
                self.place.report.fault(&self.place.key, self.place.at, None, allowed.into());
                None
            }
        }
    }

    /// A fault where the key was given at all; else `Some(())`.
    pub fn absent(&self, why: &str) -> Option<()> {
        self.or((), |item| item.refuse(why))
    }
}

/// A value that was given.
pub(crate) struct GivenValue<'a> {
    place: KeyPath<'a>,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> GivenValue<'a> {
    /// The last part of the key.
    pub fn name(&self) -> &str {
        self.place.key.rsplit('.').next().unwrap_or_default()
    }

    /// Records a fault of this value; the `None` is the reader's answer.
    pub fn refuse<T>(&self, allowed: impl Into<String>) -> Option<T> {
        self.place.report.fault(&self.place.key, self.place.at, self.text_as_written(), allowed.into());
        None
    }

    /// Records that this value asks for too much: memory, time or size.
    pub fn too_large<T>(&self, allowed: String) -> Option<T> {
        let (key, at) = (&self.place.key, self.place.at);
        self.place.report.too_large(key, at, self.text_as_written(), allowed);
        None
    }

    /// Records a note about this value.
    pub fn note(&self, text: impl Into<String>) {
        self.place.report.note(&self.place.key, self.place.at, self.text_as_written(), text.into());
    }

    /// A float within `bounds`; whole numbers are floats too. Never -0.
    pub fn float(&self, bounds: &Bounds) -> Option<f64> {
        let value = match self.value.get_ref() {
            DeValue::Integer(digits) => {
                i128::from_str_radix(digits.as_str(), digits.radix()).map_or(f64::INFINITY, |i| i as f64)
            }
            DeValue::Float(digits) => digits.as_str().parse().unwrap_or(f64::NAN),
            _ => return self.wrong_type("a number"),
        };
        match bounds.fault(value) {
            Some(fault) => self.refuse(fault),
            None => Some(value + 0.0),
        }
    }

    /// A whole number within `range`. `1e6` is one: floats that are whole are taken up to 2^53.
    pub fn whole(&self, range: RangeInclusive<u64>) -> Option<u64> {
        match self.as_whole() {
            Some(value) if range.contains(&value) => Some(value),
            None if !matches!(self.value.get_ref(), DeValue::Integer(_) | DeValue::Float(_)) => {
                self.wrong_type("a whole number")
            }
            _ => self.refuse(format!("must be a whole number in [{}, {}]", range.start(), range.end())),
        }
    }

    /// A whole number that 64 bits hold, without a fault where it is none.
    pub fn as_whole(&self) -> Option<u64> {
        let value = match self.value.get_ref() {
            DeValue::Integer(digits) => i128::from_str_radix(digits.as_str(), digits.radix()).ok(),
            DeValue::Float(digits) => digits.as_str().parse().ok().and_then(whole_float),
            _ => None,
        };
        value.and_then(|value| u64::try_from(value).ok())
    }

    /// [`GivenValue::whole`] for the sizes that fit 32 bits.
    pub fn count(&self, range: RangeInclusive<u32>) -> Option<u32> {
        let value = self.whole(u64::from(*range.start())..=u64::from(*range.end()))?;
        u32::try_from(value).ok()
    }

    /// A string, without a fault where it is none.
    pub fn as_text(&self) -> Option<&'a str> {
        self.value.get_ref().as_str()
    }

    /// `true` or `false`, without a fault where it is neither.
    pub fn as_boolean(&self) -> Option<bool> {
        self.value.get_ref().as_bool()
    }

    /// `true` or `false`.
    pub fn boolean(&self) -> Option<bool> {
        self.as_boolean().or_else(|| self.wrong_type("true or false"))
    }

    /// A string.
    pub fn text(&self) -> Option<&'a str> {
        self.value.get_ref().as_str().or_else(|| self.wrong_type("a string"))
    }

    /// One of the words of `choices`.
    pub fn choice<T: Copy>(&self, choices: &[(&'static str, T)]) -> Option<T> {
        let word = self.text()?;
        let chosen = choices.iter().find(|(name, _)| *name == word);
        chosen.map(|(_, value)| *value).or_else(|| {
            let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
            self.refuse(format!("must be {}", names.join(" or ")))
        })
    }

    /// Number of elements, where this is a list.
    pub fn list_length(&self) -> Option<usize> {
        self.value.get_ref().as_array().map(|array| array.len())
    }

    /// The elements of a list, each at its own place under the list's key.
    pub fn list(&self) -> Option<Vec<GivenValue<'a>>> {
        let Some(array) = self.value.get_ref().as_array() else { return self.wrong_type("a list") };
        let element = |value: &'a Spanned<DeValue<'a>>| {
            let place = KeyPath { at: Some(value.span().start), ..self.place.clone() };
            GivenValue { place, value }
        };
        Some(array.iter().map(element).collect())
    }

    /// The elements of a list; a number stands for a list of one.
    pub fn one_or_list(&self) -> Option<Vec<GivenValue<'a>>> {
        let value = self.value.get_ref();
        if value.is_integer() || value.is_float() {
            Some(vec![GivenValue { place: self.place.clone(), value: self.value }])
        } else {
            self.list()
        }
    }

    /// What `read` makes of the elements of a list. All are read, so that the faults of all are told.
    pub fn each<T>(&self, read: impl Fn(&GivenValue<'a>) -> Option<T>) -> Option<Vec<T>> {
        let read: Vec<Option<T>> = self.list()?.iter().map(read).collect();
        read.into_iter().collect()
    }

    /// Whether this is a table.
    pub fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    /// A table.
    pub fn table(&self) -> Option<TableReader<'a>> {
        match self.value.get_ref().as_table() {
            Some(entries) => Some(TableReader { place: self.place.clone(), entries: Some(entries) }),
            None => self.wrong_type("a table"),
        }
    }

    /// A fault: `wanted` was asked for.
    pub fn wrong_type<T>(&self, wanted: &str) -> Option<T> {
        let given = self.value.get_ref().type_str();
        let article = if given.starts_with(['a', 'i']) { "an" } else { "a" };
        self.refuse(format!("must be {wanted}; this is {article} {given}"))
    }

    /// The value as the user wrote it. A table under a heading is not quoted: the key says it all.
    fn text_as_written(&self) -> Option<String> {
        let span: Range<usize> = self.value.span();
        let text = self.place.report.quote(&span)?;
        let heading = self.is_table() && !text.starts_with('{');
        (!heading).then_some(text)
    }
}

/// A float that is a whole number and exactly that one.
fn whole_float(value: f64) -> Option<i128> {
    let whole = value.abs() <= WHOLE_FLOATS && value.fract() == 0.0;
    whole.then_some(value as i128)
}
