//! From a package to a program that has confirmed itself, over a line that loses and damages what it carries.

mod flash;
mod line;

use update::{Refusal, SecretKey};

use super::*;
use crate::crafted::program_of;
use line::{Faults, Shared};

fn key() -> SecretKey {
    SecretKey::from_seed([7; 32])
}

fn package(length: usize, version: &str) -> Package {
    Package::sign(program_of(length, version), &key()).expect("a program")
}

/// A board that runs version 1.2.3.
fn board(faults: Faults) -> Shared {
    Shared::new(&program_of(40_000, "1.2.3"), key().public(), faults)
}

/// What the command does, and what was heard meanwhile.
fn update(shared: &Shared, package: &Package) -> (Result<(), SendError>, Vec<Stage>, Vec<usize>) {
    let (mut line, mut pace) = (shared.line(), shared.clone());
    let (mut stages, mut sent) = (Vec::new(), Vec::new());
    let done = running(&mut line)
        .and_then(|runs| runs.may_be_followed_by(package))
        .and_then(|()| send(&mut line, package, &mut pace, &mut |bytes| sent.push(bytes)))
        .and_then(|()| install(&mut line, &mut pace))
        .and_then(|()| {
            wait(&mut line, package, &mut pace, &mut |stage| {
                stages.push(stage)
            })
        });
    (done, stages, sent)
}

fn runs(shared: &Shared) -> String {
    shared.look(|board| board.runs().version.to_string())
}

#[test]
fn a_program_is_sent_installed_tried_and_confirmed() {
    let shared = board(Faults::default());
    let package = package(50_001, "1.3.0");
    let (done, stages, sent) = update(&shared, &package);
    done.expect("confirmed");
    assert_eq!(runs(&shared), "1.3.0");
    assert_eq!(shared.look(|board| board.starts), 1);
    assert_eq!(sent.last(), Some(&package.bytes().len()));
    assert!(sent.is_sorted());
    assert_eq!(stages.first(), Some(&Stage::Checking));
    assert!(stages.contains(&Stage::Exchanging));
    let left: Vec<u16> = stages
        .iter()
        .filter_map(|stage| match stage {
            Stage::OnTrial(left) => Some(*left),
            _ => None,
        })
        .collect();
    assert!(
        left.first() > Some(&50) && left.is_sorted_by(|a, b| a >= b),
        "{left:?}"
    );
    let mut line = shared.line();
    assert_eq!(
        running(&mut line).expect("an answer").checksum,
        package.seal().checksum
    );
}

/// Beyond 128 KiB pieces go to another file.
#[test]
fn the_longest_program_fits() {
    let shared = board(Faults::default());
    update(&shared, &package(108 * 2_048, "2.0.0"))
        .0
        .expect("confirmed");
    assert_eq!(runs(&shared), "2.0.0");
}

#[test]
fn a_line_that_loses_and_damages_frames_only_takes_longer() {
    for (lost_requests, lost_answers, damaged_answers) in
        [(5, 0, 0), (0, 3, 0), (0, 0, 2), (7, 5, 11)]
    {
        let faults = Faults {
            lost_requests,
            lost_answers,
            damaged_answers,
            ..Faults::default()
        };
        let shared = board(faults);
        let (done, ..) = update(&shared, &package(20_000, "1.3.0"));
        assert!(done.is_ok(), "{done:?}, {faults:?}");
        assert_eq!(runs(&shared), "1.3.0");
    }
}

/// The board heard the order, and its answer was lost: by the next attempt it has started again.
#[test]
fn a_lost_answer_to_the_order_is_no_failure() {
    for dark in 0..6 {
        let shared = board(Faults::default());
        let (mut line, mut pace) = (shared.line(), shared.clone());
        let package = package(20_000, "1.3.0");
        send(&mut line, &package, &mut pace, &mut |_| {}).expect("received");
        shared.look(|board| board.faults.dark = (board.requests + 1, board.requests + dark));
        install(&mut line, &mut pace).expect("heard, or it starts again");
        wait(&mut line, &package, &mut pace, &mut |_| {}).expect("confirmed");
        assert_eq!(runs(&shared), "1.3.0", "{dark}");
    }
}

#[test]
fn a_board_that_starts_again_meanwhile_gets_it_from_the_beginning() {
    let shared = board(Faults {
        restart_at: 60,
        ..Faults::default()
    });
    let (done, _, sent) = update(&shared, &package(20_000, "1.3.0"));
    done.expect("confirmed");
    assert_eq!(
        sent.iter().filter(|bytes| **bytes == 0).count(),
        2,
        "two beginnings"
    );
    assert_eq!(runs(&shared), "1.3.0");
}

