#![no_std]
//! The monitor core.
