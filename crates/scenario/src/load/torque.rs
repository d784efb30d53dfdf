//! What the shaft has to drive.
//!
//! Sign: a positive load torque opposes positive speed; `J d w/dt = tau_em - B w - tau_load`. A load is
//! passive unless it is declared active: a passive load opposes motion in either direction and cannot
//! start it. An active load (a weight on a rope) keeps its direction and drives the shaft when the motor
//! does not hold it.

/// Half-width of the speed band, in rad/s, in which a passive torque passes from one sign to the other.
/// 0.1 rad/s is a revolution a minute: a load at rest yields by less than that instead of chattering.
const STANDSTILL_RAD_S: f64 = 0.1;

/// Load torque as a function of time and speed.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// None.
    None,
    /// `B_l w`: the paper's load. Coefficient in N m s, >= 0.
    Friction(f64),
    /// The same torque at any speed, N m, e.g. a conveyor or a hoist.
    Constant {
        /// N m.
        torque: f64,
        /// Whether it drives the shaft at standstill.
        active: bool,
    },
    /// `k w |w|`, e.g. a fan or a pump. Coefficient in N m s2, >= 0.
    Quadratic(f64),
    /// A torque over time.
    Profile {
        /// The torque.
        profile: Profile,
        /// Whether it drives the shaft at standstill.
        active: bool,
    },
    /// Several loads on one shaft.
    Sum(Vec<Load>),
}

impl Load {
    /// Load torque (N m) at time `t` (s) and shaft speed `omega_mech` (rad/s).
    pub fn torque(&self, t: f64, omega_mech: f64) -> f64 {
        match self {
            Load::None => 0.0,
            Load::Friction(b_l) => b_l * omega_mech,
            Load::Constant { torque, active } => directed(*torque, *active, omega_mech),
            Load::Quadratic(k) => k * omega_mech * omega_mech.abs(),
            Load::Profile { profile, active } => directed(profile.at(t), *active, omega_mech),
            Load::Sum(loads) => loads.iter().map(|load| load.torque(t, omega_mech)).sum(),
        }
    }
}

fn directed(torque: f64, active: bool, omega_mech: f64) -> f64 {
    if active {
        torque
    } else {
        torque * (omega_mech / STANDSTILL_RAD_S).clamp(-1.0, 1.0)
    }
}

/// How a profile goes from one point to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value holds until the next point.
    Step,
    /// A straight line to the next point.
    Linear,
}

/// A quantity over time; before the first point it has the first value, after the last the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    points: Vec<(f64, f64)>,
    interpolation: Interpolation,
}

/// Why points do not make a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProfileError {
    /// No point at all.
    Empty,
    /// A time or a value that is not finite, at this index.
    NotFinite(usize),
    /// A time that is not after the one before it, at this index.
    NotIncreasing(usize),
}

impl std::fmt::Display for ProfileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            ProfileError::Empty => write!(f, "has no points: give at least one time and value"),
            ProfileError::NotFinite(i) => {
                write!(f, "point {} is not finite: write finite numbers", i + 1)
            }
            ProfileError::NotIncreasing(i) => write!(
                f,
                "point {} is not later than the one before it: sort the times",
                i + 1
            ),
        }
    }
}

impl std::error::Error for ProfileError {}

impl Profile {
    /// A profile through points `(time s, value)`.
    ///
    /// # Errors
    /// No points, a point that is not finite, or times that do not increase.
    pub fn new(
        points: Vec<(f64, f64)>,
        interpolation: Interpolation,
    ) -> Result<Profile, ProfileError> {
        if points.is_empty() {
            return Err(ProfileError::Empty);
        }
        if let Some(i) = points
            .iter()
            .position(|(t, x)| !t.is_finite() || !x.is_finite())
        {
            return Err(ProfileError::NotFinite(i));
        }
        if let Some(i) = points.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
            return Err(ProfileError::NotIncreasing(i + 1));
        }
        Ok(Profile {
            points,
            interpolation,
        })
    }

    /// The value at time `t`, s.
    pub fn at(&self, t: f64) -> f64 {
        let next = self.points.partition_point(|(time, _)| *time <= t);
        let Some(before) = next.checked_sub(1) else {
            return self.points[0].1;
        };
        let (t0, x0) = self.points[before];
        match (self.interpolation, self.points.get(next)) {
            (Interpolation::Linear, Some((t1, x1))) => x0 + (x1 - x0) * (t - t0) / (t1 - t0),
            _ => x0,
        }
    }

    /// The points, in the order of time.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passive(torque: f64) -> Load {
        Load::Constant {
            torque,
            active: false,
        }
    }

    #[test]
    fn loads_oppose_motion_in_both_directions() {
        for load in [Load::Friction(0.01), Load::Quadratic(1e-4), passive(2.0)] {
            let (forward, backward) = (load.torque(0.0, 100.0), load.torque(0.0, -100.0));
            assert!(forward > 0.0);
            assert_eq!(forward, -backward);
        }
        assert_eq!(Load::Friction(0.01).torque(0.0, 100.0), 1.0);
        assert_eq!(Load::Quadratic(1e-4).torque(0.0, 100.0), 1.0);
    }

    /// Integrates a shaft without a motor: only an active load may move it.
    #[test]
    fn only_an_active_load_starts_a_shaft_at_rest() {
        let run = |load: &Load| {
            (0..1000).fold(0.0, |omega, _| {
                omega - 1e-3 * load.torque(0.0, omega) / 0.01
            })
        };
        assert_eq!(run(&passive(5.0)), 0.0);
        let hoist = Load::Constant {
            torque: 5.0,
            active: true,
        };
        // tau/J over one second.
        assert!((run(&hoist) + 500.0).abs() < 1e-9);
    }

    #[test]
    fn loads_add() {
        let both = Load::Sum(vec![Load::Friction(0.01), passive(2.0), Load::None]);
        assert_eq!(both.torque(0.0, 100.0), 3.0);
    }

    #[test]
    fn a_profile_holds_or_draws_lines() {
        let points = vec![(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        let step = Profile::new(points.clone(), Interpolation::Step).expect("valid");
        let line = Profile::new(points, Interpolation::Linear).expect("valid");
        for (t, held, drawn) in [
            (0.0, 10.0, 10.0),
            (1.0, 10.0, 10.0),
            (1.5, 10.0, 15.0),
            (2.0, 20.0, 20.0),
            (3.0, 20.0, 10.0),
            (4.0, 0.0, 0.0),
            (9.0, 0.0, 0.0),
        ] {
            assert_eq!((step.at(t), line.at(t)), (held, drawn), "t = {t}");
        }
    }

    #[test]
    fn impossible_profiles_are_refused() {
        let make = |points: &[(f64, f64)]| Profile::new(points.to_vec(), Interpolation::Step);
        assert_eq!(make(&[]), Err(ProfileError::Empty));
        assert_eq!(make(&[(0.0, f64::NAN)]), Err(ProfileError::NotFinite(0)));
        assert_eq!(
            make(&[(0.0, 1.0), (0.0, 2.0)]),
            Err(ProfileError::NotIncreasing(1))
        );
    }
}
