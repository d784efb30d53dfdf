//! The program: self-test, then samples to lamps for ever.

use core::hint::black_box;
use core::panic::PanicInfo;

use board::modbus::Command;
use board::{Button, Calibration, Capture, Display, LAMPS, Press, Shown, StuckChannels, levels};
use embassy_executor::Spawner;
use embassy_stm32::gpio::Input;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_time::{Duration, Timer};
use monitor::{Lamp, Lamps, Monitor, MonitorState, Report};
use static_cell::ConstStaticCell;

use crate::commissioning::Commissioning;
use crate::hardware::board::{Board, clocks};
use crate::hardware::flash_store;
use crate::hardware::housekeeping::{Housekeeping, ResetCause, is_vdda_credible};
use crate::hardware::lamps::Lamps as LampWires;
use crate::hardware::sampling::{Acquisition, Block, Gap};
use crate::hardware::serial;
use crate::hardware::telemetry::Telemetry;
use crate::record::Record;

include!(concat!(env!("OUT_DIR"), "/motor.rs"));

/// us; ten blocks and three recoveries fit, a person does not notice it.
const WATCHDOG: u32 = 250_000;
/// How long each lamp is lit at power-up.
const LAMP_TEST: Duration = Duration::from_millis(150);
/// Blocks that are thrown away at first: the filters and sensors settle (0.1 s).
const INHIBITED_BLOCKS: u32 = 31;
/// Blocks between two looks at the converters' supply: about a second.
const HOUSEKEEPING_BLOCKS: u32 = 312;
/// Half of a 1 Hz blink, in blocks of 3.2 ms.
const BLINK_BLOCKS: u32 = 156;

/// 9 KiB that are never moved: the stack has not the room.
static CAPTURE: ConstStaticCell<Capture> = ConstStaticCell::new(Capture::new());

/// Starts up; nothing comes back from here.
#[embassy_executor::main]
async fn main(spawner: Spawner) -> ! {
    let cause = ResetCause::take();
    let board = Board::new(embassy_stm32::init(clocks()));
    let telemetry = Telemetry::default();
    let capture = CAPTURE.take();
    defmt::info!("drive-monitor: {=str}, reset: {}", NAME, cause);
    let mut watchdog = IndependentWatchdog::new(board.watchdog, WATCHDOG);
    watchdog.unleash();
    serial::start(spawner, board.lines);
    let mut lamps = board.lamps;
    test_lamps(&mut lamps, &mut watchdog).await;
    let mut panel = Panel {
        wires: lamps,
        watchdog,
        button: board.button,
        press: Button::default(),
        housekeeping: Housekeeping::new(board.housekeeping),
        record: Record::new(telemetry, cause, capture),
        // Through memory that the compiler cannot see through: the constants are read from flash, not folded.
        commissioning: Commissioning::new(
            black_box(&IMAGE),
            &EFFECTS,
            flash_store::open(board.flash),
        ),
        display: Display::default(),
        instrument_faulty: false,
        channels: StuckChannels::default(),
        blocks: 0,
    };
    panel.look_after_supply();
    let mut monitor = panel.commissioning.monitor();
    match &mut monitor {
        Some(monitor) => run(monitor, &mut panel, board.sources).await,
        None => panel.refuse().await,
    }
}

/// Each lamp alone, in order, so that a person sees that every one works.
async fn test_lamps(wires: &mut LampWires, watchdog: &mut IndependentWatchdog<'static, IWDG>) {
    for lamp in 0..LAMPS {
        wires.set(core::array::from_fn(|other| other == lamp));
        watchdog.pet();
        Timer::after(LAMP_TEST).await;
    }
    wires.set([false; LAMPS]);
    watchdog.pet();
}

/// Samples to lamps. Every gap in the samples ends in a fresh acquisition, and every calibration in a fresh monitor.
async fn run(
    monitor: &mut Monitor,
    panel: &mut Panel,
    mut sources: crate::hardware::sampling::Sources,
) -> ! {
    let mut state = MonitorState::default();
    let mut lamps = Lamps {
        run: Lamp::Blink,
        ..Lamps::default()
    };
    loop {
        let mut acquisition = Acquisition::start(&mut sources);
        let pause = watch(monitor, &mut state, &mut acquisition, panel, &mut lamps).await;
        drop(acquisition);
        match pause {
            Pause::Gap(gap) => {
                defmt::warn!("samples are missing: {}", gap);
                panel.record.interrupt();
            }
            Pause::Learnt(calibration) => {
                panel.commissioning.store(&calibration);
                if let Some(calibrated) = panel.commissioning.monitor() {
                    *monitor = calibrated;
                }
            }
        }
        state.resume_after_gap();
    }
}

