//! Resistance and temperature.

use num_traits::Float;

/// Temperature at which the resistance of copper extrapolates to zero, degC below zero: IEC 60034-1
/// uses 235 (234.5 in IEEE Std 112), rounded measurements of the same line.
pub const COPPER_ZERO_RESISTANCE_DEGC: f64 = 234.5;

/// Resistance of a copper winding at another temperature.
///
/// `r` is the resistance (ohm) at `from_degc`; the answer holds at `to_degc`:
/// `R_2 = R_1 (234.5 + t_2)/(234.5 + t_1)` (IEEE Std 112-2017, clause 5.2.1). Valid where the line is: from
/// -100 to 400 degC. Aluminium has 225 instead; a cage rotor of aluminium errs by 1 % at 100 K.
pub fn copper_resistance_at<F: Float>(r: F, from_degc: F, to_degc: F) -> F {
    let k = F::from(COPPER_ZERO_RESISTANCE_DEGC).unwrap_or_else(F::nan);
    r * (k + to_degc) / (k + from_degc)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.393 % per kelvin at 20 degC is the published coefficient of annealed copper (IEC 60028).
    #[test]
    fn the_slope_at_20_degrees_is_the_published_one() {
        let per_kelvin = copper_resistance_at(1.0, 20.0, 21.0) - 1.0;
        assert!((per_kelvin - 0.003_93).abs() < 0.000_005, "{per_kelvin}");
    }

    #[test]
    fn there_and_back_is_the_same() {
        let hot = copper_resistance_at(0.56, 20.0, 90.0);
        assert!((copper_resistance_at(hot, 90.0, 20.0) - 0.56_f64).abs() < 1e-15);
        assert!(hot > 0.71 && hot < 0.72);
    }
}
