//! Alarms as operators know them (ANSI/ISA-18.2, IEC 62682).

pub mod change;

pub use change::{
    Alarm, AlarmCause, AlarmChange, AlarmFilter, AlarmState, Change, Evidence, Phase, Severity, Who,
};
