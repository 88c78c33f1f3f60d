//! How many rays the paths of blocks took, and how many they did without.

use crate::campaign::Campaign;
use crate::trace::PathEnd;

/// Counts rays for the cost report.
#[derive(Default)]
pub(super) struct RayCounts {
    pub(super) traced: u64,
    pub(super) skipped: u64,
}

impl RayCounts {
    /// The second part of split light: its ray alone.
    pub fn count_further(&mut self, ending: &PathEnd, campaign: &Campaign) {
        let traced = match ending {
            PathEnd::Shadowed | PathEnd::Lost | PathEnd::Absorbed { .. } => return,
            PathEnd::Truncated { down } => !down,
            PathEnd::Out { .. } | PathEnd::LeftDomain { .. } => true,
        };
        let traced = traced && campaign.trace.visibility;
        self.traced += u64::from(traced);
        self.skipped += u64::from(!traced);
    }

    pub fn count(&mut self, ending: &PathEnd, campaign: &Campaign) {
        let bounces = u64::from(campaign.trace.bounces);
        // The light's ray, and one after each bounce.
        let (traced, skipped) = match *ending {
            PathEnd::Out { order, .. } | PathEnd::LeftDomain { order, .. } | PathEnd::Absorbed { order } => {
                (1 + u64::from(order), 0)
            }
            PathEnd::Truncated { down } => (1 + bounces - u64::from(down), u64::from(down)),
            PathEnd::Shadowed | PathEnd::Lost => (1, 0),
        };
        if campaign.trace.visibility {
            self.traced += traced;
            self.skipped += skipped;
        } else {
            self.skipped += traced + skipped;
        }
    }
}
