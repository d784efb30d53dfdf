//! From reports to registers.

use core::f32::consts::{SQRT_2, TAU};

use micromath::F32Ext;
use monitor::{CHANNELS, Lamp, Reason, Report, Suspicion, Window, likely, magnitude};

use super::map::{Field, Image, MAP_VERSION};
use crate::calibration::CalibrationSource;
use crate::display::Shown;
use crate::doubt::Doubts;
use crate::fault_record::FaultRecord;
use crate::frame::{packed, why_not_judged};
use crate::learn::LearnState;

/// Rad/s of one turn per minute.
const RAD_S_PER_RPM: f32 = TAU / 60.0;
const RESIDUALS: [Field; 4] = [
    Field::Residual1,
    Field::Residual2,
    Field::Residual3,
    Field::Residual4,
];
const THRESHOLDS: [Field; 4] = [
    Field::Threshold1,
    Field::Threshold2,
    Field::Threshold3,
    Field::Threshold4,
];
const CHANNEL_FIELDS: [Field; CHANNELS] = [
    Field::VoltageA,
    Field::VoltageB,
    Field::VoltageC,
    Field::CurrentA,
    Field::CurrentB,
    Field::CurrentC,
];

/// What the board knows about itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoardStatus {
    /// [`crate::MotorImage::identification`].
    pub motor: u32,
    /// Number of the reset cause, as in the map.
    pub reset_cause: u16,
    /// Supply of the converters, mV.
    pub vdda_millivolt: u16,
    /// Temperature of the chip, degrees Celsius.
    pub temperature_degc: f32,
    /// Which values are computed with.
    pub calibration: CalibrationSource,
    /// How learning stands.
    pub learning: LearnState,
    /// Windows judged while learning.
    pub learned_windows: u16,
    /// Number of the capture's state, as in the map.
    pub capture: u16,
    /// Thresholds that hold.
    pub thresholds: [f32; 4],
    /// What the board doubts about itself.
    pub doubts: Doubts,
    /// Whether the relay is energised.
    pub relay: bool,
    /// Since the start, s.
    pub uptime_s: u32,
    /// Deepest stack since the start, bytes.
    pub stack_bytes: u16,
    /// Crashes without a quiet minute between them.
    pub crashes: u16,
    /// What ended the program before this start.
    pub crash: Option<FaultRecord>,
    /// Double words of stored data that failed their error correction since the start.
    pub stored_data_errors: u16,
    /// Length and checksum of the program, where it was sealed.
    pub program: Option<(u32, u32)>,
}

/// The registers, and what has to be counted for them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    windows: u32,
    judged: u32,
}

impl Status {
    /// Counts a report and puts it with the board's state and with what the door shows into registers.
    #[inline(never)]
    pub fn take(&mut self, report: &Report, shown: &Shown, board: &BoardStatus) -> Image {
        self.windows = self.windows.wrapping_add(1);
        self.judged = self.judged.wrapping_add(u32::from(report.is_judged()));
        let mut image = Image::default();
        image.set_long(Field::Windows, self.windows);
        image.set_long(Field::WindowsJudged, self.judged);
        put_board(&mut image, board);
        put_report(&mut image, report);
        put_cause(&mut image, report, shown);
        image.set_word(Field::NotJudged, u16::from(why_not_judged(report, shown)));
        put_window(&mut image, report.window.as_ref());
        self.put_shown(&mut image, shown);
        image
    }

    /// Puts what the door shows now, and how the board is, into registers that were filled before: what changed between two
    /// reports.
    #[inline(never)]
    pub fn refresh(&self, image: &mut Image, shown: &Shown, board: &BoardStatus) {
        put_board(image, board);
        if shown.instrument_faulty {
            image.set_word(Field::NotJudged, u16::from(Reason::Instrument.number()));
            image.set_word(Field::LikelyFault, 0);
            image.set_word(Field::FaultProbability, 0);
        }
        self.put_shown(image, shown);
    }

    fn put_shown(&self, image: &mut Image, shown: &Shown) {
        image.set_long(Field::Lamps, packed(&shown.lamps));
        image.set_word(Field::Verdict, self.verdict(shown));
    }

    /// The lamps in one word: nobody reads "healthy" where FAULT or SENSOR is lit.
    fn verdict(&self, shown: &Shown) -> u16 {
        match (shown.lamps.fault, shown.lamps.sensor) {
            (Lamp::On, _) => 2,
            (_, Lamp::On) => 0,
            _ if self.judged > 0 => 1,
            _ => 0,
        }
    }
}

fn put_board(image: &mut Image, board: &BoardStatus) {
    image.set_word(Field::MapVersion, MAP_VERSION);
    image.set_long(Field::MotorIdentification, board.motor);
    image.set_word(Field::ResetCause, board.reset_cause);
    image.set_word(Field::ConverterSupply, board.vdda_millivolt);
    image.set_float(Field::Temperature, board.temperature_degc);
    image.set_word(Field::Calibration, board.calibration as u16);
    image.set_word(Field::Learning, board.learning.code());
    image.set_word(Field::LearnedWindows, board.learned_windows);
    image.set_word(Field::Capture, board.capture);
    for (field, threshold) in THRESHOLDS.into_iter().zip(board.thresholds) {
        image.set_float(field, threshold);
    }
    put_health(image, board);
    put_crash(image, board.crash.as_ref());
    let (length, checksum) = board.program.unwrap_or_default();
    image.set_long(Field::ProgramLength, length);
    image.set_long(Field::ProgramChecksum, checksum);
}

