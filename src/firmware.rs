//! The program: self-test, then samples to lamps for ever.

use core::hint::black_box;

use board::modbus::Identity;
use board::{Button, Calibration, Compiled, Display, Doubt, Doubts, LAMPS, Relay, StuckChannels};
use embassy_executor::Spawner;
use embassy_time::{Duration, Timer};
use monitor::{Lamp, Lamps, Monitor, MonitorState, Report};
use motion::Companion;
use static_cell::StaticCell;

use crate::commissioning::Commissioning;
use crate::configuration::{Change, Settings};
use crate::events::Events;
use crate::hardware::board::Board;
use crate::hardware::flash_store;
use crate::hardware::housekeeping::{self, Housekeeping};
use crate::hardware::lamps::Lamps as LampWires;
use crate::hardware::sampling::{Acquisition, Block, Gap, Sources};
use crate::hardware::serial;
use crate::hardware::telemetry::Telemetry;
use crate::panel::Panel;
use crate::record::Record;
use crate::safety::clock::{self, Source};
use crate::safety::protection::{self, StackMark};
use crate::safety::selftest::SelfTest;
use crate::safety::watchdog::Watchdog;
use crate::safety::{Start, marks, marks::Mark, options};
use crate::updates::Updates;

include!(concat!(env!("OUT_DIR"), "/motor.rs"));

/// s; the sampling clock runs at 10 kHz.
const T_SAMPLE: f32 = 1e-4;
/// What judges in motion: too large for the stack.
static COMPANION: StaticCell<Companion> = StaticCell::new();
/// How long each lamp is lit at power-up.
const LAMP_TEST: Duration = Duration::from_millis(150);
/// Blocks that are thrown away at first: the filters and sensors settle (0.1 s).
const INHIBITED_BLOCKS: u32 = 31;

/// Starts up; nothing comes back from here.
#[embassy_executor::main]
async fn main(spawner: Spawner) -> ! {
    let start = Start::take();
    let source = clock::start(start.trusts_crystal());
    let board = Board::new(embassy_stm32::init(clock::config(source)));
    clock::watch(source);
    protection::start();
    tell(&start, source);
    let mut watchdog = Watchdog::start(board.watchdog);
    let identity = Identity {
        version: env!("CARGO_PKG_VERSION"),
        revision: REVISION,
        serial: housekeeping::serial_number(),
    };
    let (calibration, log, stored, updater) = match flash_store::open(board.flash) {
        Some(stored) => (
            Some(stored.calibration),
            Some(stored.events),
            Some(stored.configuration),
            Some(stored.updates),
        ),
        None => (None, None, None, None),
    };
    let compiled = Compiled {
        name: NAME,
        // Through memory that the compiler cannot see through: the constants are read from flash, not folded.
        image: black_box(&IMAGE),
        t_sample: T_SAMPLE,
    };
    let settings = Settings::new(compiled, stored, board.button.is_high());
    let holds = settings.holds();
    serial::show(holds);
    let line = holds.line().unwrap_or_default();
    serial::start(spawner, board.lines, line, identity);
    let relay = Relay::new(holds.relay().unwrap_or_default());
    let mut lamps = board.lamps;
    test_lamps(&mut lamps, &mut watchdog).await;
    let events = Events::new(log, &start);
    let mut panel = Panel {
        wires: lamps,
        relay_wires: board.relay,
        relay,
        settings,
        change: None,
        watchdog,
        button: board.button,
        press: Button::default(),
        housekeeping: Housekeeping::new(board.housekeeping),
        supply: 1.0,
        record: Record::new(
            Telemetry::default(),
            &start,
            events.newest().wrapping_add(1),
            identity.serial,
        ),
        commissioning: Commissioning::new(calibration),
        events,
        updates: Updates::new(updater),
        display: Display::default(),
        selftest: SelfTest::at_start(),
        channels: StuckChannels::default(),
        stack: StackMark::new(),
        doubts: doubts_of(source),
        acknowledged: Doubts::default(),
        told: Doubts::default(),
        prepares_at: None,
        judged: false,
        reported: false,
        blocks: 0,
        second_at: 0,
    };
    panel.look_after_supply();
    panel.take_motor();
    let mut monitor = panel.commissioning.monitor();
    panel.note_calibration();
    match &mut monitor {
        _ if start.gives_up => panel.refuse(Doubt::Restarts).await,
        _ if panel.all_doubts().has(Doubt::Processor) => panel.refuse(Doubt::Processor).await,
        Some(monitor) => {
            let companion = companion_of(monitor);
            run((monitor, companion), &mut panel, board.sources).await
        }
        None => panel.refuse(Doubt::Constants).await,
    }
}

