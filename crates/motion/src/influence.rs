//! How departures move the rotor flux, and with it the rows: one more flux for each departure.
//!
//! A departure of the rotor is not forgotten when the current falls: the flux remembers it for `L_r/R_r`. So sensitivities are
//! run through the flux's own equation, in parts of a cycle of a millisecond. Saturating iron takes most of a departure back:
//! what moves the flux moves `L_m` the other way.

use monitor::magnitude;
use num_complex::Complex32;

use crate::circuit::{Circuit, Coefficients, PHASES};
use crate::departures::FLUXES;
use crate::observer::Interval;

const J: Complex32 = Complex32::new(0.0, 1.0);
/// Squared slip at which half of the skin effect has come.
pub const SKIN_SLIP: f32 = 0.1;
/// Squared current, share of rated, at which half of the leakage's bend has come.
const BEND_CURRENT: f32 = 9.0;

/// What is summed up over one part of a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Part {
    samples: f32,
    x: Complex32,
    y: Complex32,
    mirrored: Complex32,
    weight: Complex32,
    turned: f32,
}

/// What one cycle's sums say of the departures of the rotor flux.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// `sum g dlambda` and `sum g* dlambda` of each departure, V s.
    pub linkage: [[Complex32; 2]; FLUXES],
    /// Sum over the samples of what each departure does to the torque, N m.
    pub torque: [f32; FLUXES],
}

/// The flux of one departure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Response {
    /// Rotor flux in coordinates of the rotor, V s.
    flux: Complex32,
    /// Stator flux at the end of the latest part, V s.
    linkage: Complex32,
    /// Relative change of `L_m` by the iron.
    iron: f32,
}

/// The fluxes of the departures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influences {
    responses: [Response; FLUXES],
    part: Part,
    /// Electrical speed of the rotor in the latest part, rad/s; `None` before the first.
    omega: Option<f32>,
}

/// What one departure does at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Direct {
    /// Drives the rotor flux, V.
    driven: Complex32,
    /// Of the stator flux, V s.
    linkage: Complex32,
    /// Of `k_r`, absolute.
    share: f32,
    /// Of the current, A.
    current: Complex32,
    /// Of the rotor's leakage flux, V s.
    leakage: Complex32,
}

/// Where the motor is at the end of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    i: Complex32,
    psi_r: Complex32,
    psi_m: Complex32,
    /// How much of skin effect, of the leakage's bend and of the iron's there is.
    skin: f32,
    bend: f32,
    iron: f32,
    /// `d ln L_m/d ln psi_m`, at most 0.
    softness: f32,
}

impl Influences {
    /// Adds one sampling interval; `turned` in electrical rad.
    #[inline]
    pub fn add(&mut self, interval: &Interval, turned: f32) {
        self.part.samples += 1.0;
        self.part.x += interval.x;
        self.part.y += interval.y;
        self.part.mirrored += interval.y_mirrored;
        self.part.weight += interval.weight;
        self.part.turned += turned;
    }

    /// Samples in the open part.
    pub fn samples(&self) -> f32 {
        self.part.samples
    }

    /// Electrical speed of the rotor in the open part, rad/s.
    pub fn omega(&self, t_sample: f32) -> f32 {
        self.part.turned / (self.part.samples.max(1.0) * t_sample)
    }

    /// Ends a part of a cycle at `interval`; `slip` as a share of rated supply frequency.
    #[inline(never)]
    pub fn close(
        &mut self,
        (circuit, c): (&Circuit, &Coefficients),
        rotor: Complex32,
        interval: &Interval,
        slip: f32,
        moved: &mut Moved,
    ) {
        let part = core::mem::take(&mut self.part);
        if part.samples < 1.0 {
            return;
        }
        let time = part.samples * circuit.t_sample;
        let decay = time * c.r_r / c.l_r;
        let keep = [libm::expf(-decay), libm::expf(-0.5 * decay) * time];
        let point = Point::new(circuit, c, interval, slip);
        let weight = part.weight / part.samples;
        let factor = 1.5 * circuit.mechanics.n_p * part.samples;
        let magnetizing = magnetizing(c, &part, &point);
        let omega = part.turned / time;
        let acceleration = (omega - self.omega.replace(omega).unwrap_or(omega)) / time;
        let all = directs(c, &part, &point, &magnetizing, [omega, acceleration]);
        let places = self.responses.iter_mut().zip(all);
        let sums = moved.linkage.iter_mut().zip(&mut moved.torque);
        for ((response, direct), (linkage, torque)) in places.zip(sums) {
            let direct = direct.with_iron(&magnetizing, response.iron);
            let flux = response.follow(&direct, keep, rotor);
            response.iron = point.give(c, &direct, flux);
            let change = response.step(direct.linkage + flux * c.k_r);
            let [forward, backward] = linkage;
            *forward += change * weight;
            *backward += change * weight.conj();
            *torque += factor * point.torque(c, &direct, flux);
        }
    }

    /// Rotor flux that each unit of relative rotor resistance moves, in coordinates of the rotor, V s.
    pub fn of_rotor_resistance(&self) -> Complex32 {
        let [rotor, ..] = self.responses;
        rotor.flux
    }
}

