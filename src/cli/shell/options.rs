//! What an option that a command does not know was meant for.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};

use crate::campaign::key_tables::table_of;

/// The same answer, with a tip that holds: where the option belongs to another command or is a key of the campaign.
pub fn with_tip(mut answer: Error, program: fn() -> Command) -> Error {
    if answer.kind() != ErrorKind::UnknownArgument {
        return answer;
    }
    let Some(ContextValue::String(word)) = answer.get(ContextKind::InvalidArg) else { return answer };
    let option = word.trim_start_matches('-').split('=').next().unwrap_or_default();
    let tip = tip(option, &program());
    // Of the library's own tips that of a similar option is of use; the other would take the option for a value.
    answer.remove(ContextKind::Suggested);
    if let Some(tip) = tip {
        answer.remove(ContextKind::SuggestedArg);
        answer.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    answer
}

fn tip(option: &str, program: &Command) -> Option<String> {
    let knows = |verb: &&Command| verb.get_opts().any(|known| known.get_long() == Some(option));
    let verbs: Vec<&str> = program.get_subcommands().filter(knows).map(Command::get_name).collect();
    if !verbs.is_empty() {
        return Some(format!("--{option} is an option of {}", listed(&verbs)));
    }
    let key = option.replace('-', "_");
    table_of(&key).map(|table| format!("{key} is a key of the campaign, in {table}"))
}

/// `gonio a, b or c`
fn listed(verbs: &[&str]) -> String {
    match verbs {
        [rest @ .., last] if !rest.is_empty() => format!("gonio {} or {last}", rest.join(", ")),
        _ => format!("gonio {}", verbs.concat()),
    }
}
