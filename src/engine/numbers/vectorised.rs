//! Functions that are compiled for several instruction sets, one of which is chosen when they are called.

/// Compiles a function for several instruction sets. Each call chooses the widest that the processor has.
///
/// The argument of the macro is an ordinary function of one of two kinds. In the first the compiler finds the vectors
/// by itself:
///
/// ```ignore
/// vectorised!(
///     /// Adds the second row to the first.
///     fn add(to: &mut [f64], from: &[f64]) {
///         to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
///     }
/// );
/// ```
///
/// The second works with registers of four numbers, `F64x4`. Its first type parameter is `Q: F64x4`,
/// which the macro fills in, so that callers do not name it:
///
/// ```ignore
/// vectorised!(
///     /// Adds the second four numbers to the first.
///     fn add_four<Q: F64x4>(to: &mut [f64; 4], from: &[f64; 4]) {
///         Q::load(to).plus(Q::load(from)).store(to);
///     }
/// );
/// add_four(&mut force, &change);
/// ```
///
/// `add_four` becomes
///
/// ```ignore
/// fn add_four(to: &mut [f64; 4], from: &[f64; 4]) {
///     #[inline(always)]
///     fn with_registers<Q: F64x4>(_: PhantomData<Q>, to: &mut [f64; 4], from: &[f64; 4]) {
///         Q::load(to).plus(Q::load(from)).store(to);
///     }
///     #[target_feature(enable = "avx2")]
///     fn in_avx2(to: &mut [f64; 4], from: &[f64; 4]) {
///         with_registers(avx2_registers(), to, from)
///     }
///     // Likewise `in_avx512`.
///     match instruction_set() {
///         InstructionSet::Avx512 => unsafe { in_avx512(to, from) },
///         InstructionSet::Avx2 => unsafe { in_avx2(to, from) },
///         InstructionSet::Baseline => with_registers(portable_registers(), to, from),
///     }
/// }
/// ```
///
/// A function of the first kind has no copy for AVX-512: its loops run over rows, most of which are too short to
/// benefit from it.
///
/// The bits are the same in all copies: each operation is rounded once, multiplications and additions are never fused,
/// and the width of a vector is only the number of values that are worked on side by side.
///
/// # Rules for the function
/// * All functions that it calls must be `#[inline(always)]`: only inlined code is compiled for the instructions of a
///   copy. Closures often are not inlined; vectors in them, and therefore in `map` of arrays, are an order of magnitude
///   slower.
/// * Arguments are plain names, without patterns, `mut` or `self`. All generic parameters except `Q` follow from their
///   types.
/// * The loop over a row lies in a function of its own that takes each row it writes to as an argument `&mut [T]`. The
///   compiler then knows that the row overlaps with no other, and compares no addresses at run time, which would take
///   longer than a short row itself.
/// * This loop counts `0..n`, and all rows are slices of one length, cut with the same variable. If a bounds check
///   remains in the loop, the last cells of each row, at least one of them, are processed by a loop without vectors.
///
/// # Why this is sound
/// The copies are safe code. Calling one is `unsafe` for a single reason: a processor without its instructions would
/// fault, or do something else. Each call depends on [`instruction_set`](super::instruction_set), which never exceeds
/// what was detected on this processor, and the features of `in_avx512` are those that it detects. The type of the
/// registers of AVX2 is private to `simd.rs`. Generic code gets it only from `avx2_registers`, which is `unsafe` to
/// call in the same way, except from functions that are compiled for AVX2, such as the copies.
#[macro_export]
macro_rules! vectorised {
    // A generic parameter is `T: Bound` or `const N: usize`: one or two identifiers, a colon, and a path.
    (
        $(#[$attribute:meta])*
        $visibility:vis fn $name:ident<Q: F64x4 $(, $($parameter:ident)+: $bound:path)*>(
            $($argument:ident: $type:ty),* $(,)?
        ) $(-> $output:ty)? $body:block
    ) => {
        $(#[$attribute])*
        $visibility fn $name<$($($parameter)+: $bound),*>($($argument: $type),*) $(-> $output)? {
            #[inline(always)]
            fn with_registers<Q: F64x4 $(, $($parameter)+: $bound)*>(
                _: ::std::marker::PhantomData<Q>,
                $($argument: $type),*
            ) $(-> $output)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn in_avx2<$($($parameter)+: $bound),*>($($argument: $type),*) $(-> $output)? {
                with_registers($crate::numbers::avx2_registers(), $($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512vl,avx512bw,avx512dq,avx2")]
            fn in_avx512<$($($parameter)+: $bound),*>($($argument: $type),*) $(-> $output)? {
                with_registers($crate::numbers::avx2_registers(), $($argument),*)
            }

            match $crate::numbers::instruction_set() {
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the instruction set is chosen at run time")]
                // SAFETY: the processor has AVX-512, since its set is chosen.
                $crate::numbers::InstructionSet::Avx512 => unsafe { in_avx512($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the instruction set is chosen at run time")]
                // SAFETY: the processor has AVX2, since its set is chosen.
                $crate::numbers::InstructionSet::Avx2 => unsafe { in_avx2($($argument),*) },
                _ => with_registers($crate::numbers::portable_registers(), $($argument),*),
            }
        }
    };
    (
        $(#[$attribute:meta])*
        $visibility:vis fn $name:ident$(<$($($parameter:ident)+: $bound:path),+>)?(
            $($argument:ident: $type:ty),* $(,)?
        ) $(-> $output:ty)? $body:block
    ) => {
        $(#[$attribute])*
        $visibility fn $name$(<$($($parameter)+: $bound),+>)?($($argument: $type),*) $(-> $output)? {
            #[inline(always)]
            fn on_any_processor$(<$($($parameter)+: $bound),+>)?($($argument: $type),*) $(-> $output)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn in_avx2$(<$($($parameter)+: $bound),+>)?($($argument: $type),*) $(-> $output)? {
                on_any_processor($($argument),*)
            }

            match $crate::numbers::instruction_set() {
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the instruction set is chosen at run time")]
                // SAFETY: the processor has AVX2, which both sets include.
                $crate::numbers::InstructionSet::Avx2 | $crate::numbers::InstructionSet::Avx512 => unsafe {
                    in_avx2($($argument),*)
                },
                _ => on_any_processor($($argument),*),
            }
        }
    };
}

pub use vectorised;
