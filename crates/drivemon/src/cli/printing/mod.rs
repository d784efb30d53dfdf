//! How results, failures and progress reach a person or a file.

pub(crate) mod answers;
pub(crate) mod failure;
pub(crate) mod findings;
pub(crate) mod lamp_symbol;
pub(crate) mod motion;
pub(crate) mod output;
pub(crate) mod paint;
pub(crate) mod progress;
pub(crate) mod shell;
pub(crate) mod terminal;
