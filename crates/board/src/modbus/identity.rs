//! Function 43, type 14: who the board is, as text.

use heapless::Vec;

use super::answer::Answer;
use super::entry::Field;
use super::exception::Exception;
use super::map::MAP_VERSION;
use super::memory::Memory;
use crate::configuration::{Configuration, NAME_BYTES};

/// Type 14 of function 43: device identification.
const TYPE: u8 = 14;
/// All three groups, as streams and one by one.
const CONFORMITY: u8 = 0x83;
/// Kinds of requests: the first three are groups, the fourth a single object.
const SINGLE: u8 = 4;
/// Longest value, bytes: the motor's name.
const MOST_BYTES: usize = NAME_BYTES;

const VENDOR: &str = "drive-monitor (open source)";
const PRODUCT_CODE: &str = "DM-G474";
const PRODUCT: &str = "three-phase induction motor monitor";
const MODEL: &str = "STM32G474RE";

/// What can be asked for. The numbers are the protocol's, from 0x80 on the board's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[allow(missing_docs)] // The labels say it, for the documentation too.
pub enum Object {
    Vendor = 0x00,
    ProductCode = 0x01,
    Version = 0x02,
    ProductName = 0x04,
    Model = 0x05,
    Motor = 0x06,
    Revision = 0x80,
    Program = 0x81,
    MapVersion = 0x82,
    Serial = 0x83,
    MotorIdentification = 0x84,
    Calibration = 0x85,
}

type Value = Vec<u8, MOST_BYTES>;

impl Object {
    /// All of them, in the order of their numbers.
    pub const ALL: [Object; 12] = [
        Object::Vendor,
        Object::ProductCode,
        Object::Version,
        Object::ProductName,
        Object::Model,
        Object::Motor,
        Object::Revision,
        Object::Program,
        Object::MapVersion,
        Object::Serial,
        Object::MotorIdentification,
        Object::Calibration,
    ];

    /// By its number.
    pub fn by_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|object| *object as u8 == number)
    }

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Object::Vendor => "vendor",
            Object::ProductCode => "product code",
            Object::Version => "version",
            Object::ProductName => "product",
            Object::Model => "chip",
            Object::Motor => "motor",
            Object::Revision => "source revision",
            Object::Program => "program checksum",
            Object::MapVersion => "register map version",
            Object::Serial => "serial number",
            Object::MotorIdentification => "motor constants",
            Object::Calibration => "calibration",
        }
    }

    fn value(self, memory: &Memory<'_>) -> Value {
        let (identity, image) = (memory.identity, memory.image);
        match self {
            Object::Vendor => text(VENDOR),
            Object::ProductCode => text(PRODUCT_CODE),
            Object::Version => text(identity.version),
            Object::ProductName => text(PRODUCT),
            Object::Model => text(MODEL),
            Object::Motor => name(memory.desk.active()),
            Object::Revision => text(identity.revision),
            Object::Program => hexadecimal(&[image.long(Field::ProgramChecksum)]),
            Object::MapVersion => digit(MAP_VERSION),
            Object::Serial => hexadecimal(&identity.serial),
            Object::MotorIdentification => hexadecimal(&[image.long(Field::MotorIdentification)]),
            Object::Calibration => hexadecimal(&[image.long(Field::CalibrationIdentification)]),
        }
    }
}

/// As much of the text as fits, whole characters only.
fn text(text: &str) -> Value {
    let mut value = Value::new();
    let mut buffer = [0; 4];
    for character in text.chars() {
        let bytes = character.encode_utf8(&mut buffer).as_bytes();
        if value.extend_from_slice(bytes).is_err() {
            break;
        }
    }
    value
}

/// Of the motor.
fn name(active: &Configuration) -> Value {
    text(active.name().text().unwrap_or_default())
}

fn digit(number: u16) -> Value {
    let mut value = Value::new();
    let _ = value.push(b'0' + (number % 10) as u8);
    value
}

fn hexadecimal(words: &[u32]) -> Value {
    let mut value = Value::new();
    for byte in words.iter().flat_map(|word| word.to_be_bytes()) {
        for four in [byte >> 4, byte & 0xF] {
            let letter = if four < 10 { b'0' } else { b'a' - 10 };
            let _ = value.push(letter + four);
        }
    }
    value
}

/// Last object of a group; its first is 0.
fn last_of(kind: u8) -> Option<u8> {
    match kind {
        1 => Some(0x02),
        2 => Some(0x7F),
        3 => Some(0xFF),
        _ => None,
    }
}

/// Answers a request for one object or for a group of them, which may take several answers.
pub(super) fn read(
    data: &[u8],
    memory: &Memory<'_>,
    answer: &mut Answer<'_>,
) -> Result<(), Exception> {
    let [TYPE, kind, first] = *data else {
        return Err(match data {
            [TYPE, ..] => Exception::Value,
            _ => Exception::Function,
        });
    };
    answer.push_all(&[TYPE, kind, CONFORMITY]);
    if kind == SINGLE {
        let object = Object::by_number(first).ok_or(Exception::Address)?;
        answer.push_all(&[0, 0, 1]);
        push(object, &object.value(memory), answer);
        return Ok(());
    }
    let last = last_of(kind).ok_or(Exception::Value)?;
    // The protocol begins anew where it is asked for an object that does not exist.
    let first = Object::by_number(first).map_or(0, |_| first);
    let (follows, at) = (answer.length(), answer.length() + 1);
    answer.push_all(&[0, 0, 0]);
    let mut count = 0;
    let wanted = |object: &Object| (first..=last).contains(&(*object as u8));
    for object in Object::ALL.into_iter().filter(wanted) {
        let value = object.value(memory);
        if answer.room() < 2 + value.len() {
            answer.set(follows, 0xFF);
            answer.set(at, object as u8);
            break;
        }
        push(object, &value, answer);
        count += 1;
        answer.set(at + 1, count);
    }
    Ok(())
}

fn push(object: Object, value: &Value, answer: &mut Answer<'_>) {
    answer.push(object as u8);
    answer.push(value.len() as u8);
    answer.push_all(value);
}
