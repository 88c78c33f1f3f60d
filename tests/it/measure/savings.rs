//! Promise: what the plan says that it skips is what the run skips: rays as they are counted, for every way of choosing
//! surface samples.
//!
//! That the answer stays the same is `skips.rs`'s promise.

use std::collections::BTreeSet;
use std::path::Path;

use gonio::campaign::{self, Campaign, SurfaceKind};
use gonio::measure::{self, Cost, Measured, Patches, Plan};

const RANDOM: &str = "cells = 128\n[surface.ggx]\nalpha = 0.4\n";
const RELATIVE: &str = "azimuth = \"relative\"\n";
const HEMISPHERE: &str = "[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n";
const ARM: &str = "[sensor.arm]\ntheta_r_deg = [-40, 0, 20, 60]\nphi_r_deg = [150, 180]\naperture_deg = 1\n";
/// Apertures that cover more of the hemisphere than an index pays for.
const WIDE_ARM: &str = "[sensor.arm]\ntheta_r_deg = [20, 50]\nphi_r_deg = [90, 180]\naperture_deg = 25\n";

/// A campaign, its plan, and what a run of it counted.
struct Counted {
    plan: Plan,
    cost: Cost,
    table: Measured,
}

impl Counted {
    fn new(campaign: &Campaign, patches: &Patches, plan: Plan) -> Self {
        let (mut tables, cost) = measure::measure(campaign, &plan, patches, &|_| ()).expect("measured");
        Counted { plan, cost, table: tables.remove(0) }
    }

    fn starts(&self) -> u64 {
        self.plan.total_samples
    }

    /// Paths of all incidences that ended so.
    fn paths(&self, of: impl Fn(&measure::IncidenceResult) -> u64) -> u64 {
        self.table.incidences.iter().map(of).sum()
    }

    /// Checks the saving of this name; `all`: the same campaign with light in all directions followed.
    fn check(&self, what: &str, saves: &str, all: Option<&Counted>) {
        let Counted { plan, cost, table } = self;
        let traced = cost.rays_traced;
        let outside = self.paths(|incidence| incidence.outside);
        match what {
            // Three would be: from above, towards the light, and towards the sensor.
            "primary rays" | "the light's ray of each sample" => {
                assert!(traced <= 2 * self.starts(), "{traced} of {}", self.starts())
            }
            "all rays" => assert_eq!(traced, 0),
            "the sensor's ray of paths that go down at the last order" => {
                let followed = self.starts() - outside;
                let sent = self.paths(|incidence| incidence.orders[0] + incidence.cut);
                let not_sent = followed + sent - traced;
                // Between the walls of grooves so flat none goes down, and none into an aperture.
                let none = plan.apertures_only || plan.start_sampler.name() == "by_place";
                // A start that a grain buries has no light's ray either.
                let buried = if plan.start_sampler.name() == "on_grains" {
                    self.paths(|incidence| incidence.hidden)
                } else {
                    0
                };
                let most = self.paths(|incidence| incidence.cut) + buried;
                assert!((none || not_sent > 0) && not_sent <= most, "{not_sent}");
                assert_eq!(not_sent, cost.rays_skipped - 2 * outside);
            }
            "both rays of starts that send light into no aperture" => {
                assert!(
                    outside > 0
                        && cost.rays_skipped >= 2 * outside
                        && traced <= 2 * (self.starts() - outside)
                );
                // Each aperture of half-angle d covers 1 - cos d.
                let half_angle = plan.grid.aperture_deg.expect("an arm").to_radians();
                let fraction = plan.bins as f64 * 2.0 * (0.5 * half_angle).sin().powi(2);
                assert!(saves.contains(&format!("cover {:.2} %", 100.0 * fraction)), "{saves}: {fraction}");
            }
            "starts on facets that send light into no aperture" => {
                let all = all.expect("an arm").cost.rays_traced;
                assert!(10 * traced <= all, "{traced} of {all}: {saves}");
            }
            "half of the directions" => {
                let folded = plan.folded.iter().filter(|&&folded| folded).count();
                assert!(saves.contains(&format!("{folded} of {} incidences", plan.incidences)), "{saves}");
                let hits = |incidence: usize| -> u64 {
                    table.table.hits[incidence * plan.bins..][..plan.bins]
                        .iter()
                        .map(|&hits| u64::from(hits))
                        .sum()
                };
                // The bins of a hemisphere hold every path, once or on both sides.
                for incidence in (0..plan.incidences).filter(|_| !plan.apertures_only && plan.bins == 7 * 12)
                {
                    let sides = if plan.folded[incidence] { 2 } else { 1 };
                    assert_eq!(
                        hits(incidence),
                        sides * table.incidences[incidence].orders.iter().sum::<u64>()
                    );
                }
            }
            "the light's ray of starts that another grain buries" => {
                let hidden = self.paths(|incidence| incidence.hidden);
                // Of grains that cover a fifth of the plane by themselves, a tenth is buried: ln(1/0.8)/0.2 - 1.
                assert!(
                    cost.rays_skipped > self.starts() / 200
                        && cost.rays_skipped <= hidden + self.paths(|incidence| incidence.cut)
                );
            }
            // Nothing that rays are counted of.
            "the walk of rays steeper than every slope"
            | "samples that fall together by chance"
            | "synthesis for further incidences"
            | "incidences at further azimuths"
            | "throughput" => {}
            other => panic!("a saving that no count stands against: {other}"),
        }
    }
}

