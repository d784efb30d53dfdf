//! The panel in a browser: a local server, a source of windows, and the page.
//!
//! The source runs on its own thread, paced by the clock on the wall; it hands every window to a broadcast channel and
//! never waits for a reader. The server is one thread: it turns the channel into server-sent events, and requests into
//! commands for the source's thread.

mod api;
mod assets;
mod bench;
mod connections;
mod events;
mod export;
mod fields;
mod guard;
mod history;
mod message;
mod pace;
mod server;
mod session;
mod shared;
pub mod source;
mod stream;
mod wave;
pub mod workbench;
mod worker;

pub use guard::{Guard, Token};
pub use message::{LampsMessage, Operation, Plate, Vectors, WindowMessage};
pub use server::{Options, PanelError, Running, bind};
pub use session::{Session, start};
