//! Modbus as it travels: frames of Modbus TCP, and questions with their answers.

pub(crate) mod mbap;
pub(crate) mod question;
