//! What the page is told about each window: one schema for every source.

use monitor::{Frame, Lamp, Lamps, MotionWord, Reason, Report, Window};
use motor::steady_state::rotor_flux;
use num_complex::Complex32;
use serde::{Serialize, Serializer};

use replay::causes::{self, Candidate};
use replay::words;

/// One window.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WindowMessage {
    /// Counts windows since the source was opened; a gap shows what a slow reader lost.
    pub sequence: u64,
    /// End of the window on the source's clock, s.
    pub t_s: f64,
    /// The nine lamps.
    pub lamps: LampsMessage,
    /// Why the window counts for nothing; `None` when it was judged, at rest or in motion.
    pub not_judged: Option<String>,
    /// How it stands in motion; `None` at rest, or where nothing is judged in motion.
    pub motion: Option<&'static str>,
    /// Findings about sensors and supply, in words.
    pub findings: Vec<String>,
    /// r1..r4, percent of their scales; `None` where they could not be evaluated.
    pub r_percent: Option<[f32; 4]>,
    /// r1..r4 over their thresholds: beyond 1 is on; `None` for one that is not compared.
    pub r_over_threshold: Option<[Option<f32>; 4]>,
    /// Distance from the healthy motor, standard deviations; only of a calibrated motor.
    pub significance_sigma: Option<f32>,
    /// Rise of the winding resistances since the calibration, percent; only of a calibrated motor.
    pub resistance_rise_percent: Option<f32>,
    /// What may be wrong, the likeliest first; empty while FAULT is dark, or lit from windows before.
    pub causes: Vec<LikelyCause>,
    /// What to do about the likeliest and what is tied with it.
    pub todo: Vec<&'static str>,
    /// What the motor does.
    pub operation: Operation,
    /// Voltage, current and flux in the monitor's d-q frame; `None` without voltages, currents and speed.
    pub vectors: Option<Vectors>,
}

/// One possible cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LikelyCause {
    /// Row of Table 1, a cause of a calibrated motor, `bars`, or `unknown`.
    pub name: &'static str,
    /// The same in plain words.
    pub words: &'static str,
    /// `a`, `b` or `c`, where the phase is known.
    pub phase: Option<&'static str>,
    /// Probability, percent.
    pub probability_percent: f64,
    /// Change of the quantity that explains the window best, percent; only of a calibrated motor.
    pub size_percent: Option<f64>,
    /// Cannot be told apart from the likeliest, or is the likeliest with which another is tied.
    pub tied: bool,
}

/// The likeliest causes with their ties, and what to do about the first.
pub(crate) fn likely(
    candidates: Vec<Candidate>,
    calibrated: bool,
) -> (Vec<LikelyCause>, Vec<&'static str>) {
    let tied = causes::tied(&candidates);
    let faults: Vec<_> = candidates[..tied].iter().map(|one| one.fault).collect();
    let todo = causes::todo(&faults, calibrated);
    let told = causes::listed(candidates)
        .into_iter()
        .enumerate()
        .map(|(k, candidate)| LikelyCause {
            name: candidate.fault.name(),
            words: candidate.fault.words(),
            phase: candidate.phase,
            probability_percent: 100.0 * candidate.probability,
            size_percent: candidate.size_percent,
            tied: tied > 1 && k < tied,
        });
    (told.collect(), todo)
}

/// Each lamp: `off`, `on` or `blink`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LampsMessage {
    /// RUN.
    #[serde(serialize_with = "by_name")]
    pub run: Lamp,
    /// r1.
    #[serde(serialize_with = "by_name")]
    pub r1: Lamp,
    /// r2.
    #[serde(serialize_with = "by_name")]
    pub r2: Lamp,
    /// r3.
    #[serde(serialize_with = "by_name")]
    pub r3: Lamp,
    /// r4.
    #[serde(serialize_with = "by_name")]
    pub r4: Lamp,
    /// SENSOR.
    #[serde(serialize_with = "by_name")]
    pub sensor: Lamp,
    /// LINE.
    #[serde(serialize_with = "by_name")]
    pub line: Lamp,
    /// LOAD.
    #[serde(serialize_with = "by_name")]
    pub load: Lamp,
    /// FAULT.
    #[serde(serialize_with = "by_name")]
    pub fault: Lamp,
}

