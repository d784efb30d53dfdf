//! What a person sees and touches, and what looks after the board itself.

use board::modbus::Command;
use board::{
    Button, Calibration, Display, Doubt, Doubts, EventCause, LearnState, Press, Relay, Shown,
    Situation, StuckChannels, levels,
};
use embassy_stm32::gpio::Input;
use embassy_time::{Duration, Instant, Timer};
use monitor::{Lamp, Lamps, Monitor, Report};
use update::Refusal;

use crate::commissioning::Commissioning;
use crate::configuration::{Change, Settings};
use crate::events::Events;
use crate::hardware::housekeeping::{self, Housekeeping, is_vdda_credible};
use crate::hardware::lamps::{Lamps as LampWires, RelayWires};
use crate::hardware::{flash_store, serial};
use crate::record::Record;
use crate::safety::protection::StackMark;
use crate::safety::selftest::SelfTest;
use crate::safety::watchdog::Watchdog;
use crate::safety::{options, retained};
use crate::updates::Updates;

/// Blocks between two looks at the converters' supply: about a second.
const SECOND_BLOCKS: u32 = 312;
/// Half of a 1 Hz blink, in blocks of 3.2 ms.
const BLINK_BLOCKS: u32 = 156;
/// Blocks without a crash after which earlier ones are forgotten: a minute.
const QUIET_BLOCKS: u32 = 60 * SECOND_BLOCKS;
/// Until the answer to a command is out that starts the board again.
const ANSWER_BLOCKS: u32 = 32;
/// While nothing is computed.
const IDLE: Duration = Duration::from_millis(100);
const IDLES_A_SECOND: u32 = 10;

/// The door, and the board's own health.
pub struct Panel {
    /// Lamps.
    pub wires: LampWires,
    /// Relay and its contact.
    pub relay_wires: RelayWires,
    /// What the relay does.
    pub relay: Relay,
    /// Fed when all is well.
    pub watchdog: Watchdog,
    /// The button and what it means.
    pub button: Input<'static>,
    /// See `button`.
    pub press: Button,
    /// Supply and temperature of the chip.
    pub housekeeping: Housekeeping,
    /// Supply of the converters as it was measured last, a share of the nominal one.
    pub supply: f32,
    /// What is told.
    pub record: Record,
    /// Calibration and learning.
    pub commissioning: Commissioning,
    /// What was configured over the line.
    pub settings: Settings,
    /// A change of it for which judging stops for a moment.
    pub change: Option<Change>,
    /// What is kept in flash of everything that happens.
    pub events: Events,
    /// Programs that come over the line.
    pub updates: Updates,
    /// Lamps that stay.
    pub display: Display,
    /// Tests of the board by itself.
    pub selftest: SelfTest,
    /// Channels that do not move.
    pub channels: StuckChannels,
    /// Depth of the stack.
    pub stack: StackMark,
    /// Doubts that are found elsewhere than in the tests.
    pub doubts: Doubts,
    /// Doubts that a person has seen.
    pub acknowledged: Doubts,
    /// Doubts that were logged.
    pub told: Doubts,
    /// The block after which the option bytes are written.
    pub prepares_at: Option<u32>,
    /// A window was judged in this block.
    pub judged: bool,
    /// A window ended in this block: its work is enough.
    pub reported: bool,
    /// Blocks since the start, and at the last look of once a second.
    pub blocks: u32,
    /// See `blocks`.
    pub second_at: u32,
}

impl Panel {
    /// Takes one window's result: shown and told everywhere. A calibration may come out of it.
    pub fn take(&mut self, report: &Report, monitor: &Monitor) -> Option<Calibration> {
        self.judged |= report.is_judged_either_way();
        self.reported = true;
        let shown = self.show(&report.shown_lamps());
        self.record
            .tell(report, &shown, monitor, &self.commissioning);
        let doubts = self.all_doubts();
        self.commissioning.observe(report, monitor, doubts)
    }

