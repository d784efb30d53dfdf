//! Frames that are no sound requests, over the wire into the unmodified firmware: no reset, no lost sample, no wrong write.
//!
//! The line is as fast as it can be configured, so that a frame takes some 5 ms; an ordinary run sends a few thousand, MODBUS_FRAMES
//! says how many.
//! `cargo test -p board modbus` gives the slave's own code a million.

mod common;

use board::modbus::{Field, UNLOCK_KEY, WORDS, address};
use common::master::{CONFIRMED, FAST_BAUD, UNIT, quicken, sealed};
use common::{LAMP_TEST_S, board as board_of, scenario};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use virtual_board::{Port, Quality, VirtualBoard};

const DEFAULT_FRAMES: u32 = 2_000;
/// A character of 11 bits, s.
const CHARACTER_S: f64 = 11.0 / FAST_BAUD as f64;
/// The silence that ends a frame (1.75 ms), and until the sample loop lets the slave answer (a block's work, 0.1 ms).
const PATIENCE_S: f64 = 0.004;
/// Frames between two looks at the registers.
const LOOK_EVERY: u32 = 500;

/// Key and the command to learn in one request, for `unit`.
fn unlock_and_learn(unit: u8) -> Vec<u8> {
    let [high, low] = UNLOCK_KEY.to_be_bytes();
    sealed(&[unit, 16, 0, 0, 0, 2, 4, high, low, 0, 2])
}

/// A frame, and whether the protocol demands an answer.
fn frame(random: &mut Pcg64Mcg) -> (Vec<u8>, bool) {
    let mut rubbish = |most| -> Vec<u8> {
        let length = random.random_range(1..=most);
        (0..length).map(|_| random.random()).collect()
    };
    let bytes = rubbish(12);
    match random.random_range(0..8) {
        0 => (bytes, false),
        1 => {
            let mut damaged = unlock_and_learn(UNIT);
            let bit = random.random_range(0..8 * damaged.len());
            damaged[bit / 8] ^= 1 << (bit % 8);
            (damaged, false)
        }
        2 => {
            let others = [0, 2, 17, 246, 247];
            let unit = others[random.random_range(0..others.len())];
            (unlock_and_learn(unit), false)
        }
        // Sound, but locked: an answer that refuses.
        3 => (
            sealed(&[UNIT, 6, 0, 1, 0, random.random_range(1..=2)]),
            true,
        ),
        // Any function but the two that write.
        4 => {
            let function = [1, 2, 5, 7, 8, 15, 17, 20, 22, 23, 43, 255][usize::from(bytes[0]) % 12];
            (sealed(&[&[UNIT, function], &bytes[1..]].concat()), true)
        }
        // A part of a file that there may be.
        5 => {
            let mut parts = vec![UNIT, 20, 7, 6, 0, random.random_range(0..=2)];
            parts.extend([random.random_range(0..0x24), random.random(), 0]);
            parts.push(random.random_range(0..=130));
            (sealed(&parts), true)
        }
        // A word of a configuration or beside it; what is written there is checked before it holds.
        6 => {
            let [high, low] = random.random_range(900..3_000_u16).to_be_bytes();
            (
                sealed(&[UNIT, 6, high, low, random.random(), random.random()]),
                true,
            )
        }
        // A write of the wrong length.
        _ => {
            let [high, low] = UNLOCK_KEY.to_be_bytes();
            (sealed(&[UNIT, 6, 0, 0, high, low, bytes[0]]), true)
        }
    }
}

/// Sends a frame and gives what is answered.
fn ask(board: &mut VirtualBoard, frame: &[u8], quality: impl Fn(usize) -> Quality) -> Vec<u8> {
    let wire: Vec<_> = frame
        .iter()
        .enumerate()
        .map(|(k, byte)| (*byte, quality(k)))
        .collect();
    board.deliver(Port::Modbus, &wire);
    let seconds = CHARACTER_S * (frame.len() + 1) as f64 + PATIENCE_S;
    board.run(seconds).expect("a run");
    let mut answer = Vec::new();
    loop {
        let sent = board.take_sent(Port::Modbus);
        if sent.is_empty() {
            return answer;
        }
        answer.extend(sent.iter().map(|sent| sent.byte));
        board.run(4.0 * CHARACTER_S).expect("a run");
    }
}

/// Registers from `first` on, read with `function`.
fn read(board: &mut VirtualBoard, function: u8, first: u16, count: u16) -> Vec<u16> {
    let [[a, b], [c, d]] = [first, count].map(u16::to_be_bytes);
    let answer = ask(board, &sealed(&[UNIT, function, a, b, c, d]), |_| {
        Quality::Good
    });
    let length = 3 + 2 * usize::from(count);
    assert_eq!(answer, sealed(&answer[..length]), "a sound answer");
    let (words, _) = answer[3..length].as_chunks::<2>();
    words.iter().map(|word| u16::from_be_bytes(*word)).collect()
}

fn assert_nothing_happened(board: &mut VirtualBoard, missed: u64, after: u32) {
    let words = read(board, 4, 0, WORDS as u16);
    let word = |field| words[usize::from(address(field))];
    assert_eq!(word(Field::Learning), 0, "after {after} frames");
    assert_eq!(word(Field::Verdict), 1, "after {after} frames");
    assert_eq!(
        word(Field::Configuration),
        CONFIRMED,
        "after {after} frames"
    );
    assert_eq!(word(Field::ConfigurationRefused), 0, "after {after} frames");
    assert_eq!(read(board, 3, 0, 1), [0], "unlocked after {after} frames");
    let tally = board.tally();
    let troubles = (tally.resets, tally.missed_triggers);
    assert_eq!(troubles, (0, missed), "{tally:?}");
}

/// A board that judges, on a fast line.
fn fast_board(seconds: f64) -> VirtualBoard {
    let mut board = board_of(&scenario(seconds));
    board.forget_taken();
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    quicken(&mut board);
    board
}

#[test]
fn frames_that_are_no_sound_requests_change_nothing() {
    let asked = std::env::var("MODBUS_FRAMES").ok();
    let frames: u32 = asked
        .and_then(|text| text.parse().ok())
        .unwrap_or(DEFAULT_FRAMES);
    let mut board = fast_board(20.0 + 0.1 * f64::from(frames));
    // While constants change nothing is sampled.
    let missed = board.tally().missed_triggers;
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut answers = 0;
    for sent in 1..=frames {
        let (bytes, answered) = frame(&mut random);
        // Half of the rubbish is disturbed on the wire too.
        let disturbed = !answered && random.random_bool(0.5);
        let answer = ask(&mut board, &bytes, |k| match (disturbed, k % 3) {
            (true, 0) => Quality::Bad,
            _ => Quality::Good,
        });
        assert_eq!(!answer.is_empty(), answered, "{bytes:02x?}: {answer:02x?}");
        answers += u32::from(answered);
        if sent % LOOK_EVERY == 0 || sent == frames {
            assert_nothing_happened(&mut board, missed, sent);
        }
        if sent % 50_000 == 0 {
            println!("{sent} of {frames} frames");
        }
    }
    println!("{frames} frames, {answers} of them refused with an answer, no reset, no write");
}
