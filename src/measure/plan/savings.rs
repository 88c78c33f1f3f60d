//! What a campaign does not need: each with the reason why the answer stays the same, and what it saves.

use super::decisions::{Plan, Saving};
use super::start_sampler::{StartSampler, aperture_fraction};
use crate::campaign::{Campaign, Optics, SurfaceKind};
use crate::instrument::GridKind;

/// The list of what is skipped. `tests/it/measure/skips.rs` tests each against its reason.
pub(crate) fn skips(campaign: &Campaign, plan: &Plan) -> Vec<Saving> {
    let mut skipped = Vec::new();
    let mut skip = |what: &str, why: &str, saves: String| {
        skipped.push(Saving { what: what.into(), why: why.into(), saves });
    };
    of_rays(campaign, plan, &mut skip);
    of_apertures(plan, &mut skip);
    of_samples(campaign, plan, &mut skip);
    of_materials(campaign, plan, &mut skip);
    skipped
}

/// Rays whose answer is known.
fn of_rays(campaign: &Campaign, plan: &Plan, skip: &mut impl FnMut(&str, &str, String)) {
    let explicit = !matches!(campaign.surface.kind, SurfaceKind::Smith(_));
    if !explicit {
        return;
    }
    // Of clear facets both parts of the light have a ray.
    let rays = if plan.sums.goes_through() { "four" } else { "three" };
    let (above, all) = plan.start_sampler.count_from_above();
    let share =
        |some: usize| if some == all { String::new() } else { format!(", at {some} of {all} incidences") };
    if above < all || all == 0 {
        skip(
            "primary rays",
            "paths start on the facets, in proportion to the area turned to the light",
            format!("one ray of {rays} at order 1{}", share(all - above)),
        );
    }
    if above > 0 {
        skip(
            "the light's ray of each sample",
            "what a ray from above meets first is lit",
            format!("one ray of {rays} at order 1{}", share(above)),
        );
    }
    if !campaign.trace.visibility {
        skip(
            "all rays",
            "visibility is switched off; energy laws do not apply",
            "all tracing but the reflections".into(),
        );
        return;
    }
    if above < all {
        skip(
            "samples that fall together by chance",
            "starts go in equal steps from grain to grain, their normals evenly",
            "half (coverage 0.5) to 3 of 4 (coverage 0.2) of the time for the same error (measured)".into(),
        );
        skip(
            "the light's ray of starts that another grain buries",
            "what lies inside a grain is no surface",
            "a ray for each of them: the share of the grains that is buried".into(),
        );
    }
    if plan.start_sampler == StartSampler::BySlope {
        skip(
            "samples that fall together by chance",
            "starts go in equal steps from facet to facet of like slope: they send light into the same bin, which gets \
             its share of them",
            "half (alpha 0.8) to 4 of 5 (alpha 0.05) of the time for the same error (measured)".into(),
        );
    }
    skip(
        "the sensor's ray of paths that go down at the last order",
        "a path that goes down must hit again",
        "1 % of these rays at alpha 0.2, 10 % at alpha 0.5 and grazing light".into(),
    );
    if campaign.surface.kind.explicit_grains().is_none() {
        skip(
            "the walk of rays steeper than every slope",
            "nothing on their way rises as fast",
            "all rays of smooth maps and grooves within their slope, few where a patch has needles".into(),
        );
    }
}

/// Facets and rays that no aperture asks for.
fn of_apertures(plan: &Plan, skip: &mut impl FnMut(&str, &str, String)) {
    if plan.grid.kind != GridKind::Arm || !plan.apertures_only {
        return;
    }
    let share = 100.0 * aperture_fraction(&plan.grid.regions(0));
    skip(
        "both rays of starts that send light into no aperture",
        "a facet and the light fix where it goes; albedos and energy laws are then not available",
        format!("the rays of most starts: the apertures cover {share:.2} % of the hemisphere"),
    );
    if matches!(plan.start_sampler, StartSampler::IntoApertures(_)) {
        skip(
            "starts on facets that send light into no aperture",
            "an index of the facets by slope finds the others: same density of starts, same flux each",
            "9 parts of 10 of the tracing and more, for an in-plane scan (measured)".into(),
        );
    }
}

/// Samples that others stand for.
fn of_samples(campaign: &Campaign, plan: &Plan, skip: &mut impl FnMut(&str, &str, String)) {
    let roughnesses = campaign.alphas().len();
    if roughnesses > 1 {
        skip(
            "synthesis for further roughnesses",
            "one canonical patch serves every alpha: scaling is affine",
            format!("{} of {roughnesses} patches", roughnesses - 1),
        );
    }
    if plan.incidences > 1 && campaign.surface.kind.has_random_patches() {
        skip(
            "synthesis for further incidences",
            "all incidences see the same patches",
            format!("{} of {} patches", plan.incidences - 1, plan.incidences),
        );
    }
    if plan.averages_azimuth {
        skip(
            "incidences at further azimuths",
            "the table is averaged over the light's azimuth: one for every block",
            "a dimension of the table; 4 to 8 times the noise of starts at one azimuth".into(),
        );
    }
    let folded = plan.folded.iter().filter(|&&folded| folded).count();
    if folded > 0 {
        skip(
            "half of the directions",
            "the law is its own mirror image: each arrival counts on both sides",
            format!("half of the samples at {folded} of {} incidences", plan.incidences),
        );
    }
    if plan.images > 1 {
        skip(
            "further patches",
            "mirror images of a patch have the same law: the arms are mirrored",
            "up to 7 of 8 patches at the same error".into(),
        );
    }
}

/// Colours and weights that follow from others.
fn of_materials(campaign: &Campaign, plan: &Plan, skip: &mut impl FnMut(&str, &str, String)) {
    if campaign.optics == Optics::PerfectMirror {
        skip(
            "throughput",
            "F = 1: tallies are counts",
            "three products and a rounding for each arrival".into(),
        );
        return;
    }
    if plan.sums.goes_through() {
        if campaign.trace.bounces == 1 {
            skip(
                "the choice between both parts of the light at a facet",
                "each part is followed with its share of the flux",
                "all noise of that choice".into(),
            );
        }
        return;
    }
    let colours = format!("{} of {} traces", plan.colours - 1, plan.colours);
    let (why, saves) = match (plan.sums.is_traced(), campaign.trace.bounces) {
        (true, _) if plan.colours == 1 => return,
        (true, _) => ("all colours are worked out along the same paths", colours),
        (false, 1) => (
            "Schlick's Fresnel follows from the bin's sum of (1-c)^5",
            format!("{colours}, and all of a further material (`recolour`)"),
        ),
        (false, _) => (
            "Schlick's Fresnel of every order is a polynomial in F0, whose coefficients are summed",
            format!("{colours}, and all of a further material (`recolour`)"),
        ),
    };
    skip("a trace for each colour and material", why, saves);
}
