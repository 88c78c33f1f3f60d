//! The resolved campaign reads back as itself, whatever was accepted; and nothing makes the reader panic.

use gonio::campaign::{Campaign, to_toml};
use gonio::error::Error;
use proptest::prelude::*;

use crate::support::any_campaign::any_campaign;
use crate::support::campaign_text::{ARM, FILE, GOOD, accepted, on, parse, with, with_arm};
use crate::support::mutations::{self, Bits};

/// What is written must read back as the same campaign, and be written the same again.
#[track_caller]
fn round_trips(campaign: &Campaign) {
    let text = to_toml(campaign);
    let again = accepted(&text).campaign;
    assert_eq!(&again, campaign, "{text}");
    assert_eq!(to_toml(&again), text);
}

/// `GOOD` with Gaussian heights of a power spectral density.
fn by_density(model: &str) -> String {
    with("correlation_cells = 8.0\n", "")
        .replace("[surface.ggx]\nalpha = 0.2", &format!("[surface.psd]\npitch_um = 0.5\n{model}"))
}

#[test]
fn the_resolved_campaign_reads_back_as_itself() {
    let averaged = |text: String| text.replace("[light]", "[light]\naverage_azimuth = true");
    let texts = [
        GOOD.to_string(),
        with("seed = 7", "seed = 18446744073709551615"),
        with("alpha = 0.2", "alpha = [0.1, 0.2, 0.5]"),
        averaged(with("alpha = 0.2", "alpha_x = 1e-4\nalpha_y = 1")),
        with("[surface.ggx]", "[surface.beckmann]"),
        with("[surface.ggx]", "[surface.beckmann]\nspectrum = \"exponential\""),
        with("[surface.ggx]", "[surface.student_t]\ngamma = 3.7"),
        with("[surface.ggx]\nalpha = 0.2", "[surface.blinn_phong]\nexponent = 47.3"),
        by_density("model = \"k_correlation\"\na_um3 = 0.02\nb_um = 12\nc = 3.5"),
        by_density(
            "model = \"self_affine\"\nrms_um = 0.3\nhurst = 0.7\nf_min_per_um = 0.1\nf_max_per_um = 0.5",
        ),
        by_density(
            "model = \"table\"\nfrequency_per_um = [0.01, 0.1, 1]\npsd_um4 = [0.9, 0.5, 1e-4]\nrms_um = 0.19",
        ),
        by_density("model = \"table\"\nfrequency_per_um = [0.01, 0.1, 1]\npsd_um3 = [0.09, 0.05, 1e-5]"),
        format!("{GOOD}\n[scale]\npitch_um = 0.25\nwavelength_nm = 632.8\n"),
        with("material = \"gold\"", "f0 = [0.1, 0.25, 1e-7]"),
        with("[0, 15, 30]", "{ from = 0, to = 89.9, step = 0.1 }"),
        with("[light]", "[light]\nphi_i_deg = { from = -0.0, to = 350, step = 0.7 }"),
        with("[expect]\nmasking = \"direction_correlated\"\nl1_model = 0.04\n", ""),
        with("cells = 256\ncorrelation_cells = 8.0", "cells = 9"),
        with_arm(ARM),
        format!("{GOOD}\n[bench]\ncells = [128, 256]\ncorrelation_cells = [4, 8.5]\n"),
        format!("{GOOD}\n[bench]\n"),
        on("[surface.mirror]\n"),
        on("[surface.smith]\nalpha = [0.1, 0.5]\nndf = \"beckmann\"\nheights = \"independent\"\n"),
        on(
            "[surface.grains]\nalpha = 0.3\ncoverage = [0.1, 0.9]\nshape = \"pits\"\nbase = \"absorbing\"\nside = 20\n",
        ),
        averaged(on("[surface.v_groove]\nslope = 0.5\n")),
        averaged(on(FILE)),
        averaged(on("[surface.file]\npath = 'a \"quoted\" \\ näme.exr'\ndetrend = \"none\"\n")),
        averaged(on("[surface.file]\npath = \"a.exr\"\nrefine = 8\n")),
        averaged(on("[surface.file]\npath = \"a.gwy\"\nchannel = 3\n")),
        averaged(on("[surface.file]\npath = \"a.gwy\"\nchannel = \"Z raw\"\n")),
    ];
    for text in texts {
        let campaign = accepted(&text).campaign;
        round_trips(&campaign);
        for alpha in campaign.alphas().into_iter().flatten() {
            let one = campaign.with_alpha(alpha);
            assert_eq!(one.alphas(), [Some(alpha)]);
            round_trips(&one);
        }
    }
}

proptest! {
    // A failing case is printed; nothing is written beside the sources.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_campaign_within_its_ranges_round_trips(campaign in any_campaign()) {
        round_trips(&campaign);
    }
}

/// Changes of texts that stay the same whatever the libraries do.
struct Mutations(Bits);

impl Mutations {
    fn below(&mut self, limit: usize) -> usize {
        self.0.below(limit)
    }

    /// One to three bytes replaced, taken out or put in; half of the time one digit for another.
    fn of(&mut self, text: &[u8]) -> Vec<u8> {
        const TELLING: &[u8] = b"0123456789.-+e_[]{}\"'=,#\n\r\t \\naif\xff\x00";
        let mut bytes = text.to_vec();
        for _ in 0..=self.below(3) {
            let at = self.below(bytes.len());
            match self.below(8) {
                0 => bytes[at] = TELLING[self.below(TELLING.len())],
                1 => bytes[at] = self.below(256) as u8,
                2 => bytes.insert(at, TELLING[self.below(TELLING.len())]),
                3 => drop(bytes.remove(at)),
                _ => self.redraw_digit(&mut bytes, at),
            }
        }
        bytes
    }

    /// Another digit for the first one from `at` on: the change that most often leaves a campaign.
    fn redraw_digit(&mut self, bytes: &mut [u8], at: usize) {
        if let Some(digit) = bytes[at..].iter_mut().find(|b| b.is_ascii_digit()) {
            *digit = b'0' + self.below(10) as u8;
        }
    }
}

#[test]
fn no_mutation_of_a_campaign_panics_and_what_is_accepted_round_trips() {
    let ranged = with("[0, 15, 30]", "{ from = 0, to = 75, step = 15 }")
        .replace("[light]", "[light]\nphi_i_deg = [-0.0, 90, 180]");
    let file = on(FILE).replace("[light]", "[light]\nphi_i_deg = [0]").replace("\"gold\"", "\"water\"");
    let texts = [GOOD.to_string(), ranged, with_arm(ARM), file];
    let mut mutations = Mutations(Bits(1));
    let mut taken = 0;
    let rounds = mutations::rounds();
    for i in 0..rounds {
        match parse(mutations.of(texts[i % texts.len()].as_bytes())) {
            Ok(parsed) => {
                taken += 1;
                round_trips(&parsed.campaign);
            }
            Err(Error::Campaign(faults)) => assert!(!faults.is_empty()),
            Err(other) => panic!("{other}"),
        }
    }
    // Enough of both kinds for the test to mean something.
    assert!((rounds / 20..rounds / 20 * 19).contains(&taken), "{taken}");
}
