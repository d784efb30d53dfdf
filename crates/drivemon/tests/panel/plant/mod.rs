//! The page of a plant: simulated boards, a gateway and the page, each a program of its own.

mod browser;
mod processes;
mod recording;
mod strangers;
