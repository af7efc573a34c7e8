//! Elementary functions in the path of the state: in pure Rust, so that the bits do not depend on the
//! machine's C library.

/// sin(x), x in radians.
pub fn sine(x: f64) -> f64 {
    libm::sin(x)
}

/// x^y for x > 0.
pub fn power(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}
