use super::*;

const SPEED: Target = Target::Channel(Channel::SPEED);

/// The tachometer of the 4 kW laboratory motor: raw -2.11 at rest, 152.43 at 1497 rpm.
fn tachometer() -> Mapping {
    let mut mapping = Mapping::default();
    mapping.set_column("speed=speed_raw").unwrap();
    mapping.set_unit("speed=rpm").unwrap();
    mapping.set_scale("speed=9.6868").unwrap();
    mapping.set_offset("speed=-2.11").unwrap();
    mapping
}

#[test]
fn offset_comes_before_scale_and_scale_before_unit() {
    let map = &tachometer().columns[&SPEED];
    let rest = map.to_si(Quantity::Speed, -2.11);
    let no_load = map.to_si(Quantity::Speed, 152.43);
    assert_eq!(rest, 0.0);
    // 1497 rpm in rad/s; the scale above has five digits.
    let expected = 1497.0 * std::f64::consts::TAU / 60.0;
    assert!((no_load - expected).abs() < 2e-5 * expected, "{no_load}");
}

#[test]
fn the_assumption_is_a_sentence() {
    let sentence = tachometer().columns[&SPEED].sentence(SPEED, "speed_raw");
    let expected = "speed = 9.6868 x (speed_raw + 2.11) in rpm, user's assumption";
    assert_eq!(sentence.as_deref(), Some(expected));
    assert_eq!(ColumnMap::default().sentence(SPEED, "speed"), None);
}

#[test]
fn a_delay_is_a_time_with_its_unit_and_part_of_the_assumption() {
    let ia = Target::Channel(Channel::CURRENTS[0]);
    for (text, seconds) in [("11.55us", 11.55e-6), ("-0.3ms", -3e-4), ("0.002s", 0.002)] {
        let mut mapping = Mapping::default();
        mapping.set_delay(&format!("ia={text}")).unwrap();
        let found = mapping.columns[&ia].delay.unwrap();
        assert!((found - seconds).abs() < 1e-15, "{text}: {found}");
    }
    let mut mapping = Mapping::default();
    mapping.set_delay("ia=11.55us").unwrap();
    let expected = "ia = i1 in A, sampled 11.55 us after the row's time, user's assumption";
    assert_eq!(
        mapping.columns[&ia].sentence(ia, "i1").as_deref(),
        Some(expected)
    );
}

#[test]
fn flags_win_over_the_sidecar_field_by_field() {
    let mut flags = Mapping::default();
    flags.set_scale("speed=2").unwrap();
    let merged = flags.over(tachometer());
    let map = &merged.columns[&SPEED];
    assert_eq!(
        (map.scale, map.offset),
        (Some(Factor::Known(2.0)), Some(-2.11))
    );
    assert_eq!(map.name.as_deref(), Some("speed_raw"));
}

#[test]
fn the_factor_of_the_speed_may_be_unknown_and_flags_may_know_it_again() {
    let mut unknown = tachometer();
    unknown.set_scale("speed=unknown").unwrap();
    let map = &unknown.columns[&SPEED];
    // In the unit of the column, without a factor: 152.43 + 2.11 rpm.
    let expected = 154.54 * std::f64::consts::TAU / 60.0;
    assert!((map.to_si(Quantity::Speed, 152.43) - expected).abs() < 1e-12);
    assert_eq!(
        map.sentence(SPEED, "speed_raw").as_deref(),
        Some("speed = an unknown factor x (speed_raw + 2.11) in rpm, user's assumption")
    );
    let known = tachometer().over(unknown);
    assert_eq!(known.columns[&SPEED].scale, Some(Factor::Known(9.6868)));
}

#[test]
fn wrong_flags_say_what_is_right() {
    let mut m = Mapping::default();
    let cases = [
        (m.set_column("speed"), "CHANNEL=VALUE"),
        (m.set_column("spead=x"), "did you mean `speed`"),
        (m.set_unit("speed=kmh"), "rad/s, rpm"),
        (m.set_scale("speed=0"), "other than 0"),
        (m.set_scale("ia=unknown"), "only that of the speed"),
        (m.set_scale("speed=1,02"), "decimal point"),
        (m.set_offset("speed=nan"), "finite"),
        (m.set_delay("ia=11.55"), "with its unit"),
        (m.set_delay("ia=us"), "finite"),
        (m.set_delay("ia=0.2s"), "more than 100 ms"),
        (m.set_delay("t=1us"), "late against itself"),
        (m.set_sample_rate(-1.0), "samples per second"),
        (m.set_delimiter("comma"), "use one of"),
        (m.set_pulses(0), "on its plate"),
    ];
    for (result, expected) in cases {
        let error = result.unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
    assert_eq!(m, Mapping::default());
}
