//! Healthy motors through random instruments: whatever is wrong with an instrument is named, nothing that is sound is refused,
//! and no healthy motor gets a FAULT by a sound instrument.
//!
//! `CASES=1000 cargo test -p drivemon --release --test recorders random_instruments -- --nocapture` is the full run of docs/recordings.md.

use std::collections::BTreeMap;
use std::path::Path;

use audit::{Audit, Code, Expectation, audit};
use formats::{read_recording, write_recording};
use monitor::Monitor;
use motor::MotorFile;
use recording::{Channel, Mapping, Metadata, Recording, Sensors};
use replay::{self, Samples, VerdictState};
use scenario::Scenario;
use scenario::simulate::record;

const MOTORS: [&str; 4] = ["peer-2k2", "chalmers-4kw", "imc-18k5", "assumed-300w"];

/// Numbers that are the same every time (splitmix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.uniform() < share
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.uniform() * from.len() as f64) as usize % from.len()]
    }
}

/// Something that an instrument does to a recording and that must be named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Defect {
    None,
    /// Currents of a meter that is refreshed every some rows.
    HeldCurrents,
    HeldSpeed,
    SpeedSpikes,
    Frozen,
    TwoClocks,
    /// Speed 1 % too high.
    FastSpeed,
}

#[derive(Clone, Debug)]
struct Case {
    motor: &'static str,
    load_percent: f64,
    hz_factor: f64,
    rate_hz: f64,
    /// Simulated samples per row; channels are sampled one simulated sample after the other where it is above 1.
    parts: usize,
    bits: i32,
    full_scale: f64,
    noise: f64,
    gains: [f64; 6],
    offsets: [f64; 6],
    dropped: f64,
    line_voltages: bool,
    missing: Option<Channel>,
    units: bool,
    defect: Defect,
}

const DEFECTS: [Defect; 12] = [
    Defect::None,
    Defect::None,
    Defect::None,
    Defect::None,
    Defect::None,
    Defect::None,
    Defect::HeldCurrents,
    Defect::HeldSpeed,
    Defect::SpeedSpikes,
    Defect::Frozen,
    Defect::TwoClocks,
    Defect::FastSpeed,
];

impl Case {
    fn random(random: &mut Random) -> Case {
        let class = random.pick(&[0.0, 0.0, 0.001, 0.005]);
        let [gains, offsets] =
            [(); 2].map(|()| [(); 6].map(|()| class * random.between(-1.0, 1.0)));
        let missing = [Channel::CURRENTS[2], Channel::CURRENTS[0], Channel::SPEED];
        Case {
            motor: random.pick(&MOTORS),
            load_percent: random.between(-60.0, 110.0).round(),
            hz_factor: random.pick(&[1.0, 1.0, 1.001, 0.998, 0.8]),
            rate_hz: if random.chance(0.5) {
                random.pick(&[1e3, 2e3, 5e3, 1e4, 2e4, 5e4])
            } else {
                10f64.powf(random.between(3.0, 4.7)).round()
            },
            parts: random.pick(&[1, 1, 1, 9]),
            bits: random.pick(&[8, 10, 12, 12, 14, 16]),
            full_scale: random.between(1.2, 10.0),
            noise: random.pick(&[0.0, 0.0002, 0.0005, 0.002, 0.005]),
            gains,
            offsets,
            dropped: random.pick(&[0.0, 0.0, 0.0, 0.01, 0.1]),
            line_voltages: random.chance(0.15),
            missing: random.chance(0.2).then(|| random.pick(&missing)),
            units: random.chance(0.3),
            defect: random.pick(&DEFECTS),
        }
    }

    /// Whether the instrument is as good as uncalibrated thresholds of 0.3 % ask for; the 300 W motor asks for more.
    fn is_sound(&self) -> bool {
        let steps = 2f64.powi(self.bits) / (2.0 * self.full_scale);
        self.defect == Defect::None
            && self.gains == [0.0; 6]
            && self.noise * self.full_scale < 0.003
            && self.motor != "assumed-300w"
            && steps > 150.0
            && self.rate_hz >= 5e3
            && self.hz_factor > 0.9
    }

