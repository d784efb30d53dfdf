//! Simulated boards on a serial line.

use std::io::{ErrorKind, Read, Result, Write};
use std::time::Instant;

use board::modbus::Collector;

use super::plant::Share;

/// Answers the questions of a line until it breaks. A read that times out is the silence behind a frame: the port's own time
/// limit says how long that is.
///
/// # Errors
/// The port is gone.
pub fn answer_line(share: &Share, port: &mut (impl Read + Write + ?Sized)) -> Result<()> {
    let begin = Instant::now();
    let mut collector = Collector::default();
    let mut bytes = [0; 256];
    loop {
        match port.read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(length) => collector.push(&bytes[..length]),
            Err(error) if error.kind() == ErrorKind::TimedOut => {
                let now_ms = begin.elapsed().as_millis() as u32;
                let answer = share.respond(now_ms, collector.frame());
                collector.clear();
                port.write_all(&answer)?;
            }
            Err(error) => return Err(error),
        }
    }
}
