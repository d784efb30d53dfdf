//! Directions against the changed motor, and causes named from synthetic windows.

use super::plant::{Plant, evidence, evidence_by, index, statistics};
use crate::checks::sensors::Phase;
use crate::isolation::{ALL_CAUSES, Cause, Heating, Isolation};
use num_complex::Complex64;

/// The healthy motor with one quantity changed by a share.
pub fn changed(cause: Cause, by: f64) -> Plant {
    let mut plant = Plant::healthy();
    let factor = 1.0 + by;
    let p = &mut plant.params;
    match cause {
        Cause::StatorResistance => p.r_s *= factor,
        Cause::RotorResistance => p.r_r *= factor,
        Cause::MagnetizingInductance => p.l_m *= factor,
        Cause::Leakage => {
            p.l_ls *= factor;
            p.l_lr *= factor;
        }
        Cause::Friction => plant.friction *= factor,
        Cause::AllVoltages => plant.gains[..3].fill(factor),
        Cause::AllCurrents => plant.gains[3..].fill(factor),
        Cause::SpeedGain => plant.speed_gain = factor,
        Cause::SeriesResistance(phase) => plant.series[index(phase)] = by * p.r_s,
        Cause::Turns(phase) => plant.shorted[index(phase)] = by,
        Cause::VoltageChannel(phase) => plant.gains[index(phase)] = factor,
        Cause::CurrentChannel(phase) => plant.gains[3 + index(phase)] = factor,
    }
    plant
}

fn length(rows: impl IntoIterator<Item = f32>) -> f32 {
    processor::sqrtf(rows.into_iter().map(|x| x * x).sum())
}

#[test]
fn the_healthy_motor_shows_no_departure() {
    // A hundred roundings of single precision.
    let departure = evidence(&Plant::healthy()).departure;
    assert!(length(departure) < 1e-5, "{departure:?}");
}

/// What of a departure its cause's direction leaves over, as a share of what it explains.
fn left_over(cause: Cause, by: f64) -> f32 {
    let evidence = evidence(&changed(cause, by));
    let expected = evidence.direction(cause).map(|x| x * by as f32);
    let rest = evidence.departure.iter().zip(expected).map(|(x, y)| x - y);
    length(rest) / length(expected)
}

/// A change of 2 % bends by some 2 % of itself, and the difference quotient by half its step of 1 %; a speed that is wrong
/// by 2 % would be beyond synchronous speed, so 0.2 %.
#[test]
fn a_changed_motor_departs_along_its_direction() {
    for cause in ALL_CAUSES.into_iter().filter(|c| *c != Cause::Leakage) {
        let by = if cause == Cause::SpeedGain {
            0.002
        } else {
            0.02
        };
        let share = left_over(cause, by);
        assert!(share < 0.05, "{cause:?}: {share:.4} off");
    }
}

/// The chord's end is three times the leakage. On the way the departure bends by up to half of what the chord explains:
/// the price of a direction that still holds where leakage can be seen away from rated load.
#[test]
fn leakage_departs_along_a_chord() {
    let at_its_end = left_over(Cause::Leakage, 2.0);
    assert!(at_its_end < 1e-4, "{at_its_end:e} off: single precision");
    for by in [0.02, 0.15, 0.5, 1.0] {
        let share = left_over(Cause::Leakage, by);
        assert!(share < 0.5, "{by}: {share:.3} off");
    }
}

/// Beside a supply with 2 % of negative sequence a parameter of all phases moves that row, too, as `Z_2` does: by the derivative, from
/// which a change of 2 % bends by some 2 % of itself; leakage is nearly all of `Z_2` and goes along its chord. A gain of all
/// currents or voltages changes the drop by itself.
#[test]
fn what_is_in_all_phases_moves_the_drop_of_the_supplys_own_negative_sequence() {
    let of_all = [
        (Cause::StatorResistance, 0.02),
        (Cause::RotorResistance, 0.02),
        (Cause::MagnetizingInductance, 0.02),
        (Cause::Leakage, 1.0),
        (Cause::AllCurrents, 0.02),
        (Cause::AllVoltages, 0.02),
    ];
    for (cause, by) in of_all {
        let mut plant = changed(cause, by);
        plant.unbalance = Complex64::new(0.012, -0.016);
        let evidence = evidence(&plant);
        let direction = evidence.direction(cause).map(|x| x * by as f32);
        let [x, y] = [3, 4].map(|row| evidence.departure[row] - direction[row]);
        let moved = length([direction[3], direction[4]]);
        assert!(moved > 1e-6, "{cause:?}: {moved:e}");
        assert!(
            length([x, y]) < 0.05 * moved,
            "{cause:?}: {x:e} {y:e} of {moved:e}"
        );
    }
}

