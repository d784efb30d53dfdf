//! The equations of every effect against the effect itself, at random points and states.

use super::{HELD, Model, Section, model_of};
use crate::algebra::{Expr, Statement, Values};
use crate::effects::OF_WHOLE_SIGNALS;
use motor::MotorFile;
use motor::dynamic::{Dynamic, DynamicState, Flow, Hooks, Linear, clarke, phases};
use motor::effect::curve::{Action, curve};
use motor::effect::expression::expression;
use motor::effect::{
    EffectConfig, EffectStack, Hook, Inputs, Outputs, Rated, Role, Timeline, rated, to_entry,
};
use motor::effects::ALL;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Points and states for each set of effects.
const POINTS: usize = 12;
const STATES: usize = 20;

fn motor_file() -> MotorFile {
    let mut file = MotorFile::read("../../motors/peer-2k2.toml").expect("a motor file");
    file.mechanics.friction = 0.002;
    file.mechanics.load_friction = 0.003;
    file
}

/// Values within the range, sizes about the typical one.
fn drawn(
    effect: &'static dyn motor::effect::Effect,
    rated: &Rated<f64>,
    rng: &mut Pcg64Mcg,
) -> EffectConfig {
    let mut config = EffectConfig::absent(effect, rated);
    for (p, value) in effect
        .descriptor()
        .parameters
        .iter()
        .zip(&mut config.values)
    {
        let [low, high] = p.range;
        let x = match p.role {
            Role::Size => (p.typical * rng.random_range(-2.0..2.0)).clamp(low, high),
            Role::Shape | Role::Form => rng.random_range(low..high),
        };
        *value = if p.role == Role::Size && x == 0.0 {
            p.typical
        } else {
            x
        } * p.scale.of(rated);
    }
    config
}

/// A random state, input and time of a motor.
struct Point {
    t: f64,
    state: DynamicState<[f64; STATES]>,
    u_abc: [f64; 3],
    tau_load: f64,
    omega_sync: f64,
}

fn point(rated: &Rated<f64>, states: usize, rng: &mut Pcg64Mcg) -> Point {
    let mut vector = |size: f64| {
        Complex64::from_polar(
            size * rng.random_range(0.05..1.5),
            rng.random_range(0.0..TAU),
        )
    };
    let psi_s = vector(rated.flux());
    let psi_r = psi_s * vector(1.0);
    let u = phases(vector(rated.voltage));
    let mut state = DynamicState::<[f64; STATES]>::rest();
    (state.psi_s, state.psi_r) = (psi_s, psi_r);
    state.omega_mech = rated.speed() * rng.random_range(-1.2..1.2);
    state.theta_mech = rng.random_range(-50.0..50.0);
    for x in &mut state.extra[..states] {
        *x = rng.random_range(-2.0..2.0);
    }
    Point {
        t: rng.random_range(0.0..20.0),
        state,
        u_abc: u,
        tau_load: rated.torque * rng.random_range(-1.0..1.0),
        omega_sync: rated.omega_sync * rng.random_range(0.3..1.2),
    }
}

/// The model's values at a point.
fn evaluated(model: &Model, section: &Section, point: &Point, held: Complex64) -> Vec<f64> {
    let s = &point.state;
    let own = [
        s.psi_s.re,
        s.psi_s.im,
        s.psi_r.re,
        s.psi_r.im,
        s.omega_mech,
        s.theta_mech,
    ];
    let states = own.iter().chain(&s.extra).copied();
    let [a, b, c] = point.u_abc;
    let inputs = [a, b, c, point.tau_load, point.omega_sync];
    let names = model.states.iter().map(|q| q.name.clone()).zip(states);
    let names = names.chain(model.inputs.iter().map(|q| q.name.clone()).zip(inputs));
    let more = [("t", point.t), (HELD[0], held.re), (HELD[1], held.im)];
    let more = more.map(|(name, x)| (name.to_owned(), x));
    let mut values = Values {
        names: names.chain(more).collect(),
        parameters: model
            .parameters
            .iter()
            .map(|p| (p.name.as_str(), p.value))
            .collect(),
        tables: &model.tables,
    };
    values.run(&section.statements);
    section
        .results
        .iter()
        .map(|result: &Expr| values.of(result))
        .collect()
}

