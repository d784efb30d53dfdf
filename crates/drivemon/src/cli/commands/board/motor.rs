//! A motor file as the board takes it.

use std::path::Path;

use board::MotorImage;
use monitor::{Monitor, MonitorConfig};
use motor::{effect, effects};

use crate::cli::arguments::input::read_motor;
use crate::cli::printing::failure::Failure;

/// s; the board's sampling time.
pub const T_SAMPLE: f64 = 1e-4;

/// Name and constants of the motor of a file.
///
/// # Errors
/// Everything that the board would refuse, before it is asked.
pub fn read(path: &Path) -> Result<(String, MotorImage), Failure> {
    let file = path.display().to_string();
    let motor = read_motor(path)?;
    let config = MonitorConfig::of_board(&motor)?;
    Monitor::new(config).map_err(|error| Failure::Config {
        file: file.clone(),
        error,
    })?;
    for effect in effect::from_motor_file(&motor, &file)? {
        // Laws are numbers, not terms of the program.
        let is_known = effect.effect.law().is_some()
            || effects::STEADY
                .iter()
                .any(|known| std::ptr::eq(known.descriptor(), effect.effect.descriptor()));
        if !is_known {
            let name = effect.effect.descriptor().name;
            let message = format!(
                "{file}: effects.{name}: a formula runs on a host only; remove it for the board"
            );
            return Err(Failure::Usage(message));
        }
    }
    Ok((motor.name, MotorImage::new(&config)))
}