/// Negative and zero sequence grow as `g/(1 + g/3)` exactly; the rows of the positive one bend, which leaves some 3 % of a gain of 50 %.
#[test]
fn the_size_of_a_large_gain_is_the_gain() {
    for by in [-0.5, -0.2, 0.2, 0.5] {
        for cause in of_phases(Cause::CurrentChannel).chain(of_phases(Cause::VoltageChannel)) {
            let isolation = isolated(&changed(cause, by));
            let place = ALL_CAUSES.iter().position(|c| *c == cause).expect("listed");
            let size = f64::from(isolation.sizes[place]);
            assert!((size / by - 1.0).abs() < 0.03, "{cause:?} {by}: {size}");
        }
    }
}

fn isolated(plant: &Plant) -> Isolation {
    Isolation::of(&evidence(plant), &statistics(), Heating::any(&statistics()))
}

fn likeliest(isolation: &Isolation) -> (Option<Cause>, f32) {
    let (shares, unknown) = isolation.probabilities();
    let all = ALL_CAUSES.map(Some).into_iter().zip(shares);
    all.chain([(None, unknown)])
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .expect("there are causes")
}

fn of_phases(cause: fn(Phase) -> Cause) -> impl Iterator<Item = Cause> {
    Phase::ALL.into_iter().map(cause)
}

/// Asserts that a cause is named, its size found to within a tenth, and FAULT lit.
fn assert_named(cause: Cause, by: f64) {
    let isolation = isolated(&changed(cause, by));
    let (named, probability) = likeliest(&isolation);
    assert_eq!(named, Some(cause), "by {by}: {probability}, {isolation:?}");
    assert!(probability > 0.5, "{cause:?}: {probability}");
    assert!(
        isolation.significance > statistics().significance,
        "{cause:?}"
    );
    let place = ALL_CAUSES.iter().position(|c| *c == cause).expect("listed");
    let size = f64::from(isolation.sizes[place]);
    assert!((size / by - 1.0).abs() < 0.1, "{cause:?}: {size} for {by}");
}

#[test]
fn a_channel_gain_is_named_in_its_phase() {
    for by in [-0.05, 0.05] {
        of_phases(Cause::CurrentChannel).for_each(|cause| assert_named(cause, by));
        of_phases(Cause::VoltageChannel).for_each(|cause| assert_named(cause, by));
    }
}

#[test]
fn a_series_resistance_is_named_in_its_phase() {
    of_phases(Cause::SeriesResistance).for_each(|cause| assert_named(cause, 0.2));
}

#[test]
fn shorted_turns_are_named_in_their_phase() {
    of_phases(Cause::Turns).for_each(|cause| assert_named(cause, 0.15));
}

/// A loose contact of several times the winding's resistance is as much a contact as one of a fifth of it.
#[test]
fn a_large_series_resistance_is_no_shorted_turn() {
    for by in [1.0, 2.0, 4.0] {
        for cause in of_phases(Cause::SeriesResistance) {
            let (named, probability) = likeliest(&isolated(&changed(cause, by)));
            assert_eq!(named, Some(cause), "by {by}: {probability}");
        }
    }
}

