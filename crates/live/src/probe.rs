//! Frames through a debug probe: in the board's log, RTT channel 0.

use std::time::Duration;

use probe_rs::rtt::{Error, Rtt};
use probe_rs::{Session, SessionConfig};

use super::{LogSplitter, Source, SourceError};

const CHIP: &str = "STM32G474RETx";
/// The channel of log and frames.
const CHANNEL: usize = 0;
/// Between two looks; the board's memory holds 0.3 s of frames.
const PAUSE: Duration = Duration::from_millis(50);

struct Probe {
    session: Session,
    rtt: Rtt,
    log: LogSplitter,
}

/// Attaches to the first probe's chip without stopping it.
pub(super) fn open() -> Result<Box<dyn Source>, SourceError> {
    let mut session = Session::auto_attach(CHIP, SessionConfig::default()).map_err(|error| {
        SourceError::Probe(format!(
            "no debug probe with a {CHIP}: {error}; plug the NUCLEO's USB in, and close other debuggers"
        ))
    })?;
    let rtt = attach(&mut session).map_err(|error| {
        SourceError::Probe(format!(
            "the board does not run this firmware: {error}; flash it with `drivemon flash`"
        ))
    })?;
    let log = LogSplitter::default();
    Ok(Box::new(Probe { session, rtt, log }))
}

fn attach(session: &mut Session) -> Result<Rtt, Error> {
    let mut core = session.core(0)?;
    Rtt::attach(&mut core)
}

impl Source for Probe {
    fn read(&mut self) -> Result<Vec<u8>, SourceError> {
        std::thread::sleep(PAUSE);
        let mut bytes = vec![0; 2048];
        let length = self.read_into(&mut bytes).map_err(|error| {
            SourceError::Probe(format!(
                "the debug probe lost the board: {error}; is it powered?"
            ))
        })?;
        bytes.truncate(length);
        Ok(self.log.take(&bytes).frames)
    }
}

impl Probe {
    fn read_into(&mut self, bytes: &mut [u8]) -> Result<usize, Error> {
        let mut core = self.session.core(0)?;
        match self.rtt.up_channel(CHANNEL) {
            Some(channel) => channel.read(&mut core, bytes),
            None => Ok(0),
        }
    }
}
