//! A board whose motor is made up: event log, seconds and Modbus are the real ones.

use board::modbus::{
    Command, Field, Files, Identity, Image, MAP_VERSION, MAX_RESPONSE_BYTES, Memory,
    SecondCollector, Slave,
};
use board::{
    Appended, CAPTURE_BYTES, Capture, CaptureState, Configuration, Desk, Event, EventCause,
    EventLog, Journal, MotorImage, SecondRing, Situation,
};
use crc::{CRC_16_MODBUS, Crc};
use fleet::lamp;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use super::capture;
use super::flash::Flash;
use super::life::{Life, Moment};
use super::truth::Produced;

const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MODBUS);
/// Windows of a second: one each cycle of 50 Hz.
const WINDOWS: u32 = 50;
/// Noise of a window's voltage, current and speed, share of the value, standard deviation.
const SPREAD: f32 = 0.002;
/// Number of the reset cause "power".
const POWER: u16 = 1;
const RESIDUALS: [Field; 4] = [
    Field::Residual1,
    Field::Residual2,
    Field::Residual3,
    Field::Residual4,
];
const PHASES: [[Field; 3]; 2] = [
    [Field::VoltageA, Field::VoltageB, Field::VoltageC],
    [Field::CurrentA, Field::CurrentB, Field::CurrentC],
];

/// What a simulated board is made from.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    /// Its motor's name.
    pub name: String,
    /// Address on its bus.
    pub unit: u8,
    /// Serial number of its chip.
    pub serial: [u32; 3],
    /// All its chances follow from it.
    pub seed: u64,
    /// When its motor begins to fail, s; `None`: never.
    pub fault_s: Option<u32>,
    /// Mean time between losses of its power, s; `None`: it never loses it.
    pub restart_s: Option<u32>,
}

/// A board.
pub(crate) struct SimulatedBoard {
    recipe: Recipe,
    identity: Identity,
    slave: Slave,
    desk: Desk,
    image: Image,
    flash: Flash,
    log: EventLog<Flash>,
    journal: Journal,
    ring: SecondRing,
    collector: SecondCollector,
    capture: Capture,
    was_faulty: bool,
    uptime_s: u32,
    windows: u32,
    judged: u32,
    life: Life,
    rng: Pcg32,
}

impl SimulatedBoard {
    /// Switched on for the first time.
    pub fn new(recipe: Recipe) -> Self {
        let flash = Flash::new();
        let mut rng = Pcg32::seed_from_u64(recipe.seed);
        let life = Life::new(Pcg32::seed_from_u64(rng.random()), recipe.fault_s);
        let identity = Identity {
            version: env!("CARGO_PKG_VERSION"),
            revision: "simulated",
            serial: recipe.serial,
        };
        let mut desk = Desk::blank();
        desk.show(&Configuration::of(
            &recipe.name,
            &MotorImage([0; board::IMAGE_WORDS]),
        ));
        let mut board = SimulatedBoard {
            slave: Slave::new(recipe.unit),
            log: EventLog::open(flash.clone(), 0),
            recipe,
            identity,
            desk,
            image: Image::default(),
            flash,
            journal: Journal::default(),
            ring: SecondRing::new(),
            collector: SecondCollector::new(1),
            capture: Capture::new(),
            was_faulty: false,
            uptime_s: 0,
            windows: 0,
            judged: 0,
            life,
            rng,
        };
        board.start();
        board
    }

    /// Address on its bus.
    pub fn unit(&self) -> u8 {
        self.recipe.unit
    }

    /// Its motor's name.
    pub fn name(&self) -> &str {
        &self.recipe.name
    }

    /// The power comes back: what was in RAM is lost.
    pub fn start(&mut self) {
        self.collector = SecondCollector::new(self.log.newest() + 1);
        self.ring = SecondRing::new();
        self.journal = Journal::default();
        self.capture = Capture::new();
        self.was_faulty = false;
        self.life.forget();
        (self.uptime_s, self.windows, self.judged) = (0, 0, 0);
        self.slave = Slave::new(self.recipe.unit);
        self.image = Image::default();
        self.image.set_word(Field::MapVersion, MAP_VERSION);
        self.image.set_word(Field::ResetCause, POWER);
        self.image.set_word(Field::NotJudged, 1);
        let [high, middle, low] = self.recipe.serial;
        self.image.set_long(Field::SerialHigh, high);
        self.image.set_long(Field::SerialMiddle, middle);
        self.image.set_long(Field::SerialLow, low);
        self.journal.note(EventCause::Start, [u32::from(POWER), 0]);
        self.show_numbers();
    }

    /// One second passes; tells what the board has produced in it.
    pub fn tick(&mut self, mut produced: impl FnMut(Produced)) {
        if self.loses_power() {
            self.start();
        }
        self.uptime_s += 1;
        let moment = self.life.step();
        self.show(&moment);
        for _ in 0..WINDOWS {
            self.window(&moment);
        }
        self.write_events(&moment, &mut produced);
        self.record(&moment, &mut produced);
        let second = self.collector.close(&self.image);
        self.ring.push(&second);
        produced(Produced::Second(second.to_bytes()));
        self.show_numbers();
    }

    /// Answers function and data of a question.
    pub fn answer(&mut self, now_ms: u32, content: &[u8]) -> Option<Vec<u8>> {
        let mut request = vec![self.unit()];
        request.extend_from_slice(content);
        request.extend(CRC.checksum(&request).to_le_bytes());
        let answer = self.respond(now_ms, &request);
        let [_, content @ .., _, _] = &answer[..] else {
            return None;
        };
        Some(content.to_vec())
    }