/// The operating point of one window; what was not measured is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Operation {
    /// Positive sequence of the phase voltages, V rms.
    pub voltage_rms_volt: Option<f32>,
    /// Positive sequence of the phase currents, A rms.
    pub current_rms_amp: Option<f32>,
    /// Supply frequency, Hz.
    pub frequency_hz: Option<f32>,
    /// Shaft speed, rad/s, negative backwards.
    pub speed_rad_s: Option<f32>,
    /// Slip, percent of the synchronous speed.
    pub slip_percent: Option<f32>,
    /// Air-gap torque as the model computes it from voltages and currents, N m.
    pub torque_nm: Option<f32>,
    /// The same, percent of rated.
    pub load_percent: Option<f32>,
    /// Negative over positive sequence of the currents, percent.
    pub current_unbalance_percent: Option<f32>,
    /// Negative over positive sequence of the voltages, percent.
    pub voltage_unbalance_percent: Option<f32>,
}

/// Amplitudes in the monitor's frame, `[d, q]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Vectors {
    /// `rotor-flux` or `voltage`: what the d axis lies on, or is behind of.
    pub frame: &'static str,
    /// Stator voltage, V.
    pub u_dq_volt: [f32; 2],
    /// Stator current, A.
    pub i_dq_amp: [f32; 2],
    /// Rotor flux, V s.
    pub psi_r_dq_volt_second: [f32; 2],
}

/// What is needed beside a report to tell about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Rated torque, N m.
    pub rated_torque: f32,
    /// Pole pairs.
    pub pole_pairs: f32,
    /// Frame of the residuals.
    pub frame: Frame,
    /// The load is friction: motor's and load's cannot be told apart.
    pub load_friction: bool,
    /// Whether the motor is known at all.
    pub known: bool,
    /// What the audit of a recording found.
    pub audit: Vec<audit::Finding>,
}

impl WindowMessage {
    /// Tells about a report whose window ended at `t_s`.
    pub fn new(sequence: u64, t_s: f64, report: &Report, plate: &Plate) -> WindowMessage {
        let isolation = report.isolation.as_ref();
        let wrong = causes::wrong_channels(&plate.audit, [t_s, t_s]);
        let candidates = causes::of_report(report, &wrong, plate.load_friction);
        let (causes, todo) = likely(candidates, isolation.is_some());
        WindowMessage {
            sequence,
            t_s,
            lamps: LampsMessage::of(&report.shown_lamps()),
            not_judged: not_judged(report),
            motion: in_motion(report.motion_word()),
            findings: findings(report),
            r_percent: report
                .residuals
                .map(|residuals| residuals.r.map(|r| 100.0 * r)),
            r_over_threshold: report
                .normalised
                .map(|r| r.map(|r| r.is_finite().then_some(r))),
            significance_sigma: isolation.map(|isolation| isolation.significance),
            resistance_rise_percent: isolation.map(|isolation| 100.0 * isolation.heating.rise),
            causes,
            todo,
            operation: Operation::new(report, plate),
            vectors: report
                .point
                .filter(|_| plate.known)
                .map(|point| Vectors::new(&point, plate.frame)),
        }
    }
}

fn not_judged(report: &Report) -> Option<String> {
    match report.reason()? {
        Reason::DoesNotFit => Some(words::SOMETHING_IN_MOTION.to_owned()),
        _ => report.not_judged.map(words::not_judged),
    }
}

/// In a few words.
pub(crate) fn in_motion(word: MotionWord) -> Option<&'static str> {
    (word != MotionWord::AtRest).then(|| word.label())
}

fn findings(report: &Report) -> Vec<String> {
    let sensor = report.sensor.map(words::sensor);
    let supply = report
        .supply
        .map(|finding| words::supply(finding).to_owned());
    sensor.into_iter().chain(supply).collect()
}

fn by_name<S: Serializer>(lamp: &Lamp, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(lamp.name())
}

impl LampsMessage {
    /// The names of the lamps' states.
    pub fn of(lamps: &Lamps) -> LampsMessage {
        let [r1, r2, r3, r4] = lamps.r;
        LampsMessage::from_order([
            lamps.run,
            r1,
            r2,
            r3,
            r4,
            lamps.sensor,
            lamps.line,
            lamps.load,
            lamps.fault,
        ])
    }