/// A motor whose stator resistance is nearly twice and whose leakage is two thirds of what is believed, as a plate may leave them: the
/// negative sequence of its contact is turned by the angle between the two impedances.
#[test]
fn a_contact_of_a_hardly_known_motor_is_no_shorted_turn() {
    let mut unlike = Plant::healthy();
    unlike.params.r_s *= 1.9;
    unlike.params.l_ls *= 0.65;
    unlike.params.l_lr *= 0.65;
    let mut healthy = statistics();
    healthy.mean = evidence(&unlike).departure;
    healthy.uncertainty.stator_resistance = 0.3;
    healthy.uncertainty.leakage = 0.3;
    for phase in Phase::ALL {
        let mut faulty = unlike;
        faulty.series[index(phase)] = 1.5 * unlike.params.r_s;
        let evidence = evidence_by(&faulty, &healthy);
        let isolation = Isolation::of(&evidence, &healthy, Heating::any(&healthy));
        let (named, _) = likeliest(&isolation);
        assert_eq!(named, Some(Cause::SeriesResistance(phase)), "{isolation:?}");
    }
}

/// However little is known of the motor: current that the supply's negative sequence does not draw is no matter of belief about `Z_2`.
/// Each parameter is as uncertain as it is large: were `Z_2 I_2` as uncertain as that, no departure would be longer than one standard
/// deviation of it, far below the lamp; three times the lamp's takes it to be known.
#[test]
fn no_belief_about_a_motor_takes_the_unbalance_of_a_contact_away() {
    let mut healthy = statistics();
    let u = &mut healthy.uncertainty;
    (u.stator_resistance, u.rotor_resistance) = (1.0, 1.0);
    (u.magnetizing_inductance, u.leakage) = (1.0, 1.0);
    (u.friction, u.speed) = (1.0, 1.0);
    for cause in of_phases(Cause::SeriesResistance) {
        let evidence = evidence_by(&changed(cause, 1.0), &healthy);
        let isolation = Isolation::of(&evidence, &healthy, Heating::any(&healthy));
        let lights = isolation.significance > 3.0 * healthy.significance;
        assert!(lights, "{cause:?}: {isolation:?}");
    }
}

/// The loop's resistance and leakage decide on the angle of its current. Where a quarter of a turn is behind, what is in all phases alike
/// (magnetizing current, leakage) has a share of it, but no negative sequence.
#[test]
fn shorted_turns_are_named_in_their_phase_however_their_current_lags() {
    for phase in Phase::ALL {
        for lag_deg in [15.0_f64, 45.0, 75.0, 90.0] {
            let cause = Cause::Turns(phase);
            let mut plant = changed(cause, 0.15);
            plant.lag = lag_deg.to_radians();
            let isolation = isolated(&plant);
            let (named, probability) = likeliest(&isolation);
            assert_eq!(named, Some(cause), "{lag_deg} deg: {probability}");
            let place = ALL_CAUSES.iter().position(|c| *c == cause);
            let size = isolation.sizes[place.expect("listed")];
            assert!((size / 0.15 - 1.0).abs() < 0.15, "{lag_deg} deg: {size}");
        }
    }
}

/// A channel's gain beside a change of all phases looks like a short that draws what the change does in all phases, and what the gain makes of
/// the negative sequence; the zero sequence tells them apart, or nothing of one cause is said.
#[test]
fn a_gain_beside_another_change_is_nothing_in_a_phase_of_the_motor() {
    for (other, by) in [
        (Cause::MagnetizingInductance, -0.2),
        (Cause::Friction, 0.25),
        (Cause::StatorResistance, 0.8),
    ] {
        for phase in Phase::ALL {
            for gain in [-0.05, 0.05] {
                for channel in [Cause::VoltageChannel(phase), Cause::CurrentChannel(phase)] {
                    let mut plant = changed(channel, gain);
                    plant.params = changed(other, by).params;
                    plant.friction = changed(other, by).friction;
                    let (named, probability) = likeliest(&isolated(&plant));
                    let said = format!("{other:?}, {channel:?} {gain}: {named:?} {probability}");
                    assert!(
                        [Some(channel), Some(other), None].contains(&named),
                        "{said}"
                    );
                }
            }
        }
    }
}

