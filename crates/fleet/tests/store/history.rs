//! History: trends from each level, what is thinned when, files for other programs.

use fleet::{Entry, Limits, Reader, Store, ThinnedTo};

use super::{DAY, HOUR, all, event, id, plant, second, seconds};

/// Sum of seconds and the mean speed of a trend, weighed by them.
fn sums(store: &Store, from: i64, to: i64, points: usize) -> (u32, f64, f32, f32) {
    let trend = store.trend(&id("a"), from, to, points).unwrap();
    assert!(trend.points.len() <= points);
    let seconds = trend.points.iter().map(|p| p.seconds).sum::<u32>();
    let speeds = trend
        .points
        .iter()
        .filter_map(|p| p.speed_rpm.map(|v| (p.seconds, v)));
    let (mut sum, mut min, mut max) = (0.0, f32::MAX, f32::MIN);
    for (n, v) in speeds {
        sum += f64::from(n) * f64::from(v.mean);
        (min, max) = (min.min(v.min), max.max(v.max));
    }
    (seconds, sum / f64::from(seconds), min, max)
}

#[test]
fn a_trend_is_the_same_from_seconds_blocks_minutes_and_hours() {
    // Speed is the number of the second: the mean of 1 to n is (n + 1) / 2.
    let limits = Limits {
        seconds_days: 1,
        minutes_days: 2,
        hours_days: 3,
        ..Limits::default()
    };
    let (_folder, _path, store) = plant(&limits, &["a"]);
    let n = 30_000;
    for part in 0..10 {
        store
            .append(&seconds("a", part * n / 10 + 1..=(part + 1) * n / 10))
            .unwrap();
        if part == 5 {
            store.seal().unwrap();
        }
    }
    let end = DAY + i64::from(n) * 1000;
    let holds = |store: &Store, points: usize, what: &str| {
        let (seconds, mean, min, max) = sums(store, DAY, end, points);
        assert_eq!(seconds, n, "{what}");
        // A float of 15 bits of fraction, and means of f32.
        let near = |a: f64, b: f64| (a - b).abs() <= b * 2_f64.powi(-15);
        assert!(near(mean, f64::from(n + 1) / 2.0), "{what}: mean {mean}");
        assert!(
            near(min.into(), 1.0) && near(max.into(), n.into()),
            "{what}: {min} to {max}"
        );
    };
    holds(&store, 1000, "half of it sealed");
    store.seal().unwrap();
    holds(&store, 1000, "sealed");
    holds(&store, 5, "sealed, hours");
    store.maintain(DAY + 50 * HOUR).unwrap();
    holds(&store, 400, "minutes");
    holds(&store, 5, "minutes, hours");
    store.maintain(DAY + 80 * HOUR).unwrap();
    holds(&store, 400, "hours alone");
    // A point of a minute has the minute's own extremes.
    store.maintain(DAY + 120 * HOUR).unwrap();
    assert_eq!(sums(&store, DAY, end, 5).0, 0);
    let said: Vec<_> = all(&store)
        .into_iter()
        .filter_map(|entry| match entry {
            Entry::Thinned(thinned) => Some((thinned.to, thinned.before_ms)),
            _ => None,
        })
        .collect();
    let day = 24 * HOUR;
    let expected = [
        (ThinnedTo::Minutes, DAY + day),
        (ThinnedTo::Hours, DAY + day),
        (ThinnedTo::HoursDropped, DAY + 2 * day),
    ];
    assert_eq!(said, expected);
}

#[test]
fn a_trend_of_one_second_a_point_shows_each_second() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    store.append(&seconds("a", 1..=50)).unwrap();
    store.seal().unwrap();
    store.append(&seconds("a", 51..=100)).unwrap();
    let trend = store.trend(&id("a"), DAY, DAY + 100_000, 100).unwrap();
    assert_eq!((trend.step_ms, trend.points.len()), (1000, 100));
    for (point, number) in trend.points.iter().zip(1_u32..) {
        assert_eq!(point.seconds, 1);
        assert_eq!((point.windows, point.judged, point.lamps), (4, 3, 1));
        assert_eq!(
            point.speed_rpm.map(|v| (v.min, v.max)),
            Some((number as f32, number as f32))
        );
        assert_eq!((point.current_a, point.residuals[3]), (None, None));
        assert_eq!(point.residuals[2].map(|v| v.mean), Some(0.25));
    }
    assert!(
        store
            .trend(&id("a"), DAY + 100_000, DAY, 10)
            .unwrap()
            .points
            .is_empty()
    );
}

