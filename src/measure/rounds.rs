//! The tables under way: what every stop has so far, and which stops go on.

use super::plan::Plan;
use super::record::StopRecord;
use super::stopping::{Progress, StoppedBy, relative_error};
use crate::campaign::{Alpha, Campaign};

/// One table for each roughness.
pub(super) struct Tables {
    tables: Vec<Table>,
}

/// The table of one roughness.
pub(super) struct Table {
    pub alpha: Option<Alpha>,
    /// [realisation][stop], `None` before the first round.
    records: Vec<Vec<Option<StopRecord>>>,
    stops: Vec<Progress>,
}

/// A table that goes no further.
pub(super) struct Finished {
    pub alpha: Option<Alpha>,
    /// [realisation][stop].
    pub records: Vec<Vec<StopRecord>>,
    /// What ended each stop.
    pub stops: Vec<Progress>,
}

impl Tables {
    pub fn new(campaign: &Campaign, plan: &Plan) -> Self {
        let table = |alpha| Table {
            alpha,
            records: vec![vec![None; plan.stops]; plan.realisations as usize],
            stops: vec![Progress::default(); plan.stops],
        };
        Tables { tables: campaign.alphas().into_iter().map(table).collect() }
    }

    pub fn each_mut(&mut self) -> impl Iterator<Item = &mut Table> {
        self.tables.iter_mut()
    }

    /// After all realisations have `blocks` blocks: which stops have enough.
    pub fn judge(&mut self, campaign: &Campaign, plan: &Plan, blocks: u64) {
        let wanted = campaign.stop.relative_error;
        // Only here, whatever rounds the clock asks for.
        let looked_at = blocks.is_power_of_two() || blocks == plan.blocks;
        for table in &mut self.tables {
            for stop in table.open_stops() {
                match wanted {
                    Some(wanted) if looked_at => {
                        let error = table.relative_error(plan, stop);
                        table.stops[stop].judge(blocks, error, wanted, plan.realisations);
                    }
                    _ => {}
                }
                let progress = &mut table.stops[stop];
                progress.blocks = blocks;
                if blocks == plan.blocks && progress.by.is_none() {
                    progress.by = Some(StoppedBy::Samples);
                }
            }
        }
    }

    /// Ends what is open: the time is over.
    pub fn time_is_over(&mut self) {
        for stop in self.tables.iter_mut().flat_map(|table| &mut table.stops) {
            stop.by = stop.by.or(Some(StoppedBy::Seconds));
        }
    }

    pub fn all_ended(&self) -> bool {
        self.tables.iter().flat_map(|table| &table.stops).all(|stop| stop.by.is_some())
    }

    /// Starts so far, of all tables, stops and realisations.
    pub fn starts(&self, plan: &Plan) -> u64 {
        let blocks: u64 = self.tables.iter().flat_map(|table| &table.stops).map(|stop| stop.blocks).sum();
        blocks * plan.block_starts * u64::from(plan.realisations)
    }

    /// Every table. Flux is a share of what fell in all planned blocks: a stop that ended earlier is scaled to those
    /// that it had.
    pub fn finished(self, plan: &Plan) -> Vec<Finished> {
        let finished = |table: Table| {
            let scaled = |(record, stop): (Option<StopRecord>, &Progress)| {
                record.map(|record| record.scaled(plan.blocks as f64 / stop.blocks as f64))
            };
            let of_realisation = |records: Vec<_>| records.into_iter().zip(&table.stops).filter_map(scaled);
            let records = table.records.into_iter().map(|records| of_realisation(records).collect());
            Finished { alpha: table.alpha, records: records.collect(), stops: table.stops.clone() }
        };
        self.tables.into_iter().map(finished).collect()
    }
}

impl Table {
    /// The stops that go on.
    pub fn open_stops(&self) -> Vec<usize> {
        (0..self.stops.len()).filter(|&stop| self.stops[stop].by.is_none()).collect()
    }

    /// Adds what a round measured of some stops of a realisation. Rounds come in their order, so that sums of
    /// floats are the same for any number of threads.
    pub fn add(&mut self, realisation: usize, records: Vec<(usize, StopRecord)>) {
        for (stop, record) in records {
            let sum = &mut self.records[realisation][stop];
            *sum = Some(match sum.take() {
                Some(before) => before.plus(&record),
                None => record,
            });
        }
    }

    fn relative_error(&self, plan: &Plan, stop: usize) -> Option<f64> {
        let records: Vec<&StopRecord> = self.records.iter().filter_map(|r| r[stop].as_ref()).collect();
        let regions = plan.grid.regions(stop);
        let sizes: Vec<f64> = regions.iter().map(|region| region.projected_solid_angle()).collect();
        relative_error(&records, &sizes, &plan.weighing)
    }
}
