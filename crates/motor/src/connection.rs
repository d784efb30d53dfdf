//! Star and delta, rms and peak.

use num_traits::Float;

fn constant<F: Float>(x: f64) -> F {
    F::from(x).unwrap_or_else(F::nan)
}

/// Amplitude of a sinusoid from its rms value: `sqrt(2) x`.
pub fn amplitude_of_rms<F: Float>(rms: F) -> F {
    rms * constant(core::f64::consts::SQRT_2)
}

/// Rms value of a sinusoid from its amplitude: `x / sqrt(2)`.
pub fn rms_of_amplitude<F: Float>(amplitude: F) -> F {
    amplitude * constant(core::f64::consts::FRAC_1_SQRT_2)
}

/// Amplitude of the phase voltage of the (equivalent) star from the line-to-line rms voltage: `sqrt(2/3) x`.
pub fn phase_amplitude_of_line_rms<F: Float>(line_rms: F) -> F {
    line_rms * (constant::<F>(2.0) / constant(3.0)).sqrt()
}

/// Line-to-line rms voltage from the phase amplitude of the (equivalent) star: `sqrt(3/2) x`.
pub fn line_rms_of_phase_amplitude<F: Float>(amplitude: F) -> F {
    amplitude * (constant::<F>(3.0) / constant(2.0)).sqrt()
}

/// Impedance (ohm, or H) of the equivalent star phase from that of a delta phase: a third.
pub fn star_of_delta<F: Float>(delta: F) -> F {
    delta / constant(3.0)
}

/// Impedance (ohm, or H) of a delta phase from that of the equivalent star phase: three times.
pub fn delta_of_star<F: Float>(star: F) -> F {
    star * constant(3.0)
}

/// Line current from the current in a delta winding (both rms or both amplitudes): `sqrt(3) x`.
pub fn line_current_of_delta_phase<F: Float>(phase: F) -> F {
    phase * constant::<F>(3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A balanced star and a balanced delta take the same line current from the same line voltage when
    /// the delta's impedance is three times the star's: computed here from both circuits.
    #[test]
    fn star_and_delta_draw_the_same_line_current() {
        let (line_volt, star_ohm) = (400.0_f64, 7.0);
        let star_current = line_volt / 3.0_f64.sqrt() / star_ohm;
        let delta_current = line_current_of_delta_phase(line_volt / delta_of_star(star_ohm));
        assert!((star_current / delta_current - 1.0).abs() < 4.0 * f64::EPSILON);
        assert_eq!(star_of_delta(delta_of_star(star_ohm)), star_ohm);
    }

    /// 230 V rms has its peak at 325.27 V; 400 V between lines is 326.60 V peak per phase.
    #[test]
    fn peaks_of_the_public_supply() {
        assert!((amplitude_of_rms(230.0_f64) - 325.269_119_345_812_3).abs() < 1e-9);
        assert!((phase_amplitude_of_line_rms(400.0_f64) - 326.598_632_371_090_5).abs() < 1e-9);
        assert!((line_rms_of_phase_amplitude(326.598_632_371_090_5_f64) - 400.0).abs() < 1e-9);
        assert!((rms_of_amplitude(amplitude_of_rms(3.0_f32)) - 3.0).abs() < 1e-6);
    }
}
