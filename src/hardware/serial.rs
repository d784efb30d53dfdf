//! The two serial lines: Modbus RTU over RS-485, and frames to the debugger's virtual COM port.
//!
//! Both live in tasks of their own beside the sample loop and share a few words with it, so that nothing that comes over
//! a wire can hold up a sample.

use core::cell::{Cell, RefCell};

use board::modbus::{
    Collector, Command, Files, Identity, Image, MAX_RESPONSE_BYTES, Memory, Slave,
};
use board::{Capture, Configuration, Desk, Line, LineParity, MAX_FRAME_BYTES, Second, SecondRing};
use embassy_executor::Spawner;
use embassy_stm32::peripherals::{DMA1_CH3, LPUART1, PA2, PA9, PA10, PA12, USART1};
use embassy_stm32::usart::{self, BufferedUart, Config, Parity, StopBits, UartTx};
use embassy_stm32::{Peri, bind_interrupts, dma};
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Instant, Timer, with_timeout};

use super::flash_store;
use crate::safety::marks::{self, Mark};
use embedded_io_async::{Read, Write};
use heapless::Vec;
use static_cell::ConstStaticCell;
use update::Tray;

/// Bit/s of the frames; some 8 kB/s are sent while a capture is handed over.
const FRAMES_BAUD: u32 = 115_200;

bind_interrupts!(
    struct Irqs {
        USART1 => usart::BufferedInterruptHandler<USART1>;
        DMA1_CHANNEL3 => dma::InterruptHandler<DMA1_CH3>;
    }
);

/// What the lines are made of.
pub struct Lines {
    /// RS-485.
    pub modbus: ModbusLine,
    /// Virtual COM port.
    pub frames: FrameLine,
}

/// Peripheral, receive, transmit, driver enable.
type ModbusLine = (
    Peri<'static, USART1>,
    Peri<'static, PA10>,
    Peri<'static, PA9>,
    Peri<'static, PA12>,
);

/// Peripheral, transmit, DMA.
type FrameLine = (
    Peri<'static, LPUART1>,
    Peri<'static, PA2>,
    Peri<'static, DMA1_CH3>,
);

/// One frame on its way.
type Packet = Vec<u8, MAX_FRAME_BYTES>;

/// Two windows' worth: the line is faster than the frames come.
static PACKETS: Channel<CriticalSectionRawMutex, Packet, 2> = Channel::new();
/// What DMA sends lies where the test of the RAM does not write.
#[unsafe(link_section = ".dma.frames")]
#[allow(unsafe_code)]
static OUTGOING: ConstStaticCell<[u8; MAX_FRAME_BYTES]> =
    ConstStaticCell::new([0; MAX_FRAME_BYTES]);
static IMAGE: CriticalSectionMutex<Cell<Option<Image>>> =
    CriticalSectionMutex::new(Cell::new(None));
static COMMAND: CriticalSectionMutex<Cell<Option<Command>>> =
    CriticalSectionMutex::new(Cell::new(None));

/// The last two minutes.
static SECONDS: CriticalSectionMutex<RefCell<SecondRing>> =
    CriticalSectionMutex::new(RefCell::new(SecondRing::new()));

/// The samples around an alarm: 9 KiB that are never moved.
static CAPTURE: CriticalSectionMutex<RefCell<Capture>> =
    CriticalSectionMutex::new(RefCell::new(Capture::new()));

/// What holds, and what a master is writing. Neither side ever keeps it across a wait.
static DESK: CriticalSectionMutex<RefCell<Desk>> =
    CriticalSectionMutex::new(RefCell::new(Desk::blank()));
/// How the line has to be set from now on, where that has changed.
static LINE: CriticalSectionMutex<Cell<Option<Line>>> = CriticalSectionMutex::new(Cell::new(None));

/// Starts both lines. One that cannot be set up stays silent; its settings are constants, so a test would see it.
pub fn start(spawner: Spawner, lines: Lines, line: Line, identity: Identity) {
    if let Ok(token) = serve_modbus(lines.modbus, line, identity) {
        spawner.spawn(token);
    }
    if let Ok(token) = send_frames(lines.frames) {
        spawner.spawn(token);
    }
}

/// Hands a frame to the line; dropped when two are waiting, or when it is longer than any frame is.
pub fn send(frame: &[u8]) {
    if let Ok(packet) = Packet::from_slice(frame) {
        let _ = PACKETS.try_send(packet);
    }
}

/// Shows these registers from now on.
pub fn publish(image: Image) {
    IMAGE.lock(|shared| shared.set(Some(image)));
}

/// Keeps a second for masters that ask for it later.
pub fn keep(second: &Second) {
    SECONDS.lock(|seconds| {
        if let Ok(mut seconds) = seconds.try_borrow_mut() {
            seconds.push(second);
        }
    });
}

fn read_seconds(at: usize, bytes: &mut [u8]) -> bool {
    SECONDS.lock(|seconds| {
        let seconds = seconds.try_borrow();
        seconds.is_ok_and(|seconds| seconds.read(at, bytes))
    })
}

/// Does something with the samples around an alarm; with interrupts off, for some microseconds at most.
pub fn with_capture<T>(work: impl FnOnce(&mut Capture) -> T) -> Option<T> {
    CAPTURE.lock(|capture| Some(work(&mut *capture.try_borrow_mut().ok()?)))
}

