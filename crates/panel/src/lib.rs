//! The panel in a browser: a local server, a source of windows, and the page.
//!
//! The source runs on its own thread, paced by the clock on the wall; it hands every window to a broadcast channel and
//! never waits for a reader. The server is one thread: it turns the channel into server-sent events, and requests into
//! commands for the source's thread.

pub mod fleet;
pub mod source;
pub mod workbench;

mod http;
mod running;

pub use http::guard::{Guard, Token};
pub use http::server::{Options, PanelError, Running, bind};
pub use http::tls::{TlsError, TlsFiles};
pub use running::bench::MotorError;
pub use running::message::{LampsMessage, Operation, Plate, Vectors, WindowMessage};
pub use running::session::{Session, start};
