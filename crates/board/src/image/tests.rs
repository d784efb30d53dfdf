use monitor::{CalibratedRange, Healthy, InMotion, ROWS, Uncertainty};

use super::*;
use motor::effect::curve::{Coordinate, Place};
use motor::motor_file::MotorFile;
use proptest::prelude::*;

fn shipped(name: &str) -> MonitorConfig {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors/");
    let file = MotorFile::read(format!("{folder}{name}")).expect("a shipped motor file");
    MonitorConfig::from_motor_file(&file, 1e-4).expect("effects of the library")
}

fn image(config: &MonitorConfig) -> MotorImage {
    MotorImage::new(config)
}

fn with_effects() -> MonitorConfig {
    let mut config = shipped("assumed-300w.toml");
    config.channel_gain[4] = 0.98;
    config.converter.chain.delay = [8.9e-5, 8.8e-5, 8.7e-5, 8.6e-5, 8.5e-5, 8.4e-5];
    config.converter.chain.roll_off = 8.37e-5;
    for (slot, number) in config.effects.iter_mut().zip([2, 9]) {
        *slot = Some(ActiveEffect {
            effect: STEADY[number],
            parameters: [0.1, 2.0, 0.3, number as f32],
        });
    }
    config
}

#[test]
fn effects_and_channel_gains_survive_the_round_trip() {
    let config = with_effects();
    assert_eq!(image(&config).config(), Ok(config));
}

#[test]
fn the_kind_of_sensors_and_the_largest_code_survive_the_round_trip() {
    for ratiometric in [[false, true], [true, false], [true, true]] {
        let mut config = shipped("assumed-300w.toml");
        config.converter = config.converter.summed(16);
        config.converter.ratiometric = ratiometric;
        assert_eq!(image(&config).config(), Ok(config));
    }
}

#[test]
fn every_effect_has_a_number_of_its_own() {
    let numbers: std::collections::BTreeSet<u32> =
        STEADY.iter().map(|effect| number(*effect)).collect();
    assert_eq!(numbers.len(), STEADY.len());
    assert!(!numbers.contains(&0));
}

#[test]
fn laws_survive_the_round_trip() {
    let mut config = with_effects();
    let knots = |n: usize| {
        (0..n)
            .map(|k| k as f64 * 7.0)
            .collect::<std::vec::Vec<f64>>()
    };
    let values = |n: usize| {
        (0..n)
            .map(|k| (k as f64).sin())
            .collect::<std::vec::Vec<f64>>()
    };
    let law = |place, coordinate, n| {
        let action = Action { place, coordinate };
        SteadyCurve::new(action, &knots(n), &values(n))
    };
    config.laws = [
        law(Place::Torque, Coordinate::Speed, 18),
        law(Place::StatorPhaseB, Coordinate::PhaseCurrent, BOARD_KNOTS),
    ];
    assert!(config.laws.iter().all(Option::is_some));
    assert_eq!(image(&config).config(), Ok(config));
}

#[test]
fn an_effect_that_the_program_lacks_is_refused_rather_than_dropped() {
    let mut image = image(&with_effects());
    let known = number(STEADY[9]);
    let place = image.0.iter().position(|word| *word == known);
    image.0[place.expect("the second effect")] ^= 1;
    image.0[IMAGE_WORDS - 1] = crc32_words(&image.0[..IMAGE_WORDS - 1]);
    assert_eq!(image.config(), Err(ImageError::Effects));
}

#[test]
fn every_shipped_motor_survives_the_round_trip_bit_for_bit() {
    for name in ["assumed-300w.toml", "peer-2k2.toml", "imc-18k5.toml"] {
        let config = shipped(name);
        assert_eq!(image(&config).config(), Ok(config), "{name}");
    }
}

/// Every number another one, so that none can take another's place unseen.
fn calibrated() -> MonitorConfig {
    let mut next = 0.0;
    let mut number = || {
        next += 0.001_f32;
        next
    };
    let healthy = Healthy {
        mean: [(); ROWS].map(|()| -number()),
        scatter: [(); ROWS].map(|()| number()),
        current_unbalance: [number(), -number()],
        current_unbalance_at: number(),
        negative_drop: [-number(), number()],
        current_unbalance_scatter: number(),
        turns_axis: [number(), number()],
        uncertainty: Uncertainty {
            stator_resistance: number(),
            rotor_resistance: number(),
            heating: number(),
            magnetizing_inductance: number(),
            leakage: number(),
            friction: number(),
            current_gain: number(),
            voltage_gain: number(),
            speed: number(),
            iron_loss: number(),
            supply_unbalance: number(),
            negative_impedance: number(),
        },
        range: Some(CalibratedRange {
            current: number(),
            volt_per_hertz: [number(), number()],
            frequency: [number(), number()],
            active: -number(),
        }),
        significance: 5.5,
        in_motion: InMotion::Differs,
    };
    let sidebands = HealthySidebands {
        at: [number(), number()],
        lower: [number(), number()],
        scatter: number(),
    };
    MonitorConfig {
        healthy: Some(healthy),
        cage: Cage {
            bars: 28.0,
            healthy: Some(sidebands),
        },
        ..with_effects()
    }
}

#[test]
fn a_calibrated_motor_survives_the_round_trip_number_by_number() {
    let config = calibrated();
    assert_eq!(image(&config).config(), Ok(config));
}

#[test]
fn every_calibrated_motor_that_ships_survives_the_round_trip() {
    for motor in ["assumed-300w", "peer-2k2", "chalmers-4kw"] {
        let config = shipped(&format!("{motor}-calibrated.toml"));
        assert!(config.healthy.is_some(), "{motor} is not calibrated");
        let read = image(&config).config();
        assert_eq!(read, Ok(config), "{motor}");
    }
}

#[test]
fn a_calibration_changes_the_identification() {
    let without = MonitorConfig {
        healthy: None,
        ..calibrated()
    };
    let read = image(&without).config();
    assert_eq!(read, Ok(without));
    let ids = [without, calibrated()].map(|config| image(&config).identification());
    assert_ne!(ids[0], ids[1]);
}

#[test]
fn choices_that_no_shipped_motor_makes_survive_too() {
    let config = MonitorConfig {
        frame: Frame::Voltage,
        load: LoadKind::Measured,
        field: FieldCurrent::Nominal(1.25),
        ..shipped("assumed-300w.toml")
    };
    assert_eq!(image(&config).config(), Ok(config));
}

#[test]
fn the_last_word_before_the_checksum_is_used() {
    let mut config = with_effects();
    let bends = [[0.0; BOARD_KNOTS], [0.0; BOARD_KNOTS], [7.5; BOARD_KNOTS]];
    let action = Action {
        place: Place::Torque,
        coordinate: Coordinate::Speed,
    };
    config.laws[MAX_LAWS - 1] = Some(SteadyCurve::of_words(action, BOARD_KNOTS, 0.0, bends));
    let image = image(&config);
    assert_eq!(f32::from_bits(image.0[IMAGE_WORDS - 2]), 7.5);
}

proptest! {
    /// CRC-32 finds every single-bit error, in the content as in the checksum.
    #[test]
    fn any_flipped_bit_is_found(word in 0..IMAGE_WORDS, bit in 0..32_u32) {
        let mut image = image(&shipped("assumed-300w.toml"));
        image.0[word] ^= 1 << bit;
        prop_assert_eq!(image.config(), Err(ImageError::Checksum));
    }
}
