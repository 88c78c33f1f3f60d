//! A verdict in words: for a line, and for a reader who meets its terms for the first time.

use super::judgement::{ENERGY, Judgement, LIGHT, MODEL, RECIPROCITY, Ruling, TRANSMISSION};

/// All laws in one sentence: `passed`, `failed: energy`, `passed; not judged: reciprocity`, `not judged`.
pub fn overall(judgements: &[Judgement]) -> String {
    let named = |ruling: Ruling| {
        let of = judgements.iter().filter(|judgement| judgement.ruling == ruling);
        of.map(|judgement| &*judgement.law).collect::<Vec<_>>()
    };
    let [failed, passed, open] = [Ruling::Failed, Ruling::Passed, Ruling::NotJudged].map(named);
    if !failed.is_empty() {
        format!("failed: {}", failed.join(", "))
    } else if passed.is_empty() {
        "not judged: no law could be tested".into()
    } else if open.is_empty() {
        "passed".into()
    } else {
        format!("passed: {}; not judged: {}", passed.join(", "), open.join(", "))
    }
}

/// The same for a reader who meets these words for the first time: what holds, what does not, what is not known.
// Tested by `a_verdict_in_words_says_what_was_tested_and_no_more`.
pub fn in_words(judgements: &[Judgement]) -> String {
    let clauses = |ruling: Ruling| {
        let of = judgements.iter().filter(|judgement| judgement.ruling == ruling);
        of.map(|judgement| clause(&judgement.law, ruling)).collect::<Vec<_>>()
    };
    let [failed, passed, open] = [Ruling::Failed, Ruling::Passed, Ruling::NotJudged].map(clauses);
    let tested = match (failed.is_empty(), passed.is_empty()) {
        (true, true) => "Nothing could be tested.".into(),
        (true, false) => sentence(&listed(&passed)),
        (false, true) => sentence(&listed(&failed)),
        (false, false) => format!("{} Yet {}.", sentence(&listed(&failed)), listed(&passed)),
    };
    match open[..] {
        [] => tested,
        _ if failed.is_empty() && passed.is_empty() => tested,
        _ => format!("{tested} Not tested: {}.", listed(&open)),
    }
}

/// What a law says of the table, as it was ruled; of one that was not judged, its subject.
fn clause(law: &str, ruling: Ruling) -> &str {
    let [passed, failed, open] = match law {
        LIGHT => ["light arrived", "light is missing", "whether light arrived"],
        ENERGY => {
            ["no more light leaves than arrived", "more light leaves than arrived", "the sum of the light"]
        }
        RECIPROCITY => [
            "lamp and sensor may be exchanged",
            "lamp and sensor may not be exchanged",
            "the exchange of lamp and sensor",
        ],
        MODEL => [
            "the table is no farther from the formula than such a surface is",
            "the table is farther from the formula than such a surface is",
            "the distance from a formula",
        ],
        TRANSMISSION => [
            "light that goes through agrees with its formula",
            "light that goes through disagrees with its formula",
            "light that goes through",
        ],
        other => [other; 3],
    };
    match ruling {
        Ruling::Passed => passed,
        Ruling::Failed => failed,
        Ruling::NotJudged => open,
    }
}

/// `a`, `a and b`, `a, b, and c`.
fn listed(clauses: &[&str]) -> String {
    match clauses {
        [first, second] => format!("{first} and {second}"),
        [before @ .., last] if !before.is_empty() => format!("{}, and {last}", before.join(", ")),
        _ => clauses.concat(),
    }
}

/// With a capital and a full stop.
pub fn sentence(text: &str) -> String {
    let (first, rest) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    format!("{}{rest}.", first.to_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judgement(law: &'static str, ruling: Ruling) -> Judgement {
        Judgement { ruling, ..Judgement::not_judged(law, "") }
    }

    #[test]
    fn nothing_tested_is_no_pass() {
        let [open, passed, failed] = [Ruling::NotJudged, Ruling::Passed, Ruling::Failed]
            .map(|ruling| move |law| judgement(law, ruling));
        assert_eq!(overall(&[open(ENERGY), open(MODEL)]), "not judged: no law could be tested");
        assert_eq!(overall(&[passed(ENERGY), open(MODEL)]), "passed: energy; not judged: model");
        assert_eq!(overall(&[passed(ENERGY)]), "passed");
        assert_eq!(overall(&[passed(ENERGY), failed(MODEL), open(LIGHT)]), "failed: model");
    }

    #[test]
    fn a_verdict_in_words_says_what_was_tested_and_no_more() {
        use Ruling::{Failed, NotJudged, Passed};
        let said = |rulings: &[(&'static str, Ruling)]| {
            in_words(&rulings.iter().map(|&(law, ruling)| judgement(law, ruling)).collect::<Vec<_>>())
        };
        assert_eq!(
            said(&[(LIGHT, Passed), (ENERGY, Passed), (RECIPROCITY, NotJudged)]),
            "Light arrived and no more light leaves than arrived. Not tested: the exchange of lamp and sensor."
        );
        assert_eq!(
            said(&[(LIGHT, Passed), (ENERGY, Passed), (RECIPROCITY, Passed)]),
            "Light arrived, no more light leaves than arrived, and lamp and sensor may be exchanged."
        );
        assert_eq!(
            said(&[(ENERGY, Failed), (RECIPROCITY, Passed)]),
            "More light leaves than arrived. Yet lamp and sensor may be exchanged."
        );
        assert_eq!(said(&[(ENERGY, NotJudged)]), "Nothing could be tested.");
        assert_eq!(said(&[(MODEL, Failed)]), "The table is farther from the formula than such a surface is.");
    }
}
