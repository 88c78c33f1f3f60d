//! What the blocks of a run share.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use super::blocks::polarimeter::Polarimeter;
use super::cost::{Clocks, Cost};
use super::optics::{FacetWay, ways_of};
use super::persist::run_state::RunState;
use super::plan::Plan;
use super::session::{Session, locked};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Sensor;
use crate::trace::Kernel;

/// Everything that blocks share.
pub(super) struct Context<'a> {
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub session: &'a Session<'a>,
    pub sensor: Sensor,
    /// Where Mueller matrices are measured.
    pub polarimeter: Option<Polarimeter<'a>>,
    pub kernel: Kernel,
    /// How paths are followed from the surface samples.
    pub ways: Vec<FacetWay>,
    pub run_state: Mutex<RunState>,
    pub clocks: Mutex<Clocks>,
    rays: AtomicU64,
    skipped: AtomicU64,
}

impl<'a> Context<'a> {
    pub fn new(
        campaign: &'a Campaign,
        plan: &'a Plan,
        session: &'a Session<'a>,
        run_state: RunState,
    ) -> Self {
        Context {
            campaign,
            plan,
            session,
            sensor: Sensor::new(&plan.grid),
            polarimeter: campaign.optics.has_mueller().then(|| Polarimeter::new(plan)),
            kernel: Kernel::widest(),
            ways: ways_of(&campaign.optics),
            clocks: Mutex::new(Clocks::new(run_state.cost.clone())),
            rays: AtomicU64::new(run_state.cost.rays_traced),
            skipped: AtomicU64::new(run_state.cost.rays_skipped),
            run_state: Mutex::new(run_state),
        }
    }

    /// Keeps the digest of a patch; where there is one already, it must be the same.
    pub fn note_digest(&self, realisation: u64, digest: Option<[u8; 32]>) -> Result<()> {
        let mut run_state = locked(&self.run_state);
        let kept = &mut run_state.digests[realisation as usize];
        if kept.is_some() && *kept != digest {
            let [here, there] = [digest, *kept].map(|digest| files::hex(&digest.unwrap_or_default()));
            return Err(Error::Refused(format!(
                "patch {realisation} has the digest {here}, blocks of {there} are kept: made on another processor, or by \
                 other --patches; --force starts again"
            )));
        }
        *kept = digest;
        Ok(())
    }

    /// Adds to the rays of the cost report.
    pub fn add_rays(&self, traced: u64, skipped: u64) {
        self.rays.fetch_add(traced, Ordering::Relaxed);
        self.skipped.fetch_add(skipped, Ordering::Relaxed);
    }

    /// What the run has cost up to now.
    pub fn cost(&self) -> Cost {
        Cost {
            rays_traced: self.rays.load(Ordering::Relaxed),
            rays_skipped: self.skipped.load(Ordering::Relaxed),
            ..locked(&self.clocks).cost()
        }
    }
}