fn put_health(image: &mut Image, board: &BoardStatus) {
    image.set_long(Field::Doubts, board.doubts.bits());
    image.set_word(Field::Relay, u16::from(board.relay));
    image.set_long(Field::Uptime, board.uptime_s);
    image.set_word(Field::Stack, board.stack_bytes);
    image.set_word(Field::Crashes, board.crashes);
    image.set_word(Field::StoredDataErrors, board.stored_data_errors);
}

fn put_crash(image: &mut Image, crash: Option<&FaultRecord>) {
    let Some(crash) = crash else {
        return;
    };
    image.set_word(Field::CrashCause, crash.cause as u16);
    for (field, value) in [
        (Field::CrashProgramCounter, crash.pc),
        (Field::CrashLink, crash.lr),
        (Field::CrashStatus, crash.xpsr),
        (Field::CrashFaults, crash.cfsr),
        (Field::CrashHardFault, crash.hfsr),
        (Field::CrashAddress, crash.address),
        (Field::CrashStack, crash.sp),
        (Field::CrashUptime, crash.uptime_ms),
    ] {
        image.set_long(field, value);
    }
    image.set_word(Field::CrashLine, crash.line as u16);
    image.set_word(Field::CrashLength, crash.length as u16);
}

fn put_report(image: &mut Image, report: &Report) {
    let residuals = report
        .residuals
        .map_or([f32::NAN; 4], |residuals| residuals.r);
    for (field, residual) in RESIDUALS.into_iter().zip(residuals) {
        image.set_float(field, residual);
    }
}

fn put_cause(image: &mut Image, report: &Report, shown: &Shown) {
    let (fault, probability) = match shown.instrument_faulty {
        true => (0, 0.0),
        false => likeliest(report),
    };
    image.set_word(Field::LikelyFault, fault);
    image.set_word(Field::FaultProbability, (1000.0 * probability) as u16);
}

/// Number of the likeliest cause while FAULT is lit, the first of equals; 0 when it is none that has a number.
fn likeliest(report: &Report) -> (u16, f32) {
    let mut best = (0, 0.0);
    if report.lamps.fault == Lamp::On {
        likely(report, &[], &mut |Suspicion {
                                      suspect,
                                      probability,
                                      ..
                                  }| {
            if probability > best.1 {
                best = (suspect.fault().number(), probability);
            }
        });
    }
    best
}

/// Angle of the current behind the voltage in degrees, NaN where one of them is missing. It is for people: an
/// approximate arctangent suffices.
fn current_lag(window: &Window) -> f32 {
    let power = window.u_s.positive * window.i_s.positive.conj();
    if power.re == 0.0 && power.im == 0.0 {
        return f32::NAN;
    }
    F32Ext::atan2(power.im, power.re).to_degrees()
}