fn read_capture(at: usize, bytes: &mut [u8]) -> bool {
    with_capture(|capture| capture.read(at, bytes)).unwrap_or(false)
}

/// This configuration holds from now on: read by masters, and the line follows it behind the answer that is being sent.
pub fn show(configuration: &Configuration) {
    DESK.lock(|desk| {
        if let Ok(mut desk) = desk.try_borrow_mut() {
            desk.show(configuration);
        }
    });
    LINE.lock(|line| line.set(configuration.line().ok()));
}

/// What a master has written.
pub fn copy_staged(into: &mut Configuration) {
    copy(Desk::staged, into);
}

/// What holds.
pub fn copy_active(into: &mut Configuration) {
    copy(Desk::active, into);
}

fn copy(which: fn(&Desk) -> &Configuration, into: &mut Configuration) {
    DESK.lock(|desk| {
        if let Ok(desk) = desk.try_borrow() {
            into.clone_from(which(&desk));
        }
    });
}

/// What a master has asked for since the last look.
pub fn take_command() -> Option<Command> {
    COMMAND.lock(Cell::take)
}

/// Does something with the piece of a program that came last; with interrupts off, for some microseconds at most.
pub fn with_tray<T>(work: impl FnOnce(&mut Tray) -> T) -> Option<T> {
    DESK.lock(|desk| Some(work(desk.try_borrow_mut().ok()?.tray())))
}

#[embassy_executor::task]
async fn send_frames(parts: FrameLine) {
    let (line, pin, dma) = parts;
    let mut config = Config::default();
    config.baudrate = FRAMES_BAUD;
    let Ok(mut line) = UartTx::new(line, pin, dma, Irqs, config) else {
        return;
    };
    let outgoing = OUTGOING.take();
    loop {
        let packet = PACKETS.receive().await;
        if let Some(bytes) = outgoing.get_mut(..packet.len()) {
            bytes.copy_from_slice(&packet);
            let _ = line.write(bytes).await;
        }
    }
}

#[embassy_executor::task]
async fn serve_modbus(parts: ModbusLine, settings: Line, identity: Identity) {
    let (line, receive, transmit, enable) = parts;
    let (mut sent, mut received) = ([0; MAX_RESPONSE_BYTES + 1], [0; 64]);
    let line = BufferedUart::new_with_de(
        line,
        receive,
        transmit,
        enable,
        Irqs,
        &mut sent,
        &mut received,
        config_of(&settings),
    );
    let Ok(mut line) = line else {
        return;
    };
    let mut slave = Slave::new(settings.unit);
    let mut silence = Duration::from_micros(u64::from(settings.silence_us()));
    let mut collector = Collector::default();
    let mut response = [0; MAX_RESPONSE_BYTES];
    loop {
        if let Some(settings) = LINE.lock(Cell::take) {
            // The last byte of the answer is still on its way where the driver calls the line flushed.
            Timer::after(silence).await;
            // Settings that the driver refuses were refused before they came here.
            let _ = line.set_config(&config_of(&settings));
            slave.set_unit(settings.unit);
            silence = Duration::from_micros(u64::from(settings.silence_us()));
        }
        if !collect(&mut line, &mut collector, silence).await {
            continue;
        }
        let image = IMAGE.lock(Cell::get).unwrap_or_default();
        let now_ms = Instant::now().as_millis() as u32;
        let (length, command) = DESK.lock(|desk| {
            let Ok(mut desk) = desk.try_borrow_mut() else {
                return (0, None);
            };
            let mut memory = Memory {
                image: &image,
                identity: &identity,
                files: Files {
                    events: &flash_store::read_events,
                    seconds: &read_seconds,
                    capture: &read_capture,
                },
                desk: &mut desk,
            };
            slave.respond(now_ms, collector.frame(), &mut memory, &mut response)
        });
        collector.clear();
        if command.is_some() {
            COMMAND.lock(|shared| shared.set(command));
        }
        let answer = response.get(..length).unwrap_or_default();
        if !answer.is_empty() {
            let _ = line.write(answer).await;
            while with_timeout(SIGN_OF_LIFE, line.flush()).await.is_err() {
                marks::leave(Mark::Serial);
            }
        }
    }
}

/// Between two marks at most: a line may be silent for ever, the task may not.
const SIGN_OF_LIFE: Duration = Duration::from_millis(30);

fn config_of(settings: &Line) -> Config {
    let mut config = Config::default();
    config.baudrate = settings.baud;
    (config.parity, config.stop_bits) = match settings.parity {
        LineParity::None => (Parity::ParityNone, StopBits::STOP2),
        LineParity::Odd => (Parity::ParityOdd, StopBits::STOP1),
        LineParity::Even => (Parity::ParityEven, StopBits::STOP1),
    };
    config
}

/// Waits a while for bytes, then for the silence behind them; whether any came.
async fn collect(
    line: &mut BufferedUart<'_>,
    collector: &mut Collector,
    silence: Duration,
) -> bool {
    let mut bytes = [0; 32];
    marks::leave(Mark::Serial);
    let Ok(read) = with_timeout(SIGN_OF_LIFE, line.read(&mut bytes)).await else {
        return false;
    };
    let mut some = read.unwrap_or(0);
    loop {
        marks::leave(Mark::Serial);
        collector.push(bytes.get(..some).unwrap_or_default());
        match with_timeout(silence, line.read(&mut bytes)).await {
            Ok(length) => some = length.unwrap_or(0),
            Err(_) => return true,
        }
    }
}
