//! Helpers of all tests.

// Each of the two test programs uses its own part.
#![allow(dead_code)]

pub mod alone;
pub mod analytic;
pub mod any_campaign;
pub mod arrays;
pub mod campaign_text;
pub mod ended;
pub mod exact_rays;
pub mod failing;
pub mod long;
pub mod measuring;
pub mod mutations;
pub mod outputs;
pub mod processor_time;
pub mod program;
pub mod radiance;