    /// After a block: the only place from which the watchdog is fed while sampling.
    pub fn after_block(&mut self, lamps: &Lamps) {
        self.blocks = self.blocks.wrapping_add(1);
        self.selftest.step(self.blocks, self.reported);
        if !self.reported && self.blocks.wrapping_sub(self.second_at) >= SECOND_BLOCKS {
            self.second_at = self.blocks;
            self.every_second();
        }
        self.watchdog.look();
        self.obey_button();
        self.obey_master();
        self.doubts.set(Doubt::Channel, self.channels.is_any());
        self.doubts.set(Doubt::Lamps, self.wires.contradict());
        self.put_out(lamps);
    }

    /// Levels for lamps and relay, and registers for masters.
    fn put_out(&mut self, lamps: &Lamps) {
        let bright = (self.blocks / BLINK_BLOCKS).is_multiple_of(2);
        let shown = self.show(lamps);
        let closed = self.relay_wires.is_closed();
        let (level, contradicts) = self.relay.step(&shown, self.judged, closed);
        let has_time = !self.reported;
        (self.judged, self.reported) = (false, false);
        self.doubts.set(Doubt::Relay, contradicts);
        self.relay_wires.set(level);
        let (doubts, energised) = (self.all_doubts(), self.relay.is_energised());
        self.tell(doubts);
        self.record.note_health(doubts, energised);
        let has_time = self.events.step(&self.situation(&shown, doubts), has_time);
        self.step_update(has_time);
        self.record.note_event(self.events.newest());
        self.record.note_settings(&self.settings);
        self.record.refresh(&shown, &self.commissioning);
        self.wires.set(levels(&shown.lamps, bright));
    }

    /// At most one of event and update takes its time in a block.
    fn step_update(&mut self, has_time: bool) {
        if has_time {
            self.updates.step(self.obstacle());
        }
        if let Some((cause, values)) = self.updates.take_event() {
            self.events.note_values(cause, values);
        }
        self.record.note_update(self.updates.status());
    }

    /// Why no program may be installed now.
    fn obstacle(&self) -> Option<Refusal> {
        if self.commissioning.learning() == LearnState::Learning {
            return Some(Refusal::Learning);
        }
        if self.settings.is_on_trial() {
            return Some(Refusal::Configuration);
        }
        flash_store::is_supply_low().then_some(Refusal::Supply)
    }

    fn situation(&self, shown: &Shown, doubts: Doubts) -> Situation {
        Situation {
            fault: shown.lamps.fault == Lamp::On,
            likely: self.record.likely(),
            sensor: shown.lamps.sensor == Lamp::On,
            not_judged: self.record.not_judged(),
            doubts: doubts.bits(),
            learning: self.commissioning.learning(),
            calibration: self.commissioning.calibration_identification(),
        }
    }

    /// A calibration that is ignored is worth an event.
    pub fn note_calibration(&mut self) {
        let source = self.commissioning.source();
        if source.is_ignored() {
            self.events
                .note(EventCause::CalibrationIgnored, source as u32);
        }
    }

    /// Logs every doubt that is new. One that has gone and comes back is new to people, too.
    fn tell(&mut self, doubts: Doubts) {
        self.acknowledged = Doubts::from_bits(self.acknowledged.bits() & doubts.bits());
        let new = doubts.bits() & !self.told.bits();
        for doubt in Doubts::from_bits(new).iter() {
            defmt::error!("doubt: {=str}", doubt.label());
        }
        self.told = doubts;
    }

    /// Follows a change of the configuration; whether a monitor has to be made anew.
    #[inline(never)]
    pub fn configure(&mut self, change: Change) -> bool {
        if change == Change::Confirm {
            if self.settings.confirm() {
                self.note_configuration(EventCause::Configured);
            }
            return false;
        }
        let holds = self.settings.holds();
        self.relay.mode = holds.relay().unwrap_or_default();
        serial::show(holds);
        self.take_motor();
        if change == Change::HoldsAgain {
            self.note_configuration(EventCause::TrialEnded);
        }
        true
    }

    /// Learning and judging belong to the motor of the configuration that holds.
    pub fn take_motor(&mut self) {
        self.commissioning.set_motor(self.settings.holds());
    }

    fn note_configuration(&mut self, cause: EventCause) {
        let line = self.settings.holds().line();
        let unit = line.map_or(0, |line| u32::from(line.unit));
        let values = [self.commissioning.motor(), unit];
        self.events.note_values(cause, values);
    }

