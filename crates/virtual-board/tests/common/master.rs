//! A Modbus master from elsewhere (`rmodbus`), on the emulated wire.

use board::modbus::{Command, Field, UNLOCK_KEY, WORDS, address};
use board::{Configuration, Line, MotorImage, STAGED};
use monitor::MonitorConfig;
use rmodbus::ModbusProto;
use rmodbus::client::ModbusRequest;
use virtual_board::{Port, Quality, Sent, VirtualBoard};

use super::motor;

/// The slave's address.
pub const UNIT: u8 = 1;
/// A character of 11 bits at 19 200 bit/s, s.
pub const CHARACTER_S: f64 = 11.0 / 19_200.0;

/// One master for one slave.
pub struct Master {
    unit: u8,
}

impl Master {
    /// Talks to this slave.
    pub fn new(unit: u8) -> Self {
        Master { unit }
    }

    /// A request to be filled.
    pub fn request(&self) -> ModbusRequest {
        ModbusRequest::new(self.unit, ModbusProto::Rtu)
    }

    /// All input registers.
    pub fn registers(&self, board: &mut VirtualBoard) -> Vec<u16> {
        let mut master = self.request();
        let mut request = Vec::new();
        master
            .generate_get_inputs(0, WORDS as u16, &mut request)
            .expect("a request");
        let answer = ask(board, &request);
        let mut words: Vec<u16> = Vec::new();
        master
            .parse_u16(&bytes(&answer), &mut words)
            .expect("an answer");
        words
    }

    /// A value of one register.
    pub fn word(&self, board: &mut VirtualBoard, field: Field) -> u16 {
        self.registers(board)[usize::from(address(field))]
    }

    /// A value of two registers.
    pub fn long(&self, board: &mut VirtualBoard, field: Field) -> u32 {
        let at = usize::from(address(field));
        let words = self.registers(board);
        u32::from(words[at]) << 16 | u32::from(words[at + 1])
    }

    /// Writes a holding register; whether it was taken.
    pub fn write(&self, board: &mut VirtualBoard, register: u16, value: u16) -> bool {
        let mut master = self.request();
        let mut request = Vec::new();
        master
            .generate_set_holding(register, value, &mut request)
            .expect("a request");
        let answer = ask(board, &request);
        master.parse_ok(&bytes(&answer)).is_ok()
    }

    /// Writes holding registers; whether they were taken.
    pub fn write_block(&self, board: &mut VirtualBoard, first: u16, values: &[u16]) -> bool {
        let mut master = self.request();
        let mut request = Vec::new();
        master
            .generate_set_holdings_bulk(first, values, &mut request)
            .expect("a request");
        let answer = ask(board, &request);
        master.parse_ok(&bytes(&answer)).is_ok()
    }

    /// Writes a configuration's words.
    pub fn stage(&self, board: &mut VirtualBoard, configuration: &Configuration) {
        let registers: Vec<u16> = configuration.registers().collect();
        for (first, part) in (STAGED..).step_by(100).zip(registers.chunks(100)) {
            assert!(self.write_block(board, first, part), "{first}");
        }
    }

    /// Holding registers.
    pub fn holding(&self, board: &mut VirtualBoard, first: u16, count: u16) -> Vec<u16> {
        let mut master = self.request();
        let mut request = Vec::new();
        master
            .generate_get_holdings(first, count, &mut request)
            .expect("a request");
        let answer = ask(board, &request);
        let mut words: Vec<u16> = Vec::new();
        master
            .parse_u16(&bytes(&answer), &mut words)
            .expect("an answer");
        words
    }

    /// Whether somebody answers at this address.
    pub fn is_answered(&self, board: &mut VirtualBoard) -> bool {
        let mut request = Vec::new();
        self.request()
            .generate_get_inputs(0, 1, &mut request)
            .expect("a request");
        !ask(board, &request).is_empty()
    }

    /// Key and command.
    pub fn command(&self, board: &mut VirtualBoard, command: u16) {
        assert!(self.write(board, 0, UNLOCK_KEY), "the key");
        assert!(self.write(board, 1, command), "the command");
    }
}

/// The checksum bit by bit, after the protocol's own description (Modbus over serial line V1.02, 6.2.2).
pub fn sealed(body: &[u8]) -> Vec<u8> {
    let crc = body.iter().fold(0xFFFF_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xA001 } else { 0 }
        })
    });
    [body, &crc.to_le_bytes()].concat()
}

/// Undisturbed bytes.
pub fn good(bytes: &[u8]) -> Vec<(u8, Quality)> {
    bytes.iter().map(|byte| (*byte, Quality::Good)).collect()
}

/// The bytes alone.
pub fn bytes(sent: &[Sent]) -> Vec<u8> {
    sent.iter().map(|sent| sent.byte).collect()
}

/// Functions that change nothing but a program's place of waiting: their next request may follow at once.
const BRISK: [u8; 5] = [3, 4, 20, 21, 43];
/// Emulated time between two looks at the line, s: longer than any character.
const LOOK_S: f64 = 0.005;

/// Sends a request and waits for the answer. What a write sets off gets its time too.
pub fn ask(board: &mut VirtualBoard, request: &[u8]) -> Vec<Sent> {
    board.take_sent(Port::Modbus);
    board.deliver(Port::Modbus, &good(request));
    let patience_s = CHARACTER_S * (2 * request.len() + 20) as f64 + 0.15;
    if !request
        .get(1)
        .is_some_and(|function| BRISK.contains(function))
    {
        board.run(patience_s).expect("a run");
        return board.take_sent(Port::Modbus);
    }
    let mut answer = Vec::new();
    for _ in 0..(patience_s / LOOK_S) as u32 {
        board.run(LOOK_S).expect("a run");
        let sent = board.take_sent(Port::Modbus);
        if sent.is_empty() && !answer.is_empty() {
            break;
        }
        answer.extend(sent);
    }
    answer
}

/// Register `Configuration` of constants that a master sent and confirmed.
pub const CONFIRMED: u16 = 1;
/// The fastest line that a board can be given, bit/s.
pub const FAST_BAUD: u32 = 115_200;

/// Configures the board's motor once more, with a line at [`FAST_BAUD`]. Samples pause while it is stored.
pub fn quicken(board: &mut VirtualBoard) {
    let master = Master::new(UNIT);
    let config = MonitorConfig::of_board(&motor()).expect("shipped");
    let mut wanted = Configuration::of("on a fast line", &MotorImage::new(&config));
    wanted.set_line(Line {
        baud: FAST_BAUD,
        ..Line::default()
    });
    master.stage(board, &wanted);
    master.command(board, Command::Commit as u16);
    board.set_peer_speed(Port::Modbus, FAST_BAUD);
    board.run(0.1).expect("a run");
    master.command(board, Command::Confirm as u16);
    board.run(1.0).expect("a run");
}
