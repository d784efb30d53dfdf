//! The firmware, a simulated motor, and the host's core on the very samples that the firmware took.
#![allow(dead_code)] // every test binary uses its own part of this

pub mod flash_image;
pub mod master;
pub mod packages;
pub mod wire;

use std::path::{Path, PathBuf};

use board::{EVENT_BYTES, Event, LOG_EVENTS};
use monitor::{Lamp, Lamps, Monitor, MonitorConfig, MonitorState, RawSample};
use motion::Companion;
use motor::MotorFile;
use scenario::Scenario;
use scenario::simulate::Simulation;
use virtual_board::{Inputs, VirtualBoard};

/// Blocks of 32 samples that the firmware throws away after power-up: one after every start, 31 after this one.
pub const INHIBITED: usize = 32 * 32;
/// The lamp test lasts nine times 0.15 s; the loader (5 ms) and the test of the RAM come before it, that of the flash behind.
/// Sampling begins then.
pub const LAMP_TEST_S: f64 = 1.45;
/// Two windows of a 60 Hz supply and a block, in instants: the lag that the lamps may have.
const LAG: usize = 2 * 167 + 32;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A program and the motor that is compiled into it.
pub struct Program {
    pub elf: Vec<u8>,
    pub motor: MotorFile,
}

/// The release ELF: `DRIVE_MONITOR_ELF`, or where `tools/thumb build --release -p drive-monitor` puts it.
pub fn firmware() -> Vec<u8> {
    read(&elf_path())
}

/// Where it is.
pub fn elf_path() -> PathBuf {
    let default = root().join("target/thumbv7em-none-eabihf/release/drive-monitor");
    std::env::var_os("DRIVE_MONITOR_ELF").map_or(default, PathBuf::from)
}

fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| {
        panic!(
            "{}: {error}; tools/test-virtual-board builds it",
            path.display()
        )
    })
}

/// The motor that is compiled into the firmware by default.
pub fn motor() -> MotorFile {
    MotorFile::read(root().join("motors/assumed-300w.toml")).expect("a shipped motor file")
}

/// That motor as a configuration of a board, with thresholds a tenth larger: its residuals stay, its lamps are other ones.
pub fn less_touchy() -> MonitorConfig {
    let mut config = MonitorConfig::of_board(&motor()).expect("shipped");
    config.thresholds = config.thresholds.map(|threshold| 1.1 * threshold);
    config
}

/// The default program.
pub fn plain() -> Program {
    Program {
        elf: firmware(),
        motor: motor(),
    }
}

/// A program of another motor file that tools/test-virtual-board builds beside the default one, with its motor file.
pub fn variant(name: &str) -> Program {
    let mut path = elf_path().into_os_string();
    path.push(format!("-{name}"));
    let elf = read(Path::new(&path));
    path.push(".toml");
    Program {
        elf,
        motor: MotorFile::read(path).expect("a valid motor file"),
    }
}

/// A running motor with the noise of its file, for `seconds` after the first sample.
pub fn scenario(seconds: f64) -> Scenario {
    let mut scenario = Scenario::of(motor(), seconds);
    scenario.seed = 11;
    scenario
}

/// A simulation as the sensors of the board; it holds its last sample after its end.
pub struct Sensors {
    simulation: Simulation,
    next: u64,
    latest: RawSample,
    mirrored: bool,
}

impl Sensors {
    pub fn new(scenario: &Scenario) -> Self {
        Sensors {
            simulation: Simulation::new(scenario).expect("a scenario that runs"),
            next: 0,
            latest: RawSample::default(),
            mirrored: false,
        }
    }

    /// Phases b and c exchanged and the shaft turning the other way: the same motor running backwards.
    pub fn mirrored(self) -> Self {
        Sensors {
            mirrored: true,
            ..self
        }
    }
}

impl Inputs for Sensors {
    fn at(&mut self, index: u64) -> RawSample {
        while self.next <= index {
            self.next += 1;
            if let Some(sample) = self.simulation.next() {
                let measured = sample.measured;
                self.latest = RawSample {
                    voltage_codes: measured.voltage_codes,
                    current_codes: measured.current_codes,
                    encoder_count: measured.encoder_count,
                    ..RawSample::default()
                };
                if self.mirrored {
                    self.latest.voltage_codes.swap(1, 2);
                    self.latest.current_codes.swap(1, 2);
                    self.latest.encoder_count = self.latest.encoder_count.wrapping_neg();
                }
            }
        }
        self.latest
    }
}

/// A board that has power and runs through its lamp test.
pub fn board(scenario: &Scenario) -> VirtualBoard {
    VirtualBoard::new(&firmware(), Box::new(Sensors::new(scenario))).expect("a firmware that loads")
}

/// Sensors that answer alike when they are asked for an earlier instant again.
struct Remembered {
    sensors: Sensors,
    seen: Vec<RawSample>,
}

impl Inputs for Remembered {
    fn at(&mut self, index: u64) -> RawSample {
        while self.seen.len() as u64 <= index {
            let next = self.seen.len() as u64;
            self.seen.push(self.sensors.at(next));
        }
        self.seen[index as usize]
    }
}