fn parsed(surface: &str, light: &str, sensor: &str, more: &str) -> Campaign {
    let text = format!(
        "name = \"savings\"\nseed = 3\n[surface]\nrealisations = 2\n{surface}[light]\ntheta_i_deg = [20, 70]\n\
         {light}{sensor}{more}[stop]\nsamples = 65_536\n"
    );
    campaign::parse(&text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}")).campaign
}

#[test]
fn reported_savings_are_the_counted_ones() {
    let random = |sensor, more| parsed(RANDOM, RELATIVE, sensor, more);
    // One block on a patch of more than 64 cells for each sample.
    let large = "cells = 2056\n[surface.beckmann]\nalpha = 0.4\n";
    let smith = "[surface.smith]\nndf = \"ggx\"\nheights = \"correlated\"\nalpha = 0.4\n";
    let absolute = "azimuth = \"absolute\"\nphi_i_deg = [0, 25]\n";
    let cases = [
        ("by_slope", random(HEMISPHERE, "")),
        ("by_slope", random(HEMISPHERE, "[trace]\nvisibility = false\n")),
        ("by_slope", random(WIDE_ARM, "")),
        ("by_place", parsed(large, RELATIVE, HEMISPHERE, "")),
        ("by_place", parsed("[surface.v_groove]\nslope = 0.5\n", absolute, HEMISPHERE, "")),
        ("into_apertures", random(ARM, "")),
        ("on_grains", parsed("[surface.grains]\ncoverage = 0.2\nalpha = 0.4\n", RELATIVE, HEMISPHERE, "")),
        ("from_above", parsed("[surface.grains]\ncoverage = 0.9\nalpha = 0.4\n", RELATIVE, HEMISPHERE, "")),
        ("law", parsed(smith, RELATIVE, HEMISPHERE, "")),
    ];
    let mut seen = BTreeSet::new();
    for (sampler, mut campaign) in cases {
        // One patch of that size tells as much as two.
        if campaign.surface.cells > 1024 {
            campaign.surface.realisations = 1;
        }
        let plan = measure::plan(&campaign).expect("a plan");
        assert_eq!(plan.start_sampler.name(), sampler);
        let others = [plan.by_place(&campaign), plan.all_directions(&campaign)];
        let plans = [Some(plan)].into_iter().chain(others).flatten();
        // Heights are made once for all plans.
        let patches = match campaign.surface.kind {
            SurfaceKind::Ggx(_) | SurfaceKind::Beckmann { .. } => Patches::held(&campaign),
            _ => Patches::prepare(&campaign, &mut Vec::new()),
        };
        let patches = patches.expect("patches");
        let counted: Vec<Counted> = plans.map(|plan| Counted::new(&campaign, &patches, plan)).collect();
        for run in &counted {
            let all = counted.iter().find(|other| !other.plan.apertures_only);
            run.plan.skipped.iter().for_each(|skip| run.check(&skip.what, &skip.saves, all));
            seen.insert(run.plan.start_sampler.name());
        }
    }
    assert_eq!(
        seen.into_iter().collect::<Vec<_>>(),
        ["by_place", "by_slope", "from_above", "into_apertures", "law", "on_grains"]
    );
}