    /// From lamps in the order of [`board::LAMP_NAMES`].
    pub fn from_order(lamps: [Lamp; board::LAMPS]) -> LampsMessage {
        let [run, r1, r2, r3, r4, sensor, line, load, fault] = lamps;
        LampsMessage {
            run,
            r1,
            r2,
            r3,
            r4,
            sensor,
            line,
            load,
            fault,
        }
    }

    /// Lamps that are on, RUN apart.
    pub fn lit(&self) -> Vec<&'static str> {
        let all = [
            ("r1", self.r1),
            ("r2", self.r2),
            ("r3", self.r3),
            ("r4", self.r4),
            ("sensor", self.sensor),
            ("line", self.line),
            ("load", self.load),
            ("fault", self.fault),
        ];
        let lit = all.into_iter().filter(|(_, state)| *state == Lamp::On);
        lit.map(|(name, _)| name).collect()
    }
}

impl Default for LampsMessage {
    fn default() -> LampsMessage {
        LampsMessage::of(&Lamps::default())
    }
}

/// Amplitude of a sinusoid to its effective value.
pub(crate) fn rms(amplitude: f32) -> Option<f32> {
    (amplitude > 0.0).then_some(amplitude * std::f32::consts::FRAC_1_SQRT_2)
}

impl Operation {
    fn new(report: &Report, plate: &Plate) -> Operation {
        let Some(window) = &report.window else {
            return Operation::default();
        };
        let torque = report
            .point
            .filter(|_| plate.known)
            .map(|point| torque(&point, plate.pole_pairs));
        Operation {
            torque_nm: torque,
            load_percent: torque.map(|torque| 100.0 * torque / plate.rated_torque),
            ..Operation::measured(window, plate)
        }
    }

    fn measured(window: &Window, plate: &Plate) -> Operation {
        let voltage = rms(monitor::magnitude(window.u_s.positive));
        let current = rms(monitor::magnitude(window.i_s.positive));
        let percent = |ratio: Complex32| 100.0 * ratio.norm();
        Operation {
            voltage_rms_volt: voltage,
            current_rms_amp: current,
            frequency_hz: Some(window.omega_sync / std::f32::consts::TAU),
            speed_rad_s: window.shaft_speed(),
            slip_percent: window
                .omega_mech
                .filter(|_| plate.known)
                .map(|omega| slip_percent(window.omega_sync, omega * plate.pole_pairs)),
            current_unbalance_percent: current.map(|_| percent(window.i_s.unbalance())),
            voltage_unbalance_percent: voltage.map(|_| percent(window.u_s.unbalance())),
            ..Operation::default()
        }
    }
}

/// Slip from electrical speeds, percent.
pub(crate) fn slip_percent(omega_sync: f32, omega_el: f32) -> f32 {
    100.0 * (omega_sync - omega_el) / omega_sync
}

fn flux(point: &monitor::OperatingPoint) -> Complex32 {
    let (u, i) = (point.u_s_dq, point.i_s_dq);
    let (u, i) = (Complex32::new(u.d, u.q), Complex32::new(i.d, i.q));
    rotor_flux(&point.params, u, i, point.omega_sync)
}

/// `3/2 n_p L_m/L_r psi_r x i_s`.
fn torque(point: &monitor::OperatingPoint, n_p: f32) -> f32 {
    let current = Complex32::new(point.i_s_dq.d, point.i_s_dq.q);
    let cross = (flux(point).conj() * current).im;
    1.5 * n_p * point.params.l_m / point.params.l_r() * cross
}

impl Vectors {
    fn new(point: &monitor::OperatingPoint, frame: Frame) -> Vectors {
        let psi = flux(point);
        Vectors {
            frame: match frame {
                Frame::RotorFlux => "rotor-flux",
                Frame::Voltage => "voltage",
            },
            u_dq_volt: [point.u_s_dq.d, point.u_s_dq.q],
            i_dq_amp: [point.i_s_dq.d, point.i_s_dq.q],
            psi_r_dq_volt_second: [psi.re, psi.im],
        }
    }
}
