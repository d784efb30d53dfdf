//! What a window measured, freed from physical effects, and the operating point that it stands for.

use motor::TParams;

use crate::model::effects::{ActiveEffects, Corrected, correct};
use crate::model::operating_point::{Frame, OperatingPoint};
use crate::model::settled::settled;
use crate::monitor::Monitor;
use crate::rehearsal::Rehearsal;
use crate::window::Window;

impl Monitor {
    /// What one window measured, freed from physical effects.
    pub(crate) fn corrected(&self, window: &Window) -> Option<Corrected> {
        self.corrected_at(0.0, window)
    }

    /// The same with resistances that have risen by this share: an effect's law may depend on the flux behind them.
    #[inline(never)]
    pub(crate) fn corrected_at(&self, rise: f32, window: &Window) -> Option<Corrected> {
        let moving = self.moving_at(rise, window)?;
        let mechanics = &self.config.mechanics;
        Some(settled(
            &moving,
            &window.rates,
            window.omega_sync,
            mechanics,
        ))
    }

    /// The same as it is, with whatever it changes.
    #[inline(never)]
    pub(crate) fn moving_at(&self, rise: f32, window: &Window) -> Option<Corrected> {
        let config = &self.config;
        let params = TParams {
            r_s: config.params.r_s * (1.0 + rise),
            r_r: config.params.r_r * (1.0 + rise),
            ..config.params
        };
        self.moving(&params, &config.effects, window)
    }

    fn moving(
        &self,
        params: &TParams<f32>,
        effects: &ActiveEffects,
        window: &Window,
    ) -> Option<Corrected> {
        Some(correct(
            (effects, &self.config.laws),
            self.rated,
            params,
            [window.u_s.positive, window.i_s.positive],
            [window.omega_sync, window.omega_mech?],
        ))
    }

    #[inline(never)]
    pub(crate) fn operating_point(
        &self,
        frame: Frame,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<OperatingPoint> {
        self.point_at(&self.corrected(window)?, frame, rehearsal, window)
    }

    /// The operating point as another motor would have it.
    pub(crate) fn operating_point_of(
        &self,
        params: &TParams<f32>,
        effects: &ActiveEffects,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<OperatingPoint> {
        let moving = self.moving(params, effects, window)?;
        let mechanics = &self.config.mechanics;
        let corrected = settled(&moving, &window.rates, window.omega_sync, mechanics);
        self.point_at(&corrected, self.config.frame, rehearsal, window)
    }

    #[inline(never)]
    pub(crate) fn point_at(
        &self,
        corrected: &Corrected,
        frame: Frame,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<OperatingPoint> {
        let omega_el = corrected.omega_mech * self.config.mechanics.n_p;
        OperatingPoint::new(corrected, frame, window.omega_sync, omega_el)
            .map(|point| point.rehearse(rehearsal))
    }
}
