//! How paths end: into which sums their light goes, and how many rays they took.

use glam::{DVec2, DVec3};

use super::tracer::{BlockTracer, Carried};
use crate::measure::accumulate::tally::to_units;
use crate::measure::optics::PathLight;
use crate::trace::{PathEnd, SplitEnd};

impl BlockTracer<'_> {
    /// Notes whether the light sees the facet of a start, where facets of every slope are started on.
    pub(super) fn look(&mut self, to_field: impl Fn(DVec3) -> DVec3, slope: DVec2, ending: PathEnd) {
        if !self.context.campaign.trace.visibility || self.context.plan.apertures_only {
            return;
        }
        let turn = &mut self.turns[self.at];
        let header = turn.arms.header;
        let along = *turn.along.get_or_insert_with(|| {
            let along = to_field(header).truncate();
            // A surface without an alpha is told by its slopes themselves, whatever unit its heights are in.
            if self.context.campaign.alphas()[0].is_some() { along / along.length() } else { along }
        });
        self.tally.seen.count(slope.dot(along), ending != PathEnd::Shadowed);
    }

    /// Whether nothing but apertures counts, and a start sends light into none: `reflected` is where it goes.
    pub(super) fn misses(&self, reflected: impl Fn() -> Option<DVec3>) -> bool {
        if !self.context.plan.apertures_only {
            return false;
        }
        let Some(wo) = reflected().filter(|wo| wo.z > 0.0) else { return true };
        let arms = &self.turn().arms;
        let (sensor, wo) = (&self.context.sensor, arms.in_bins(wo));
        let folded = self.context.plan.folded[self.incidence];
        let seen = sensor.sees(wo) || (folded && sensor.sees(arms.mirrored(wo)));
        !seen
    }

    /// Counts samples that send light into no aperture: they need no ray.
    pub(super) fn leave_out(&mut self, starts: u64) {
        self.counted += starts;
        self.tally.outside.add_many(starts, self.turn().carried.units);
        self.rays.skipped += 2 * starts;
    }

    /// Counts all samples of a block none of whose facets is facing the light: they carry nothing.
    pub fn all_turned_away(&mut self, starts: u64) {
        self.counted += starts;
        self.tally.hidden.add_many(starts * self.paths(), 0);
        self.rays.skipped += starts;
    }

    /// Counts what is missing of `starts` as starts that send light into no aperture.
    pub fn leave_out_up_to(&mut self, starts: u64) {
        if !self.given_up {
            self.leave_out(starts.saturating_sub(self.counted));
        }
    }

    /// Counts a path.
    pub(super) fn end(&mut self, ending: PathEnd, light: &PathLight) {
        self.counted += 1;
        self.rays.count(&ending, self.context.campaign);
        let carried = self.turn().carried;
        self.end_with(ending, light, &carried);
    }

    /// Counts both parts of the light of a path, each with its share of the flux.
    pub(super) fn end_split(&mut self, ends: &SplitEnd, light: &PathLight) {
        let campaign = self.context.campaign;
        self.counted += 1;
        self.rays.count(&ends.reflected, campaign);
        self.rays.count_further(&ends.refracted, campaign);
        let whole = self.turn().carried;
        let carried = |share: f64| Carried::new(share * whole.flux, share * whole.part);
        let up = carried(ends.reflectance);
        // Both parts are the whole, to the last unit.
        let down = Carried {
            units: whole.units - up.units,
            part_units: whole.part_units - up.part_units,
            ..carried(1.0 - ends.reflectance)
        };
        self.end_with(ends.reflected, light, &up);
        self.end_with(ends.refracted, light, &down);
    }

    fn end_with(&mut self, ending: PathEnd, light: &PathLight, carried: &Carried) {
        let units = carried.units;
        match ending {
            PathEnd::Out { wo, order } => self.arrive(wo, order, light, (carried, false)),
            PathEnd::Shadowed => self.tally.hidden.add(units),
            PathEnd::Truncated { .. } => self.tally.cut.add(units),
            PathEnd::LeftDomain { wo, order, further } => {
                self.tally.left_map.add(units);
                if further {
                    self.tally.left(&self.context.plan.sums).cut.add(units);
                }
                if let Some(wo) = wo {
                    self.arrive(wo, order, light, (carried, true));
                }
            }
            PathEnd::Absorbed { .. } => self.tally.absorbed.add(units),
            PathEnd::Lost => self.tally.lost += 1,
        }
    }

    /// A path that leaves: into its order, and into its bins, mirrored ones too where the incidence is folded. One that
    /// left an open map on its way goes into the sums of those.
    fn arrive(&mut self, wo: DVec3, order: u32, light: &PathLight, (carried, left_map): (&Carried, bool)) {
        let (context, weights) = (self.context, &mut self.weights);
        let tally = if left_map { self.tally.left(&context.plan.sums) } else { &mut *self.tally };
        let Carried { flux, units, part, part_units } = carried;
        let arms = &self.turns[self.at].arms;
        let hits_first = light.place() * context.plan.bins;
        context.plan.sums.weigh(light, order, weights);
        let polarised = context.polarimeter.as_ref().map(|it| it.light_of(light, arms, wo, weights));
        let orders = if wo.z > 0.0 { &mut tally.orders } else { &mut tally.through };
        let out = &mut orders[order as usize - 1];
        out.count += 1;
        out.flux += units;
        for (sum, weight) in out.weighted[weights.order_first..].iter_mut().zip(&weights.order) {
            *sum += to_units(flux * weight);
        }
        let share = |weight: &f64| to_units(part * weight);
        let into_bin = |bin: usize, mirrored: bool| {
            tally.hits[hits_first + bin] += 1;
            if let Some(polarised) = &polarised {
                polarised.add(bin, mirrored, *part, &mut tally.mueller);
            }
            let sums = if order > 1 {
                &mut tally.multiple[weights.first..]
            } else {
                tally.single[bin] += part_units;
                &mut tally.first[weights.first..]
            };
            for (sums, weight) in sums.iter_mut().zip(&weights.bins) {
                sums[bin] += share(weight);
            }
        };
        let wo = arms.in_bins(wo);
        if context.plan.folded[self.incidence] {
            context.sensor.each_bin_of_both(wo, arms.mirrored(wo), into_bin);
        } else {
            let mut into_bin = into_bin;
            context.sensor.each_bin(wo, |bin| into_bin(bin, false));
        }
    }
}

impl Drop for BlockTracer<'_> {
    /// Adds the blocks' rays to the run's.
    fn drop(&mut self) {
        self.context.add_rays(self.rays.traced, self.rays.skipped);
    }
}
