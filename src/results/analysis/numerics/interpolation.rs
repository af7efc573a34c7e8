//! Values and peaks between the points of an even grid.

/// The value at `place`, in units of the spacing from the first point, by the cubic through the four nearest points
/// (Lagrange); linear in the first and last interval; constant outside.
pub fn value_at(values: &[f64], place: f64) -> f64 {
    let last = values.len().saturating_sub(1);
    if last == 0 {
        return values.first().copied().unwrap_or(0.0);
    }
    let place = place.clamp(0.0, last as f64);
    let below = (place as usize).min(last - 1);
    let x = place - below as f64;
    if below == 0 || below + 2 > last {
        return values[below] + x * (values[below + 1] - values[below]);
    }
    let [a, b, c, d] = [values[below - 1], values[below], values[below + 1], values[below + 2]];
    -a * x * (x - 1.0) * (x - 2.0) / 6.0 + b * (x * x - 1.0) * (x - 2.0) / 2.0
        - c * x * (x + 1.0) * (x - 2.0) / 2.0
        + d * x * (x * x - 1.0) / 6.0
}

/// Position of the maximum near point `index`, in units of the spacing, by the parabola through the point and its
/// neighbours; the point itself at the ends of the grid or if the three points have no maximum.
pub fn peak_near(values: &[f64], index: usize) -> f64 {
    if index == 0 || index + 1 >= values.len() {
        return index as f64;
    }
    let (before, here, after) = (values[index - 1], values[index], values[index + 1]);
    let curvature = before - 2.0 * here + after;
    if curvature < 0.0 {
        index as f64 + (0.5 * (before - after) / curvature).clamp(-0.5, 0.5)
    } else {
        index as f64
    }
}

/// Position of the maximum near point `index`, in units of the spacing. It is that of the least-squares parabola
/// through all points around it whose values are at least `part` of its own, so that ripples from noise do not shift
/// it. With fewer than five such points, or if the maximum of the parabola is not among them, it is that of
/// [`peak_near`].
pub fn broad_peak_near(values: &[f64], index: usize, part: f64) -> f64 {
    let least = part * values[index];
    let below = values[..index].iter().rev().take_while(|&&value| value >= least).count();
    let above = values[index + 1..].iter().take_while(|&&value| value >= least).count();
    // The range is symmetric, so that the ends of the grid do not matter.
    let reach = below.min(above);
    if reach < 2 {
        return peak_near(values, index);
    }
    let (mut slope, mut curvature) = (0.0, 0.0);
    let (mut squares, mut fourths) = (0.0, 0.0);
    let mean_square = (reach * (reach + 1)) as f64 / 3.0;
    for (offset, value) in values[index - reach..=index + reach].iter().enumerate() {
        let x = offset as f64 - reach as f64;
        let bend = x * x - mean_square;
        slope += x * value;
        curvature += bend * value;
        squares += x * x;
        fourths += bend * bend;
    }
    let shift = -0.5 * (slope / squares) / (curvature / fourths);
    if curvature < 0.0 && shift.abs() <= reach as f64 {
        index as f64 + shift
    } else {
        peak_near(values, index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_and_parabolas_are_exact() {
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.1 * x * x * x;
        let values: Vec<f64> = (0..8).map(|i| cubic(f64::from(i))).collect();
        // Between the second and the last but one point the cubic is reproduced up to round-off.
        assert!((value_at(&values, 3.37) - cubic(3.37)).abs() < 1e-13);
        let parabola: Vec<f64> =
            (0..8).map(|i| -(f64::from(i) - 4.3) * (f64::from(i) - 4.3)).collect();
        assert!((peak_near(&parabola, 4) - 4.3).abs() < 1e-13);
        let high: Vec<f64> = parabola.iter().map(|value| value + 20.0).collect();
        assert!((broad_peak_near(&high, 4, 0.6) - 4.3).abs() < 1e-13);
        assert_eq!(value_at(&[], 1.0), 0.0);
        assert_eq!(value_at(&[5.0], 1.0), 5.0);
    }
}
