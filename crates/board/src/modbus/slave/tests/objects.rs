//! Identification and files: functions 43 and 20.

use super::super::super::identity::Object;
use super::*;
use crate::events::{EVENT_BYTES, LOG_EVENTS};
use crate::frames::capture::CAPTURE_BYTES;
use crate::modbus::{CAPTURE_FILE, EVENT_FILE, MOST_FILE_WORDS, SECONDS_FILE};
use crate::seconds::{SECOND_BYTES, SECONDS};

/// All objects from `first` on, as a client of the specification collects them, and how many answers that took.
fn identified(kind: u8, mut first: u8) -> (Vec<(u8, std::string::String)>, u32) {
    let (mut objects, mut answers) = (Vec::new(), 0);
    loop {
        let (function, data) = answered(&[UNIT, 43, 14, kind, first]);
        assert_eq!((function, &data[..3]), (43, &[14, kind, 0x83][..]));
        let [follows, next, count] = data[3..6] else {
            panic!("too short")
        };
        let mut rest = &data[6..];
        for _ in 0..count {
            let (value, tail) = rest[2..].split_at(usize::from(rest[1]));
            let text = core::str::from_utf8(value).expect("text").into();
            objects.push((rest[0], text));
            rest = tail;
        }
        assert!(rest.is_empty());
        answers += 1;
        match follows {
            0 => return (objects, answers),
            _ => first = next,
        }
    }
}

#[test]
fn the_board_says_who_it_is_in_as_many_answers_as_that_takes() {
    let (all, answers) = identified(3, 0);
    assert_eq!(answers, 2);
    let numbers: Vec<u8> = all.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, Object::ALL.map(|object| object as u8));
    let of = |object: Object| {
        let found = all.iter().find(|(number, _)| *number == object as u8);
        found.map(|(_, text)| text.as_str()).expect("an object")
    };
    assert_eq!(of(Object::Version), "1.2.3");
    assert_eq!(of(Object::Serial), "00123456789abcdef000000f");
    assert_eq!(of(Object::MapVersion), "2");
    assert_eq!(of(Object::Motor), &MOTOR[..64]);
    assert_eq!(identified(1, 0).0, all[..3]);
    assert_eq!(identified(2, 0).0, all[..6]);
    assert_eq!(identified(3, 0x82).0, all[8..]);
    // No such object: from the beginning.
    assert_eq!(identified(1, 0x50).0, all[..3]);
    for (k, object) in Object::ALL.into_iter().enumerate() {
        assert_eq!(identified(4, object as u8).0, all[k..=k]);
    }
}

#[test]
fn what_no_identification_is_gets_an_exception() {
    assert_eq!(refused(&[UNIT, 43, 14, 4, 0x50]), 2, "no such object");
    assert_eq!(refused(&[UNIT, 43, 14, 0, 0]), 3, "no such group");
    assert_eq!(refused(&[UNIT, 43, 14, 1]), 3, "too short");
    assert_eq!(refused(&[UNIT, 43, 13, 1, 0]), 1, "another interface");
    assert_eq!(refused(&[UNIT, 43]), 1, "nothing");
}

/// A request for parts of files: file, first word, words.
fn file_request(parts: &[(u16, u16, u16)]) -> Vec<u8> {
    let mut request = vec![UNIT, 20, 7 * parts.len() as u8];
    for (file, first, words) in parts {
        request.push(6);
        for word in [file, first, words] {
            request.extend(word.to_be_bytes());
        }
    }
    request
}

#[test]
fn events_are_read_as_a_file_in_the_order_of_their_bytes() {
    let (_, data) = answered(&file_request(&[(EVENT_FILE, 16, MOST_FILE_WORDS)]));
    let bytes = 2 * usize::from(MOST_FILE_WORDS);
    assert_eq!(data.len(), 3 + bytes);
    assert_eq!(data[..3], [2 + bytes as u8, 1 + bytes as u8, 6]);
    let expected: Vec<u8> = (EVENT_BYTES..EVENT_BYTES + bytes)
        .map(|at| at as u8)
        .collect();
    assert_eq!(data[3..], expected);
    let (_, two) = answered(&file_request(&[(EVENT_FILE, 0, 1), (EVENT_FILE, 8, 2)]));
    assert_eq!(two, [10, 3, 6, 0, 1, 5, 6, 16, 17, 18, 19]);
}

#[test]
fn seconds_are_the_second_file_and_one_request_may_read_both() {
    let (_, data) = answered(&file_request(&[(EVENT_FILE, 1, 1), (SECONDS_FILE, 1, 1)]));
    assert_eq!(data, [8, 3, 6, 2, 3, 3, 6, !2, !3]);
    let words = (6 * SECOND_BYTES / 2) as u16;
    let (_, six) = answered(&file_request(&[(SECONDS_FILE, 0, words)]));
    assert_eq!(six.len(), 3 + 6 * SECOND_BYTES);
    let end = (SECONDS as usize * SECOND_BYTES / 2) as u16;
    assert_eq!(refused(&file_request(&[(SECONDS_FILE, end - 1, 2)])), 2);
}

#[test]
fn the_samples_around_an_alarm_are_the_third_file() {
    let end = (CAPTURE_BYTES / 2) as u16;
    let (_, last) = answered(&file_request(&[(CAPTURE_FILE, end - 1, 1)]));
    let at = CAPTURE_BYTES - 2;
    assert_eq!(last, [4, 3, 6, at as u8, (at + 1) as u8]);
    assert_eq!(refused(&file_request(&[(CAPTURE_FILE, end - 1, 2)])), 2);
}

#[test]
fn parts_of_files_that_do_not_exist_get_an_exception() {
    let end = (LOG_EVENTS * EVENT_BYTES as u32 / 2) as u16;
    assert_eq!(refused(&file_request(&[(9, 0, 1)])), 2, "no such file");
    assert_eq!(refused(&file_request(&[(EVENT_FILE, end, 1)])), 2);
    assert_eq!(refused(&file_request(&[(EVENT_FILE, end - 1, 2)])), 2);
    assert_eq!(refused(&file_request(&[(EVENT_FILE, 0, 0)])), 3);
    assert_eq!(
        refused(&file_request(&[(EVENT_FILE, 0, 125)])),
        3,
        "too long"
    );
    let twice = [(EVENT_FILE, 0, MOST_FILE_WORDS); 2];
    assert_eq!(refused(&file_request(&twice)), 3, "too long together");
    assert_eq!(refused(&[UNIT, 20, 7, 6, 0, 1, 0, 0]), 3, "too short");
    assert_eq!(refused(&[UNIT, 20, 0]), 3, "nothing asked");
}

#[test]
fn a_log_that_is_being_erased_is_busy() {
    let busy = |_: usize, _: &mut [u8]| false;
    let request = sealed(&file_request(&[(EVENT_FILE, 0, 16)]));
    let (answer, _) = ask_of(&mut Slave::new(UNIT), 0, &request, &busy, &mut desk());
    assert_eq!(answer[..3], [UNIT, 20 | 0x80, 6]);
}
