//! What simulated motors live through: starts, steps, ramps, presses and dips, on motors that are not quite what is believed.

use std::f64::consts::TAU;

use motor::MotorFile;
use motor::dynamic::Harmonic;
use motor::motor_file::EffectEntry;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use scenario::{
    Change, Fault, Interpolation, Load, LoadSpec, Piecewise, Probe, Profile, Scenario, SensorSpec,
    SpeedSensor, Start, SupplySpec, Target,
};

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// At full voltage.
    DirectStart,
    /// At a star's voltage, then at full voltage.
    StarDelta,
    /// From 10 to 70 % of the load.
    LoadStep,
    /// From 10 to 80 % of the load in a second.
    LoadRamp,
    /// Strokes of eight cycles of the supply.
    Press,
    /// To 60 % of the voltage for 0.2 s.
    Dip,
    /// The voltage falls by a tenth.
    SupplyRamp,
    /// A start at an inverter.
    FrequencyRamp,
    /// A weight, lifted and lowered.
    Hoist,
    /// No voltage for 0.3 s.
    Interruption,
    /// At full voltage against a load that holds the shaft.
    Stall,
}

/// All of them.
pub const DRIVES: [Drive; 11] = [
    Drive::DirectStart,
    Drive::StarDelta,
    Drive::LoadStep,
    Drive::LoadRamp,
    Drive::Press,
    Drive::Dip,
    Drive::SupplyRamp,
    Drive::FrequencyRamp,
    Drive::Hoist,
    Drive::Interruption,
    Drive::Stall,
];

impl Drive {
    /// As tables show it.
    pub fn name(self) -> &'static str {
        match self {
            Drive::DirectStart => "direct start",
            Drive::StarDelta => "star-delta start",
            Drive::LoadStep => "load step",
            Drive::LoadRamp => "load ramp",
            Drive::Press => "press, 8 cycles a stroke",
            Drive::Dip => "dip to 60 %, 0.2 s",
            Drive::SupplyRamp => "supply -10 % in 3 s",
            Drive::FrequencyRamp => "V/Hz ramp, 8 Hz to rated in 2 s",
            Drive::Hoist => "hoist, lifting and lowering",
            Drive::Interruption => "interruption of 0.3 s",
            Drive::Stall => "start with the shaft held",
        }
    }

    /// Length, s.
    fn duration(self) -> f64 {
        match self {
            Drive::DirectStart | Drive::Stall => 1.2,
            Drive::StarDelta => 1.5,
            Drive::LoadStep | Drive::Dip => 1.2,
            Drive::LoadRamp | Drive::Interruption => 1.8,
            Drive::Press => 3.0,
            Drive::SupplyRamp => 3.6,
            Drive::FrequencyRamp => 2.6,
            Drive::Hoist => 3.0,
        }
    }

    fn starts(self) -> bool {
        matches!(
            self,
            Drive::DirectStart | Drive::StarDelta | Drive::FrequencyRamp | Drive::Stall
        )
    }
}

/// How far motor and instruments are from what the monitor believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubts {
    /// Factor on the standard deviations of parameters and gains.
    pub wrong: f64,
    /// Whether iron beyond the motor file, leakage and cage bend at high current and slip.
    pub bends: bool,
    /// Saturation that the motor file does not declare.
    pub undeclared_iron: f64,
    /// Offset of one current channel, share of full scale.
    pub offset: f64,
    /// By how much currents are late, s.
    pub late_s: f64,
    /// Noise, share of full scale.
    pub noise: f64,
    /// Kelvin that the winding may be away from the motor file's temperature.
    pub warm_k: f64,
    /// Phases b and c exchanged, the shaft turning the other way.
    pub backwards: bool,
    /// Voltage of the supply, share of the rated one.
    pub volt: f64,
}

impl Doubts {
    /// What a calibration leaves, and what its circuit lacks.
    pub const USUAL: Doubts = Doubts {
        wrong: 1.0,
        bends: true,
        undeclared_iron: 0.0,
        offset: 0.0,
        late_s: 0.0,
        noise: 0.002,
        warm_k: 0.0,
        backwards: false,
        volt: 1.0,
    };

    /// A motor and instruments that are as believed but for noise, share of full scale, at a voltage, share of the rated one.
    pub fn none(noise: f64, volt: f64) -> Doubts {
        Doubts {
            wrong: 0.0,
            bends: false,
            noise,
            volt,
            ..Doubts::USUAL
        }
    }
}

/// A fault, where it begins: at once, or while the machine moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Break {
    /// What changes.
    pub targets: &'static [Target],
    /// By how much.
    pub percent: f64,
    /// After the drive began, s; `None`: at once.
    pub from_s: Option<f64>,
}

