//! The page of a plant: simulated boards, a gateway and the page, each a program of its own.

mod browser;
mod encrypted;
mod processes;
mod recording;
mod strangers;
