//! Arithmetic whose results do not depend on order, ranks or machine: sums of quantised numbers and exact sums, random
//! numbers determined by ids, elementary functions; and vector instructions.

mod exact_sum;
mod fetch_ahead;
mod flags;
mod functions;
mod instruction_set;
mod largest;
mod quantum;
mod quick_sum;
mod radix_sort;
mod random;
mod schedule;
mod simd;
mod vectorised;

pub use exact_sum::ExactSum;
pub(crate) use fetch_ahead::{fetch_ahead, fetch_part_ahead};
pub(crate) use flags::{any_flagged, first_flagged};
pub(crate) use functions::{power, powers, sine, whole};
pub use instruction_set::{
    InstructionSet, UnknownInstructionSet, check_instruction_set, instruction_set,
};
pub(crate) use largest::Largest;
pub use quantum::{Quantum, within};
pub(crate) use quick_sum::QuickSum;
pub use radix_sort::sorted_by_key;
pub use random::{normal, random_of, uniform};
pub use schedule::Schedule;
#[cfg(target_arch = "x86_64")]
pub(crate) use simd::avx2_registers;
pub(crate) use simd::{F64x4, four, four_mut, portable_registers};
pub use vectorised::vectorised;
