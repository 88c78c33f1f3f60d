//! AVX-512 (16 lanes) and AVX2 (8 lanes): the only `unsafe` file.
//!
//! Every operation is the IEEE one of a single lane (no fused multiply-add, no reciprocal estimates), so that all
//! widths give the same bits. A value of `Avx512` or `Avx2` exists only after the processor was asked: that is what
//! makes each intrinsic below safe to call. Memory is read through slices: whole vectors behind a bounds check, gathers
//! with every index masked by the last one of a table that is not empty.
#![allow(unsafe_code)]
#![deny(clippy::undocumented_unsafe_blocks)]

use std::arch::x86_64::*;

use super::LaneWork;
use super::vector::{Gathered, Lanes, operations};

/// 16 lanes. A value exists only inside `in_avx512`, whose features its operations need.
#[derive(Clone, Copy)]
struct Avx512(());

/// 8 lanes. A value exists only inside `in_avx2`, whose features its operations need.
#[derive(Clone, Copy)]
struct Avx2(());

/// Whether this processor has the features of `in_avx512`.
pub(crate) fn has_avx512() -> bool {
    has_avx2() && is_x86_feature_detected!("avx512f")
}

/// Whether this processor has the features of `in_avx2`.
pub(crate) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Does the work in 16 lanes; gives it back where the processor lacks them.
pub(crate) fn run_avx512<W: LaneWork>(work: W) -> Option<W> {
    if !has_avx512() {
        return Some(work);
    }
    // SAFETY: has_avx512() asked the processor for these very features.
    unsafe { in_avx512(work) };
    None
}

/// Does the work in 8 lanes; gives it back where the processor lacks them.
pub(crate) fn run_avx2<W: LaneWork>(work: W) -> Option<W> {
    if !has_avx2() {
        return Some(work);
    }
    // SAFETY: has_avx2() asked the processor for these very features.
    unsafe { in_avx2(work) };
    None
}

// The features stay off FMA: a fused product would round unlike the other kernels.
#[target_feature(enable = "avx512f,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn in_avx512(work: impl LaneWork) {
    work.run(Avx512(()));
}

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn in_avx2(work: impl LaneWork) {
    work.run(Avx2(()));
}

/// Operations on registers alone.
macro_rules! instructions {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $kind),*) -> $result {
            // SAFETY: a value of this type exists only where the processor has its features; no memory is touched.
            unsafe { $value }
        }
    )*};
}

/// A vector's indices in memory.
#[repr(C, align(64))]
struct Indices([u32; 16]);

/// For each mask of 8 lanes: the rank of each lane among those set, and the lanes set in order.
static RANKS: [[i32; 8]; 256] = tables().0;
static PLACES: [[i32; 8]; 256] = tables().1;

const fn tables() -> ([[i32; 8]; 256], [[i32; 8]; 256]) {
    let (mut ranks, mut places) = ([[0; 8]; 256], [[0; 8]; 256]);
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut rank) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 != 0 {
                ranks[bits][lane] = rank;
                places[bits][rank as usize] = lane as i32;
                rank += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    (ranks, places)
}

impl Lanes for Avx512 {
    type F = __m512;
    type I = __m512i;
    type M = __mmask16;
    const WIDTH: usize = 16;

