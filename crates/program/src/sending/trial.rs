//! The order to install a program, and what becomes of it.

use std::time::Duration;

use board::modbus::{Command, Field, UNLOCK_KEY};
use live::{ModbusLine, Registers, RegistersError};

use super::{ATTEMPT, MOST_SILENT, Pace, SendError, may_pass, of_registers, refusal};
use update::UpdateState;

use crate::package::Package;

/// Between two looks.
const LOOK: Duration = Duration::from_millis(500);
/// How long a board may check before it starts again.
const MOST_CHECKING: Duration = Duration::from_secs(30);
/// How long it may be silent: the loader checks the signature and exchanges up to 108 pages.
const MOST_EXCHANGING: Duration = Duration::from_secs(120);

/// What a board that was asked to install a program is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It checks what it received.
    Checking,
    /// It does not answer: the loader checks the signature and exchanges the programs.
    Exchanging,
    /// The new program runs, and confirms itself in so many seconds.
    OnTrial(u16),
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Stage::Checking => f.write_str("the board checks the program"),
            Stage::Exchanging => {
                f.write_str("the loader checks the signature and exchanges the programs")
            }
            Stage::OnTrial(left) => write!(f, "the new program is on trial: {left} s left"),
        }
    }
}

/// Asks the board to check the program that it has received, and to install it.
///
/// # Errors
/// A refusal, or the port is gone. No answer is no error: it may have been lost, and the board starts again.
pub fn install(line: &mut ModbusLine, pace: &mut dyn Pace) -> Result<(), SendError> {
    let begun = pace.now();
    loop {
        match line.write_holding(0, &[UNLOCK_KEY, Command::Install as u16]) {
            Err(error) if may_pass(&error) => {}
            done => return Ok(done?),
        }
        let waits = Registers::read(line)
            .is_ok_and(|registers| registers.word(Field::Update) == UpdateState::Receiving as u16);
        if !waits || pace.now() - begun > MOST_SILENT {
            return Ok(());
        }
        pace.pause(ATTEMPT);
    }
}

/// Waits until the new program has confirmed itself. `tell` hears what the board is doing.
///
/// # Errors
/// The board refuses, brings the old program back, or does not come back on the line.
pub fn wait(
    line: &mut ModbusLine,
    package: &Package,
    pace: &mut dyn Pace,
    tell: &mut dyn FnMut(Stage),
) -> Result<(), SendError> {
    let mut heard = pace.now();
    let begun = heard;
    loop {
        if pace.is_stopped() {
            return Err(SendError::StoppedWaiting);
        }
        match Registers::read(line) {
            Ok(registers) => {
                heard = pace.now();
                match judge(&registers, package)? {
                    None => return Ok(()),
                    Some(Stage::Checking) if heard - begun > MOST_CHECKING => {
                        return Err(SendError::NotInstalled(MOST_CHECKING.as_secs()));
                    }
                    Some(stage) => tell(stage),
                }
            }
            Err(error) => silence(error, pace.now() - heard, tell)?,
        }
        pace.pause(LOOK);
    }
}

/// `None` once the new program has confirmed itself.
fn judge(registers: &Registers, package: &Package) -> Result<Option<Stage>, SendError> {
    let state = registers.word(Field::Update);
    let is = |wanted: UpdateState| state == wanted as u16;
    let (runs, sent) = (of_registers(registers).checksum, package.seal().checksum);
    if is(UpdateState::Refused) {
        return Err(refusal(registers).unwrap_or(SendError::RefusedUnknown(0)));
    }
    if is(UpdateState::BroughtBack) {
        return Err(SendError::BroughtBack);
    }
    if !is(UpdateState::OnTrial) && !is(UpdateState::Confirmed) {
        return Ok(Some(Stage::Checking));
    }
    if runs != sent {
        return Err(SendError::Another { runs, sent });
    }
    let left = registers.word(Field::UpdateTrial);
    Ok(is(UpdateState::OnTrial).then_some(Stage::OnTrial(left)))
}

fn silence(
    error: RegistersError,
    since: Duration,
    tell: &mut dyn FnMut(Stage),
) -> Result<(), SendError> {
    let passes = matches!(&error, RegistersError::Line(error) if may_pass(error));
    if !passes || since > MOST_EXCHANGING {
        return Err(error.into());
    }
    tell(Stage::Exchanging);
    Ok(())
}
