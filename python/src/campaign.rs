//! A campaign as Python has it: a file, a text or a document, and keys that are set besides.

use std::path::{Path, PathBuf};

use gonio::campaign::{self, Parsed};
use gonio::error::{Error, Result};
use gonio::files;
use pyo3::FromPyObject;
use serde_json::Value;
use toml::Table;

/// Where a campaign is from.
#[derive(FromPyObject)]
pub struct Source {
    /// The file.
    #[pyo3(item)]
    pub path: Option<PathBuf>,
    /// The TOML text, where there is no file; a document is an empty one.
    #[pyo3(item)]
    text: String,
    /// Keys that are set besides, JSON: tables are joined, null takes a key away.
    #[pyo3(item)]
    keys: Option<String>,
}

impl Source {
    /// The campaign; height maps are looked for next to its file, or where the process is.
    ///
    /// Errors: as [`campaign::read`]. With keys besides there are no lines that a fault could name.
    pub fn read(&self) -> Result<Parsed> {
        let Some(keys) = &self.keys else { return self.plain() };
        let text = match &self.path {
            Some(path) => String::from_utf8_lossy(&files::read(path)?).into_owned(),
            None => self.text.clone(),
        };
        let Ok(mut table) = text.trim_start_matches('\u{feff}').parse::<Table>() else { return self.plain() };
        join(&mut table, serde_json::from_str(keys).map_err(|e| Error::Usage(format!("campaign: {e}")))?)?;
        let text = toml::to_string(&table).map_err(|e| Error::Usage(format!("campaign: {e}")))?;
        campaign::parse(text, &self.name(), self.folder()).map_err(without_lines)
    }

    fn plain(&self) -> Result<Parsed> {
        match &self.path {
            Some(path) => campaign::read(path),
            None => campaign::parse(&self.text, &self.name(), self.folder()),
        }
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        self.path.as_ref().map_or("campaign".into(), |path| path.display().to_string())
    }

    fn folder(&self) -> &Path {
        self.path.as_deref().and_then(Path::parent).unwrap_or(Path::new(""))
    }
}

/// Sets the keys of a document in a table, tables within tables.
fn join(table: &mut Table, document: Value) -> Result<()> {
    let Value::Object(keys) = document else {
        return Err(Error::Usage("campaign: a document of keys and values is needed".into()));
    };
    for (key, value) in keys {
        match value {
            Value::Null => drop(table.remove(&key)),
            Value::Object(_) => {
                let mut below = match table.remove(&key) {
                    Some(toml::Value::Table(below)) => below,
                    _ => Table::new(),
                };
                join(&mut below, value)?;
                table.insert(key, below.into());
            }
            value => {
                let value = toml::Value::try_from(&value)
                    .map_err(|e| Error::Usage(format!("campaign: {key} = {value}: {e}")))?;
                table.insert(key, value);
            }
        }
    }
    Ok(())
}

/// The faults of a text that nobody has seen.
fn without_lines(error: Error) -> Error {
    let Error::Campaign(mut faults) = error else { return error };
    faults.iter_mut().for_each(|fault| (fault.line, fault.column) = (None, None));
    Error::Campaign(faults)
}