fn put_window(image: &mut Image, window: Option<&Window>) {
    let speed = window.and_then(Window::shaft_speed);
    let value = |of: fn(&Window) -> f32| window.map_or(f32::NAN, of);
    image.set_float(Field::Speed, speed.map_or(f32::NAN, |x| x / RAD_S_PER_RPM));
    image.set_float(
        Field::SupplyFrequency,
        value(|window| window.omega_sync / TAU),
    );
    image.set_float(
        Field::Voltage,
        value(|window| magnitude(window.u_s.positive) / SQRT_2),
    );
    image.set_float(
        Field::Current,
        value(|window| magnitude(window.i_s.positive) / SQRT_2),
    );
    image.set_float(Field::CurrentLag, window.map_or(f32::NAN, current_lag));
    for (k, field) in CHANNEL_FIELDS.into_iter().enumerate() {
        let channel = window.and_then(|window| window.channels.get(k));
        let rms = channel.map_or(f32::NAN, |channel| magnitude(channel.phasor) / SQRT_2);
        image.set_float(field, rms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use monitor::{Candidates, Residuals};

    /// The registers of a door that shows what the monitor says.
    fn registers(report: &Report) -> Image {
        let shown = Shown {
            lamps: report.lamps,
            ..Shown::default()
        };
        Status::default().take(report, &shown, &BoardStatus::default())
    }

    fn float(image: &Image, field: Field) -> f32 {
        let words = image
            .range(super::super::address(field), 2)
            .expect("in the map");
        f32::from_bits(u32::from(words[0]) << 16 | u32::from(words[1]))
    }

    fn word(image: &Image, field: Field) -> u16 {
        image
            .range(super::super::address(field), 1)
            .expect("in the map")[0]
    }

    fn report() -> Report {
        let mut window = Window {
            omega_sync: 60.0 * TAU,
            omega_mech: Some(1_500.0 * RAD_S_PER_RPM),
            ..Window::default()
        };
        window.channels[4].phasor.im = 3.0 * SQRT_2;
        Report {
            window: Some(window),
            residuals: Some(Residuals {
                r: [0.1, -0.2, 0.3, -0.4],
                e_d: 0.0,
                e_q: 0.0,
            }),
            ..Report::default()
        }
    }

    #[test]
    fn measurements_arrive_in_the_units_of_the_map() {
        let image = registers(&report());
        assert_eq!(float(&image, Field::Residual2), -0.2);
        for (field, expected) in [
            (Field::Speed, 1_500.0),
            (Field::SupplyFrequency, 60.0),
            (Field::CurrentB, 3.0),
        ] {
            // Two roundings of single precision.
            assert!(
                (float(&image, field) - expected).abs() < 2e-7 * expected,
                "{field:?}"
            );
        }
        assert_eq!(word(&image, Field::Verdict), 1);
    }

    /// All angles of a circle: what the map promises of it, against the mathematical library.
    #[test]
    fn the_current_lags_by_its_angle_within_a_fifth_of_a_degree() {
        let mut worst: f32 = 0.0;
        for tenth in -1_799..=1_799_i16 {
            let expected = f32::from(tenth) / 10.0;
            let mut window = Window::default();
            window.u_s.positive.re = 325.0;
            let angle = -expected.to_radians();
            window.i_s.positive.re = 4.0 * libm::cosf(angle);
            window.i_s.positive.im = 4.0 * libm::sinf(angle);
            worst = worst.max((current_lag(&window) - expected).abs());
        }
        assert!(worst < 0.2, "{worst}");
        assert!(current_lag(&Window::default()).is_nan());
    }

    #[test]
    fn without_a_window_there_are_no_measurements() {
        let nothing = Report {
            not_judged: Some(monitor::NotJudged::NotLocked),
            ..Report::default()
        };
        let image = registers(&nothing);
        for field in RESIDUALS
            .into_iter()
            .chain(CHANNEL_FIELDS)
            .chain([Field::Speed])
        {
            assert!(float(&image, field).is_nan(), "{field:?}");
        }
        assert_eq!(
            (word(&image, Field::Verdict), word(&image, Field::NotJudged)),
            (0, 1)
        );
    }

    #[test]
    fn a_lit_fault_names_its_likeliest_row() {
        let mut faulty = report();
        faulty.lamps.fault = Lamp::On;
        // Speed sensor: r1, r2, r4 and not r3.
        faulty.candidates = Some(Candidates::from_normalised(&[9.0, 9.0, 0.0, 9.0]));
        let image = registers(&faulty);
        assert_eq!(
            (
                word(&image, Field::Verdict),
                word(&image, Field::LikelyFault)
            ),
            (2, 9)
        );
        assert!((500..=1000).contains(&word(&image, Field::FaultProbability)));
        // The likeliest is no row at all: it has no number, as before.
        faulty.candidates = Some(Candidates::from_normalised(&[0.0, 9.0, 0.0, 0.0]));
        let image = registers(&faulty);
        assert_eq!(word(&image, Field::LikelyFault), 0);
    }

    #[test]
    fn a_dead_sensor_and_broken_bars_are_named_too() {
        let mut faulty = report();
        faulty.lamps.fault = Lamp::On;
        faulty.sensor = Some(monitor::SensorFinding::DeadCurrent(monitor::Phase::A));
        let named = |report: &Report| {
            let image = registers(report);
            (
                word(&image, Field::LikelyFault),
                word(&image, Field::FaultProbability),
            )
        };
        assert_eq!(named(&faulty), (7, 1000));
        faulty.sensor = None;
        faulty.rotor.is_broken = true;
        assert_eq!(named(&faulty), (13, 1000));
    }

    #[test]
    fn a_doubt_about_the_instrument_reaches_the_master_between_two_reports() {
        let mut faulty = report();
        faulty.lamps.fault = Lamp::On;
        faulty.candidates = Some(Candidates::from_normalised(&[9.0, 9.0, 0.0, 9.0]));
        let mut status = Status::default();
        let shown = Shown {
            lamps: faulty.lamps,
            ..Shown::default()
        };
        let mut image = status.take(&faulty, &shown, &BoardStatus::default());
        let mut doubt = shown;
        (doubt.lamps.sensor, doubt.instrument_faulty) = (Lamp::On, true);
        status.refresh(&mut image, &doubt, &BoardStatus::default());
        assert_eq!(image, status_with(&faulty, &doubt));
        assert_eq!(word(&image, Field::NotJudged), 14);
        assert_eq!(word(&image, Field::LikelyFault), 0);
    }

    fn status_with(report: &Report, shown: &Shown) -> Image {
        Status::default().take(report, shown, &BoardStatus::default())
    }

    #[test]
    fn nobody_reads_healthy_beside_a_lit_sensor_lamp() {
        let mut shown = Shown::default();
        shown.lamps.sensor = Lamp::On;
        assert_eq!(word(&status_with(&report(), &shown), Field::Verdict), 0);
    }
}