#[test]
fn a_queue_that_nobody_takes_is_cut_and_that_is_said() {
    let limits = Limits {
        queue_seconds: 10_000,
        ..Limits::default()
    };
    let (_folder, _path, store) = plant(&limits, &["a"]);
    store.declare_sinks(&["away"]).unwrap();
    store.append(&seconds("a", 1..=15_000)).unwrap();
    store.append(&[(id("a"), event(1))]).unwrap();
    store.maintain(DAY).unwrap();
    let left = all(&store);
    let kept = left
        .iter()
        .filter(|e| matches!(e, Entry::Second(_)))
        .count();
    assert!((8_000..=10_000).contains(&kept), "{kept}");
    assert!(left.contains(&event(1)));
    let said = left.iter().find_map(|e| match e {
        Entry::Thinned(thinned) => Some((thinned.to, thinned.count)),
        _ => None,
    });
    assert_eq!(said, Some((ThinnedTo::QueueCut, 15_000 - kept as u64)));
    let trend = store.trend(&id("a"), DAY, DAY + 24 * HOUR, 1).unwrap();
    assert_eq!(
        trend.points[0].seconds, 15_000,
        "what was cut is in the history"
    );
}

/// Fills a store of the least size with noise, so that it must thin within its newest day.
#[test]
fn a_full_store_thins_its_oldest_seconds_and_keeps_every_event() {
    use rand::{Rng, SeedableRng};
    let limits = Limits {
        bytes: 16_000_000,
        ..Limits::default()
    };
    let (_folder, _path, store) = plant(&limits, &["a"]);
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
    let (days, mut events) = (13, 0);
    for day in 0..days {
        let mut batch = Vec::new();
        for s in 1..=86_400_u32 {
            let mut new = second(1, day * 86_400 + s);
            let volt = rng.random_range(100.0..400.0_f32);
            let (amp, rpm) = (
                rng.random_range(8.0..12.0),
                rng.random_range(1440.0..1500.0),
            );
            (new.voltage_v, new.current_a, new.speed_rpm) = (Some(volt), Some(amp), Some(rpm));
            new.residuals = Some(std::array::from_fn(|_| rng.random_range(-3.0..3.0)));
            batch.push((id("a"), Entry::Second(new)));
        }
        events += 1;
        batch.push((id("a"), event(events)));
        store.append(&batch).unwrap();
        store.seal().unwrap();
        store
            .maintain(DAY + i64::from(day + 1) * 24 * HOUR)
            .unwrap();
        assert!(store.bytes().unwrap() <= limits.bytes, "day {day}");
    }
    let left = all(&store);
    let kept = left.iter().filter(|e| matches!(e, Entry::Event(_))).count();
    assert_eq!(kept as u32, events);
    let because = left.iter().filter_map(|e| match e {
        Entry::Thinned(thinned) if thinned.why == "bytes" => Some(thinned.to),
        _ => None,
    });
    assert!(because.clone().count() > 0);
    assert!(!because.clone().any(|to| to == ThinnedTo::EntriesDropped));
    // Every second is still counted, if only in its hour.
    let end = DAY + i64::from(days) * 24 * HOUR;
    let trend = store.trend(&id("a"), DAY, end, 12).unwrap();
    assert_eq!(
        trend.points.iter().map(|p| p.seconds).sum::<u32>(),
        days * 86_400
    );
}

/// Read back by the library's own reader, row by row, without the types that wrote it.
#[test]
fn a_day_as_parquet_has_every_second_once() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;
    let (folder, path, store) = plant(&Limits::default(), &["b", "a"]);
    store.append(&seconds("a", 1..=1_000)).unwrap();
    store.seal().unwrap();
    // These wait in the queue.
    store.append(&seconds("b", 1..=500)).unwrap();
    let reader = Reader::open(&path).unwrap();
    let file = folder.path().join("day.parquet");
    // From second 101 on.
    assert_eq!(
        reader
            .export_seconds(DAY + 100_000, DAY + 24 * HOUR, &file)
            .unwrap(),
        1_300
    );
    let written = SerializedFileReader::new(std::fs::File::open(&file).unwrap()).unwrap();
    let rows: Vec<_> = written
        .get_row_iter(None)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let expected = (101..=1_000)
        .map(|n| ("a", n))
        .chain((101..=500).map(|n| ("b", n)));
    assert_eq!(rows.len(), 1_300);
    for (row, (motor, number)) in rows.iter().zip(expected) {
        let names: Vec<_> = row
            .get_column_iter()
            .map(|(name, _)| name.as_str())
            .collect();
        let at = |name: &str| names.iter().position(|n| *n == name).unwrap();
        assert_eq!(row.get_string(at("motor")).unwrap(), motor);
        assert_eq!(
            row.get_long(at("time_unix_ms")).unwrap(),
            DAY + i64::from(number - 1) * 1000
        );
        assert_eq!(row.get_uint(at("number")).unwrap(), number);
        assert_eq!(row.get_float(at("speed_rpm")).unwrap(), number as f32);
        assert_eq!(row.get_float(at("r3")).unwrap(), 0.25);
        assert!(row.get_float(at("r4")).is_err() && row.get_float(at("current_a")).is_err());
    }
    // Nothing is left of a file that cannot be written.
    let nowhere = folder.path().join("no/such/folder.parquet");
    assert!(
        reader
            .export_seconds(DAY, DAY + HOUR, &nowhere)
            .unwrap_err()
            .to_string()
            .contains("folder.parquet")
    );
}
