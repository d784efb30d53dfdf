//! How far noise moves a window.

pub(crate) mod allowance;
pub(crate) mod margin;
pub(crate) mod scatter;
pub(crate) mod trend;
