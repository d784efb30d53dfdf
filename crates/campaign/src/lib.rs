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

pub mod hours;
mod planned;
mod results;
mod runs;
pub mod slurm;

pub use planned::axis::{AXES, Axis, Conditions, Grid};
pub use planned::fault::{FAULTS, FaultKind};
pub use planned::plan::{Block, Case, LoadKnowledge, MotorPair, Place, Plan, Target};
pub use results::detection::{DETECTED, Detection, Direction, Size};
pub use results::groups::Named;
pub use results::markdown::page as markdown;
pub use results::statistics::{RISK, Share, poisson_at_most};
pub use results::table::{Alarm, Healthy, Table, conditions};
pub use runs::file::{About, Results, StoreError};
pub use runs::outcome::{Answer, LampsSeen, Outcome};
pub use runs::parts::{Done, finished, run as run_range, share};
pub use runs::row::Row;
pub use runs::run::{Run, T_SAMPLE_S};