fn tell(start: &Start, source: Source) {
    defmt::info!("drive-monitor: {=str}, reset: {}", NAME, start.cause);
    if source == Source::Internal {
        defmt::error!("the crystal does not oscillate");
    }
    if let Some(crash) = start.crash {
        let (what, at) = (crash.cause.label(), crash.pc);
        defmt::error!("the last run ended: {=str}, at {=u32:#x}", what, at);
    }
}

fn doubts_of(source: Source) -> Doubts {
    let mut doubts = Doubts::default();
    doubts.set(Doubt::Clock, source == Source::Internal);
    doubts.set(Doubt::OptionBytes, !options::are_prepared());
    doubts
}

/// Each lamp alone, in order, so that a person sees that every one works.
async fn test_lamps(wires: &mut LampWires, watchdog: &mut Watchdog) {
    for lamp in 0..LAMPS {
        wires.set(core::array::from_fn(|other| other == lamp));
        Timer::after(LAMP_TEST).await;
        watchdog.feed_while_waiting();
    }
    wires.set([false; LAMPS]);
}

/// Not inlined: on its way into its place a companion may lie on the stack, which is free again afterwards.
#[inline(never)]
fn companion_of(monitor: &Monitor) -> &'static mut Companion {
    let companion = COMPANION.init_with(Companion::default);
    companion.set_motor(monitor.config());
    companion
}

/// Samples to lamps. Every gap in the samples ends in a fresh acquisition, and every calibration in a fresh monitor.
async fn run(
    (monitor, companion): (&mut Monitor, &mut Companion),
    panel: &mut Panel,
    mut sources: Sources,
) -> ! {
    let mut state = MonitorState::default();
    let mut lamps = Lamps {
        run: Lamp::Blink,
        ..Lamps::default()
    };
    loop {
        let mut acquisition = Acquisition::start(&mut sources);
        panel.selftest.remember_settings();
        let judges = (&*monitor, &mut state, &mut *companion);
        let pause = watch(judges, &mut acquisition, panel, &mut lamps).await;
        drop(acquisition);
        panel.selftest.resume();
        match pause {
            Pause::Gap(gap) => {
                defmt::warn!("samples are missing: {}", gap);
                panel.record.interrupt();
                panel.events.note_gap(gap);
                panel.updates.disturb();
                panel.watchdog.starve();
            }
            Pause::Learnt(calibration) => {
                panel.commissioning.store(&calibration);
                renew(monitor, companion, panel);
            }
            Pause::Update => panel.updates.settle(),
            Pause::Configured(change) => {
                if panel.configure(change) {
                    renew(monitor, companion, panel);
                }
            }
        }
        state.resume_after_gap();
        companion.resume_after_gap();
    }
}

/// Judges with what was learnt or configured just now.
#[inline(never)]
fn renew(monitor: &mut Monitor, companion: &mut Companion, panel: &mut Panel) {
    if let Some(renewed) = panel.commissioning.monitor() {
        *monitor = renewed;
        companion.set_motor(monitor.config());
    }
    panel.note_calibration();
}

/// Why judging stops for a moment.
enum Pause {
    Gap(Gap),
    Learnt(Calibration),
    Configured(Change),
    Update,
}

/// Judges block after block until samples are missing or something was learnt.
async fn watch(
    (monitor, state, companion): (&Monitor, &mut MonitorState, &mut Companion),
    acquisition: &mut Acquisition<'_>,
    panel: &mut Panel,
    lamps: &mut Lamps,
) -> Pause {
    let mut block = Block::new();
    loop {
        if let Err(gap) = acquisition.read(&mut block).await {
            return Pause::Gap(gap);
        }
        state.note_converter_supply(panel.supply);
        if panel.blocks >= INHIBITED_BLOCKS
            && let Some(report) = process_block(monitor, state, companion, &block)
        {
            *lamps = report.shown_lamps();
            if let Some(calibration) = panel.take(&report, monitor) {
                return Pause::Learnt(calibration);
            }
        }
        marks::leave(Mark::Block);
        panel.record.keep(block.samples());
        panel.channels.look(block.first());
        panel.after_block(lamps);
        if let Some(change) = panel.change.take() {
            return Pause::Configured(change);
        }
        if panel.updates.is_due() {
            return Pause::Update;
        }
    }
}

/// One block through the core; at most one report ends in it, because a block is shorter than a cycle.
/// A symbol of its own, so that what it reaches can be inspected (tools/check-firmware).
#[inline(never)]
fn process_block(
    monitor: &Monitor,
    state: &mut MonitorState,
    companion: &mut Companion,
    block: &Block,
) -> Option<Report> {
    let mut raw = block.raw();
    let mut latest = None;
    while !raw.is_empty() {
        let report = monitor.update_block_beside(state, &mut raw, companion);
        latest = report.or(latest);
    }
    latest
}
