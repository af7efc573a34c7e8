//! Numerical building blocks of the analyses: Fourier transform, distribution functions, peaks.

pub mod distributions;
pub mod fourier;
pub mod interpolation;
