//! Beyond what the calibration saw.

use motor::TParams;

use super::plant::{Plant, monitor, statistics};
use crate::isolation::{Beyond, CalibratedRange, Conditions, Healthy, Heating, Isolation};
use crate::tests::motor_2200_watt::PARAMS;
use crate::{Cause, Monitor, MonitorConfig};

/// What the healthy motor runs at.
fn conditions() -> Conditions {
    let window = Plant::healthy().window();
    monitor().conditions(&window).expect("voltages and speed")
}

/// A calibration that saw half as much current again, the same frequency, and `voltage` times the voltage.
fn seen(voltage: f32) -> CalibratedRange {
    let at = conditions();
    CalibratedRange {
        current: 1.5 * at.current,
        volt_per_hertz: [voltage * at.volt_per_hertz; 2],
        frequency: [at.frequency; 2],
        active: 0.0,
    }
}

fn isolation(plant: &Plant, range: Option<CalibratedRange>) -> Isolation {
    let healthy = Healthy {
        range,
        ..statistics()
    };
    let monitor = Monitor::new(MonitorConfig {
        healthy: Some(healthy),
        ..*monitor().config()
    });
    let evidence = monitor
        .expect("a valid range")
        .evidence(&healthy, &plant.window());
    Isolation::of(&evidence.expect("speed"), &healthy, Heating::default())
}

/// Iron that saturates: 5 % more voltage leave 10 % less inductance, d ln L_m/d ln psi = -2.
fn saturated() -> Plant {
    Plant {
        params: TParams {
            l_m: 0.9 * PARAMS.l_m,
            ..PARAMS
        },
        ..Plant::healthy()
    }
}

#[test]
fn within_its_range_a_calibration_says_what_it_said() {
    for plant in [Plant::healthy(), saturated()] {
        assert_eq!(isolation(&plant, Some(seen(1.0))), isolation(&plant, None));
    }
}

#[test]
fn saturation_at_a_higher_voltage_is_no_fault() {
    let lights = statistics().significance;
    let within = isolation(&saturated(), Some(seen(1.0)));
    assert!(within.significance > 2.0 * lights, "{within:?}");
    let beyond = isolation(&saturated(), Some(seen(0.95)));
    assert!(beyond.significance < 0.7 * lights, "{beyond:?}");
}

/// One channel moves the negative and the zero sequence, of which voltage and load say nothing.
#[test]
fn a_channel_that_is_wrong_is_found_beyond_as_well() {
    let mut plant = saturated();
    plant.gains[3] = 1.05;
    let beyond = isolation(&plant, Some(seen(0.95)));
    assert!(beyond.significance > statistics().significance);
    let best = beyond.scores.iter().copied().fold(f32::MIN, f32::max);
    let place = crate::ALL_CAUSES.iter().position(
        |cause| matches!(cause, Cause::CurrentChannel(phase) if *phase == crate::checks::sensors::Phase::A),
    );
    assert_eq!(beyond.scores[place.expect("a cause")], best, "{beyond:?}");
}

/// Distances from the nearer end, half a per cent beyond it, as shares of it.
#[test]
fn distances_are_shares_of_the_nearer_end() {
    let range = CalibratedRange {
        current: 0.8,
        volt_per_hertz: [0.95, 1.0],
        frequency: [0.5, 1.0],
        active: -0.2,
    };
    let at = |current, volt_per_hertz, frequency| {
        range.beyond(&Conditions {
            current,
            volt_per_hertz,
            frequency,
            active: -0.2,
            slip: 0.1,
        })
    };
    assert!(at(0.0, 0.95, 1.004).is_within() && at(0.803, 1.0, 0.499).is_within());
    let Beyond {
        current,
        volt_per_hertz,
        frequency,
        ..
    } = at(1.2, 0.76, 1.5);
    let near = |x: f32, y: f32| assert!((x - y).abs() < 1e-6, "{x} {y}");
    near(current, 1.2 / (0.8 * 1.005) - 1.0);
    near(volt_per_hertz, 0.76 / (0.95 * 0.995) - 1.0);
    near(frequency, 1.5 / 1.005 - 1.0);
    let seen = at(1.2, 0.76, 1.5).from_seen();
    near(seen.current, 0.5);
    near(seen.volt_per_hertz, -0.2);
    near(seen.frequency, 0.5);
    assert_eq!(at(0.8, 1.0, 1.0).from_seen(), Beyond::default());
}

