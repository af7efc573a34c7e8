//! Fast Fourier transform by radix 2, with twiddle factors from `libm`.

use std::f64::consts::PI;

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// |z|^2.
    pub fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// conj(self) * other.
    pub fn conjugate_times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re + self.im * other.im,
            im: self.re * other.im - self.im * other.re,
        }
    }

    fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

/// Direction of a transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// X_k = sum_n x_n exp(-2 pi i k n / N).
    Forward,
    /// x_n = (1/N) sum_k X_k exp(+2 pi i k n / N).
    Inverse,
}

/// Tables for transforms of one length.
#[derive(Clone, Debug)]
pub struct FourierTransform {
    twiddles: Vec<Complex>,
}

impl FourierTransform {
    /// A transform for the smallest power of two that is not below `length` (and not below 2).
    pub fn at_least(length: usize) -> Self {
        let size = length.max(2).next_power_of_two();
        let twiddles = (0..size / 2)
            .map(|k| {
                let angle = -2.0 * PI * k as f64 / size as f64;
                Complex { re: libm::cos(angle), im: libm::sin(angle) }
            })
            .collect();
        Self { twiddles }
    }

    /// The number of points.
    pub fn size(&self) -> usize {
        2 * self.twiddles.len()
    }

    /// Spectrum of a real series, padded with zeros to the transform's size; longer series are truncated.
    pub fn spectrum(&self, series: &[f64]) -> Vec<Complex> {
        let mut values = vec![Complex::default(); self.size()];
        for (value, &sample) in values.iter_mut().zip(series) {
            value.re = sample;
        }
        self.transform(&mut values, Direction::Forward);
        values
    }

    /// Transforms in place; slices whose length differs from [`Self::size`] are left unchanged.
    pub fn transform(&self, values: &mut [Complex], direction: Direction) {
        let size = self.size();
        if values.len() != size {
            return;
        }
        reverse_bits(values);
        let mut half = 1;
        while half < size {
            self.butterflies(values, half, direction);
            half *= 2;
        }
        if direction == Direction::Inverse {
            let scale = 1.0 / size as f64;
            for value in values {
                value.re *= scale;
                value.im *= scale;
            }
        }
    }

    fn butterflies(&self, values: &mut [Complex], half: usize, direction: Direction) {
        let stride = self.twiddles.len() / half;
        for block in values.chunks_exact_mut(2 * half) {
            let (lower, upper) = block.split_at_mut(half);
            for (k, (a, b)) in lower.iter_mut().zip(upper).enumerate() {
                let mut twiddle = self.twiddles[k * stride];
                if direction == Direction::Inverse {
                    twiddle.im = -twiddle.im;
                }
                let turned = b.times(twiddle);
                *b = Complex { re: a.re - turned.re, im: a.im - turned.im };
                *a = Complex { re: a.re + turned.re, im: a.im + turned.im };
            }
        }
    }
}

fn reverse_bits(values: &mut [Complex]) {
    let bits = values.len().trailing_zeros();
    for index in 0..values.len() {
        let partner = index.reverse_bits() >> (usize::BITS - bits);
        if index < partner {
            values.swap(index, partner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectrum_is_that_of_the_definition_and_the_inverse_returns_the_series() {
        let series: Vec<f64> = (0..16).map(|n| f64::from((n * n + 3) % 7) - 2.5).collect();
        let transform = FourierTransform::at_least(16);
        let mut spectrum = transform.spectrum(&series);
        for (k, value) in spectrum.iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (n, sample) in series.iter().enumerate() {
                let angle = -2.0 * PI * (k * n) as f64 / 16.0;
                re += sample * angle.cos();
                im += sample * angle.sin();
            }
            // Round-off of 16 terms of order 5.
            assert!((value.re - re).abs() < 1e-12 && (value.im - im).abs() < 1e-12);
        }
        transform.transform(&mut spectrum, Direction::Inverse);
        for (value, sample) in spectrum.iter().zip(&series) {
            assert!((value.re - sample).abs() < 1e-13 && value.im.abs() < 1e-13);
        }
    }
}
