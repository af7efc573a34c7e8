//! Four numbers side by side, for loops that the compiler does not turn into vector instructions by itself.

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::avx2_registers;
use std::marker::PhantomData;

/// Four doubles in one register.
///
/// Each operation is an IEEE operation on each number, rounded once, so that all implementations give the same bits.
/// Everything is `#[inline(always)]`: it must be compiled into the function that was chosen for the processor.
///
/// The methods are safe although those of one implementation are vector instructions of AVX2; its documentation
/// explains why no code can reach it on a processor without them.
pub(crate) trait F64x4: Copy {
    /// Loads four numbers from memory.
    fn load(numbers: &[f64; 4]) -> Self;

    /// Stores the numbers in memory.
    fn store(self, numbers: &mut [f64; 4]);

    /// Returns the same number four times.
    fn splat(number: f64) -> Self;

    /// Adds number by number.
    fn plus(self, other: Self) -> Self;

    /// Subtracts number by number.
    fn minus(self, other: Self) -> Self;

    /// Multiplies number by number.
    fn times(self, other: Self) -> Self;

    /// Divides number by number.
    fn over(self, other: Self) -> Self;

    /// Takes the square root of each number.
    fn root(self) -> Self;

    /// Takes the magnitude of each number.
    fn magnitude(self) -> Self;

    /// Takes the larger of each two numbers; either of them if one is undefined.
    fn larger(self, other: Self) -> Self;

    /// Bits of a comparison: bit k is set if number k is less than that of the other, and neither is undefined.
    fn below(self, other: Self) -> u32;

    /// Bits of a comparison: bit k is set if number k is at most that of the other, and neither is undefined.
    fn at_most(self, other: Self) -> u32;

    /// Turns rows into columns.
    fn transposed(rows: [Self; 4]) -> [Self; 4];
}

/// Four consecutive items of a slice.
#[inline(always)]
pub(crate) fn four<T>(items: &[T], from: usize) -> &[T; 4] {
    items[from..].first_chunk().expect("the slice has four items from there on")
}

/// Mutable access to four consecutive numbers.
#[inline(always)]
pub(crate) fn four_mut(numbers: &mut [f64], from: usize) -> &mut [f64; 4] {
    numbers[from..].first_chunk_mut().expect("the slice has four numbers from there on")
}

/// The registers of any processor, as a type parameter determined by the argument.
pub(crate) fn portable_registers() -> PhantomData<impl F64x4> {
    PhantomData::<Portable>
}

/// Four numbers on any processor.
#[derive(Clone, Copy)]
struct Portable([f64; 4]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        let (a, b) = (self.0, other.0);
        Self([
            operation(a[0], b[0]),
            operation(a[1], b[1]),
            operation(a[2], b[2]),
            operation(a[3], b[3]),
        ])
    }
}

