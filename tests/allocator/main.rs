//! The allocator returns large arrays to the system when they are freed. This is a process of its own with a single
//! test, since allocations of other tests would be counted too.

#![cfg(all(target_os = "linux", target_env = "gnu"))]
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

use std::hint::black_box;
use talcum::parallel::AllocatorOfRanks;

const MEBIBYTE: usize = 1 << 20;

/// An array of so many mebibytes, all of which is in memory.
fn array(mebibytes: usize) -> Vec<u8> {
    black_box(vec![1; mebibytes * MEBIBYTE])
}

/// Memory of this process, in mebibytes.
fn resident() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<usize>().unwrap() / 1024
}

/// What remains of an array of so many mebibytes after it was freed, if a smaller one behind it is not.
fn left_of(mebibytes: usize) -> usize {
    let before = resident();
    let freed = array(mebibytes);
    let kept = black_box(vec![1_u8; 1000]);
    assert!(resident() >= before + mebibytes - 1);
    drop(freed);
    let after = resident();
    drop(kept);
    after.saturating_sub(before)
}

#[test]
fn large_arrays_return_to_the_system() {
    // A control: what glibc has freed once by itself, it keeps from then on.
    drop(array(24));
    assert!(left_of(20) >= 19);
    AllocatorOfRanks::return_large_arrays();
    assert!(left_of(28) <= 1); // it does not fit into what is left of the other
    assert!(left_of(32) <= 1);
}