    fn seconds(&self) -> f64 {
        if self.defect == Defect::TwoClocks {
            3.0
        } else {
            0.8
        }
    }

    /// What the audit may say of it.
    fn allowed(&self) -> Vec<Code> {
        let mut codes = Vec::new();
        let derived = matches!(self.missing, Some(channel) if channel != Channel::SPEED);
        if self.missing == Some(Channel::SPEED) {
            codes.push(Code::ChannelMissing);
            // A generator without a speed looks like currents of other phases, and is told so without being refused.
            if self.load_percent < 0.0 {
                codes.push(Code::SwappedPhases);
            }
        }
        // A class of 0.5 % on both amplitude and zero: these are its errors.
        if self.gains != [0.0; 6] {
            codes.extend([
                Code::Offset,
                Code::ZeroSequence,
                Code::SupplyUnbalance,
                Code::SpeedImplausible,
            ]);
        }
        if self.dropped > 0.0 {
            codes.push(Code::Gap);
        }
        if self.parts > 1 && !derived {
            codes.push(Code::ZeroSequence);
        }
        match self.defect {
            Defect::None => {}
            Defect::HeldCurrents | Defect::HeldSpeed => codes.push(Code::Held),
            Defect::SpeedSpikes => codes.push(Code::Spikes),
            Defect::Frozen => codes.push(Code::Frozen),
            Defect::TwoClocks => codes.push(Code::ClockDrift),
            Defect::FastSpeed => codes.push(Code::SpeedImplausible),
        }
        codes
    }

    /// What the audit must say, where the channel is there and the instrument fine enough to show it.
    fn required(&self) -> Option<Code> {
        let speed = self.missing != Some(Channel::SPEED);
        let fine = self.rate_hz >= 2e3 && self.dropped == 0.0;
        match self.defect {
            Defect::HeldCurrents if fine && self.bits >= 10 => Some(Code::Held),
            Defect::SpeedSpikes if speed => Some(Code::Spikes),
            Defect::Frozen if fine => Some(Code::Frozen),
            Defect::TwoClocks if speed && fine && self.noise < 0.004 => Some(Code::ClockDrift),
            _ => None,
        }
    }

    fn refuses(&self) -> bool {
        matches!(self.defect, Defect::HeldCurrents | Defect::TwoClocks)
    }
}

fn project(path: &str) -> std::path::PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(path)
}

/// What is so: the motor, sampled `parts` times per row.
fn truth(case: &Case, motor: &MotorFile) -> Recording {
    let hz = motor.nameplate.frequency_hz * case.hz_factor;
    let text = format!(
        "motor = \"{}.toml\"\nstart = \"running\"\nduration_s = {}\nsample_rate_hz = {}\n[supply]\nfrequency_hz = {hz}\n\
         voltage_line_rms_volt = {}\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = {}\n[sensors]\n\
         quantise = false\nnoise_sigma_fraction_of_full_scale = 0.0\ntorque = true",
        case.motor,
        case.seconds(),
        case.rate_hz * case.parts as f64,
        motor.nameplate.voltage_line_rms_volt * case.hz_factor.min(1.0),
        case.load_percent,
    );
    let scenario = Scenario::parse(&text, "scenario.toml", &project("motors"));
    record(
        &scenario.unwrap_or_else(|error| panic!("{error}\n{text}")),
        |_| {},
    )
    .expect("it runs")
}

/// The channels in the order in which a recorder samples them.
fn channels() -> Vec<Channel> {
    let signals = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    signals.chain([Channel::SPEED]).collect()
}

