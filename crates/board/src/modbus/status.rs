//! From reports to registers.

use core::f32::consts::{SQRT_2, TAU};

use micromath::F32Ext;
use monitor::{CHANNELS, Lamp, Reason, Report, Suspicion, Window, likely, magnitude};
use update::UpdateState;

use super::entry::Field;
use super::map::{Image, MAP_VERSION};
use crate::calibration::CalibrationSource;
use crate::configuration::{ConfigurationSource, Refused};
use crate::door::display::Shown;
use crate::frames::frame::packed;
use crate::health::doubt::Doubts;
use crate::health::fault_record::FaultRecord;
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
    /// The chip's serial number, its highest 32 bits first.
    pub serial: [u32; 3],
    /// [`crate::Calibration::identification`] of the one that is used; 0 where there is none.
    pub calibration_identification: u32,
    /// Number of the newest event.
    pub last_event: u32,
    /// Which run of the program.
    pub start_number: u32,
    /// Number of the newest second of it.
    pub last_second: u32,
    /// Where the configuration comes from.
    pub configuration: ConfigurationSource,
    /// What of the last one was refused.
    pub refused: Option<Refused>,
    /// Until the end of a trial, s; 0 where there is none.
    pub trial_s: u16,
    /// The update of the program.
    pub update: UpdateStatus,
    /// Version of the program, as [`update::Version`] packs it.
    pub version: u32,
}

/// How the update of the program stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UpdateStatus {
    /// How far it is.
    pub state: UpdateState,
    /// Why the last one was not taken.
    pub refused: Option<update::Refusal>,
    /// Bytes that were received.
    pub bytes: u32,
    /// Until the new program confirms itself, s; 0 without a trial.
    pub trial_s: u16,
}

/// What the monitor says of its last window; nothing of it is told while the board doubts what it measures.
#[derive(Clone, Copy, Debug)]
struct Judgement {
    not_judged: u8,
    motion: u8,
    fault: u16,
    per_mille: u16,
    residuals: [f32; RESIDUALS.len()],
}

impl Judgement {
    /// Of nothing, because of `why`.
    fn missing(why: Reason) -> Self {
        Judgement {
            not_judged: why.number(),
            motion: 0,
            fault: 0,
            per_mille: 0,
            residuals: [f32::NAN; RESIDUALS.len()],
        }
    }

    fn of(report: &Report) -> Self {
        let (fault, probability) = likeliest(report);
        let residuals = report.residuals.map(|residuals| residuals.r);
        Judgement {
            not_judged: report.reason().map_or(0, Reason::number),
            motion: report.motion_word() as u8,
            fault,
            per_mille: (1000.0 * probability) as u16,
            residuals: residuals.unwrap_or([f32::NAN; RESIDUALS.len()]),
        }
    }
}

/// The registers, and what has to be remembered for them.
#[derive(Clone, Copy, Debug)]
pub struct Status {
    windows: u32,
    judged: u32,
    last: Judgement,
}

impl Default for Status {
    fn default() -> Self {
        Status {
            windows: 0,
            judged: 0,
            last: Judgement::missing(Reason::NotLocked),
        }
    }
}

impl Status {
    /// Counts a report and puts it with the board's state and with what the door shows into registers.
    #[inline(never)]
    pub fn take(&mut self, report: &Report, shown: &Shown, board: &BoardStatus) -> Image {
        self.windows = self.windows.wrapping_add(1);
        self.judged = self
            .judged
            .wrapping_add(u32::from(report.is_judged_either_way()));
        self.last = Judgement::of(report);
        self.fill(report.window.as_ref(), shown, board)
    }

    /// Registers before the first report.
    pub fn nothing_yet(&self, shown: &Shown, board: &BoardStatus) -> Image {
        self.fill(None, shown, board)
    }

    fn fill(&self, window: Option<&Window>, shown: &Shown, board: &BoardStatus) -> Image {
        let mut image = Image::default();
        image.set_long(Field::Windows, self.windows);
        image.set_long(Field::WindowsJudged, self.judged);
        put_window(&mut image, window);
        self.refresh(&mut image, shown, board);
        image
    }

    /// Puts what the door shows now, and how the board is, into registers that were filled before: what changed between two
    /// reports.
    #[inline(never)]
    pub fn refresh(&self, image: &mut Image, shown: &Shown, board: &BoardStatus) {
        put_board(image, board);
        put_judgement(
            image,
            &match shown.instrument_faulty {
                true => Judgement::missing(Reason::Instrument),
                false => self.last,
            },
        );
        image.set_long(Field::Lamps, packed(&shown.lamps));
        image.set_word(Field::Verdict, self.verdict(shown));
    }

    /// Number and probability, per mille, of the likeliest fault of the last window.
    pub fn likely(&self) -> (u16, u16) {
        (self.last.fault, self.last.per_mille)
    }

    /// Number of the reason why the last window was not judged, 0 where it was.
    pub fn not_judged(&self) -> u16 {
        u16::from(self.last.not_judged)
    }

    /// The lamps in one word: nobody reads "healthy" where FAULT or SENSOR is lit.
    fn verdict(&self, shown: &Shown) -> u16 {
        match (shown.lamps.fault, shown.lamps.sensor) {
            (Lamp::On, _) => 2,
            (_, Lamp::On) => 0,
            _ if self.last.not_judged == Reason::DoesNotFit.number() => 0,
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
    put_identity(image, board);
    put_update(image, &board.update);
    image.set_long(Field::ProgramVersion, board.version);
}

fn put_update(image: &mut Image, update: &UpdateStatus) {
    image.set_word(Field::Update, update.state as u16);
    let refused = update.refused.map_or(0, |refused| refused as u16);
    image.set_word(Field::UpdateRefused, refused);
    image.set_long(Field::UpdateBytes, update.bytes);
    image.set_word(Field::UpdateTrial, update.trial_s);
}

fn put_identity(image: &mut Image, board: &BoardStatus) {
    let [high, middle, low] = board.serial;
    image.set_long(Field::SerialHigh, high);
    image.set_long(Field::SerialMiddle, middle);
    image.set_long(Field::SerialLow, low);
    image.set_long(
        Field::CalibrationIdentification,
        board.calibration_identification,
    );
    image.set_long(Field::LastEvent, board.last_event);
    image.set_long(Field::StartNumber, board.start_number);
    image.set_long(Field::LastSecond, board.last_second);
    image.set_word(Field::Configuration, board.configuration as u16);
    let refused = board.refused.map_or(0, |refused| refused as u16);
    image.set_word(Field::ConfigurationRefused, refused);
    image.set_word(Field::TrialSeconds, board.trial_s);
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

fn put_judgement(image: &mut Image, judgement: &Judgement) {
    image.set_word(Field::NotJudged, u16::from(judgement.not_judged));
    image.set_word(Field::Motion, u16::from(judgement.motion));
    image.set_word(Field::LikelyFault, judgement.fault);
    image.set_word(Field::FaultProbability, judgement.per_mille);
    for (field, residual) in RESIDUALS.into_iter().zip(judgement.residuals) {
        image.set_float(field, residual);
    }
}

/// Number of the likeliest cause while FAULT is lit, the first of equals; 0 when it is none that has a number.
fn likeliest(report: &Report) -> (u16, f32) {
    let mut best = (0, 0.0);
    if report.shown_lamps().fault == Lamp::On {
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
mod tests;
