//! Run time against error: ladders of sample counts, and what their errors say of noise and bias.
//!
//! Every rung is measured several times with seeds of its own (replicates), so that no two errors share a draw or a
//! patch. The error of a run is the flux-weighted L1 distance of its order-1 table from the truth, averaged over
//! incidences and colours. err^2 = a/N + b^2 is then fitted: a is noise, b what no further sample removes.
//!
//! A random surface has two noises: rays and patches. One ladder adds samples to a fixed number of patches (its b
//! holds the patches' spread and the bias), the other adds patches of fixed samples (its b is the bias alone).
//! A campaign with a `[bench]` table varies cells and correlation length instead. `against` measures one table by two
//! ways, `scale` one incidence on patches of several sizes.

pub mod against;
pub mod answer;
pub mod fit;
pub mod ladder;
pub mod resolution;
pub mod run;
pub mod scale;
pub mod truth;

pub use against::{Against, Other, against};
pub use answer::{BenchAnswer, FittedLadder};
pub use fit::{LadderFit, Point, fit};
pub use ladder::{Ladders, Range, Varies, planned};
pub use resolution::{Convergence, Flatness, ResolutionRow, convergence, flatness, resolution};
pub use run::{Bench, Ladder, MeasuredRung, bench};
pub use scale::{Scale, ScalePatch, ScaleRow, scale};
pub use truth::{ERROR_MEASURE, Truth, TruthKind};
