//! Excess of the fall velocity of a lone particle over that of its drag law, in cells that are not much larger than it.

/// The relative excess of the fall velocity of a lone particle whose drag is computed with the gas that it drags along:
///
/// ```math
/// \frac{s}{1 - s} \left( 1 - 0.6 \left( \frac{d}{h} \right)^3 \right), \qquad
/// s = \frac{b}{\mu d}\, \frac{0.047}{H / d\, (1 + 0.24\, \mathrm{Re}\, H / d)}, \qquad
/// H^2 = h^2 + (1.3\, w)^2 .
/// ```
///
/// s is the fraction of its slip by which the particle accelerates the gas around it, its drag coefficient b times the
/// mobility of Oseen's flow on the grid. h is the edge of a cell and w the width of the filter, both over the diameter;
/// Re is the Reynolds number of the fall, and `resistance` is b / (mu d), 3 pi for Stokes' drag. The last factor
/// accounts for the particle's own volume, which acts as a bed in cells narrower than 2 diameters. Fitted to falls at
/// Re 0.24 and 3 through cells of 1.5 to 6 diameters, to within a quarter of the excess (docs/verification.md has the
/// table).
///
/// ```
/// # use talcum_engine as talcum;
/// use talcum::rules::excess_of_lone_fall;
/// // 40 um, 2000 kg/m^3, in air, on cells of 3 diameters: 16 % are measured.
/// let resistance = 3.0 * std::f64::consts::PI * (1.0 + 0.15 * 0.24_f64.powf(0.687));
/// assert!((excess_of_lone_fall([3.0, 0.0], 0.24, resistance) - 0.157).abs() < 0.02);
/// ```
pub fn excess_of_lone_fall([cell, filter]: [f64; 2], reynolds: f64, resistance: f64) -> f64 {
    let reach = cell.hypot(1.3 * filter);
    // A particle cannot lose all of its slip.
    let share = (0.047 * resistance / (reach * (1.0 + 0.24 * reynolds * reach))).min(0.75);
    let own_volume = 1.0 - (0.6 / cell.powi(3)).min(1.0);
    share / (1.0 - share) * own_volume
}
