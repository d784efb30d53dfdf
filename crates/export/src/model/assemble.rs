//! The equations in their order: what `motor::dynamic` and the stack of effects compute at one instant.

use super::parameters::Constants;
use super::parts::{Part, Parts};
use crate::algebra::{Body, Expr, Function, Vector, clarke, number, phases};
use crate::effects::{
    At, Flow, Given, Motor, Now, Rates, Shown, Terminal, Winding, linear_currents,
};
use motor::effect::Hook;

/// Rounds that the air-gap flux of a saturating motor takes at most.
const ROUNDS: u32 = 12;
/// Share of the rated flux at which its iteration ends.
const CLOSE: f64 = 1e-9;

/// One instant of a motor, as far as its terminals.
pub struct Instant {
    pub at: At,
    pub winding: Winding,
    pub terminal: Terminal,
    given: Given,
}

/// Symbols of the instant.
pub fn instant(
    body: &mut Body,
    constants: &Constants,
    parts: &Parts,
    held: Option<&Vector>,
) -> Instant {
    let at = at(body, constants, parts);
    let winding = winding(body, &at, parts);
    let mut given = given(body, parts);
    if let Some(held) = held {
        given.u = body.vector("u_driven", &(&given.u + held));
    }
    let mut terminal = Terminal {
        supply: given.u.clone(),
        u: given.u.clone(),
        i: winding.i_s.clone(),
    };
    for part in parts.with(Hook::Terminal) {
        body.note(&part.label);
        let equations = part.equations();
        equations.terminal(&part.own, body, &at, &winding, &mut terminal);
    }
    Instant {
        at,
        winding,
        terminal,
        given,
    }
}

fn at(body: &mut Body, constants: &Constants, parts: &Parts) -> At {
    let mut motor = constants.motor.clone();
    for part in parts.with_outer(Hook::Motor) {
        body.note(&part.label);
        part.equations().motor(&part.own, body, &mut motor);
    }
    let vector = |name: &str| Vector {
        re: Expr::name(&format!("{name}_alpha")),
        im: Expr::name(&format!("{name}_beta")),
    };
    At {
        t: Expr::name("t"),
        psi_s: vector("psi_s"),
        psi_r: vector("psi_r"),
        omega_mech: Expr::name("omega_mech"),
        theta_mech: Expr::name("theta_mech"),
        omega_sync: Expr::name("omega_sync"),
        rated: constants.rated.clone(),
        motor,
    }
}

/// What drives the motor.
fn given(body: &mut Body, parts: &Parts) -> Given {
    body.note("supply");
    let u = clarke(&["u_a", "u_b", "u_c"].map(Expr::name));
    let mut given = Given {
        u: body.vector("u", &u),
        tau_load: Expr::name("tau_load"),
    };
    for part in parts.with_outer(Hook::Inputs) {
        body.note(&part.label);
        part.equations().inputs(&part.own, body, &mut given);
    }
    given
}

/// Currents and resistances of the windings.
fn winding(body: &mut Body, at: &At, parts: &Parts) -> Winding {
    body.note("currents of the linear motor");
    let linear = linear(body, &at.motor, at);
    let is_saturating = parts.with(Hook::Magnetizing).next().is_some();
    let mut now = Now {
        motor: at.motor.clone(),
        cage: None,
    };
    let mut changes = false;
    for part in parts.with(Hook::Parameters) {
        changes = true;
        body.note(&part.label);
        let equations = part.equations();
        equations.parameters(&part.own, body, at, &linear.i_s, &mut now);
    }
    if !changes && !is_saturating {
        return linear;
    }
    if is_saturating || now.cage.is_some() {
        return star(body, at, &now, parts);
    }
    body.note("currents with the inductances of this instant");
    self::linear(body, &now.motor, at)
}

fn linear(body: &mut Body, motor: &Motor, at: &At) -> Winding {
    let (i_s, i_r) = linear_currents(body, motor, &at.psi_s, &at.psi_r);
    Winding {
        i_s: body.vector("i_s", &i_s),
        i_r: body.vector("i_r", &i_r),
        r_s: motor.r_s.clone(),
        r_r: motor.r_r.clone(),
    }
}

/// A star of branches: magnetizing branch, two leakages and perhaps a second cage.
fn star(body: &mut Body, at: &At, now: &Now, parts: &Parts) -> Winding {
    body.note("air-gap flux of a star of branches");
    let m = &now.motor;
    let a_s = body.name("a_s", 1.0 / &m.l_ls);
    let a_r = body.name("a_r", 1.0 / &m.l_lr);
    let mut sum = &(&at.psi_s * &a_s) + &(&at.psi_r * &a_r);
    let mut admittance = &a_s + &a_r;
    if let Some(cage) = &now.cage {
        sum = &sum + &(&cage.psi * &(1.0 / &cage.l));
        admittance = admittance + 1.0 / &cage.l;
    }
    let sum = body.vector("drive", &sum);
    let admittance = body.name("admittance", admittance);
    let psi_m = air_gap_flux(body, at, &sum, &admittance, &m.l_m, parts);
    let i_s = &(&at.psi_s - &psi_m) * &a_s;
    let i_r = &(&at.psi_r - &psi_m) * &a_r;
    Winding {
        i_s: body.vector("i_s_star", &i_s),
        i_r: body.vector("i_r_star", &i_r),
        r_s: m.r_s.clone(),
        r_r: m.r_r.clone(),
    }
}

