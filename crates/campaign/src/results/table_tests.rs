//! Counting, on rows made up by hand.

use crate::planned::plan::Target;
use crate::results::detection::Direction;
use crate::results::table::Table;
use crate::runs::file::{About, Results};
use crate::runs::row::Row;

fn row(percent: f64, detected: bool) -> Row {
    Row {
        motor: "m".to_owned(),
        block: "b".to_owned(),
        fault: "i".to_owned(),
        phase: "a".to_owned(),
        change_percent: percent,
        healthy_judged_windows: 20,
        judged_windows: 50,
        detected,
        delay_s: if detected { 0.1 } else { f64::NAN },
        named: if detected { "Iq" } else { "" }.to_owned(),
        name_right: detected,
        ..Row::default()
    }
}

fn results(rows: Vec<Row>) -> Results {
    let target = Target {
        block: "b".to_owned(),
        fault: "i".to_owned(),
        percent: Some(5.0),
        limit: "noise".to_owned(),
        ..Target::default()
    };
    let about = About {
        plan: "p".to_owned(),
        seed: 1,
        runs: rows.len() as u64,
        fingerprint: String::new(),
        version: String::new(),
        targets: vec![target],
    };
    Results { about, rows }
}

fn many(percent: f64, runs: usize, detected: usize) -> impl Iterator<Item = Row> {
    (0..runs).map(move |k| row(percent, k < detected))
}

#[test]
fn the_smallest_size_is_the_one_from_which_on_all_are_detected() {
    let rows = many(2.0, 10, 10)
        .chain(many(5.0, 10, 9))
        .chain(many(10.0, 10, 10))
        .chain(many(20.0, 10, 10));
    let table = Table::of(&results(rows.collect()));
    let fault = &table.detection[0];
    // 2 % was lucky: 5 % is missed once.
    assert_eq!(
        (fault.smallest_percent, fault.or_smaller),
        (Some(10.0), false)
    );
    assert_eq!(
        (fault.target_met, fault.isolation_percent),
        (Some(false), Some(20.0))
    );
    assert_eq!(fault.sizes[1].detected.count, 9);
    assert_eq!(fault.sizes[1].delay_median_s, Some(0.1));
    // Named without its phase: the cause is right, the isolation is not.
    let isolation = fault.isolation().expect("a size");
    assert_eq!(
        (isolation.cause_right.count, isolation.isolated.count),
        (10, 0)
    );
}

#[test]
fn directions_and_dead_sensors_stand_apart() {
    let rows = many(-2.0, 4, 4)
        .chain(many(2.0, 4, 0))
        .chain(many(-100.0, 4, 4));
    let table = Table::of(&results(rows.collect()));
    let found = |direction: Direction| {
        let mut rows = table.detection.iter();
        let row = rows.find(|row| row.direction == direction).expect("a row");
        (row.smallest_percent, row.target_percent, row.or_smaller)
    };
    assert_eq!(found(Direction::Less), (Some(-2.0), Some(5.0), true));
    assert_eq!(found(Direction::More), (None, Some(5.0), false));
    assert_eq!(found(Direction::Dead), (Some(-100.0), Some(100.0), false));
}

#[test]
fn a_motor_that_stalls_says_nothing_about_detection() {
    let stalled = |row: Row| Row {
        judged_windows: 20,
        ..row
    };
    let rows = many(10.0, 10, 10).chain(many(50.0, 10, 0).map(stalled));
    let table = Table::of(&results(rows.collect()));
    let fault = &table.detection[0];
    assert_eq!(fault.smallest_percent, Some(10.0));
    assert_eq!((fault.unsteady.count, fault.sizes[1].detected.of), (10, 0));
}

#[test]
fn what_was_lit_before_is_no_detection() {
    let lit = |row: Row| Row {
        lit_before: true,
        healthy_fault_windows: 5,
        false_cause: "noise".to_owned(),
        ..row
    };
    let rows = many(5.0, 10, 10)
        .enumerate()
        .map(|(k, row)| if k < 6 { lit(row) } else { row });
    let table = Table::of(&results(rows.collect()));
    let fault = &table.detection[0];
    assert_eq!((fault.lit_before.count, fault.sizes[0].detected.of), (6, 4));
    assert_eq!(fault.smallest_percent, None);
    assert_eq!((table.healthy_windows, table.fault_windows), (200, 30));
    assert_eq!((table.alarms.len(), table.causes[0].runs), (6, 6));
}