/// The same by the simulation: rates, what is shown, voltage held.
fn simulated(
    file: &MotorFile,
    configs: &[EffectConfig],
    point: &Point,
) -> (Vec<f64>, Vec<f64>, Complex64) {
    let rated = rated(file);
    let (mut inputs, mut motor) = (
        Inputs {
            t_sample: 1e-4,
            u_s: vec![clarke(point.u_abc)],
            tau_load: vec![point.tau_load],
        },
        file.parameters,
    );
    for config in configs {
        config.effect.inputs(&config.values, &rated, &mut inputs);
        config.effect.motor(&config.values, &rated, &mut motor);
    }
    let timeline = Arc::new(Timeline::constant(point.omega_sync));
    let stack = EffectStack::<STATES>::new(configs, &motor, &rated, timeline);
    let moment = stack.moment(point.t, &point.state);
    let held = stack.held_voltage(&Linear::new(&motor), &moment, &point.state);
    let model = Dynamic::with_effects(&motor, &file.mechanics, stack);
    let rate = model.rate(
        point.t,
        &point.state,
        inputs.u_s[0] + held,
        inputs.tau_load[0],
    );
    let flow = model.flow(point.t, &point.state, inputs.u_s[0], inputs.tau_load[0]);
    let own = [
        rate.psi_s.re,
        rate.psi_s.im,
        rate.psi_r.re,
        rate.psi_r.im,
        rate.omega_mech,
        rate.theta_mech,
    ];
    let rates = own.into_iter().chain(rate.extra).collect();
    (rates, shown(&flow, configs, &rated, point), held)
}

fn shown(flow: &Flow, configs: &[EffectConfig], rated: &Rated<f64>, point: &Point) -> Vec<f64> {
    let mut outputs = Outputs {
        t_start: point.t,
        t_sample: 1e-4,
        i_s_abc: vec![phases(flow.terminal.i)],
        omega_mech: vec![point.state.omega_mech],
        theta_mech: vec![point.state.theta_mech],
        u_zero: vec![0.0],
        u_measured: vec![clarke(point.u_abc)],
    };
    for config in configs
        .iter()
        .filter(|c| c.effect.hooks().contains(&Hook::Outputs))
    {
        let prepared = config.effect.prepared(&config.values, rated);
        config.effect.outputs(&prepared, rated, &mut outputs);
    }
    let [a, b, c] = outputs.i_s_abc[0];
    vec![
        a,
        b,
        c,
        outputs.omega_mech[0],
        outputs.theta_mech[0],
        flow.tau_em,
    ]
}

fn compare(what: &str, ours: &[f64], theirs: &[f64], size: f64) {
    for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
        let most = 1e-9 * a.abs().max(b.abs()) + 1e-12 * size;
        assert!(
            (a - b).abs() <= most,
            "{what}, number {k}: {a:e} against {b:e}"
        );
    }
}

/// Where a language takes rates and readings together, one name means one thing in both.
fn hold_names(model: &Model, what: &str) {
    let set = |section: &Section| {
        let statements = section
            .statements
            .iter()
            .filter_map(|statement| match statement {
                Statement::Set(name, value) => Some((name.clone(), value.clone())),
                _ => None,
            });
        statements.collect::<BTreeMap<_, _>>()
    };
    let (rates, shown) = (set(&model.derivatives), set(&model.shown));
    for (name, value) in &shown {
        assert!(
            rates.get(name).is_none_or(|other| other == value),
            "{what}: {name}"
        );
    }
}

/// Holds the model of these effects against the simulation.
fn hold(configs: &[EffectConfig], rng: &mut Pcg64Mcg) {
    let mut file = motor_file();
    file.effects = configs.iter().map(to_entry).collect();
    let what: Vec<_> = configs
        .iter()
        .map(|c| c.effect.descriptor())
        .map(|d| format!("{} {}", d.name, d.form))
        .collect();
    let what = what.join(" + ");
    let model = model_of(&file, "test", &[]).unwrap_or_else(|error| panic!("{what}: {error}"));
    if model.held.is_none() {
        hold_names(&model, &what);
    }
    let rated = rated(&file);
    for _ in 0..POINTS {
        let point = point(&rated, model.states.len() - 6, rng);
        let (rates, shown, held) = simulated(&file, configs, &point);
        let size = rated.voltage.max(rated.torque / file.mechanics.inertia);
        if let Some(section) = &model.held {
            let ours = evaluated(&model, section, &point, Complex64::ZERO);
            compare(
                &format!("{what}, held voltage"),
                &ours,
                &[held.re, held.im],
                size,
            );
        }
        let ours = evaluated(&model, &model.derivatives, &point, held);
        assert_eq!(ours.len(), model.states.len(), "{what}");
        compare(&format!("{what}, rates"), &ours, &rates, size);
        let ours = evaluated(&model, &model.shown, &point, Complex64::ZERO);
        compare(&format!("{what}, shown"), &ours, &shown, size);
    }
}

fn library() -> impl Iterator<Item = &'static dyn motor::effect::Effect> {
    let is_here = |e: &&dyn motor::effect::Effect| !OF_WHOLE_SIGNALS.contains(&e.descriptor().name);
    ALL.iter().copied().filter(is_here)
}

#[test]
fn the_motor_without_effects_is_the_simulated_one() {
    hold(&[], &mut Pcg64Mcg::seed_from_u64(1));
}

