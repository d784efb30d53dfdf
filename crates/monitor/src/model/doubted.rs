//! What uncertain parameters leave open: residuals that they alone explain light nothing.

use motor::TParams;

use crate::model::doubt::DEVIATIONS;
use crate::model::effects::ActiveEffects;
use crate::model::residuals::{RESIDUALS, Residuals};
use crate::monitor::Monitor;
use crate::rehearsal::Rehearsal;
use crate::window::Window;

/// A doubt of less than this share of a residual is nothing that a lamp could show.
const NEGLIGIBLE: f32 = 1e-6;

/// One motor that the plate allows.
struct Candidate {
    params: TParams<f32>,
    effects: ActiveEffects,
}

impl Monitor {
    /// Change of each residual that is `DEVIATIONS` standard deviations of all doubts together.
    #[inline(never)]
    pub(crate) fn parameter_doubt(
        &self,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> [f32; RESIDUALS] {
        let doubt = &self.config.doubt;
        let mut squares = [0.0; RESIDUALS];
        if !doubt.is_any() {
            return squares;
        }
        let Some((_, residuals)) = self.residuals_with(0.0, rehearsal, window) else {
            return squares;
        };
        let mut add = |up: Candidate, down: Candidate| {
            let changes =
                [up, down].map(|candidate| self.change(&candidate, rehearsal, window, &residuals));
            for (square, (a, b)) in squares.iter_mut().zip(changes[0].iter().zip(changes[1])) {
                let greater = a.max(b);
                *square += greater * greater;
            }
        };
        for (k, sigma) in doubt
            .circuit
            .iter()
            .enumerate()
            .filter(|(_, sigma)| **sigma > 0.0)
        {
            add(
                self.circuit_moved(k, DEVIATIONS * sigma),
                self.circuit_moved(k, -DEVIATIONS * sigma),
            );
        }
        for (effect, sigmas) in doubt.effects.iter().enumerate() {
            for (k, sigma) in sigmas.iter().enumerate().filter(|(_, sigma)| **sigma > 0.0) {
                add(
                    self.effect_moved([effect, k], DEVIATIONS * sigma),
                    self.effect_moved([effect, k], -DEVIATIONS * sigma),
                );
            }
        }
        squares.map(processor::sqrtf)
    }

    fn circuit_moved(&self, k: usize, log: f32) -> Candidate {
        let mut params = self.config.params;
        let places = [
            &mut params.r_s,
            &mut params.r_r,
            &mut params.l_ls,
            &mut params.l_lr,
            &mut params.l_m,
        ];
        for place in places.into_iter().skip(k).take(1) {
            *place *= libm::expf(log);
        }
        Candidate {
            params,
            effects: self.config.effects,
        }
    }

    fn effect_moved(&self, [effect, k]: [usize; 2], log: f32) -> Candidate {
        let mut effects = self.config.effects;
        let active = effects.iter_mut().skip(effect).take(1).flatten();
        for place in active.flat_map(|active| active.parameters.iter_mut().skip(k).take(1)) {
            *place *= libm::expf(log);
        }
        Candidate {
            params: self.config.params,
            effects,
        }
    }

    /// How far the residuals of another motor are from these.
    #[inline(never)]
    fn change(
        &self,
        candidate: &Candidate,
        rehearsal: &Rehearsal,
        window: &Window,
        residuals: &Residuals,
    ) -> [f32; RESIDUALS] {
        let mut change = [0.0; RESIDUALS];
        let Some(point) =
            self.operating_point_of(&candidate.params, &candidate.effects, rehearsal, window)
        else {
            return change;
        };
        let other = self.model.evaluate(&point, self.tau_load(window));
        for (change, (a, b)) in change.iter_mut().zip(other.r.iter().zip(residuals.r)) {
            let difference = (a - b).abs();
            if difference > NEGLIGIBLE {
                *change = difference;
            }
        }
        change
    }
}