    instructions! {
        splat(value: f32) -> Self::F = _mm512_set1_ps(value);
        splat_i(value: i32) -> Self::I = _mm512_set1_epi32(value);
        add(a: Self::F, b: Self::F) -> Self::F = _mm512_add_ps(a, b);
        sub(a: Self::F, b: Self::F) -> Self::F = _mm512_sub_ps(a, b);
        mul(a: Self::F, b: Self::F) -> Self::F = _mm512_mul_ps(a, b);
        div(a: Self::F, b: Self::F) -> Self::F = _mm512_div_ps(a, b);
        sqrt(a: Self::F) -> Self::F = _mm512_sqrt_ps(a);
        min(a: Self::F, b: Self::F) -> Self::F = _mm512_min_ps(a, b);
        max(a: Self::F, b: Self::F) -> Self::F = _mm512_max_ps(a, b);
        sign(a: Self::I) -> Self::I = _mm512_srai_epi32::<31>(a);
        abs(a: Self::F) -> Self::F = _mm512_abs_ps(a);
        lt(a: Self::F, b: Self::F) -> Self::M = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
        to_f(a: Self::I) -> Self::F = _mm512_cvtepi32_ps(a);
        trunc(a: Self::F) -> Self::I = _mm512_cvttps_epi32(a);
        to_bits(a: Self::F) -> Self::I = _mm512_castps_si512(a);
        add_i(a: Self::I, b: Self::I) -> Self::I = _mm512_add_epi32(a, b);
        sub_i(a: Self::I, b: Self::I) -> Self::I = _mm512_sub_epi32(a, b);
        and_i(a: Self::I, b: Self::I) -> Self::I = _mm512_and_si512(a, b);
        or_i(a: Self::I, b: Self::I) -> Self::I = _mm512_or_si512(a, b);
        xor_i(a: Self::I, b: Self::I) -> Self::I = _mm512_xor_si512(a, b);
        min_i(a: Self::I, b: Self::I) -> Self::I = _mm512_min_epi32(a, b);
        max_i(a: Self::I, b: Self::I) -> Self::I = _mm512_max_epi32(a, b);
        shl(a: Self::I, by: Self::I) -> Self::I = _mm512_sllv_epi32(a, by);
        shr(a: Self::I, by: Self::I) -> Self::I = _mm512_srlv_epi32(a, by);
        nonzero(a: Self::I) -> Self::M = _mm512_test_epi32_mask(a, a);
        negative(a: Self::I) -> Self::M = _mm512_cmplt_epi32_mask(a, _mm512_setzero_si512());
        pick(m: Self::M, a: Self::F, b: Self::F) -> Self::F = _mm512_mask_blend_ps(m, b, a);
        pick_i(m: Self::M, a: Self::I, b: Self::I) -> Self::I = _mm512_mask_blend_epi32(m, b, a);
    }
    operations! {
        and(a: Self::M, b: Self::M) -> Self::M = a & b;
        or(a: Self::M, b: Self::M) -> Self::M = a | b;
        xor(a: Self::M, b: Self::M) -> Self::M = a ^ b;
        without(a: Self::M, b: Self::M) -> Self::M = a & !b;
        bits(m: Self::M) -> u32 = u32::from(m);
        mask(bits: u32) -> Self::M = bits as __mmask16;
    }
    #[inline(always)]
    fn gather(self, table: &Gathered, index: Self::I) -> Self::F {
        let index = self.and_i(index, self.splat_i(table.last()));
        // Single loads: one gather instruction takes longer on some processors, on others as long. The indices
        // pass through memory, 10 % of a ray's time faster than through the extractions that a plain store
        // becomes.
        let mut at = Indices([0; 16]);
        // SAFETY: 64 bytes of its own, at the alignment of a vector.
        unsafe { std::ptr::write_volatile((&raw mut at).cast(), index) };
        // SAFETY: a number and'ed with the last index, which no table lacks, is no larger than that.
        let one = |k: usize| unsafe { *table.get_unchecked(at.0[k] as usize) };
        let four = |k: usize| [one(k), one(k + 1), one(k + 2), one(k + 3)];
        let ([a, b, c, d], [e, f, g, h]) = (four(0), four(4));
        let ([i, j, k, l], [m, n, o, p]) = (four(8), four(12));
        // SAFETY: `Avx512` exists only where the processor has its features.
        unsafe { _mm512_setr_ps(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) }
    }
    #[inline(always)]
    fn look_up(self, table: &[f32; 8], index: Self::I) -> Self::F {
        let index = self.and_i(index, self.splat_i(7));
        // SAFETY: 8 values are read, and none but these picked; `Avx512` exists only where the processor has its features.
        unsafe { _mm512_permutexvar_ps(index, _mm512_castps256_ps512(_mm256_loadu_ps(table.as_ptr()))) }
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::F {
        let from = &from[..16];
        // SAFETY: 16 values behind the bounds check; `Avx512` exists only where the processor has its features.
        unsafe { _mm512_loadu_ps(from.as_ptr()) }
    }
    #[inline(always)]
    fn load_i(self, from: &[i32]) -> Self::I {
        let from = &from[..16];
        // SAFETY: 16 values behind the bounds check; `Avx512` exists only where the processor has its features.
        unsafe { _mm512_loadu_si512(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [f32], a: Self::F) {
        let to = &mut to[..16];
        // SAFETY: 16 values behind the bounds check; `Avx512` exists only where the processor has its features.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), a) }
    }
    #[inline(always)]
    fn store_i(self, to: &mut [i32], a: Self::I) {
        let to = &mut to[..16];
        // SAFETY: 16 values behind the bounds check; `Avx512` exists only where the processor has its features.
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), a) }
    }
    #[inline(always)]
    fn expand(self, old: Self::F, bits: u32, from: &[f32]) -> Self::F {
        let from = self.load(from);
        // SAFETY: `Avx512` exists only where the processor has its features.
        unsafe { _mm512_mask_expand_ps(old, bits as __mmask16, from) }
    }
    #[inline(always)]
    fn expand_i(self, old: Self::I, bits: u32, from: &[i32]) -> Self::I {
        let from = self.load_i(from);
        // SAFETY: `Avx512` exists only where the processor has its features.
        unsafe { _mm512_mask_expand_epi32(old, bits as __mmask16, from) }
    }
    #[inline(always)]
    fn compress(self, to: &mut [f32], bits: u32, a: Self::F) {
        // SAFETY: `Avx512` exists only where the processor has its features.
        self.store(to, unsafe { _mm512_maskz_compress_ps(bits as __mmask16, a) });
    }
    #[inline(always)]
    fn compress_i(self, to: &mut [i32], bits: u32, a: Self::I) {
        // SAFETY: `Avx512` exists only where the processor has its features.
        self.store_i(to, unsafe { _mm512_maskz_compress_epi32(bits as __mmask16, a) });
    }
}