#[test]
fn every_effect_of_the_library_is_what_the_simulation_does() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let rated = rated(&motor_file());
    for effect in library() {
        for _ in 0..4 {
            let config = drawn(effect, &rated, &mut rng);
            hold(&[config], &mut rng);
        }
    }
}

/// Values at knots between the ends of what a motor does.
fn law(action: Action, rated: &Rated<f64>, rng: &mut Pcg64Mcg) -> EffectConfig {
    use motor::effect::curve::Coordinate::*;
    let reach = match action.coordinate {
        Speed => rated.speed(),
        Angle | AngleElectrical => 5.5,
        Slip | Frequency => 60.0,
        Current | PhaseCurrent => 5.0 * rated.current,
        Flux => 1.2 * rated.flux(),
        Voltage => rated.voltage,
        Time => 15.0,
        LoadTorque => rated.torque,
    };
    let quantity = action.place.quantity(action.coordinate);
    let knots: Vec<f64> = (0..6)
        .map(|k| reach * (0.02 + f64::from(k) / 6.0))
        .collect();
    let size = 3.0 * quantity.typical * quantity.scale.of(rated);
    let values: Vec<f64> = knots
        .iter()
        .map(|_| size * rng.random_range(-1.0..1.0))
        .collect();
    curve(action, &knots, &values).expect("a curve")
}

#[test]
fn every_law_is_what_the_simulation_does() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let rated = rated(&motor_file());
    for action in Action::all() {
        let law = law(action, &rated, &mut rng);
        hold(&[law], &mut rng);
    }
}

#[test]
fn formulas_are_what_the_simulation_does() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for (formula, adds_to) in [
        ("2 * k * (omega / 40) / (1 + (omega / 40)^2)", "torque"),
        ("k*i_d*abs(u_q) + 0.01*psi*slip", "torque"),
        ("-k*i_q^2*signum(i_q)/3*2 + sin(3*theta)", "voltage_d"),
        ("k*tanh(i_d/2)*exp(-t/10)", "voltage_q"),
    ] {
        let config = expression(Some(formula), Some(adds_to), &[("k".to_owned(), 0.7)]);
        hold(&[config.expect("a formula")], &mut rng);
    }
}

/// The order of effects counts: leakage saturates on the leakage of a deep bar, two masses split what the others leave.
#[test]
fn effects_together_are_what_the_simulation_does() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let rated = rated(&motor_file());
    let all: Vec<_> = library().collect();
    for _ in 0..40 {
        let mut configs: Vec<EffectConfig> = Vec::new();
        while configs.len() < 4 {
            let effect = all[rng.random_range(0..all.len())];
            let name = effect.descriptor().name;
            if configs.iter().all(|c| c.effect.descriptor().name != name) {
                configs.push(drawn(effect, &rated, &mut rng));
            }
        }
        let actions: Vec<_> = Action::all().collect();
        configs.push(law(
            actions[rng.random_range(0..actions.len())],
            &rated,
            &mut rng,
        ));
        hold(&configs, &mut rng);
    }
}

#[test]
fn an_effect_of_whole_signals_is_refused_unless_it_is_left_out() {
    let rated = rated(&motor_file());
    for effect in ALL
        .iter()
        .filter(|e| OF_WHOLE_SIGNALS.contains(&e.descriptor().name))
    {
        let (name, form) = (effect.descriptor().name, effect.descriptor().form);
        let told = match form {
            "" => name.to_owned(),
            form => format!("{name} ({form})"),
        };
        let mut file = motor_file();
        file.effects = vec![to_entry(&EffectConfig::typical(*effect, &rated))];
        let refused = model_of(&file, "test", &[]).expect_err(name).to_string();
        assert!(refused.contains(&format!("--without {name}")), "{refused}");
        let model = model_of(&file, "test", &[name.to_owned()]).expect("a model");
        assert_eq!(
            model.remarks,
            [format!("In the motor file, but left out: {told}")]
        );
        let wrong = model_of(&file, "test", &["windage".to_owned()]).expect_err("not there");
        assert!(
            wrong.to_string().contains(&format!("it has: {name}")),
            "{wrong}"
        );
    }
}

#[test]
fn a_motor_without_leakage_does_not_saturate() {
    let mut file = motor_file();
    let saturation = motor::effects::find("magnetizing-saturation", "").expect("in the library");
    file.effects = vec![to_entry(&EffectConfig::typical(saturation, &rated(&file)))];
    file.parameters.l_lr = 0.0;
    let refused = model_of(&file, "test", &[])
        .expect_err("refused")
        .to_string();
    assert!(refused.contains("rotor_leakage_henry"), "{refused}");
    file.effects.clear();
    assert!(model_of(&file, "test", &[]).is_ok());
}
