//! Release of the memory of large tasks.
#![cfg_attr(
    all(target_os = "linux", target_env = "gnu"),
    expect(
        unsafe_code,
        reason = "libc marks every call of the C library as unsafe"
    )
)]

/// Returns freed memory to the system. The allocator of Linux would keep most of it: it has one arena per thread, and a
/// block in use at the end of an arena keeps all memory before it.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: takes no pointers, and may be called at any time on any thread.
    unsafe {
        // It does not matter whether there was anything to release.
        libc::malloc_trim(0);
    }
}
