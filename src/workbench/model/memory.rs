//! Memory that large tasks have freed.
#![cfg_attr(
    all(target_os = "linux", target_env = "gnu"),
    expect(
        unsafe_code,
        reason = "libc marks every call of the C library as unsafe"
    )
)]

/// Gives what was freed back to the system. The allocator of Linux would keep most of it for later: each thread has its
/// own, and what is still in use at the end of one holds all before it.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: takes no pointers, and may be called at any time on any thread.
    unsafe {
        // Whether there was anything to give back does not matter.
        libc::malloc_trim(0);
    }
}
