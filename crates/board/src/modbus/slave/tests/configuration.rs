//! Words of a configuration: written in blocks, read back, and nothing else changed.

use super::*;
use crate::configuration::{ACTIVE, CONFIGURATION_REGISTERS, STAGED};

/// A master from elsewhere writes a block of registers.
fn write_block(desk: &mut Desk, first: u16, values: &[u16]) -> bool {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_set_holdings_bulk(first, values, &mut request)
        .expect("a request");
    let mut slave = Slave::new(UNIT);
    let (answer, command) = ask_of(&mut slave, 0, &request, &counting, desk);
    assert_eq!(command, None);
    master.parse_ok(&answer).is_ok()
}

fn read_block(desk: &mut Desk, first: u16, count: u16) -> Vec<u16> {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_get_holdings(first, count, &mut request)
        .expect("a request");
    let (answer, _) = ask_of(&mut Slave::new(UNIT), 0, &request, &counting, desk);
    let mut words: Vec<u16> = Vec::new();
    master.parse_u16(&answer, &mut words).expect("an answer");
    words
}

#[test]
fn a_configuration_is_written_and_read_in_blocks_without_touching_what_holds() {
    let mut desk = desk();
    let active = desk.active().clone();
    let values: Vec<u16> = (0..CONFIGURATION_REGISTERS).map(|at| at ^ 0x1234).collect();
    for (k, part) in values.chunks(123).enumerate() {
        assert!(write_block(&mut desk, STAGED + 123 * k as u16, part));
    }
    let read: Vec<u16> = (0..CONFIGURATION_REGISTERS)
        .step_by(125)
        .flat_map(|at| {
            let count = 125.min(CONFIGURATION_REGISTERS - at);
            read_block(&mut desk, STAGED + at, count)
        })
        .collect();
    assert_eq!(read, values);
    assert_eq!(desk.active(), &active);
    let held = read_block(&mut desk, ACTIVE, 2);
    assert_eq!(
        held,
        [(active.words()[0] >> 16) as u16, active.words()[0] as u16]
    );
}

#[test]
fn blocks_beyond_the_staged_configuration_are_refused_whole() {
    let mut desk = desk();
    let before = desk.staged().clone();
    let end = STAGED + CONFIGURATION_REGISTERS;
    for first in [STAGED - 1, end - 1, ACTIVE, 2] {
        assert!(!write_block(&mut desk, first, &[1, 2]), "{first}");
    }
    assert_eq!(desk.staged(), &before);
    let [high, low] = (end - 1).to_be_bytes();
    let (function, data) = answered_at(&[UNIT, 3, high, low, 0, 2], &mut desk);
    assert_eq!((function, &data[..]), (0x83, &[2][..]));
}
