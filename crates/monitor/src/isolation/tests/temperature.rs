//! The temperature from window to window: heating is followed, faults are not.

use super::plant::{Plant, evidence, evidence_of_any_load, statistics};
use crate::isolation::{Evidence, Heating, Isolation, Temperature};

/// A window comes every cycle of 50 Hz.
const CYCLE_S: f32 = 0.02;

/// A motor whose resistances changed by these shares.
fn resistances(stator: f64, rotor: f64) -> Plant {
    let mut plant = Plant::healthy();
    plant.params.r_s *= 1.0 + stator;
    plant.params.r_r *= 1.0 + rotor;
    plant
}

/// A monitor at rated current that looks at one motor for a while.
#[derive(Default)]
struct Watch {
    temperature: Temperature,
    fault: bool,
}

impl Watch {
    /// One window; FAULT follows at once.
    fn look(&mut self, plant: &Plant) -> Isolation {
        self.look_at(&evidence(plant))
    }

    fn look_at(&mut self, evidence: &Evidence) -> Isolation {
        let healthy = statistics();
        self.temperature.pass(CYCLE_S, 1.0);
        let expected = [
            self.temperature.expected(&healthy),
            self.temperature.expected_apart(),
        ];
        let isolation = Isolation::of_two(evidence, &healthy, expected);
        self.temperature.follow(&isolation, &healthy, self.fault);
        self.fault = isolation.significance > healthy.significance;
        isolation
    }

    fn look_for(&mut self, seconds: f32, plant: &Plant) -> Isolation {
        let windows = (seconds / CYCLE_S) as usize;
        let all = (0..windows).map(|_| self.look(plant));
        all.last().expect("at least one window")
    }
}

/// Half an hour nearly without load, in which winding and cage cool by 50 K. What a calibration leaves open is a deviation off,
/// so such windows tell the temperature wrongly, a hundred thousand of them alike. The load that then comes finds a cold motor,
/// and what breaks at the same moment is still seen.
#[test]
fn a_motor_that_cooled_at_light_load_is_cold_when_the_load_comes() {
    let limit = statistics().significance;
    let uncertainty = statistics().uncertainty;
    let gains = f64::from(uncertainty.current_gain);
    let main = f64::from(uncertainty.magnetizing_inductance);
    let speed = f64::from(uncertainty.speed);
    for [gains, main, speed] in [
        [0.0; 3],
        [gains, 0.0, 0.0],
        [-gains, 0.0, speed],
        [0.0, main, -speed],
        [0.0, -main, 0.0],
    ] {
        let at = |rise: f64, load: f64| {
            let mut plant = resistances(rise, rise);
            plant.friction *= load;
            plant.gains[3..].iter_mut().for_each(|gain| *gain += gains);
            plant.params.l_m *= 1.0 + main;
            plant.speed_gain += speed;
            plant
        };
        let mut watch = Watch::default();
        let warm = evidence_of_any_load(&at(0.2, 1.0));
        for _ in 0..50 {
            watch.look_at(&warm);
        }
        let known = watch.temperature.expected(&statistics());
        assert!(known.deviation < 0.04, "{known:?}");
        for second in 0..1800 {
            let cooling = 0.2 * (1.0 - f64::from(second) / 1800.0);
            let light = evidence_of_any_load(&at(cooling, 0.02));
            for _ in 0..50 {
                let significance = watch.look_at(&light).significance;
                assert!(significance < limit, "{significance} after {second} s");
            }
        }
        let loaded = watch.temperature;
        let after = |plant: &Plant| {
            let mut watch = Watch {
                temperature: loaded,
                fault: false,
            };
            watch.look_at(&evidence_of_any_load(plant)).significance
        };
        let cold = at(0.0, 1.0);
        let mut broken = cold;
        broken.gains[3] *= 0.97;
        let [cold, broken] = [cold, broken].map(|plant| after(&plant));
        // Half of the limit: the cold motor is healthy enough to be learnt from.
        assert!(cold < 0.5 * limit && broken > limit, "{cold} {broken}");
    }
}

fn at_any(plant: &Plant) -> Isolation {
    let healthy = statistics();
    Isolation::of(&evidence(plant), &healthy, Heating::any(&healthy))
}

#[test]
fn a_rotor_resistance_that_jumps_is_a_fault_and_one_that_was_there_may_be_heat() {
    let changed = resistances(0.0, 0.2);
    let limit = statistics().significance;
    assert!(at_any(&changed).significance < limit);
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    assert!(watch.look(&changed).significance > limit);
}

