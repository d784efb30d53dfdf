//! Campaigns: what the lamps can be trusted with, measured over faults, sizes and conditions.
//!
//! A plan names motors, conditions and faults. Every run follows from its index alone: it is simulated, replayed
//! through the core in ADC codes as the board sees it, and becomes one row. Rows become the table of what is detected,
//! how small, how fast, and how often wrongly.
//!
//! ```
//! use campaign::{Plan, Run};
//!
//! let plan = Plan::read("../../campaigns/healthy.toml").expect("a plan");
//! let run = Run::new(&plan, 0).expect("the first of its runs");
//! let outcome = run.outcome().expect("it can be simulated");
//! assert!(outcome.windows > 0 && outcome.healthy_fault == 0);
//! ```

mod axis;
mod cause;
mod check;
mod detection;
mod fault;
mod file;
mod groups;
mod markdown;
mod outcome;
mod pair;
mod parts;
mod plan;
mod print;
mod read;
mod row;
mod run;
mod statistics;
mod table;
#[cfg(test)]
mod table_tests;

pub use axis::{AXES, Axis, Conditions, Grid};
pub use detection::{DETECTED, Detection, Size};
pub use fault::{FAULTS, FaultKind};
pub use file::{About, Results, StoreError};
pub use groups::Named;
pub use markdown::page as markdown;
pub use outcome::{Answer, LampsSeen, Outcome};
pub use parts::{Done, run as run_range};
pub use plan::{Block, Case, LoadKnowledge, MotorPair, Place, Plan, Target};
pub use row::Row;
pub use run::{Run, T_SAMPLE_S};
pub use statistics::{RISK, Share};
pub use table::{Alarm, Healthy, Table, conditions};
