//! A serial line: its port is driven by a thread, for it knows no other way to wait.

use std::time::Duration;

use board::{Line, LineParity};
use live::{ModbusError, ModbusLine};
use tokio::task::spawn_blocking;

use super::error::BusError;
use crate::wire::question::Question;

/// A line.
pub(crate) struct RtuBus {
    port: String,
    settings: Line,
    within: Duration,
    line: Option<ModbusLine>,
}

impl RtuBus {
    /// Not opened yet.
    pub fn new(port: &str, baud: u32, parity: LineParity, within: Duration) -> Self {
        let settings = Line {
            unit: 1,
            baud,
            parity,
        };
        RtuBus {
            port: port.to_owned(),
            settings,
            within,
            line: None,
        }
    }

    /// Asks a board; a damaged or missing answer is asked for again.
    pub async fn ask(&mut self, unit: u8, question: &Question) -> Result<Vec<u8>, BusError> {
        let (line, port, settings) = (self.line.take(), self.port.clone(), self.settings);
        let (within, question) = (self.within, question.clone());
        let work = move || {
            let mut line = match line {
                Some(line) => line,
                None => ModbusLine::open(&port, settings)?,
            };
            line.set_unit(unit);
            line.set_patience(within);
            let answer = line.ask(question.function, &question.data);
            Ok((line, answer))
        };
        let outcome: Result<_, ModbusError> = spawn_blocking(work)
            .await
            .map_err(|error| BusError::Link(format!("{}: {error}", self.port)))?;
        let (line, answer) = outcome.map_err(|error| self.told(unit, error))?;
        // A port that broke is opened anew.
        if !matches!(answer, Err(ModbusError::Port(_))) {
            self.line = Some(line);
        }
        answer.map_err(|error| self.told(unit, error))
    }

    fn told(&self, unit: u8, error: ModbusError) -> BusError {
        match error {
            ModbusError::Port(error) => BusError::Link(error.to_string()),
            ModbusError::Silent { .. } => BusError::Silent {
                unit,
                within: self.within,
            },
            ModbusError::Damaged { .. } => BusError::Damaged(unit),
            ModbusError::Refused { function, code } => BusError::Refused {
                unit,
                function,
                code,
            },
        }
    }
}