/// The cage cools by 70 K in five minutes while the winding stays as it is: a full load that goes. What then jumps is a fault.
#[test]
fn a_cage_that_cools_beside_a_warm_winding_lights_nothing_and_hides_no_jump() {
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    let limit = statistics().significance;
    for second in 1..=300 {
        let cooled = resistances(0.0, -0.28 * f64::from(second) / 300.0);
        let longest = watch.look_for(1.0, &cooled).significance;
        assert!(longest < limit, "{longest} after {second} s");
    }
    let apart = watch.temperature.expected_apart();
    // 70 K are more than twice the 25 K by which the two are believed to part: followed to there and no farther.
    assert!((apart.rise + 0.2).abs() < 1e-6, "{apart:?}");
    let (end, healthy) = (evidence(&resistances(0.0, -0.28)), statistics());
    let alike = Isolation::of(&end, &healthy, watch.temperature.expected(&healthy));
    assert!(alike.significance > limit, "{alike:?}");
    for jumped in [resistances(0.3, -0.28), resistances(0.0, 0.0)] {
        let mut watch = Watch {
            temperature: watch.temperature,
            fault: false,
        };
        let jump = watch.look(&jumped).significance;
        assert!(jump > limit, "{jump}");
    }
}

/// A resistance that was far too large when the monitor was switched on passed for heat: the load that then comes shows the other one as it was. That one has
/// not fallen, nor is the speed wrong: the first is the cause.
#[test]
fn a_resistance_that_rose_before_the_first_window_is_the_cause_when_the_load_comes() {
    let healthy = statistics();
    for (k, changed) in [resistances(0.6, 0.0), resistances(0.0, 0.6)]
        .iter()
        .enumerate()
    {
        let taken_for_heat = Heating {
            rise: 0.6,
            deviation: 0.05,
        };
        let isolation = Isolation::of(&evidence(changed), &healthy, taken_for_heat);
        assert!(isolation.significance > healthy.significance);
        let (causes, _) = isolation.probabilities();
        assert!(causes[k] > 0.5 && causes[1 - k] < 0.2, "{causes:?}");
        assert!(
            (isolation.sizes[k] - 0.6).abs() < 0.1,
            "{:?}",
            isolation.sizes
        );
    }
}

/// Without the time that it takes a cage to cool, the same is a fault.
#[test]
fn a_cage_cooler_than_its_winding_from_one_window_to_the_next_is_a_fault() {
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    assert!(watch.look(&resistances(0.0, -0.2)).significance > statistics().significance);
}

/// An hour at full load does not turn a fault into heat.
#[test]
fn a_fault_that_stays_is_never_learned() {
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    let changed = resistances(0.0, 0.2);
    let first = watch.look(&changed);
    let last = watch.look_for(3600.0, &changed);
    assert!(watch.fault);
    assert!((last.significance / first.significance - 1.0).abs() < 0.01);
}

/// 0.1 %/s: a quarter of a kelvin in a second, up to 75 K; then cold again at the same rate.
#[test]
fn a_winding_that_warms_and_cools_lights_nothing_and_its_temperature_is_known() {
    let mut watch = Watch::default();
    let up = (0..=300).map(f64::from);
    let down = (0..300).rev().map(f64::from);
    for second in up.chain(down) {
        let rise = 0.001 * second;
        let isolation = watch.look_for(1.0, &resistances(rise, rise));
        assert!(!watch.fault, "at {rise}: {isolation:?}");
        let seen = f64::from(isolation.heating.rise);
        // Off by what a window leaves open (its deviation of 1 to 2 %) and by the bend of large changes.
        assert!((seen - rise).abs() < 0.02, "{seen} at {rise}");
    }
}

/// What was lit because of a jump that heating explains goes dark when the motor has stood for minutes.
#[test]
fn a_motor_that_has_rested_may_have_any_temperature() {
    let warm = resistances(0.3, 0.3);
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    watch.look_for(1.0, &warm);
    assert!(watch.fault, "30 % within a second is no heat");
    (0..3000).for_each(|_| watch.temperature.rest(0.1));
    assert!(watch.look(&warm).significance < statistics().significance);
}