#[test]
fn a_line_that_dies_ends_it_and_nothing_changes() {
    let shared = board(Faults {
        dead_from: 60,
        ..Faults::default()
    });
    let (done, ..) = update(&shared, &package(20_000, "1.3.0"));
    let told = done.expect_err("dead").to_string();
    assert!(told.contains("no answer from unit 1"), "{told}");
    assert_eq!(
        (runs(&shared), shared.look(|board| board.starts)),
        ("1.2.3".into(), 0)
    );
}

#[test]
fn a_person_who_stops_it_is_told_that_nothing_changed() {
    let shared = board(Faults {
        stop_at: 60,
        ..Faults::default()
    });
    let (done, ..) = update(&shared, &package(20_000, "1.3.0"));
    let told = done.expect_err("stopped").to_string();
    assert!(
        told.contains("of 20064 bytes; the board runs its program on as before"),
        "{told}"
    );
    assert_eq!(runs(&shared), "1.2.3");
    // The next transfer begins at the beginning and comes to its end.
    shared.look(|board| board.faults.stop_at = 0);
    update(&shared, &package(22_000, "1.4.0"))
        .0
        .expect("confirmed");
    assert_eq!(runs(&shared), "1.4.0");
}

#[test]
fn an_older_program_is_refused_before_it_is_sent_and_by_the_board_too() {
    let shared = board(Faults::default());
    let older = package(20_000, "1.2.2");
    let (done, _, sent) = update(&shared, &older);
    let told = done.expect_err("older").to_string();
    assert!(
        told.contains("holds version 1.2.2, the board runs 1.2.3"),
        "{told}"
    );
    assert!(sent.is_empty());
    let (mut line, mut pace) = (shared.line(), shared.clone());
    send(&mut line, &older, &mut pace, &mut |_| {}).expect("received");
    install(&mut line, &mut pace).expect("heard");
    let refused = wait(&mut line, &older, &mut pace, &mut |_| {});
    assert!(matches!(
        refused,
        Err(SendError::Refused {
            refusal: Refusal::Older
        })
    ));
    assert_eq!(runs(&shared), "1.2.3");
}

#[test]
fn a_signature_with_another_key_is_refused_by_the_loader() {
    let shared = board(Faults::default());
    let stranger = SecretKey::from_seed([8; 32]);
    let package = Package::sign(program_of(20_000, "1.3.0"), &stranger).expect("a program");
    let (done, ..) = update(&shared, &package);
    let told = done.expect_err("refused").to_string();
    assert!(
        told.contains("not signed with this board's key; sign it with"),
        "{told}"
    );
    assert_eq!(
        (runs(&shared), shared.look(|board| board.starts)),
        ("1.2.3".into(), 1)
    );
}

#[test]
fn a_program_that_does_not_confirm_itself_is_told_to_be_gone() {
    let shared = board(Faults {
        doubts: true,
        ..Faults::default()
    });
    let (done, stages, _) = update(&shared, &package(20_000, "1.3.0"));
    assert!(matches!(done, Err(SendError::BroughtBack)), "{done:?}");
    assert!(stages.contains(&Stage::OnTrial(60)));
    assert_eq!(
        (runs(&shared), shared.look(|board| board.starts)),
        ("1.2.3".into(), 2)
    );
}

#[test]
fn a_board_with_a_program_on_trial_takes_no_other() {
    let shared = board(Faults {
        doubts: true,
        ..Faults::default()
    });
    let (mut line, mut pace) = (shared.line(), shared.clone());
    let first = package(20_000, "1.3.0");
    send(&mut line, &first, &mut pace, &mut |_| {}).expect("received");
    install(&mut line, &mut pace).expect("heard");
    pace.pause(Duration::from_secs(40));
    let (done, ..) = update(&shared, &package(20_000, "1.4.0"));
    let told = done.expect_err("busy").to_string();
    assert!(
        told.contains("takes no program now: one is on trial"),
        "{told}"
    );
    assert_eq!(runs(&shared), "1.3.0");
}

#[test]
fn a_program_from_before_updates_says_so() {
    let shared = board(Faults {
        unable: true,
        ..Faults::default()
    });
    let (done, ..) = update(&shared, &package(20_000, "1.3.0"));
    assert!(matches!(done, Err(SendError::Unable)), "{done:?}");
}
