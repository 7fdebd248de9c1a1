//! Keeps the server small: the arrays of a search go back to the system when they are freed.
//!
//! The C library of GNU systems takes blocks above a size from the system one by one, but raises
//! that size with every such block that is freed, up to 32 MB. From then on every thread keeps
//! arrays of its own in its own heap: 430 MB where 220 are in use. A size that is set stays.

/// Size from which on a block is the system's, bytes: what the C library begins with.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const OWN_BLOCK: std::ffi::c_int = 128 * 1024;

/// Holds that size. Elsewhere the allocator does as it does.
pub(super) fn return_large_blocks() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: mallopt takes two numbers, no pointers, and may be called at any time; a value that
    // it does not like changes nothing.
    #[allow(unsafe_code)]
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, OWN_BLOCK);
    }
}
