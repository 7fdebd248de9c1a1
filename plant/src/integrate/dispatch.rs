//! The one place where the instruction set is chosen: work over lanes is compiled for the
//! baseline, AVX2 and AVX-512 and run with the widest that the processor has.
//!
//! No version uses fused multiply-add, so all of them give the same bits.
#![allow(unsafe_code)]

/// Work whose `run` is inlined whole into each version.
pub(crate) trait Work {
    /// Does it. Implementations are `#[inline(always)]`, and so is all that they call.
    fn run(self);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2")]
fn with_avx512<W: Work>(work: W) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<W: Work>(work: W) {
    work.run();
}

/// Runs the work with the widest instruction set there is.
pub(crate) fn widest<W: Work>(work: W) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("avx512bw")
        {
            // SAFETY: the processor has just been asked for every feature of that version.
            return unsafe { with_avx512(work) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { with_avx2(work) };
        }
    }
    work.run();
}