/// A neutral that moves somewhere does not turn a short or a contact into a voltage's gain.
#[test]
fn what_is_in_a_phase_beside_a_displaced_neutral_stays_there() {
    let shorts = of_phases(Cause::Turns).map(|cause| (cause, 0.15));
    let contacts = of_phases(Cause::SeriesResistance).map(|cause| (cause, 0.5));
    for (cause, by) in shorts.chain(contacts) {
        for turn_deg in [0.0_f64, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0] {
            for lag_deg in [0.0_f64, 60.0] {
                let mut plant = changed(cause, by);
                plant.lag = lag_deg.to_radians();
                plant.neutral = 0.012 * Complex64::cis(turn_deg.to_radians());
                let (named, _) = likeliest(&isolated(&plant));
                assert_eq!(named, Some(cause), "{turn_deg} {lag_deg}");
            }
        }
    }
}

/// No motor without a neutral feels where the supply's neutral is.
#[test]
fn a_displaced_neutral_lights_nothing() {
    for share in [0.002, 0.005, 0.01, 0.03, 0.1, 0.5] {
        for turn in [1.0, 100.0, 200.0_f64] {
            let mut plant = Plant::healthy();
            plant.neutral = share * Complex64::cis(turn.to_radians());
            let isolation = isolated(&plant);
            assert!(
                isolation.significance < 0.9 * statistics().significance,
                "{share}: {isolation:?}"
            );
        }
    }
}

/// With the neutral displaced by 1 % what the other rows show is still seen, a voltage channel by the negative sequence alone.
#[test]
fn a_displaced_neutral_hides_no_fault() {
    for (cause, by) in [
        (Cause::SeriesResistance(Phase::B), 0.5),
        (Cause::Turns(Phase::A), 0.15),
        (Cause::CurrentChannel(Phase::C), 0.05),
        (Cause::VoltageChannel(Phase::A), 0.05),
    ] {
        let mut plant = changed(cause, by);
        plant.neutral = Complex64::new(0.0, 0.01);
        let isolation = isolated(&plant);
        assert!(
            isolation.significance > statistics().significance,
            "{cause:?}: {isolation:?}"
        );
        if !matches!(cause, Cause::VoltageChannel(_)) {
            assert_eq!(likeliest(&isolation).0, Some(cause), "{isolation:?}");
        }
    }
}

/// The three numbers of the positive sequence leave resistances nearly as likely as a voltage gain: 0.28 and 0.15 to 0.35.
#[test]
fn gains_of_all_phases_are_the_likeliest_cause() {
    for cause in [Cause::AllCurrents, Cause::AllVoltages] {
        let isolation = isolated(&changed(cause, 0.05));
        assert_eq!(likeliest(&isolation).0, Some(cause), "{isolation:?}");
    }
}

#[test]
fn single_channels_point_to_the_sensor_and_shorted_turns_do_not() {
    for phase in Phase::ALL {
        let points = |cause, by| isolated(&changed(cause, by)).points_to_sensor();
        assert!(points(Cause::CurrentChannel(phase), 0.05), "{phase:?}");
        assert!(points(Cause::VoltageChannel(phase), 0.05), "{phase:?}");
        assert!(!points(Cause::Turns(phase), 0.15), "{phase:?}");
    }
}

/// Warm windings are no fault: both resistances 20 % up, some 50 K.
#[test]
fn heating_lights_nothing_and_is_measured() {
    let mut warm = Plant::healthy();
    warm.params.r_s *= 1.2;
    warm.params.r_r *= 1.2;
    let isolation = isolated(&warm);
    assert!(
        isolation.significance < statistics().significance,
        "{isolation:?}"
    );
    assert!(
        (isolation.heating.rise - 0.2).abs() < 0.02,
        "{}",
        isolation.heating.rise
    );
}

/// A zero sequence in voltages and currents at once has no single cause.
#[test]
fn a_direction_of_no_cause_is_called_unknown() {
    let mut plant = Plant::healthy();
    plant.gains = [1.1, 1.0, 1.0, 1.0, 0.9, 1.0];
    let isolation = isolated(&plant);
    assert_eq!(likeliest(&isolation).0, None, "{isolation:?}");
    assert!(isolation.significance > statistics().significance);
}