/// A fault that no temperature explains stops nothing: what the winding did meanwhile is allowed for.
#[test]
fn a_sensor_that_failed_for_minutes_leaves_no_fault_behind() {
    let mut watch = Watch::default();
    watch.look_for(1.0, &Plant::healthy());
    let mut broken = Plant::healthy();
    broken.gains[3] = 0.7;
    watch.look_for(120.0, &broken);
    assert!(watch.fault);
    let warmer = resistances(0.1, 0.1);
    watch.look(&warmer);
    assert!(!watch.fault);
}

/// The oracle is the same window with the wider covariance, factorised anew.
#[test]
fn what_any_temperature_would_leave_does_not_depend_on_what_was_expected() {
    let healthy = statistics();
    for plant in [resistances(0.1, 0.02), resistances(-0.05, 0.2)] {
        let evidence = evidence(&plant);
        let wide = Isolation::of(&evidence, &healthy, Heating::any(&healthy));
        for (rise, deviation) in [(0.0, 0.01), (0.08, 0.02), (-0.1, 0.1)] {
            let expected = Heating { rise, deviation };
            let narrow = Isolation::of(&evidence, &healthy, expected);
            let off = narrow.at_any_temperature - wide.at_any_temperature;
            // Differences of squares near 1e4 in single precision.
            assert!(off.abs() < 0.02, "{off} for {expected:?}");
            let ratio = narrow.heating.deviation / wide.heating.deviation;
            assert!((ratio - 1.0).abs() < 0.01, "{ratio} for {expected:?}");
        }
    }
}

fn judged(rise: f32, deviation: f32, significance: f32, at_any_temperature: f32) -> Isolation {
    Isolation {
        scores: [0.0; crate::CAUSES],
        unknown: 0.0,
        sizes: [0.0; crate::CAUSES],
        significance,
        at_any_temperature,
        heating: Heating { rise, deviation },
        apart: Heating::default(),
    }
}

fn after(temperature: &mut Temperature, isolation: &Isolation, fault: bool) -> Heating {
    temperature.follow(isolation, &statistics(), fault);
    temperature.expected(&statistics())
}

fn assert_heating(got: Heating, rise: f32, deviation: f32) {
    assert!((got.rise - rise).abs() < 1e-6, "{got:?}");
    assert!((got.deviation - deviation).abs() < 1e-6, "{got:?}");
}

/// Before anything was seen the winding may have any temperature; then what the window told, and what time adds.
#[test]
fn doubt_grows_with_time_and_with_the_square_of_the_current() {
    let mut temperature = Temperature::default();
    assert_eq!(
        temperature.expected(&statistics()),
        Heating::any(&statistics())
    );
    assert_heating(
        after(&mut temperature, &judged(0.1, 0.02, 1.0, 1.0), false),
        0.1,
        0.02,
    );
    // 0.2 % a second at rated current or less, four times as much at twice the current.
    temperature.pass(2.0, 0.5);
    assert_heating(
        temperature.expected(&statistics()),
        0.1,
        0.02_f32.hypot(0.004),
    );
    temperature.pass(1.0, 2.0);
    assert_heating(
        temperature.expected(&statistics()),
        0.1,
        0.02_f32.hypot(0.012),
    );
    temperature.rest(5.0);
    assert_heating(
        temperature.expected(&statistics()),
        0.1,
        0.02_f32.hypot(0.022),
    );
    // Never more than the range that the calibration foresees.
    temperature.pass(1000.0, 1.0);
    assert_heating(temperature.expected(&statistics()), 0.1, 0.3);
}

/// A window that tells no better moves the temperature only as far as copper can have warmed.
#[test]
fn the_rise_moves_as_fast_as_copper_warms() {
    let mut temperature = Temperature::default();
    after(&mut temperature, &judged(0.1, 0.02, 1.0, 1.0), false);
    temperature.pass(5.0, 1.0); // up to 0.01
    assert_heating(
        after(&mut temperature, &judged(0.15, 0.02, 1.0, 1.0), false),
        0.11,
        0.02,
    );
    temperature.pass(5.0, 1.0);
    assert_heating(
        after(&mut temperature, &judged(0.113, 0.03, 1.0, 1.0), false),
        0.113,
        0.02,
    );
    temperature.pass(5.0, 1.0);
    assert_heating(
        after(&mut temperature, &judged(0.0, 0.02, 1.0, 1.0), false),
        0.103,
        0.02,
    );
}

