//! The words of the command line: axes, laws, maskings.

use crate::campaign::parse::bounds::{Bounds, plain};
use crate::theory::{Masking, Ndf};

/// Below, light comes along the surface; no renderer looks there.
const MU: Bounds =
    Bounds::closed(1e-4, 1.0).advice("at mu = 0 light comes along the surface", "it is a cosine");
/// As in campaigns.
const ALPHA: Bounds = Bounds::closed(1e-4, 10.0).advice("a smooth mirror has E = 1", "");
/// Both sides are in the table, so that an index below 1 is its inverse from the other side.
const ETA: Bounds = Bounds::closed(1.0001, 10.0)
    .advice("of an index below 1 the inverse holds, with the sides exchanged", "");
/// As in campaigns.
const GAMMA: Bounds = Bounds::closed(2.0, 100.0);
/// Nodes of an axis at most.
const MOST: usize = 4096;
/// Nodes of mu and alpha where nothing is said.
const NODES: usize = 32;

/// Numbers that increase.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes(pub Vec<f64>);

impl Nodes {
    /// Where nothing is said.
    pub fn middles() -> Vec<f64> {
        middles(NODES)
    }
}

type Word<T> = Result<T, String>;

pub fn mu_nodes(word: &str) -> Word<Nodes> {
    nodes(word, &MU, true)
}

pub fn alpha_nodes(word: &str) -> Word<Nodes> {
    nodes(word, &ALPHA, true)
}

pub fn eta_nodes(word: &str) -> Word<Nodes> {
    nodes(word, &ETA, false)
}

/// The middles of equal parts of [0, 1].
fn middles(count: usize) -> Vec<f64> {
    (0..count).map(|k| (k as f64 + 0.5) / count as f64).collect()
}

fn nodes(word: &str, bounds: &Bounds, has_middles: bool) -> Word<Nodes> {
    let count = word.parse::<usize>().ok().filter(|&count| has_middles && count > 1);
    let parts: Vec<&str> = word.split(':').collect();
    let list = match (count, &parts[..]) {
        (Some(count), _) => {
            in_range(count)?;
            middles(count)
        }
        (None, [from, to, count]) => {
            let (from, to) = (number(from)?, number(to)?);
            let count = count.parse().map_err(|_| format!("`{count}` is no number of nodes"))?;
            in_range(count)?;
            let at = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
            // The last node is its own word's number, whatever the division rounds to.
            (0..count - 1).map(at).chain([to]).collect()
        }
        (None, [list]) => list.split(',').map(number).collect::<Word<Vec<f64>>>()?,
        _ => return Err("a list 0.1,0.5, or FROM:TO:N, is expected".into()),
    };
    if let Some(fault) =
        list.iter().find_map(|&node| Some(format!("{} {}", plain(node), bounds.fault(node)?)))
    {
        return Err(fault);
    }
    if list.len() > MOST {
        return Err(format!("{} nodes; at most {MOST} are allowed", list.len()));
    }
    match list.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(format!("{} comes after {}; nodes must increase", plain(pair[1]), plain(pair[0]))),
        None => Ok(Nodes(list)),
    }
}

fn in_range(count: usize) -> Word<()> {
    if (2..=MOST).contains(&count) { Ok(()) } else { Err(format!("{count} nodes; 2 to {MOST} are allowed")) }
}

fn number(word: &str) -> Word<f64> {
    word.trim()
        .parse()
        .map_err(|_| format!("`{word}` is no number; a list 0.1,0.5, or FROM:TO:N, is expected"))
}

pub fn law(word: &str) -> Word<Ndf> {
    match word.split_once(':') {
        None if word == "ggx" => Ok(Ndf::Ggx),
        None if word == "beckmann" => Ok(Ndf::Beckmann),
        Some(("student_t", gamma)) => {
            let gamma = gamma.parse().map_err(|_| format!("`{gamma}` is no number"))?;
            let fault = GAMMA.fault(gamma).map(|fault| format!("gamma {} {fault}", plain(gamma)));
            fault.map_or(Ok(Ndf::StudentT { gamma }), Err)
        }
        _ => Err("known laws are ggx, beckmann and student_t:GAMMA".into()),
    }
}

pub fn masking(name: &str) -> Word<Masking> {
    let known = &Masking::ALL[1..];
    known.iter().copied().find(|masking| masking.name() == name).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|masking| masking.name()).collect();
        format!("known maskings are {}", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_lists_ranges_and_middles() {
        let of = |word: &str| alpha_nodes(word).map(|nodes| nodes.0);
        assert_eq!(of("4"), Ok(vec![0.125, 0.375, 0.625, 0.875]));
        assert_eq!(of("0.5"), Ok(vec![0.5]));
        assert_eq!(of("1"), Ok(vec![1.0]));
        assert_eq!(of("0.1,0.5"), Ok(vec![0.1, 0.5]));
        assert_eq!(of("0.1:0.3:3"), Ok(vec![0.1, 0.2, 0.3]));
        assert_eq!(eta_nodes("2"), Ok(Nodes(vec![2.0])));
        for (word, says) in [
            ("0", "[1e-4, 10]"),
            ("nan", "finite"),
            ("0.5,0.1", "0.1 comes after 0.5"),
            ("0.1:0.5", "FROM:TO:N"),
            ("0.1:0.5:1", "2 to 4096"),
            ("5000", "2 to 4096"),
            ("a", "`a` is no number"),
            ("", "`` is no number"),
        ] {
            let why = of(word).expect_err(word);
            assert!(why.contains(says), "{word}: {why}");
        }
    }
}