/// Why judging stops for a moment.
enum Pause {
    Gap(Gap),
    Learnt(Calibration),
}

/// Judges block after block until samples are missing or something was learnt.
async fn watch(
    monitor: &Monitor,
    state: &mut MonitorState,
    acquisition: &mut Acquisition<'_>,
    panel: &mut Panel,
    lamps: &mut Lamps,
) -> Pause {
    let mut block = Block::new();
    loop {
        if let Err(gap) = acquisition.read(&mut block).await {
            return Pause::Gap(gap);
        }
        if panel.blocks >= INHIBITED_BLOCKS
            && let Some(report) = process_block(monitor, state, &block)
        {
            *lamps = report.lamps;
            let shown = panel.show(lamps);
            let commissioning = &panel.commissioning;
            panel.record.tell(&report, &shown, monitor, commissioning);
            if let Some(calibration) = panel.commissioning.observe(&report, monitor) {
                return Pause::Learnt(calibration);
            }
        }
        panel.record.keep(block.samples());
        panel.channels.look(block.first());
        panel.after_block(lamps);
    }
}

/// One block through the core; at most one report ends in it, because a block is shorter than a cycle.
/// A symbol of its own, so that what it reaches can be inspected (tools/check-firmware).
#[inline(never)]
fn process_block(monitor: &Monitor, state: &mut MonitorState, block: &Block) -> Option<Report> {
    let mut raw = block.raw();
    let mut latest = None;
    while !raw.is_empty() {
        latest = monitor.update_block(state, &mut raw).or(latest);
    }
    latest
}

/// What a person sees and touches, and what looks after the board itself.
struct Panel {
    wires: LampWires,
    watchdog: IndependentWatchdog<'static, IWDG>,
    button: Input<'static>,
    press: Button,
    housekeeping: Housekeeping,
    record: Record,
    commissioning: Commissioning,
    display: Display,
    instrument_faulty: bool,
    channels: StuckChannels,
    blocks: u32,
}

impl Panel {
    /// The only place that pets the watchdog while sampling: after a good block.
    fn after_block(&mut self, lamps: &Lamps) {
        self.watchdog.pet();
        self.blocks = self.blocks.wrapping_add(1);
        if self.blocks.is_multiple_of(HOUSEKEEPING_BLOCKS) {
            self.look_after_supply();
        }
        self.obey_button();
        self.obey_master();
        let bright = (self.blocks / BLINK_BLOCKS).is_multiple_of(2);
        let shown = self.show(lamps);
        self.record.refresh(&shown);
        self.wires.set(levels(&shown.lamps, bright));
    }

    fn obey_button(&mut self) {
        match self.press.look(self.button.is_high()) {
            Some(Press::Short) => self.acknowledge(),
            Some(Press::Long) => self.display.set_latched(!self.display.is_latched()),
            Some(Press::VeryLong) => {
                // On the way here the press was a long one; the lamp mode stays what it was.
                self.display.set_latched(!self.display.is_latched());
                self.commissioning.begin();
            }
            None => {}
        }
    }

    fn obey_master(&mut self) {
        match serial::take_command() {
            Some(Command::Acknowledge) => self.acknowledge(),
            Some(Command::Learn) => self.commissioning.begin(),
            None => {}
        }
    }

    fn acknowledge(&mut self) {
        self.display.acknowledge();
        self.commissioning.acknowledge();
        self.record.acknowledge();
    }

    /// The monitor's lamps with what the board knows beside them. A board that cannot measure says so, whatever its numbers say about the motor.
    fn show(&mut self, lamps: &Lamps) -> Shown {
        let faulty = self.instrument_faulty || self.channels.is_any();
        let overrides = self.commissioning.overrides(faulty);
        self.display.show(lamps, &overrides)
    }

    fn look_after_supply(&mut self) {
        let millivolt = self.housekeeping.vdda_millivolt();
        let faulty = !is_vdda_credible(millivolt);
        if faulty != self.instrument_faulty {
            defmt::warn!("VDDA {=u32} mV", millivolt);
        }
        self.instrument_faulty = faulty;
        let degc = self.housekeeping.temperature_degc(millivolt);
        self.record.note_chip(millivolt as u16, degc);
    }

    /// Nothing is measured with constants that do not hold: SENSOR and FAULT light, RUN stays dark.
    async fn refuse(&mut self) -> ! {
        defmt::error!("the motor constants in flash are corrupted: flash the board again");
        loop {
            self.instrument_faulty = true;
            let shown = self.show(&Lamps::default());
            self.record.refresh(&shown);
            self.wires.set(levels(&shown.lamps, false));
            self.watchdog.pet();
            Timer::after(LAMP_TEST).await;
        }
    }
}

/// No message could be read: start again, and the reset cause tells.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
