//! The one place where the instruction set is chosen: work over lanes is compiled for the
//! baseline, AVX2 and AVX-512 and run with the widest that the processor has.
//!
//! Two things that the compiler does not do by itself are asked for by name: moving numbers in
//! pairs ([`transposed`]) and fetching ahead ([`prefetch`]).
//!
//! No version uses fused multiply-add, so all of them give the same bits.
#![allow(unsafe_code)]

/// Asks for numbers that are about to be used, where many arrays are gone through side by side:
/// the processor follows a few streams by itself, not a hundred. Each part takes up where the one
/// before ended, so the cache line in which it begins is on its way already.
#[inline(always)]
pub fn prefetch(part: &[f64]) {
    #[cfg(target_arch = "x86_64")]
    for line in part.as_chunks::<8>().0 {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch changes nothing that the program sees.
        unsafe { _mm_prefetch::<_MM_HINT_T0>((&raw const line[7]).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = part;
}

/// The columns of a block of two by two. The compiler moves the four numbers one by one; as two
/// vectors they cost half, wherever the code around is compiled for.
#[inline(always)]
pub fn transposed(block: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_mm_loadu_pd, _mm_storeu_pd, _mm_unpackhi_pd, _mm_unpacklo_pd};
        let mut columns = [[0.0; 2]; 2];
        // SAFETY: each row holds the two numbers that are loaded or stored; every processor of
        // this architecture has these instructions.
        unsafe {
            let [a, b] = [_mm_loadu_pd(block[0].as_ptr()), _mm_loadu_pd(block[1].as_ptr())];
            _mm_storeu_pd(columns[0].as_mut_ptr(), _mm_unpacklo_pd(a, b));
            _mm_storeu_pd(columns[1].as_mut_ptr(), _mm_unpackhi_pd(a, b));
        }
        columns
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let [[a, b], [c, d]] = block;
        [[a, c], [b, d]]
    }
}

/// Work whose `run` is inlined whole into each version.
pub trait Work {
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
pub fn widest<W: Work>(work: W) {
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

#[cfg(test)]
mod tests {
    #[test]
    fn a_block_is_turned() {
        assert_eq!(super::transposed([[1.0, 2.0], [3.0, 4.0]]), [[1.0, 3.0], [2.0, 4.0]]);
    }
}