/// Where a fault comes in that comes during motion, s.
pub const DURING_S: f64 = 1.5;

/// One run.
pub struct Run {
    /// The motor and what happens to it.
    pub scenario: Scenario,
    /// Gain of the torque channel.
    pub torque_gain: f64,
    /// Start of the fault, s.
    pub fault_s: f64,
    /// Voltage on the clock of the start, s.
    pub on_s: f64,
}

/// Makes the scenario of a seed.
pub fn run(
    believed: &MotorFile,
    drive: Drive,
    doubts: &Doubts,
    fault: Option<&Break>,
    seed: u64,
) -> Run {
    let mut rng = Pcg64::seed_from_u64(seed);
    let plant = plant(believed, doubts, &mut rng);
    let plate = &believed.nameplate;
    let hertz = plate.frequency_hz;
    let before = if drive.starts() {
        0.1
    } else {
        0.3 + 5.0 * plant.parameters.l_r() / plant.parameters.r_r
    };
    let mut s = Scenario::of(plant, before + drive.duration());
    s.seed = seed;
    s.start = if drive.starts() {
        Start::Standstill
    } else {
        Start::Running
    };
    s.supply = supply(
        drive,
        doubts.volt * plate.phase_voltage_amplitude(),
        hertz,
        before,
        &mut rng,
    );
    s.load = load(drive, plate.torque_nm, hertz, before, &mut rng);
    s.sensors = sensors(believed, doubts, &mut rng);
    s.effects = bends(believed, doubts, &mut rng);
    let jitter = rng.random_range(0.0..1.0 / hertz);
    let fault_s = fault
        .and_then(|fault| fault.from_s)
        .map_or(0.0, |from| before + from + jitter);
    s.faults = faults(fault, fault_s);
    if doubts.offset != 0.0 {
        s.faults.push(Fault {
            target: Target::Probe(Probe::Current(0)),
            change: Change::Offset(doubts.offset * s.sensors.instrument.current_full_scale_amp),
            from_s: 0.0,
            to_s: f64::INFINITY,
        });
    }
    Run {
        torque_gain: 1.0 + 0.005 * doubts.wrong * normal(&mut rng),
        fault_s,
        on_s: before,
        scenario: s,
    }
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

fn faults(fault: Option<&Break>, from_s: f64) -> Vec<Fault> {
    let Some(fault) = fault else {
        return Vec::new();
    };
    let one = |target: &Target| Fault {
        from_s,
        ..Fault::of(*target, fault.percent)
    };
    fault.targets.iter().map(one).collect()
}

/// The motor that is really there: standard deviations as a calibration leaves them at the most.
fn plant(believed: &MotorFile, doubts: &Doubts, rng: &mut Pcg64) -> MotorFile {
    let mut motor = believed.clone();
    let heat = 0.0039 * doubts.warm_k * rng.random_range(-0.2..1.0);
    let mut off = |sigma: f64| 1.0 + sigma * doubts.wrong * normal(rng);
    let p = &mut motor.parameters;
    p.r_s *= (1.0 + heat) * off(0.02);
    p.r_r *= (1.0 + heat) * off(0.03);
    p.l_m *= off(0.01);
    let leakage = off(0.05);
    p.l_ls *= leakage;
    p.l_lr *= leakage;
    motor.mechanics.inertia *= off(0.03);
    let friction = off(0.02);
    motor.mechanics.friction *= friction;
    motor.mechanics.load_friction *= friction;
    motor
}

/// What the T model with the motor file's effects lacks, in other shapes than the monitor's.
fn bends(believed: &MotorFile, doubts: &Doubts, rng: &mut Pcg64) -> Vec<EffectEntry> {
    let mut effects = Vec::new();
    if doubts.bends {
        let amp = 12.0_f64.sqrt() * believed.nameplate.current_amplitude();
        let leakage = [
            ("leakage_drop", rng.random_range(0.05..0.3)),
            ("reference_current_amp", amp),
        ];
        effects.push(EffectEntry::with_numbers("leakage-saturation", leakage));
        let cage = [
            ("resistance_rise", rng.random_range(0.05..0.4)),
            ("leakage_drop", 0.0),
            ("slip_exponent", rng.random_range(0.8..1.5)),
        ];
        effects.push(EffectEntry::with_numbers("deep-bar", cage));
    }
    if doubts.undeclared_iron > 0.0 {
        let iron = [
            ("saturation", doubts.undeclared_iron),
            ("saturation_exponent", 7.0),
            ("flux_location", 0.0),
        ];
        effects.push(EffectEntry::with_numbers("magnetizing-saturation", iron));
    }
    effects
}

fn supply(drive: Drive, rated: f64, hertz: f64, before: f64, rng: &mut Pcg64) -> SupplySpec {
    let amplitude = rated * rng.random_range(0.97..1.03);
    let mut volts = Piecewise::constant(amplitude);
    let mut frequency = Piecewise::constant(hertz);
    let mut switch_on_s = 0.0;
    let mut components = vec![(-1.0, 0.01), (-5.0, 0.02), (7.0, 0.015)];
    match drive {
        Drive::DirectStart | Drive::Stall => switch_on_s = before,
        Drive::StarDelta => {
            switch_on_s = before;
            volts = Piecewise::constant(amplitude / 3.0_f64.sqrt());
            volts.change(before + 0.7, amplitude, 0.0);
        }
        Drive::Dip => {
            volts.change(before + 0.2, 0.6 * amplitude, 0.0);
            volts.change(before + 0.4, amplitude, 0.0);
        }
        Drive::SupplyRamp => volts.change(before + 0.2, 0.9 * amplitude, 3.0),
        Drive::FrequencyRamp => {
            switch_on_s = before;
            let low = 8.0 / hertz;
            volts = Piecewise::constant(amplitude * (low + 0.04));
            frequency = Piecewise::constant(8.0);
            volts.change(before + 0.2, amplitude, 2.0);
            frequency.change(before + 0.2, hertz, 2.0);
            components = Vec::new();
        }
        Drive::Interruption => {
            volts.change(before + 0.2, 0.0, 0.0);
            volts.change(before + 0.5, amplitude, 0.0);
        }
        _ => {}
    }
    SupplySpec {
        amplitude_volt: volts,
        frequency_hz: frequency,
        phase_rad: rng.random_range(0.0..TAU),
        switch_on_s,
        switch_off_s: None,
        components: components
            .into_iter()
            .map(|(order, share)| Harmonic {
                order,
                amplitude: Complex64::from_polar(share, rng.random_range(0.0..TAU)),
            })
            .collect(),
    }
}

/// No motor starts against so many times its rated torque.
const HELD: f64 = 8.0;

fn load(drive: Drive, rated: f64, hertz: f64, before: f64, rng: &mut Pcg64) -> LoadSpec {
    let size = rated * rng.random_range(0.8..1.0);
    let points = match drive {
        Drive::LoadStep => vec![(0.0, 0.1), (before + 0.2, 0.1), (before + 0.2 + 1e-3, 0.7)],
        Drive::LoadRamp => vec![(0.0, 0.1), (before + 0.2, 0.1), (before + 1.2, 0.8)],
        Drive::Press => press(before, hertz),
        Drive::Hoist => hoist(before),
        Drive::DirectStart | Drive::StarDelta => vec![(0.0, 0.2)],
        Drive::Stall => vec![(0.0, HELD)],
        _ => vec![(0.0, 0.5)],
    };
    let points = points.into_iter().map(|(t, x)| (t, x * size)).collect();
    let profile = Profile::new(points, Interpolation::Linear).expect("times in order");
    LoadSpec {
        other: Load::Profile {
            profile,
            active: drive == Drive::Hoist,
        },
        ..LoadSpec::default()
    }
}

/// Half a stroke loaded, half not, with flanks of a millisecond per hundredth of the stroke.
fn press(before: f64, hertz: f64) -> Vec<(f64, f64)> {
    let stroke = 8.0 / hertz;
    let mut points = vec![(0.0, 0.1)];
    let mut t = before;
    while t < before + 4.0 {
        let at = |share: f64| t + share * stroke;
        points.extend([
            (at(0.0), 0.1),
            (at(0.02), 0.85),
            (at(0.5), 0.85),
            (at(0.52), 0.1),
        ]);
        t += stroke;
    }
    points
}

fn hoist(before: f64) -> Vec<(f64, f64)> {
    let at = |t: f64| before + t;
    vec![
        (0.0, 0.3),
        (at(0.2), 0.3),
        (at(0.3), 0.8),
        (at(1.2), 0.8),
        (at(1.3), -0.4),
        (at(2.2), -0.4),
        (at(2.3), 0.5),
    ]
}

fn sensors(believed: &MotorFile, doubts: &Doubts, rng: &mut Pcg64) -> SensorSpec {
    let mut spec = SensorSpec::of(believed);
    spec.speed = SpeedSensor::Encoder;
    spec.instrument.noise_sigma_fraction_of_full_scale = doubts.noise;
    let mut off = |gains: [f64; 3]| gains.map(|g| g * (1.0 + 0.003 * doubts.wrong * normal(rng)));
    spec.instrument.voltage_gain = off(believed.sensors.voltage_gain);
    spec.instrument.current_gain = off(believed.sensors.current_gain);
    spec
}