/// One that tells it worse teaches nothing, however many there are: what is known gets older, until it is no better.
#[test]
fn worse_windows_do_not_renew_what_is_known() {
    let mut temperature = Temperature::default();
    after(&mut temperature, &judged(0.1, 0.02, 1.0, 1.0), false);
    for second in 1..=40 {
        temperature.pass(1.0, 1.0);
        let slack = 0.002 * second as f32;
        let known = after(&mut temperature, &judged(-0.1, 0.1, 1.0, 1.0), false);
        assert_heating(known, 0.1, 0.02_f32.hypot(slack));
    }
    // 0.098 from 49 s on; it moves as far as it can have moved meanwhile.
    temperature.pass(9.0, 1.0);
    let known = after(&mut temperature, &judged(-0.1, 0.1, 1.0, 1.0), false);
    assert_heating(known, 0.1 - 0.098, 0.1);
}

/// One that tells it much better, to two thirds of the deviation, replaces what was known.
#[test]
fn a_better_window_replaces_what_was_known() {
    let mut temperature = Temperature::default();
    after(&mut temperature, &judged(0.1, 0.03, 1.0, 1.0), false);
    assert_heating(
        after(&mut temperature, &judged(0.2, 0.021, 1.0, 1.0), false),
        0.1,
        0.03,
    );
    assert_heating(
        after(&mut temperature, &judged(0.2, 0.019, 1.0, 1.0), false),
        0.2,
        0.019,
    );
}

/// Half of the lamp's limit is healthy enough to learn from; beyond twice the range nothing is heat.
#[test]
fn only_healthy_windows_teach() {
    let mut temperature = Temperature::default();
    after(&mut temperature, &judged(0.1, 0.02, 1.0, 1.0), false);
    let half = 0.5 * statistics().significance;
    assert_heating(
        after(
            &mut temperature,
            &judged(0.2, 0.01, 1.01 * half, 1.0),
            false,
        ),
        0.1,
        0.02,
    );
    assert_eq!(
        temperature.latest(),
        0.2,
        "but residuals are straightened there"
    );
    assert_heating(
        after(
            &mut temperature,
            &judged(0.2, 0.01, 0.99 * half, 1.0),
            false,
        ),
        0.2,
        0.01,
    );
    after(&mut temperature, &judged(0.9, 0.01, 9.0, 9.0), false);
    assert!((temperature.latest() - 0.6).abs() < 1e-6);
    after(&mut temperature, &judged(-0.9, 0.005, 1.0, 1.0), false);
    assert!((temperature.latest() + 0.6).abs() < 1e-6);
    assert_heating(temperature.expected(&statistics()), -0.6, 0.005);
}

/// A fault that some temperature would explain stops the clock; one that none explains does not.
#[test]
fn time_does_not_excuse_a_fault_that_looks_like_heat() {
    let limit = statistics().significance;
    for (at_any, frozen) in [(0.9 * limit, true), (1.1 * limit, false)] {
        let mut temperature = Temperature::default();
        after(&mut temperature, &judged(0.1, 0.02, 1.0, 1.0), false);
        after(
            &mut temperature,
            &judged(0.3, 0.02, 2.0 * limit, at_any),
            true,
        );
        temperature.pass(10.0, 1.0);
        let grown = temperature.expected(&statistics()).deviation > 0.0201;
        assert_eq!(grown, !frozen, "{at_any}");
        // Minutes at rest excuse it all the same.
        temperature.rest(10.0);
        assert!(temperature.expected(&statistics()).deviation > 0.0201);
    }
}

/// After a load step the flux still settles: its windows would say 15 %, sure to 2 %. The sixth after them holds nothing of it. A single
/// window that noise made unsteady costs one.
#[test]
fn windows_that_hold_a_transient_teach_nothing() {
    let mut temperature = Temperature::default();
    let known = after(&mut temperature, &judged(0.02, 0.08, 1.0, 1.0), false);
    assert_heating(known, 0.02, 0.08);
    for _ in 0..7 {
        temperature.interrupt(5);
    }
    for _ in 0..5 {
        let known = after(&mut temperature, &judged(0.15, 0.02, 1.0, 1.0), false);
        assert_heating(known, 0.02, 0.08);
    }
    let known = after(&mut temperature, &judged(0.05, 0.02, 1.0, 1.0), false);
    assert_heating(known, 0.05, 0.02);
    temperature.interrupt(5);
    after(&mut temperature, &judged(0.15, 0.01, 1.0, 1.0), false);
    let known = after(&mut temperature, &judged(0.06, 0.01, 1.0, 1.0), false);
    assert_heating(known, 0.06, 0.01);
}
