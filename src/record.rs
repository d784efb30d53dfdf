//! What is kept and told about every window: frames, registers, and the samples around an alarm.

use board::modbus::{BoardStatus, Image, SecondCollector, Status, UpdateStatus};
use board::{CAPTURE_EVERY, Capture, CaptureAlarm, Doubts, Shown};
use monitor::{Lamp, Monitor, RawSample, Report};

use crate::commissioning::Commissioning;
use crate::configuration::Settings;
use crate::hardware::serial;
use crate::hardware::telemetry::Telemetry;
use crate::safety::{self, Start};
use crate::updates;

/// Frames, registers and capture.
pub struct Record {
    telemetry: Telemetry,
    status: Status,
    board: BoardStatus,
    was_lit: bool,
    registers: Image,
    seconds: SecondCollector,
    shown: Shown,
    /// Something about the board changed that no master knows yet.
    stale: bool,
}

impl Record {
    /// Nothing recorded yet, in a run of the program whose first event gets the number `start_number`.
    pub fn new(telemetry: Telemetry, start: &Start, start_number: u32, serial: [u32; 3]) -> Self {
        let board = BoardStatus {
            reset_cause: start.cause as u16,
            crash: start.crash,
            crashes: start.crashes as u16,
            program: safety::program(),
            serial,
            start_number,
            version: updates::VERSION.0,
            ..BoardStatus::default()
        };
        let (shown, status) = (Shown::default(), Status::default());
        Record {
            telemetry,
            registers: status.nothing_yet(&shown, &board),
            shown,
            status,
            seconds: SecondCollector::new(start_number),
            board,
            was_lit: false,
            stale: false,
        }
    }

    /// Notes the chip's supply, mV, and temperature, degrees Celsius.
    pub fn note_chip(&mut self, vdda_millivolt: u16, temperature_degc: f32) {
        self.board.vdda_millivolt = vdda_millivolt;
        self.board.temperature_degc = temperature_degc;
    }

    /// Notes how the board is. A master learns it with the next report or change of a lamp, within a second otherwise.
    pub fn note_health(&mut self, doubts: Doubts, relay: bool) {
        self.stale |= self.board.doubts != doubts || self.board.relay != relay;
        self.board.doubts = doubts;
        self.board.relay = relay;
    }

    /// Notes the number of the newest event.
    pub fn note_event(&mut self, number: u32) {
        self.stale |= self.board.last_event != number;
        self.board.last_event = number;
    }

    /// Notes where the configuration comes from and how its trial stands.
    pub fn note_settings(&mut self, settings: &Settings) {
        let before = (self.board.configuration, self.board.refused);
        settings.describe(&mut self.board);
        self.stale |= before != (self.board.configuration, self.board.refused);
    }

    /// Notes how an update stands. That bytes have come a master learns within a second.
    pub fn note_update(&mut self, update: UpdateStatus) {
        let before = core::mem::replace(&mut self.board.update, update);
        self.stale |= (before.state, before.refused) != (update.state, update.refused);
    }

    /// Number and probability, per mille, of the likeliest fault of the last window.
    pub fn likely(&self) -> (u16, u16) {
        self.status.likely()
    }

    /// Number of the reason why the last window was not judged.
    pub fn not_judged(&self) -> u16 {
        self.status.not_judged()
    }

    /// Ends a second. Notes the time since the start, s, and the deepest stack, bytes.
    pub fn note_second(&mut self, uptime_s: u32, stack_bytes: u32, crashes: u32) {
        serial::keep(&self.seconds.close(&self.registers));
        self.board.last_second = self.seconds.newest();
        self.board.uptime_s = uptime_s;
        self.board.stack_bytes = stack_bytes as u16;
        self.board.crashes = crashes as u16;
        let errors = safety::faults::stored_data_errors();
        self.board.stored_data_errors = errors.min(u32::from(u16::MAX)) as u16;
        self.stale = true;
    }

    /// Takes a block's samples into the ring.
    pub fn keep(&mut self, samples: impl Iterator<Item = RawSample>) {
        serial::with_capture(|capture| {
            samples
                .step_by(CAPTURE_EVERY)
                .for_each(|raw| capture.push(&raw));
        });
    }

    /// Samples are missing.
    pub fn interrupt(&mut self) {
        serial::with_capture(Capture::interrupt);
    }

    /// Waits for the next alarm.
    pub fn acknowledge(&mut self) {
        serial::with_capture(Capture::arm);
    }

    /// A master has fetched the samples around an alarm.
    pub fn release(&mut self) {
        serial::with_capture(Capture::release);
    }

    /// Tells one window's result, and what the door shows with it, everywhere.
    #[inline(never)]
    pub fn tell(
        &mut self,
        report: &Report,
        shown: &Shown,
        monitor: &Monitor,
        commissioning: &Commissioning,
    ) {
        let lit = report.shown_lamps().fault == Lamp::On;
        let motor = commissioning.motor();
        let alarm = (lit && !self.was_lit).then(|| CaptureAlarm {
            start: self.board.start_number,
            second: self.seconds.newest() + 1,
            motor,
        });
        self.was_lit = lit;
        let (state, chunk) = serial::with_capture(|capture| {
            if let Some(alarm) = alarm {
                capture.alarm(alarm);
            }
            (capture.state(), capture.next_chunk(motor))
        })
        .unwrap_or_default();
        commissioning.describe(&mut self.board);
        self.board.thresholds = monitor.config().thresholds;
        self.board.capture = state as u16;
        self.shown = *shown;
        self.registers = self.status.take(report, shown, &self.board);
        self.seconds.take(&self.registers);
        serial::publish(self.registers);
        self.telemetry
            .send(report, shown, self.board.vdda_millivolt);
        if let Some(chunk) = chunk {
            self.telemetry.send_chunk(&chunk);
        }
    }

    /// Tells a master at once what the door shows now, where it changed since the last report.
    #[inline(never)]
    pub fn refresh(&mut self, shown: &Shown, commissioning: &Commissioning) {
        if self.shown != *shown || self.stale {
            commissioning.describe(&mut self.board);
            self.shown = *shown;
            self.stale = false;
            self.status.refresh(&mut self.registers, shown, &self.board);
            serial::publish(self.registers);
        }
    }
}