/// `psi (a + f(|psi|)/L_m) = sum`, solved for its magnitude by Newton's steps.
fn air_gap_flux(
    body: &mut Body,
    at: &At,
    sum: &Vector,
    admittance: &Expr,
    l_m: &Expr,
    parts: &Parts,
) -> Vector {
    let linear = 1.0 / (admittance + 1.0 / l_m);
    if parts.with(Hook::Magnetizing).next().is_none() {
        return body.vector("psi_m", &(sum * &linear));
    }
    let drive = body.name("drive", sum.length());
    let rated = body.name("psi_rated", at.rated.flux());
    let flux = body.name("psi_m", &drive * linear);
    body.repeat(ROUNDS, |body| {
        let x = body.name("flux_over_rated", &flux / &rated);
        let mut factor: Option<(Expr, Expr)> = None;
        for part in parts.with(Hook::Magnetizing) {
            let (g, dg) = part.equations().magnetizing(&part.own, body, &x);
            factor = Some(match factor {
                None => (g, dg),
                Some((f, slope)) => (f + g - 1.0, slope + dg),
            });
        }
        let (f, slope) = factor.unwrap_or((number(1.0), number(0.0)));
        let f = body.name("factor", f);
        let excess = &flux * (admittance + &f / l_m) - &drive;
        let gradient = admittance + (f + &flux * slope / &rated) / l_m;
        let step = body.name("newton_step", excess / gradient);
        body.again(&flux, (&flux - &step).at_least(0.0));
        step.of(Function::Abs).less(CLOSE * &rated)
    });
    let along = body.name("along", flux / drive.at_least(f64::MIN_POSITIVE));
    body.vector("psi_m", &(sum * &along))
}

/// Rates of change of all states, per second.
pub fn rates(
    body: &mut Body,
    constants: &Constants,
    parts: &Parts,
    instant: &Instant,
) -> Vec<Expr> {
    let flow = flow(body, constants, instant);
    let (at, winding) = (&instant.at, &flow.winding);
    body.note("the motor's own rates");
    let omega_el = body.name("omega_el", &flow.n_p * &at.omega_mech);
    let drop = &flow.terminal.i * &winding.r_s;
    let spin = at.psi_r.quarter(&omega_el);
    let tau = &flow.tau_em - &constants.friction * &at.omega_mech - &flow.tau_load;
    let mut rates = Rates {
        psi_s: body.vector("psi_s_rate", &(&flow.terminal.u - &drop)),
        psi_r: body.vector("psi_r_rate", &(&spin - &(&winding.i_r * &winding.r_r))),
        omega_mech: body.name("omega_mech_rate", tau / &flow.inertia),
        extra: Vec::new(),
    };
    let mut extra = vec![Vec::new(); parts.all().len()];
    for part in parts.with(Hook::Finish) {
        body.note(&part.label);
        rates.extra = Vec::new();
        let equations = part.equations();
        equations.finish(&part.own, body, at, &flow, &mut rates);
        extra[part.number] = std::mem::take(&mut rates.extra);
    }
    let own = [
        rates.psi_s.re,
        rates.psi_s.im,
        rates.psi_r.re,
        rates.psi_r.im,
    ];
    let shaft = [rates.omega_mech, at.omega_mech.clone()];
    own.into_iter()
        .chain(shaft)
        .chain(extra.into_iter().flatten())
        .collect()
}

fn flow(body: &mut Body, constants: &Constants, instant: &Instant) -> Flow {
    Flow {
        winding: instant.winding.clone(),
        terminal: instant.terminal.clone(),
        tau_em: torque(body, constants, instant),
        tau_load: instant.given.tau_load.clone(),
        inertia: constants.inertia.clone(),
        n_p: constants.rated.n_p.clone(),
    }
}

fn torque(body: &mut Body, constants: &Constants, instant: &Instant) -> Expr {
    body.note("electromagnetic torque");
    let (psi, i) = (&instant.at.psi_s, &instant.winding.i_s);
    let turning = &psi.re * &i.im - &psi.im * &i.re;
    body.name("tau_em", 1.5 * &constants.rated.n_p * turning)
}

/// What the instruments show: phase currents, speed, angle, and the torque, which they do not.
pub fn shown(
    body: &mut Body,
    constants: &Constants,
    parts: &Parts,
    instant: &Instant,
) -> Vec<Expr> {
    let tau_em = torque(body, constants, instant);
    let [a, b, c] = phases(&instant.terminal.i);
    let mut shown = Shown {
        i: [
            body.name("i_line_a", a),
            body.name("i_line_b", b),
            body.name("i_line_c", c),
        ],
        omega_mech: instant.at.omega_mech.clone(),
        theta_mech: instant.at.theta_mech.clone(),
        t: instant.at.t.clone(),
    };
    for part in parts.with_outer(Hook::Outputs) {
        part.equations().outputs(&part.own, &mut shown);
    }
    let [a, b, c] = shown.i;
    vec![a, b, c, shown.omega_mech, shown.theta_mech, tau_em]
}

/// Voltage that is decided at the beginning of a step, V.
pub fn held(body: &mut Body, parts: &Parts, instant: &Instant) -> Option<Vec<Expr>> {
    let mut u: Option<Vector> = None;
    for part in parts.with(Hook::HeldVoltage) {
        body.note(&part.label);
        let more = held_by(part, body, &instant.winding.i_s);
        u = Some(u.map_or(more.clone(), |u| &u + &more));
    }
    u.map(|u| vec![u.re, u.im])
}

fn held_by(part: &Part, body: &mut Body, i_s: &Vector) -> Vector {
    part.equations().held_voltage(&part.own, body, i_s)
}