    fn every_second(&mut self) {
        if let Some(change) = self.settings.look() {
            self.change = Some(change);
        }
        self.look_after_supply();
        self.updates.second(self.all_doubts());
        self.stack.look();
        self.doubts.set(Doubt::Stack, self.stack.is_nearly_full());
        if self.blocks >= QUIET_BLOCKS {
            retained::forget_crashes();
        }
        self.record.note_second(
            Instant::now().as_secs() as u32,
            self.stack.deepest_bytes(),
            retained::crashes(),
        );
    }

    fn obey_button(&mut self) {
        match self.press.look(self.button.is_high()) {
            Some(Press::Short) => self.acknowledge(),
            Some(Press::Long) => self.display.set_latched(!self.display.is_latched()),
            Some(Press::VeryLong) => {
                // On the way here the press was a long one; the lamp mode stays what it was.
                self.display.set_latched(!self.display.is_latched());
                self.commissioning.begin(self.all_doubts());
            }
            None => {}
        }
    }

    fn obey_master(&mut self) {
        let command = serial::take_command();
        if let Some(change) = command.and_then(|command| self.settings.obey(command)) {
            self.change = Some(change);
        }
        match command {
            Some(Command::Acknowledge) => self.acknowledge(),
            Some(Command::ReleaseCapture) => self.record.release(),
            Some(Command::Install) => self.updates.install(self.obstacle()),
            Some(Command::Learn) => self.commissioning.begin(self.all_doubts()),
            Some(Command::Prepare) => {
                self.events.note(EventCause::Prepared, 0);
                self.prepares_at = Some(self.blocks.wrapping_add(ANSWER_BLOCKS));
            }
            _ => {}
        }
        if self.prepares_at == Some(self.blocks) {
            options::prepare();
        }
    }

    fn acknowledge(&mut self) {
        self.events.note(EventCause::Acknowledged, 0);
        self.display.acknowledge();
        self.commissioning.acknowledge();
        self.record.acknowledge();
        self.acknowledged = self.all_doubts();
    }

    /// What the tests have found, and what was found elsewhere.
    pub fn all_doubts(&self) -> Doubts {
        Doubts::from_bits(self.doubts.bits() | self.selftest.doubts().bits())
    }

    /// The monitor's lamps with what the board knows beside them. A board that cannot measure says so, whatever its numbers say about the motor.
    fn show(&mut self, lamps: &Lamps) -> Shown {
        let doubts = self.all_doubts();
        let noticed = doubts.bits() & !self.acknowledged.bits() != 0;
        let overrides = self.commissioning.overrides(doubts, noticed);
        self.display.show(lamps, &overrides)
    }

    /// Measures the supply of the converters and the chip's temperature.
    pub fn look_after_supply(&mut self) {
        let millivolt = self.housekeeping.vdda_millivolt();
        self.supply = housekeeping::share_of_nominal(millivolt);
        let faulty = !is_vdda_credible(millivolt);
        if self.doubts.set(Doubt::Supply, faulty) {
            defmt::warn!("VDDA {=u32} mV", millivolt);
        }
        let degc = self.housekeeping.temperature_degc(millivolt);
        self.record.note_chip(millivolt as u16, degc);
    }

    /// Nothing is computed: SENSOR and FAULT light, RUN stays dark, the relay is open; masters are answered, and the button
    /// or an acknowledgement starts the board again.
    pub async fn refuse(&mut self, doubt: Doubt) -> ! {
        defmt::error!("nothing is computed: {=str}", doubt.label());
        self.doubts.set(doubt, true);
        loop {
            self.blocks = self.blocks.wrapping_add(1);
            self.put_out(&Lamps::default());
            self.watchdog.feed_while_waiting();
            if self.blocks.is_multiple_of(IDLES_A_SECOND) {
                // A new program that ends here gives itself up after a while.
                self.updates.second(self.all_doubts());
                self.updates.settle();
            }
            let command = serial::take_command();
            if command == Some(Command::Install) {
                self.updates.install(self.obstacle());
            }
            Timer::after(IDLE).await;
            if command == Some(Command::Prepare) {
                options::prepare();
            }
            if command == Some(Command::Acknowledge) || self.button.is_high() {
                retained::forget_crashes();
                cortex_m::peripheral::SCB::sys_reset();
            }
        }
    }
}
