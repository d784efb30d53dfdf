//! What the instruments of the test bench may be off by.

use clap::Args;
use nameplate::measured::Instruments;

use crate::cli::printing::failure::Failure;

/// Limits of error; 0.2 % is what IEC 60034-2-1 asks for, 1 rpm what IEEE 112 (method B) does.
#[derive(Debug, Args)]
#[command(next_help_heading = "Instruments (limits of error)")]
pub struct InstrumentArgs {
    /// Class of voltmeter, ammeter, wattmeter, torque transducer and ohmmeter, percent (IEC 60034-2-1: 0.2)
    #[arg(long, value_name = "PERCENT", default_value_t = 0.2)]
    class: f64,
    /// Voltmeter with its transformers, percent of the reading
    #[arg(long, value_name = "PERCENT")]
    voltage_class: Option<f64>,
    /// Ammeter with its transformers, percent of the reading
    #[arg(long, value_name = "PERCENT")]
    current_class: Option<f64>,
    /// Wattmeter with its transformers, percent of the apparent power: gain and angle
    #[arg(long, value_name = "PERCENT")]
    power_class: Option<f64>,
    /// Torque transducer, percent of the reading
    #[arg(long, value_name = "PERCENT")]
    torque_class: Option<f64>,
    /// Ohmmeter, percent of the reading
    #[arg(long, value_name = "PERCENT")]
    resistance_class: Option<f64>,
    /// Speed, rpm (IEEE 112, method B: 1)
    #[arg(long, value_name = "RPM", default_value_t = 1.0)]
    speed_error_rpm: f64,
    /// Temperature of the winding, K
    #[arg(long, value_name = "K", default_value_t = 2.0)]
    temperature_error_kelvin: f64,
}

/// Limits that an instrument has.
const LIMITS: std::ops::RangeInclusive<f64> = 0.001..=20.0;

impl InstrumentArgs {
    /// The limits.
    ///
    /// # Errors
    /// A limit that no instrument has.
    pub fn read(&self) -> Result<Instruments, Failure> {
        let own = |class: Option<f64>| class.unwrap_or(self.class);
        let read = Instruments {
            voltage_percent: own(self.voltage_class),
            current_percent: own(self.current_class),
            power_percent: own(self.power_class),
            torque_percent: own(self.torque_class),
            resistance_percent: own(self.resistance_class),
            speed_rpm: self.speed_error_rpm,
            temperature_kelvin: self.temperature_error_kelvin,
        };
        let limits = [
            ("class", self.class),
            ("voltage-class", read.voltage_percent),
            ("current-class", read.current_percent),
            ("power-class", read.power_percent),
            ("torque-class", read.torque_percent),
            ("resistance-class", read.resistance_percent),
            ("speed-error-rpm", read.speed_rpm),
            ("temperature-error-kelvin", read.temperature_kelvin),
        ];
        match limits.iter().find(|(_, limit)| !LIMITS.contains(limit)) {
            Some((flag, limit)) => Err(Failure::Usage(format!(
                "--{flag} {limit}: an instrument's limit of error is within {} to {}",
                LIMITS.start(),
                LIMITS.end()
            ))),
            None => Ok(read),
        }
    }
}
