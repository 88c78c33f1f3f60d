//! A row of the list, and how it is run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

/// Longest line that still is one clear line.
const LONGEST_LINE: usize = 600;
/// Processor time within which a row ends, whatever the machine does besides.
const MOST_SECONDS: u32 = 60;

/// Commands whose options an answer may name.
const VERBS: [&str; 16] = [
    "check",
    "surface",
    "measure",
    "merge",
    "validate",
    "compare",
    "fit",
    "study",
    "export",
    "import",
    "bench",
    "report",
    "recolour",
    "albedo",
    "appearance",
    "budget",
];

/// Sets up what a row needs beside plain files.
type Prepare = fn(&Path);

/// What is given, and what must come of it.
pub struct Row {
    /// What is bad about it, in a few words; several rows may try the same.
    pub name: &'static str,
    /// The files of the folder that the program runs in.
    files: Vec<(String, Vec<u8>)>,
    prepare: Option<Prepare>,
    /// The command line, and variables of the environment.
    words: Vec<String>,
    /// What the shell limits before the program starts.
    limit: Option<&'static str>,
    environment: Vec<(&'static str, &'static str)>,
    exit: i32,
    says: Vec<&'static str>,
    in_all_lines: Vec<&'static str>,
}

/// A row that runs `words`, the command line without the program's name.
pub fn command(name: &'static str, words: &str) -> Row {
    let words = words.split_whitespace().map(String::from).collect();
    let (files, environment, says, in_all_lines) = (vec![], vec![], vec![], vec![]);
    Row { name, files, prepare: None, words, limit: None, environment, exit: 0, says, in_all_lines }
}

/// A row that measures the campaign `text`, which must be refused.
pub fn refused(name: &'static str, text: impl Into<Vec<u8>>, says: &[&'static str]) -> Row {
    command(name, "measure c.toml").file("c.toml", text).exits(2, says)
}

/// A row that checks the campaign `text`, which must be taken; the answer holds `says`.
pub fn taken(name: &'static str, text: impl Into<Vec<u8>>, says: &[&'static str]) -> Row {
    command(name, "check c.toml").file("c.toml", text).exits(0, says)
}

impl Row {
    pub fn file(mut self, name: &str, content: impl Into<Vec<u8>>) -> Row {
        self.files.push((name.into(), content.into()));
        self
    }

    /// `prepare` works on the folder before the program runs there.
    pub fn prepared(self, prepare: Prepare) -> Row {
        Row { prepare: Some(prepare), ..self }
    }

    pub fn environment(mut self, name: &'static str, value: &'static str) -> Row {
        self.environment.push((name, value));
        self
    }

    /// Under `ulimit` with these words.
    pub fn limited(self, limit: &'static str) -> Row {
        Row { limit: Some(limit), ..self }
    }

    /// One more word of the command line, whatever is in it.
    pub fn word(mut self, word: impl Into<String>) -> Row {
        self.words.push(word.into());
        self
    }

    /// The exit code, and what one line of the answer (of stderr where something is wrong) must hold.
    pub fn exits(self, exit: i32, says: &[&'static str]) -> Row {
        Row { exit, says: says.to_vec(), ..self }
    }

    /// What the whole answer must hold, anywhere.
    pub fn and_somewhere(self, says: &[&'static str]) -> Row {
        Row { in_all_lines: says.to_vec(), ..self }
    }
}

/// Runs all rows and reports every one that does not hold.
pub fn all_hold(rows: Vec<Row>) {
    let mut failures = Vec::new();
    for (at, row) in rows.iter().enumerate() {
        // Of rows with one name, which one it is.
        let nth = 1 + rows[..at].iter().filter(|other| other.name == row.name).count();
        failures.extend(run(row).err().map(|why| format!("`{}` {nth}: {why}", row.name)));
    }
    let (failed, all) = (failures.len(), rows.len());
    assert!(failures.is_empty(), "{failed} of {all} rows do not hold:\n\n{}", failures.join("\n\n"));
}

fn run(row: &Row) -> Result<(), String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    for (name, content) in &row.files {
        fs::write(folder.path().join(name), content).expect("file");
    }
    if let Some(prepare) = row.prepare {
        prepare(folder.path());
    }
    let before = contents(folder.path());
    let limits: String = row.limit.iter().map(|limit| format!("ulimit {limit}; ")).collect();
    let line = format!("ulimit -t {MOST_SECONDS}; {limits}exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_gonio")]).current_dir(folder.path()).args(&row.words);
    command.envs(row.environment.iter().copied());
    let output = command.output().expect("runs");
    judge(row, &output, before == contents(folder.path())).map_err(|why| {
        let given = row.files.first().map_or(String::new(), |(_, text)| excerpt(text));
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let words = excerpt(row.words.join(" ").as_bytes());
        format!("{why}\n  gonio {words}\n  given: {given}\n  stdout: {out}\n  stderr: {err}")
    })
}