/// What is fed back and the slip count as they are: a motor that only drove has seen nothing of either.
#[test]
fn what_is_fed_back_and_the_slip_count_from_where_loads_end() {
    let range = seen(1.0);
    let at = |fed_back: f32, slip| {
        range.beyond(&Conditions {
            active: -fed_back,
            slip,
            ..conditions()
        })
    };
    assert!(at(0.004, 0.19).is_within());
    let beyond = at(0.6, 1.0);
    let near = |x: f32, y: f32| assert!((x - y).abs() < 1e-6, "{x} {y}");
    near(beyond.fed_back, 0.745);
    near(beyond.slip, 0.8);
    near(beyond.from_seen().fed_back, 0.6);
    let lowering = Conditions {
        active: -0.6,
        ..conditions()
    };
    let learnt = CalibratedRange {
        active: -0.6,
        ..range
    };
    assert!(learnt.beyond(&lowering).is_within());
}

/// A load lighter than any that the calibration saw: of a current that its fit took for resistance there, the share that is lacking appears again.
#[test]
fn a_lighter_load_shows_again_what_a_fit_took_for_resistance() {
    let range = CalibratedRange {
        active: 0.4,
        ..seen(1.0)
    };
    let at = |active| {
        range.beyond(&Conditions {
            active,
            current: 0.5,
            ..conditions()
        })
    };
    assert!(at(0.4).is_within() && at(0.396).is_within() && at(0.9).is_within());
    let near = |x: f32, y: f32| assert!((x - y).abs() < 1e-6, "{x} {y}");
    let idle = at(0.05);
    near(idle.lighter, 0.345);
    near(idle.from_seen().lighter, 0.35);
    // 86 % of it, and half of the rated current in all.
    near(idle.regained, 0.345 / 0.4 / 0.5);
    near(idle.iron_loss(0.02), 0.02 * idle.regained);
    // A load that drives leaves all of it, and what is fed back comes on top.
    near(at(-0.3).lighter, 0.395);
    near(at(-0.3).fed_back, 0.445);
}

/// A window of a motor that drives feeds nothing back; the same motor with its currents turned round does.
#[test]
fn what_is_fed_back_is_the_active_current() {
    let driven = Plant::healthy().window();
    let at = |window| monitor().conditions(window).expect("voltages and speed");
    assert!(at(&driven).active > 0.0);
    let mut driving = driven;
    driving.i_s.positive = -driving.i_s.positive;
    let (u, i) = (driven.u_s.positive, driven.i_s.positive);
    let active = (u.conj() * i).re / u.norm() / monitor().config().rated_current;
    assert!((at(&driving).active + active).abs() < 1e-5, "{active}");
}

/// Near standstill a torque is no friction: the balance says nothing.
#[test]
fn a_shaft_that_hardly_turns_has_no_torque_balance() {
    let window = Plant::healthy().window();
    let known = |share: f32| {
        let mut window = window;
        window.omega_mech = window.omega_mech.map(|omega| share * omega);
        let evidence = monitor().evidence(&statistics(), &window);
        let [torque, e_d, ..] = *evidence.expect("speed").known();
        assert!(e_d);
        torque
    };
    assert!(known(1.0) && known(0.2) && known(-0.2));
    assert!(!known(0.05) && !known(-0.05) && !known(0.0));
}

#[test]
fn ranges_that_are_none_are_refused() {
    let refused = |change: fn(&mut CalibratedRange)| {
        let mut range = seen(1.0);
        change(&mut range);
        let healthy = Healthy {
            range: Some(range),
            ..statistics()
        };
        assert!(healthy.validate().is_err(), "{range:?}");
    };
    refused(|range| range.current = f32::NAN);
    refused(|range| range.volt_per_hertz = [1.0, 0.9]);
    refused(|range| range.frequency = [-0.1, 1.0]);
    refused(|range| range.active = f32::NAN);
}
