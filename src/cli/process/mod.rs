//! How a command ends by a signal.

pub(crate) mod ending;
pub(crate) mod signals;