fn judge(row: &Row, output: &Output, unchanged: bool) -> Result<(), String> {
    let text =
        |bytes: &[u8]| String::from_utf8(bytes.to_vec()).map_err(|_| "answer is not UTF-8".to_string());
    let (out, err) = (text(&output.stdout)?, text(&output.stderr)?);
    if output.status.code() != Some(row.exit) {
        return Err(format!("exit {:?}, not {}", output.status.code(), row.exit));
    }
    if [&out, &err].iter().any(|text| text.contains(|c: char| c.is_control() && c != '\n')) {
        return Err("control characters in the answer".into());
    }
    if err.contains("panicked") || err.lines().any(|line| line.len() > LONGEST_LINE) {
        return Err("a panic's text, or a line that nobody reads".into());
    }
    let wrong = row.exit != 0;
    if wrong && !unchanged {
        return Err("files were written".into());
    }
    if wrong && row.exit != 1 && !err.lines().any(|line| line.starts_with("error: ")) {
        return Err("no error is said".into());
    }
    advice_is_of(&row.words, &err)?;
    let holds = |line: &str| row.says.iter().all(|word| line.contains(word));
    let lines = if wrong { err.clone() } else { format!("{out}{err}") };
    if !row.says.is_empty() && !lines.lines().any(holds) {
        return Err(format!("no line has all of {:?}", row.says));
    }
    match row.in_all_lines.iter().find(|word| !lines.contains(*word)) {
        Some(word) => Err(format!("{word:?} is nowhere")),
        None => Ok(()),
    }
}

/// An option that an answer names is one of the command at hand, or of that whose name stands before it.
fn advice_is_of(words: &[String], answer: &str) -> Result<(), String> {
    let mut command = words.first().map_or("", String::as_str);
    for word in
        answer.split(|c: char| c.is_whitespace() || "`\"'(),;:=".contains(c)).filter(|word| !word.is_empty())
    {
        if VERBS.contains(&word) {
            command = word;
        }
        let option = word.trim_end_matches(['.', '?']);
        if option.starts_with("--") && option.len() > 2 && !words.iter().any(|given| given == option) {
            if !options_of(command).contains(&format!("{option} ")) {
                return Err(format!("{option} is no option of gonio {command}"));
            }
            command = &words[0];
        }
    }
    Ok(())
}

/// The help of a command, once it was asked for.
fn options_of(verb: &str) -> &'static str {
    static HELPS: [OnceLock<String>; VERBS.len()] = [const { OnceLock::new() }; VERBS.len()];
    VERBS.iter().position(|known| *known == verb).map_or("", |k| {
        HELPS[k].get_or_init(|| {
            let help =
                Command::new(env!("CARGO_BIN_EXE_gonio")).args([verb, "--help"]).output().expect("runs");
            String::from_utf8(help.stdout).expect("UTF-8").replace('\n', " ")
        })
    })
}

/// Names and bytes of everything below a folder; of what is no regular file the name alone.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("readable") {
        let path = entry.expect("entry").path();
        let kind = path.symlink_metadata().expect("there").file_type();
        let name = path.to_string_lossy().into_owned();
        if kind.is_dir() {
            // A folder that holds nothing is no result.
            found.extend(contents(&path));
            continue;
        }
        // Sparse files of a gigabyte are told by their length.
        let length = path.metadata().map_or(0, |meta| meta.len());
        let small = kind.is_file() && length < 1 << 26;
        found.insert(
            name,
            if small { fs::read(&path).unwrap_or_default() } else { length.to_le_bytes().to_vec() },
        );
    }
    found
}

fn excerpt(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(&text[..text.len().min(2000)]).into_owned();
    text.chars().take(300).collect()
}