impl Response {
    /// The flux equation over a part; gives the flux in coordinates at rest.
    fn follow(&mut self, direct: &Direct, [keep, time]: [f32; 2], rotor: Complex32) -> Complex32 {
        self.flux = self.flux * keep + direct.driven * time;
        self.flux * rotor
    }

    fn step(&mut self, linkage: Complex32) -> Complex32 {
        let change = linkage - self.linkage;
        self.linkage = linkage;
        change
    }
}

impl Direct {
    /// Adds what the iron makes of it.
    fn with_iron(mut self, magnetizing: &Direct, iron: f32) -> Direct {
        // Iron that does not saturate takes nothing back.
        if iron == 0.0 {
            return self;
        }
        self.driven += magnetizing.driven * iron;
        self.linkage += magnetizing.linkage * iron;
        self.share += magnetizing.share * iron;
        self
    }

    fn scaled(&self, by: f32) -> Direct {
        Direct {
            driven: self.driven * by,
            linkage: self.linkage * by,
            share: self.share * by,
            current: self.current * by,
            leakage: self.leakage * by,
        }
    }
}

impl Point {
    fn new(circuit: &Circuit, c: &Coefficients, interval: &Interval, slip: f32) -> Point {
        let current = interval.i.norm_sqr() / (circuit.rated.current * circuit.rated.current);
        let psi_m = (interval.psi_r + interval.i * c.l_lr) * c.k_r;
        let bend = circuit.bend(magnitude(psi_m));
        let scale = 1.0 + circuit.iron.saturation * bend;
        Point {
            i: interval.i,
            psi_r: interval.psi_r,
            psi_m,
            skin: slip * slip / (slip * slip + SKIN_SLIP),
            bend: current / (current + BEND_CURRENT),
            iron: -bend / scale,
            softness: -circuit.iron.saturation * circuit.iron.exponent * (1.0 + bend) / scale,
        }
    }

    /// Relative change of `L_m` that follows from a departure by way of the flux.
    fn give(&self, c: &Coefficients, direct: &Direct, flux: Complex32) -> f32 {
        let square = self.psi_m.norm_sqr();
        if self.softness == 0.0 || square <= f32::MIN_POSITIVE {
            return 0.0;
        }
        let moved = (flux + direct.current * c.l_lr + direct.leakage) * c.k_r
            + self.psi_m * (direct.share / c.k_r);
        self.softness * (self.psi_m.conj() * moved).re / square
    }

    /// `Im(conj(k_r psi_r) i)` as the departure moves it.
    fn torque(&self, c: &Coefficients, direct: &Direct, flux: Complex32) -> f32 {
        let of_flux = (flux * c.k_r + self.psi_r * direct.share).conj() * self.i;
        let of_current = (self.psi_r * c.k_r).conj() * direct.current;
        (of_flux + of_current).im
    }
}

/// One unit of `L_m`, relative.
fn magnetizing(c: &Coefficients, part: &Part, point: &Point) -> Direct {
    let (x, y) = (part.x / part.samples, part.y / part.samples);
    let share = c.l_m * c.l_lr / (c.l_r * c.l_r);
    Direct {
        driven: (x + y * c.l_lr) * (c.r_r * c.l_m / (c.l_r * c.l_r)),
        linkage: point.i * (share * c.l_lr) + point.psi_r * share,
        share,
        ..Direct::default()
    }
}

/// One unit of each departure, in the order of [`crate::departures::FLUX_PLACES`].
fn directs(
    c: &Coefficients,
    part: &Part,
    point: &Point,
    magnetizing: &Direct,
    [omega, acceleration]: [f32; 2],
) -> [Direct; FLUXES] {
    let n = part.samples;
    let (x, y, mirrored) = (part.x / n, part.y / n, part.mirrored / n);
    let driven_by = |driven: Complex32| Direct {
        driven,
        ..Direct::default()
    };
    let rotor = driven_by((y * c.l_m - x) * (c.r_r / c.l_r));
    let leakage = Direct {
        driven: (x - y * c.l_m) * (c.r_r * c.l_lr / (c.l_r * c.l_r)),
        linkage: point.i * (c.l_ls + c.k_r * c.l_lr - magnetizing.share * c.l_lr)
            - point.psi_r * magnetizing.share,
        share: -magnetizing.share,
        current: Complex32::ZERO,
        leakage: point.i * c.l_lr,
    };
    // The gain of one channel: 2/3 a Re(i a*) = (i + a^2 i*)/3 of the current is too much.
    let [a, b, d] = PHASES.map(|axis| {
        let square = axis * axis;
        let current = (point.i + square * point.i.conj()) * (-1.0 / 3.0);
        Direct {
            driven: (y + square * mirrored) * (-c.r_r * c.k_r / 3.0),
            linkage: current * c.l_a,
            current,
            ..Direct::default()
        }
    });
    [
        rotor,
        *magnetizing,
        leakage,
        driven_by(-J * x * omega),
        rotor.scaled(point.skin),
        leakage.scaled(point.bend),
        magnetizing.scaled(point.iron),
        a,
        b,
        d,
        driven_by(J * x * acceleration),
    ]
}