/// What the recorder writes.
fn recorded(case: &Case, motor: &MotorFile, random: &mut Random) -> Recording {
    let fine = truth(case, motor);
    let rows = fine.len() / case.parts;
    let kept: Vec<usize> = (0..rows)
        .filter(|k| *k < 2 || !random.chance(case.dropped))
        .collect();
    let t = kept.iter().map(|k| fine.t()[k * case.parts]).collect();
    let scales = [
        case.full_scale * motor.nameplate.phase_voltage_amplitude(),
        case.full_scale * motor.nameplate.current_amplitude(),
    ];
    let metadata = Metadata {
        sensors: Sensors {
            voltage_full_scale_volt: Some(scales[0]),
            current_full_scale_amp: Some(scales[1]),
            noise_sigma_fraction_of_full_scale: Some(case.noise),
            adc_bits: u32::try_from(case.bits).ok(),
            ..Sensors::default()
        },
        ..Metadata::default()
    };
    let mut shown = Recording::new("random.csv", t, metadata).expect("a clock");
    for (late, channel) in channels().into_iter().enumerate() {
        if case.missing == Some(channel) {
            continue;
        }
        let x = values(case, &fine, channel);
        let values = kept.iter().map(|k| {
            let at = (k * case.parts + if case.parts > 1 { late } else { 0 }).min(x.len() - 1);
            instrument(case, x[at], late, scales, random)
        });
        let mut values: Vec<f64> = values.collect();
        spoil(case, channel, &mut values, random);
        shown = shown.with_channel(channel, values).expect("as long");
    }
    shown
}

/// A channel as it is; currents by a clock of their own where there are two.
fn values(case: &Case, fine: &Recording, channel: Channel) -> Vec<f64> {
    let x = fine.channel(channel).expect("simulated");
    let x: Vec<f64> = if case.line_voltages && Channel::VOLTAGES.contains(&channel) {
        let [a, b, c] = fine.voltages().expect("simulated");
        let next = [b, c, a];
        let k = Channel::VOLTAGES
            .iter()
            .position(|other| *other == channel)
            .unwrap_or(0);
        x.iter().zip(next[k]).map(|(x, y)| x - y).collect()
    } else {
        x.to_vec()
    };
    if case.defect != Defect::TwoClocks || !Channel::CURRENTS.contains(&channel) {
        return x;
    }
    // 300 ppm: linear between samples of 20 kHz and more, otherwise the next one; the walk is what counts.
    let at = |k: usize| {
        let place = k as f64 * (1.0 - 3e-4);
        let (whole, part) = (place as usize, place.fract());
        x[whole] + part * (x[(whole + 1).min(x.len() - 1)] - x[whole])
    };
    (0..x.len()).map(at).collect()
}

fn instrument(case: &Case, x: f64, place: usize, scales: [f64; 2], random: &mut Random) -> f64 {
    if place == 6 {
        return x * (1.0 + 2e-5 * random.normal());
    }
    let line = if case.line_voltages && place < 3 {
        3f64.sqrt()
    } else {
        1.0
    };
    let full_scale = line * scales[place / 3];
    let step = 2.0 * full_scale / 2f64.powi(case.bits);
    let seen = x * (1.0 + case.gains[place])
        + full_scale / case.full_scale * case.offsets[place]
        + full_scale * case.noise * random.normal();
    (step * (seen / step).round()).clamp(-full_scale, full_scale - step)
}

fn spoil(case: &Case, channel: Channel, x: &mut [f64], random: &mut Random) {
    let hold = |x: &mut [f64], rows: usize| (0..x.len()).for_each(|k| x[k] = x[k - k % rows]);
    match case.defect {
        Defect::HeldCurrents if Channel::CURRENTS.contains(&channel) => hold(x, 24),
        Defect::HeldSpeed if channel == Channel::SPEED => hold(x, 30),
        Defect::SpeedSpikes if channel == Channel::SPEED => {
            for x in x.iter_mut() {
                if random.chance(0.02) {
                    *x = random.between(-4e5, 4e5);
                }
            }
        }
        Defect::Frozen => {
            let from = x.len() * 6 / 10;
            let held = x[from];
            x[from..].fill(held);
        }
        Defect::FastSpeed if channel == Channel::SPEED => x.iter_mut().for_each(|x| *x *= 1.01),
        _ => {}
    }
}