impl F64x4 for Portable {
    #[inline(always)]
    fn load(numbers: &[f64; 4]) -> Self {
        Self(*numbers)
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f64; 4]) {
        *numbers = self.0;
    }

    #[inline(always)]
    fn splat(number: f64) -> Self {
        Self([number; 4])
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }

    #[inline(always)]
    fn root(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a.sqrt(), b.sqrt(), c.sqrt(), d.sqrt()])
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([a.abs(), b.abs(), c.abs(), d.abs()])
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn below(self, other: Self) -> u32 {
        (0..4).map(|k| u32::from(self.0[k] < other.0[k]) << k).sum()
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        (0..4).map(|k| u32::from(self.0[k] <= other.0[k]) << k).sum()
    }

    #[inline(always)]
    fn transposed(rows: [Self; 4]) -> [Self; 4] {
        let [Self(a), Self(b), Self(c), Self(d)] = rows;
        [
            Self([a[0], b[0], c[0], d[0]]),
            Self([a[1], b[1], c[1], d[1]]),
            Self([a[2], b[2], c[2], d[2]]),
            Self([a[3], b[3], c[3], d[3]]),
        ]
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    #![allow(
        unsafe_code,
        reason = "vector instructions of AVX2; `Avx2` says why they are never reached without it"
    )]

    use super::F64x4;
    use std::arch::x86_64::*;
    use std::marker::PhantomData;

    /// The registers of AVX2, as a type parameter determined by the argument. Unsafe to call unless the processor has
    /// AVX2.
    #[target_feature(enable = "avx2")]
    pub(crate) fn avx2_registers() -> PhantomData<impl F64x4> {
        PhantomData::<Avx2>
    }

    /// Four numbers in a register of AVX2.
    ///
    /// Its methods are safe functions that execute instructions of AVX2. This is sound by one invariant: **code that
    /// uses this type runs only if the processor has AVX2.** The type is private to this module, so that nothing else
    /// can name it, and generic code gets it only from `avx2_registers`, which is `unsafe` to call without AVX2
    /// (`#[target_feature]`). [`vectorised`](crate::numbers::vectorised) calls it, in functions that it calls after
    /// AVX2 has been detected. A function may keep or return values of it: they exist only in a process that runs on
    /// such a processor.
    ///
    /// Loads and stores need no alignment, and `&[f64; 4]` is exactly the memory that they access.
    #[derive(Clone, Copy)]
    struct Avx2(__m256d);

    impl F64x4 for Avx2 {
        #[inline(always)]
        fn load(numbers: &[f64; 4]) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, numbers: &mut [f64; 4]) {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn splat(number: f64) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_set1_pd(number) })
        }

        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_add_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn minus(self, other: Self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_sub_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn times(self, other: Self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_mul_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn over(self, other: Self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_div_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn root(self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }

        #[inline(always)]
        fn magnitude(self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }

        #[inline(always)]
        fn larger(self, other: Self) -> Self {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn below(self, other: Self) -> u32 {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn at_most(self, other: Self) -> u32 {
            // SAFETY: the processor has AVX2, by the invariant of this type.
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }

        #[inline(always)]
        fn transposed(rows: [Self; 4]) -> [Self; 4] {
            let [Self(a), Self(b), Self(c), Self(d)] = rows;
            // SAFETY: the processor has AVX2, by the invariant of this type.
            unsafe {
                let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::vectorised;

    #[inline(always)]
    fn all_operations<Q: F64x4>() -> [[f64; 4]; 12] {
        let (a, b) = (Q::load(&[0.1, 0.2, 0.3, 0.4]), Q::load(&[-0.7, 3.0, 1.0e-9, 7.0]));
        let columns = Q::transposed([a, b, a.times(b), Q::splat(0.3)]);
        let sums = [a, a.plus(b), a.minus(b), a.times(b), a.larger(b)];
        let results = sums.into_iter().chain([a.over(b), a.root(), b.magnitude()]);
        let mut numbers = [[0.0; 4]; 12];
        for (four, numbers) in results.chain(columns).zip(&mut numbers) {
            four.store(numbers);
        }
        numbers
    }

    vectorised!(
        fn all_operations_here<Q: F64x4>() -> [[f64; 4]; 12] {
            all_operations::<Q>()
        }
    );

    #[test]
    fn all_implementations_give_the_same_bits() {
        let all = all_operations_here();
        assert_eq!(all, all_operations::<Portable>());
        let [a, sum, _, _, larger, quotient, root, magnitude, columns @ ..] = all;
        assert_eq!(a, [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(sum, [0.1 - 0.7, 0.2 + 3.0, 0.3 + 1.0e-9, 0.4 + 7.0]);
        assert_eq!(larger, [0.1, 3.0, 0.3, 7.0]);
        assert_eq!(quotient, [0.1 / -0.7, 0.2 / 3.0, 0.3 / 1.0e-9, 0.4 / 7.0]);
        assert_eq!(root, [0.1_f64, 0.2, 0.3, 0.4].map(f64::sqrt));
        assert_eq!(magnitude, [0.7, 3.0, 1.0e-9, 7.0]);
        assert_eq!(columns[1], [0.2, 3.0, 0.2 * 3.0, 0.3]);
    }

    #[inline(always)]
    fn comparisons<Q: F64x4>() -> u32 {
        let (a, b) = (Q::load(&[1.0, 2.0, f64::NAN, -4.0]), Q::load(&[2.0, 2.0, 3.0, 0.0]));
        a.below(b) | b.below(a) << 4 | a.at_most(b) << 8 | b.at_most(a) << 12
    }

    vectorised!(
        fn comparisons_here<Q: F64x4>() -> u32 {
            comparisons::<Q>()
        }
    );

    #[test]
    fn all_implementations_compare_alike() {
        let expected = 0b0010_1011_0000_1001;
        assert_eq!(comparisons_here(), expected);
        assert_eq!(comparisons::<Portable>(), expected);
    }
}
