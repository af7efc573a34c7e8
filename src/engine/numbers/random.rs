//! Random numbers determined by the seed, the id of the particle and the purpose. They do not depend on the ranks, on
//! the order of creation, or on numbers drawn before.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The generator of one particle (or trial) for one purpose, for example `random_of(seed, id, "jitter")`.
pub fn random_of(seed: u64, id: u64, purpose: &str) -> ChaCha8Rng {
    let digest = blake3::Hasher::new()
        .update(&seed.to_le_bytes())
        .update(&id.to_le_bytes())
        .update(purpose.as_bytes())
        .finalize();
    ChaCha8Rng::from_seed(*digest.as_bytes())
}

/// A number in [0, 1), all multiples of 2^-53 equally likely.
pub fn uniform(generator: &mut ChaCha8Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 * 0.5_f64.powi(53)
}

/// A number of the standard normal distribution (Box & Muller 1958).
pub fn normal(generator: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - uniform(generator))).sqrt();
    radius * libm::cos(2.0 * std::f64::consts::PI * uniform(generator))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_reproducible_and_differ_by_seed_id_and_purpose() {
        let draw = |seed, id, purpose| uniform(&mut random_of(seed, id, purpose));
        assert_eq!(draw(1, 2, "jitter"), draw(1, 2, "jitter"));
        assert_ne!(draw(1, 2, "jitter"), draw(2, 2, "jitter"));
        assert_ne!(draw(1, 2, "jitter"), draw(1, 3, "jitter"));
        assert_ne!(draw(1, 2, "jitter"), draw(1, 2, "diameter"));
    }

    #[test]
    fn moments_of_uniform_and_normal_numbers_are_correct() {
        let n = 20_000;
        let mut generator = random_of(7, 0, "moments");
        let mean: f64 = (0..n).map(|_| uniform(&mut generator)).sum::<f64>() / n as f64;
        // Four standard deviations of the mean of n uniform numbers.
        assert!((mean - 0.5).abs() < 4.0 / (12.0 * n as f64).sqrt());
        let square: f64 = (0..n).map(|_| normal(&mut generator).powi(2)).sum::<f64>() / n as f64;
        assert!((square - 1.0).abs() < 4.0 * (2.0 / n as f64).sqrt());
    }
}
