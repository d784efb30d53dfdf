//! A configuration as words, and what is refused.

use super::*;
use crate::configuration::LineParity;
use motor::motor_file::MotorFile;

pub(crate) const T_SAMPLE: f32 = 1e-4;

/// Constants of a shipped motor.
pub(crate) fn image(name: &str) -> MotorImage {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors/");
    let file = MotorFile::read(format!("{folder}{name}.toml")).expect("a shipped motor file");
    let config = MonitorConfig::from_motor_file(&file, f64::from(1e-4_f32)).expect("effects");
    MotorImage::new(&MonitorConfig {
        t_sample: T_SAMPLE,
        ..config
    })
}

pub(crate) const LINE: Line = Line {
    unit: 42,
    baud: 9_600,
    parity: LineParity::None,
};

pub(crate) fn example() -> Configuration {
    let mut example = Configuration::of("pump 3, hall B", &image("peer-2k2"));
    example.set_line(LINE);
    example.set_relay(RelayMode::FaultOrBlind);
    example
}

fn name(configuration: &Configuration) -> String {
    configuration.name().text().expect("text").to_owned()
}

#[test]
fn a_configuration_gives_back_what_was_put_in() {
    let example = example();
    assert_eq!(example.line(), Ok(LINE));
    assert_eq!(example.relay(), Ok(RelayMode::FaultOrBlind));
    assert_eq!(name(&example), "pump 3, hall B");
    assert_eq!(*example.constants(), image("peer-2k2").0);
    assert_eq!(example.identification(), image("peer-2k2").identification());
    assert_eq!(example.check(T_SAMPLE), Ok(()));
    assert_eq!(example.config(), image("peer-2k2").config().ok());
    assert_eq!(Configuration::BLANK.check(T_SAMPLE), Err(Refused::Layout));
}

#[test]
fn a_long_name_is_cut_between_characters() {
    let long = "ä".repeat(40);
    let configuration = Configuration::of(&long, &image("peer-2k2"));
    assert_eq!(name(&configuration), "ä".repeat(32));
    let odd = format!("x{long}");
    let configuration = Configuration::of(&odd, &image("peer-2k2"));
    assert_eq!(name(&configuration), format!("x{}", "ä".repeat(31)));
}

#[test]
fn what_is_refused_is_named() {
    let refused = |change: fn(&mut [u32; CONFIGURATION_WORDS])| {
        let mut configuration = example();
        change(configuration.words_mut());
        configuration.check(T_SAMPLE).expect_err("refused")
    };
    assert_eq!(refused(|words| words[0] ^= 1), Refused::Layout);
    assert_eq!(refused(|words| words[1] = 2 << 8), Refused::Unit);
    assert_eq!(refused(|words| words[1] |= 3 << 8), Refused::Parity);
    assert_eq!(refused(|words| words[1] |= 9 << 16), Refused::Relay);
    assert_eq!(refused(|words| words[2] = 300), Refused::Baud);
    assert_eq!(refused(|words| words[3] = 0xFFFF_FFFF), Refused::Name);
    assert_eq!(refused(|words| words[40] ^= 1), Refused::Checksum);
}

#[test]
fn constants_that_the_monitor_refuses_are_refused() {
    let mut config = image("peer-2k2").config().expect("a sound image");
    config.params.l_m = -1.0;
    let configuration = Configuration::of("", &MotorImage::new(&config));
    assert_eq!(configuration.check(T_SAMPLE), Err(Refused::Range));
    assert_eq!(example().check(5e-5), Err(Refused::Range));
}

#[test]
fn refusals_are_numbered_in_their_order() {
    for (k, refused) in Refused::ALL.into_iter().enumerate() {
        assert_eq!(refused as usize, k + 1);
    }
}