/// A board that can go back to a snapshot: its sensors are asked for earlier instants again then.
pub fn board_to_restore(scenario: &Scenario) -> VirtualBoard {
    let inputs = Remembered {
        sensors: Sensors::new(scenario),
        seen: Vec::new(),
    };
    VirtualBoard::new(&firmware(), Box::new(inputs)).expect("a firmware that loads")
}

/// Where src/hardware/flash_store.rs has the event log.
pub const EVENT_LOG: u32 = 0x0807_B000;

/// Whole events in flash, oldest first.
pub fn logged(board: &mut VirtualBoard) -> Vec<Event> {
    let size = LOG_EVENTS as usize * EVENT_BYTES;
    let flash = board.read_flash(EVENT_LOG, size).expect("flash");
    let (places, _) = flash.as_chunks::<EVENT_BYTES>();
    let mut events: Vec<Event> = places.iter().filter_map(Event::from_bytes).collect();
    events.sort_by_key(|event| event.number);
    events
}

/// The host's lamps after every sample of `taken`, as the firmware's core sees them without a gap.
pub fn host_lamps(taken: &[RawSample]) -> Vec<Lamps> {
    host_lamps_of(&motor(), taken)
}

fn host_lamps_of(motor: &MotorFile, taken: &[RawSample]) -> Vec<Lamps> {
    let config = MonitorConfig::of_board(motor).expect("effects of the library");
    let monitor = Monitor::new(config).expect("a valid configuration");
    let (mut state, mut companion) = (MonitorState::default(), Companion::new(monitor.config()));
    let mut lamps = Lamps {
        run: Lamp::Blink,
        ..Lamps::default()
    };
    let judged = taken.iter().enumerate().map(|(k, raw)| {
        if k >= INHIBITED
            && let Some(report) = monitor.update_raw_beside(&mut state, raw, &mut companion)
        {
            lamps = report.shown_lamps();
        }
        lamps
    });
    judged.collect()
}

/// Whether wires show these lamps; a blinking lamp may be in either half.
pub fn shows(levels: [bool; 9], lamps: &Lamps) -> bool {
    let dark = board_levels(lamps, false);
    let bright = board_levels(lamps, true);
    (0..9).all(|k| levels[k] == dark[k] || levels[k] == bright[k])
}

fn board_levels(lamps: &Lamps, phase: bool) -> [bool; 9] {
    let [r1, r2, r3, r4] = lamps.r;
    let order = [
        lamps.run,
        r1,
        r2,
        r3,
        r4,
        lamps.sensor,
        lamps.line,
        lamps.load,
        lamps.fault,
    ];
    order.map(|lamp| match lamp {
        Lamp::Off => false,
        Lamp::On => true,
        Lamp::Blink => phase,
    })
}

/// What was seen during a run.
pub struct Seen {
    /// Wires, and how many instants the converter had taken by then.
    pub observed: Vec<([bool; 9], usize)>,
    /// The host's lamps after each instant.
    pub host: Vec<Lamps>,
    /// The board at the end.
    pub board: VirtualBoard,
}

/// Runs a scenario on the default program. See [`Program::watch`].
pub fn watch(scenario: &Scenario) -> Seen {
    plain().watch(scenario)
}

impl Program {
    /// Runs a scenario on the board, looking at the lamps every 20 ms from the end of the lamp test on.
    pub fn watch(&self, scenario: &Scenario) -> Seen {
        self.watch_sensors(Sensors::new(scenario), scenario.duration_s)
    }

    /// The same of any sensors, for so many seconds.
    pub fn watch_sensors(&self, sensors: Sensors, duration_s: f64) -> Seen {
        let mut board =
            VirtualBoard::new(&self.elf, Box::new(sensors)).expect("a firmware that loads");
        board.run(LAMP_TEST_S).expect("a lamp test");
        let mut observed = Vec::new();
        for _ in 0..(duration_s / 0.02) as usize {
            board.run(0.02).expect("a run without an unknown access");
            observed.push((board.lamps(), board.taken().len()));
        }
        let host = host_lamps_of(&self.motor, board.taken());
        Seen {
            observed,
            host,
            board,
        }
    }
}

impl Seen {
    /// Every observation matches lamps that the host showed at most two windows ago.
    pub fn assert_as_on_the_host(&self, what: &str) {
        for (levels, taken) in &self.observed {
            let recent = &self.host[taken.saturating_sub(LAG)..*taken];
            assert!(
                recent.is_empty() || recent.iter().any(|lamps| shows(*levels, lamps)),
                "{what}, after {taken} instants: the board shows {levels:?}, the host {:?}",
                recent.last()
            );
        }
    }

    /// Names of the lamps that the host has on at the end, RUN apart.
    pub fn lit(&self) -> Vec<&'static str> {
        self.host
            .last()
            .map(|lamps| lamps.lit_names().collect())
            .unwrap_or_default()
    }
}