/// Through a file: units other than SI, line voltages, delays of channels that were sampled in turn.
fn reread(case: &Case, number: usize, recording: &Recording) -> Recording {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("random-instruments-{number}"));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("recording.csv");
    let mut flags = Mapping {
        line_voltages: case.line_voltages.then_some(true),
        ..Mapping::default()
    };
    let mut written = recording.clone();
    if case.units {
        for (channel, factor, unit) in [
            ("va", 1e-3, "kV"),
            ("ib", 1e3, "mA"),
            ("speed", 60.0 / std::f64::consts::TAU, "rpm"),
        ] {
            let channel = Channel::parse(channel).expect("a channel");
            if let Some(x) = recording.channel(channel) {
                let x = x.iter().map(|x| factor * x).collect();
                written = written.with_channel(channel, x).expect("as long");
                flags
                    .set_unit(&format!("{channel}={unit}"))
                    .expect("a unit");
            }
        }
    }
    if case.parts > 1 {
        let step = 1e6 / (case.rate_hz * case.parts as f64);
        let all = channels().into_iter().enumerate();
        for (late, channel) in all.filter(|(_, channel)| recording.channel(*channel).is_some()) {
            flags
                .set_delay(&format!("{channel}={:.4}us", step * late as f64))
                .expect("a delay");
        }
    }
    write_recording(&path, &written).expect("room");
    let read = read_recording(&path, &flags, &mut |_| {}).expect("readable");
    std::fs::remove_dir_all(&folder).expect("it was there");
    read
}

fn monitored(recording: &Recording, motor: &MotorFile, audit: &Audit) -> VerdictState {
    let config = replay::config_for(motor, recording).expect("effects of the library");
    let monitor = Monitor::new(config).expect("a sound configuration");
    replay::replay(&monitor, &Samples::new(recording, audit), &mut |_| {})
        .verdict(&[])
        .state
}

#[test]
fn healthy_motors_through_random_instruments() {
    let cases = std::env::var("CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    let mut random = Random(20_260);
    let mut complaints = Vec::new();
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for number in 0..cases.unwrap_or(60) {
        let case = Case::random(&mut random);
        let motor =
            MotorFile::read(project(&format!("motors/{}.toml", case.motor))).expect("it ships");
        let recording = reread(&case, number, &recorded(&case, &motor, &mut random));
        let audit = audit(&recording, &Expectation::from(&motor));
        let codes: Vec<Code> = audit.findings.iter().map(|finding| finding.code).collect();
        let allowed = case.allowed();
        let strange = audit.findings.iter().filter(|f| !allowed.contains(&f.code));
        let mut complain =
            |what: String| complaints.push(format!("{number} {what}: {case:?}\n      {codes:?}"));
        strange.for_each(|f| complain(format!("says {}", f.detail)));
        if let Some(code) = case.required().filter(|code| !codes.contains(code)) {
            complain(format!("does not say {code:?}"));
        }
        if audit.supported == case.refuses() && (case.refuses() == case.required().is_some()) {
            complain(format!("supported: {}", audit.supported));
        }
        let state = if audit.supported {
            Some(monitored(&recording, &motor, &audit))
        } else {
            None
        };
        let class = if case.is_sound() {
            "sound"
        } else if case.defect == Defect::None {
            "coarse"
        } else {
            "defect"
        };
        *seen.entry(format!("{class} {state:?}")).or_default() += 1;
        if case.is_sound() && state == Some(VerdictState::Fault) {
            complain("FAULT".to_owned());
        }
    }
    println!("{seen:#?}");
    assert!(
        complaints.is_empty(),
        "{} complaints\n{}",
        complaints.len(),
        complaints.join("\n")
    );
}