    /// Answers a frame of the serial line; empty where the protocol demands silence.
    pub fn respond(&mut self, now_ms: u32, request: &[u8]) -> Vec<u8> {
        let (flash, ring, capture) = (&self.flash, &self.ring, &self.capture);
        let files = Files {
            events: &|at: usize, bytes: &mut [u8]| flash.copy(at, bytes),
            seconds: &|at: usize, bytes: &mut [u8]| ring.read(at, bytes),
            capture: &|at: usize, bytes: &mut [u8]| capture.read(at, bytes),
        };
        let mut memory = Memory {
            image: &self.image,
            identity: &self.identity,
            files,
            desk: &mut self.desk,
        };
        let mut response = [0; MAX_RESPONSE_BYTES];
        let (length, command) = self
            .slave
            .respond(now_ms, request, &mut memory, &mut response);
        // Other commands would change the board; nobody has made that up.
        if command == Some(Command::ReleaseCapture) {
            self.capture.release();
            self.image
                .set_word(Field::Capture, self.capture.state() as u16);
        }
        response[..length].to_vec()
    }

    fn loses_power(&mut self) -> bool {
        let mean = self.recipe.restart_s;
        mean.is_some_and(|mean| self.rng.random_range(0..mean.max(1)) == 0)
    }

    fn show(&mut self, moment: &Moment) {
        let lit = moment.lit.iter().enumerate();
        let r = lit.fold(0, |lamps, (k, lit)| {
            lamps | u32::from(*lit) << (2 * (lamp::RESIDUALS + k as u32))
        });
        let run = if moment.not_judged == 0 { 1 } else { 2 };
        let fault = u32::from(moment.fault.is_some());
        let lamps = run << (2 * lamp::RUN) | r | fault << (2 * lamp::FAULT);
        self.image.set_long(Field::Lamps, lamps);
        self.image.set_word(Field::NotJudged, moment.not_judged);
        self.image
            .set_word(Field::LikelyFault, moment.fault.unwrap_or(0));
        let probability = if moment.fault.is_some() { 900 } else { 0 };
        self.image.set_word(Field::FaultProbability, probability);
        self.image.set_word(Field::ConverterSupply, 3_300);
        self.image.set_float(Field::Temperature, 35.0);
        self.image.set_word(Field::Relay, u16::from(fault == 0));
        let verdict = match (moment.fault, self.judged) {
            (Some(_), _) => 2,
            (None, 0) => 0,
            (None, _) => 1,
        };
        self.image.set_word(Field::Verdict, verdict);
    }

    fn window(&mut self, moment: &Moment) {
        for (k, field) in RESIDUALS.into_iter().enumerate() {
            let noise = self.life.noise();
            let value = moment.residuals.map_or(f32::NAN, |r| r[k] + noise);
            self.image.set_float(field, value);
        }
        let mut spread = |x: f32| x * (1.0 + SPREAD * self.life.deviate());
        let (u, i) = (spread(moment.voltage_volt), spread(moment.current_amp));
        self.image.set_float(Field::Voltage, u);
        self.image.set_float(Field::Current, i);
        self.image
            .set_float(Field::SupplyFrequency, moment.supply_hz);
        self.image.set_float(Field::Speed, spread(moment.speed_rpm));
        for (fields, value) in PHASES.into_iter().zip([u, i]) {
            fields
                .into_iter()
                .for_each(|field| self.image.set_float(field, value));
        }
        self.windows += 1;
        self.judged += u32::from(moment.not_judged == 0);
        self.collector.take(&self.image);
    }

    fn write_events(&mut self, moment: &Moment, produced: &mut impl FnMut(Produced)) {
        self.journal.look(&Situation {
            fault: moment.fault.is_some(),
            likely: (moment.fault.unwrap_or(0), 900),
            not_judged: moment.not_judged,
            ..Situation::default()
        });
        while let Some(event) = self.journal.due(self.uptime_s) {
            match self.log.append(&event) {
                Appended::Wait => continue,
                Appended::Lost => {}
                Appended::Written => {
                    let number = self.log.newest();
                    produced(Produced::Event(Event { number, ..event }.to_bytes()));
                }
            }
            self.journal.settle(event.cause, self.uptime_s);
        }
    }

    /// The samples around the second in which FAULT lights.
    fn record(&mut self, moment: &Moment, produced: &mut impl FnMut(Produced)) {
        let fault = moment.fault.and_then(|number| {
            let mut all = motor::FaultId::ALL.into_iter();
            all.find(|fault| fault.number() == number)
        });
        let lights = fault.is_some() && !self.was_faulty;
        self.was_faulty = fault.is_some();
        let Some(fault) = fault.filter(|_| lights && self.capture.state() == CaptureState::Armed)
        else {
            return;
        };
        let alarm = (self.collector.start(), self.collector.newest() + 1);
        let seed = self.recipe.seed ^ u64::from(alarm.1);
        // What is simulated is fixed, and tested to be sound.
        if capture::record(&mut self.capture, fault, seed, alarm).is_err() {
            return;
        }
        self.image
            .set_word(Field::Capture, self.capture.state() as u16);
        let mut bytes = vec![0; CAPTURE_BYTES];
        if self.capture.read(0, &mut bytes) {
            produced(Produced::Recording(bytes));
        }
    }

    fn show_numbers(&mut self) {
        let image = &mut self.image;
        image.set_long(Field::Uptime, self.uptime_s);
        image.set_long(Field::Windows, self.windows);
        image.set_long(Field::WindowsJudged, self.judged);
        image.set_long(Field::LastEvent, self.log.newest());
        image.set_long(Field::StartNumber, self.collector.start());
        image.set_long(Field::LastSecond, self.collector.newest());
    }
}
