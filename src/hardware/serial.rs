//! The two serial lines: Modbus RTU over RS-485, and frames to the debugger's virtual COM port.
//!
//! Both live in tasks of their own beside the sample loop and share a few words with it, so that nothing that comes over
//! a wire can hold up a sample.

use core::cell::Cell;

use board::MAX_FRAME_BYTES;
use board::modbus::{Collector, Command, Identity, Image, MAX_RESPONSE_BYTES, Readable, Slave};
use embassy_executor::Spawner;
use embassy_stm32::peripherals::{DMA1_CH3, LPUART1, PA2, PA9, PA10, PA12, USART1};
use embassy_stm32::usart::{self, BufferedUart, Config, Parity, UartTx};
use embassy_stm32::{Peri, bind_interrupts, dma};
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::channel::Channel;
use embassy_time::{Duration, Instant, with_timeout};

use super::flash_store;
use crate::safety::marks::{self, Mark};
use embedded_io_async::{Read, Write};
use heapless::Vec;
use static_cell::ConstStaticCell;

/// The slave's address.
const UNIT: u8 = 1;
/// Bit/s of Modbus, with even parity: the protocol's default.
const MODBUS_BAUD: u32 = 19_200;
/// The silence that ends a frame: 3.5 characters of 11 bits.
const SILENCE: Duration = Duration::from_micros(2_100);
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

/// Starts both lines. One that cannot be set up stays silent; its settings are constants, so a test would see it.
pub fn start(spawner: Spawner, lines: Lines, identity: Identity) {
    if let Ok(token) = serve_modbus(lines.modbus, identity) {
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

/// What a master has asked for since the last look.
pub fn take_command() -> Option<Command> {
    COMMAND.lock(Cell::take)
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
async fn serve_modbus(parts: ModbusLine, identity: Identity) {
    let (line, receive, transmit, enable) = parts;
    let mut config = Config::default();
    config.baudrate = MODBUS_BAUD;
    config.parity = Parity::ParityEven;
    let (mut sent, mut received) = ([0; MAX_RESPONSE_BYTES + 1], [0; 64]);
    let line = BufferedUart::new_with_de(
        line,
        receive,
        transmit,
        enable,
        Irqs,
        &mut sent,
        &mut received,
        config,
    );
    let Ok(mut line) = line else {
        return;
    };
    let mut slave = Slave::new(UNIT);
    let mut collector = Collector::default();
    let mut response = [0; MAX_RESPONSE_BYTES];
    loop {
        collect(&mut line, &mut collector).await;
        let image = IMAGE.lock(Cell::get).unwrap_or_default();
        let now_ms = Instant::now().as_millis() as u32;
        let readable = Readable {
            image: &image,
            identity: &identity,
            events: flash_store::read_events,
        };
        let (length, command) = slave.respond(now_ms, collector.frame(), &readable, &mut response);
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

/// Waits for bytes, then for the silence behind them.
async fn collect(line: &mut BufferedUart<'_>, collector: &mut Collector) {
    let mut bytes = [0; 32];
    let mut some = loop {
        marks::leave(Mark::Serial);
        if let Ok(read) = with_timeout(SIGN_OF_LIFE, line.read(&mut bytes)).await {
            break read.unwrap_or(0);
        }
    };
    loop {
        marks::leave(Mark::Serial);
        collector.push(bytes.get(..some).unwrap_or_default());
        match with_timeout(SILENCE, line.read(&mut bytes)).await {
            Ok(length) => some = length.unwrap_or(0),
            Err(_) => return,
        }
    }
}