impl Lanes for Avx2 {
    type F = __m256;
    type I = __m256i;
    type M = __m256i;
    const WIDTH: usize = 8;

    instructions! {
        splat(value: f32) -> Self::F = _mm256_set1_ps(value);
        splat_i(value: i32) -> Self::I = _mm256_set1_epi32(value);
        add(a: Self::F, b: Self::F) -> Self::F = _mm256_add_ps(a, b);
        sub(a: Self::F, b: Self::F) -> Self::F = _mm256_sub_ps(a, b);
        mul(a: Self::F, b: Self::F) -> Self::F = _mm256_mul_ps(a, b);
        div(a: Self::F, b: Self::F) -> Self::F = _mm256_div_ps(a, b);
        sqrt(a: Self::F) -> Self::F = _mm256_sqrt_ps(a);
        min(a: Self::F, b: Self::F) -> Self::F = _mm256_min_ps(a, b);
        max(a: Self::F, b: Self::F) -> Self::F = _mm256_max_ps(a, b);
        sign(a: Self::I) -> Self::I = _mm256_srai_epi32::<31>(a);
        abs(a: Self::F) -> Self::F = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        lt(a: Self::F, b: Self::F) -> Self::M = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
        to_f(a: Self::I) -> Self::F = _mm256_cvtepi32_ps(a);
        trunc(a: Self::F) -> Self::I = _mm256_cvttps_epi32(a);
        to_bits(a: Self::F) -> Self::I = _mm256_castps_si256(a);
        add_i(a: Self::I, b: Self::I) -> Self::I = _mm256_add_epi32(a, b);
        sub_i(a: Self::I, b: Self::I) -> Self::I = _mm256_sub_epi32(a, b);
        and_i(a: Self::I, b: Self::I) -> Self::I = _mm256_and_si256(a, b);
        or_i(a: Self::I, b: Self::I) -> Self::I = _mm256_or_si256(a, b);
        xor_i(a: Self::I, b: Self::I) -> Self::I = _mm256_xor_si256(a, b);
        min_i(a: Self::I, b: Self::I) -> Self::I = _mm256_min_epi32(a, b);
        max_i(a: Self::I, b: Self::I) -> Self::I = _mm256_max_epi32(a, b);
        shl(a: Self::I, by: Self::I) -> Self::I = _mm256_sllv_epi32(a, by);
        shr(a: Self::I, by: Self::I) -> Self::I = _mm256_srlv_epi32(a, by);
        nonzero(a: Self::I) -> Self::M =
            _mm256_xor_si256(_mm256_cmpeq_epi32(a, _mm256_setzero_si256()), _mm256_set1_epi32(-1));
        negative(a: Self::I) -> Self::M = _mm256_srai_epi32::<31>(a);
        pick(m: Self::M, a: Self::F, b: Self::F) -> Self::F = _mm256_blendv_ps(b, a, _mm256_castsi256_ps(m));
        pick_i(m: Self::M, a: Self::I, b: Self::I) -> Self::I = _mm256_blendv_epi8(b, a, m);
        and(a: Self::M, b: Self::M) -> Self::M = _mm256_and_si256(a, b);
        or(a: Self::M, b: Self::M) -> Self::M = _mm256_or_si256(a, b);
        xor(a: Self::M, b: Self::M) -> Self::M = _mm256_xor_si256(a, b);
        without(a: Self::M, b: Self::M) -> Self::M = _mm256_andnot_si256(b, a);
        bits(m: Self::M) -> u32 = _mm256_movemask_ps(_mm256_castsi256_ps(m)) as u32;
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        let lane = self.load_i(&[1, 2, 4, 8, 16, 32, 64, 128]);
        // SAFETY: `Avx2` exists only where the processor has its features.
        unsafe { _mm256_cmpeq_epi32(_mm256_and_si256(lane, _mm256_set1_epi32(bits as i32)), lane) }
    }
    #[inline(always)]
    fn gather(self, table: &Gathered, index: Self::I) -> Self::F {
        let index = self.and_i(index, self.splat_i(table.last()));
        // SAFETY: a number and'ed with the last index, which no table lacks, is no larger than that, and not
        // negative; `Avx2` exists only where the processor has its features.
        unsafe { _mm256_i32gather_ps::<4>(table.as_ptr(), index) }
    }
    #[inline(always)]
    fn look_up(self, table: &[f32; 8], index: Self::I) -> Self::F {
        // The low 3 bits of an index count.
        let table = self.load(table);
        // SAFETY: `Avx2` exists only where the processor has its features.
        unsafe { _mm256_permutevar8x32_ps(table, index) }
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::F {
        let from = &from[..8];
        // SAFETY: 8 values behind the bounds check; `Avx2` exists only where the processor has its features.
        unsafe { _mm256_loadu_ps(from.as_ptr()) }
    }
    #[inline(always)]
    fn load_i(self, from: &[i32]) -> Self::I {
        let from = &from[..8];
        // SAFETY: 8 values behind the bounds check; `Avx2` exists only where the processor has its features.
        unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
    }
    #[inline(always)]
    fn store(self, to: &mut [f32], a: Self::F) {
        let to = &mut to[..8];
        // SAFETY: 8 values behind the bounds check; `Avx2` exists only where the processor has its features.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), a) }
    }
    #[inline(always)]
    fn store_i(self, to: &mut [i32], a: Self::I) {
        let to = &mut to[..8];
        // SAFETY: 8 values behind the bounds check; `Avx2` exists only where the processor has its features.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), a) }
    }
    #[inline(always)]
    fn expand(self, old: Self::F, bits: u32, from: &[f32]) -> Self::F {
        let ranks = self.load_i(&RANKS[bits as usize & 255]);
        let from = self.load(from);
        // SAFETY: `Avx2` exists only where the processor has its features.
        self.pick(self.mask(bits), unsafe { _mm256_permutevar8x32_ps(from, ranks) }, old)
    }
    #[inline(always)]
    fn expand_i(self, old: Self::I, bits: u32, from: &[i32]) -> Self::I {
        let ranks = self.load_i(&RANKS[bits as usize & 255]);
        let from = self.load_i(from);
        // SAFETY: `Avx2` exists only where the processor has its features.
        self.pick_i(self.mask(bits), unsafe { _mm256_permutevar8x32_epi32(from, ranks) }, old)
    }
    #[inline(always)]
    fn compress(self, to: &mut [f32], bits: u32, a: Self::F) {
        let places = self.load_i(&PLACES[bits as usize & 255]);
        // SAFETY: `Avx2` exists only where the processor has its features.
        self.store(to, unsafe { _mm256_permutevar8x32_ps(a, places) });
    }
    #[inline(always)]
    fn compress_i(self, to: &mut [i32], bits: u32, a: Self::I) {
        let places = self.load_i(&PLACES[bits as usize & 255]);
        // SAFETY: `Avx2` exists only where the processor has its features.
        self.store_i(to, unsafe { _mm256_permutevar8x32_epi32(a, places) });
    }
}
