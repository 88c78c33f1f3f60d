//! Two vectors side by side, as one: while one waits for memory or for its last result, the other works.

use super::vector::{Gathered, Lanes};

/// Lanes of two vectors; the second one's lanes follow the first one's.
#[derive(Clone, Copy)]
pub(crate) struct Interleaved<S>(pub S);

impl<S: Lanes> Lanes for Interleaved<S> {
    type F = [S::F; 2];
    type I = [S::I; 2];
    type M = [S::M; 2];
    const WIDTH: usize = 2 * S::WIDTH;

    #[inline(always)]
    fn splat(self, value: f32) -> Self::F {
        [self.0.splat(value); 2]
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> Self::I {
        [self.0.splat_i(value); 2]
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.add(a[0], b[0]), self.0.add(a[1], b[1])]
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.sub(a[0], b[0]), self.0.sub(a[1], b[1])]
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.mul(a[0], b[0]), self.0.mul(a[1], b[1])]
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.div(a[0], b[0]), self.0.div(a[1], b[1])]
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.min(a[0], b[0]), self.0.min(a[1], b[1])]
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        [self.0.max(a[0], b[0]), self.0.max(a[1], b[1])]
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        [self.0.abs(a[0]), self.0.abs(a[1])]
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        [self.0.lt(a[0], b[0]), self.0.lt(a[1], b[1])]
    }
    #[inline(always)]
    fn to_f(self, a: Self::I) -> Self::F {
        [self.0.to_f(a[0]), self.0.to_f(a[1])]
    }
    #[inline(always)]
    fn trunc(self, a: Self::F) -> Self::I {
        [self.0.trunc(a[0]), self.0.trunc(a[1])]
    }
    #[inline(always)]
    fn add_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.add_i(a[0], b[0]), self.0.add_i(a[1], b[1])]
    }
    #[inline(always)]
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.sub_i(a[0], b[0]), self.0.sub_i(a[1], b[1])]
    }
    #[inline(always)]
    fn and_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.and_i(a[0], b[0]), self.0.and_i(a[1], b[1])]
    }
    #[inline(always)]
    fn or_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.or_i(a[0], b[0]), self.0.or_i(a[1], b[1])]
    }
    #[inline(always)]
    fn xor_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.xor_i(a[0], b[0]), self.0.xor_i(a[1], b[1])]
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.min_i(a[0], b[0]), self.0.min_i(a[1], b[1])]
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I {
        [self.0.max_i(a[0], b[0]), self.0.max_i(a[1], b[1])]
    }
    #[inline(always)]
    fn shl(self, a: Self::I, by: Self::I) -> Self::I {
        [self.0.shl(a[0], by[0]), self.0.shl(a[1], by[1])]
    }
    #[inline(always)]
    fn shr(self, a: Self::I, by: Self::I) -> Self::I {
        [self.0.shr(a[0], by[0]), self.0.shr(a[1], by[1])]
    }
    #[inline(always)]
    fn nonzero(self, a: Self::I) -> Self::M {
        [self.0.nonzero(a[0]), self.0.nonzero(a[1])]
    }
    #[inline(always)]
    fn sign(self, a: Self::I) -> Self::I {
        [self.0.sign(a[0]), self.0.sign(a[1])]
    }
    #[inline(always)]
    fn negative(self, a: Self::I) -> Self::M {
        [self.0.negative(a[0]), self.0.negative(a[1])]
    }
    #[inline(always)]
    fn pick(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        [self.0.pick(m[0], a[0], b[0]), self.0.pick(m[1], a[1], b[1])]
    }
    #[inline(always)]
    fn pick_i(self, m: Self::M, a: Self::I, b: Self::I) -> Self::I {
        [self.0.pick_i(m[0], a[0], b[0]), self.0.pick_i(m[1], a[1], b[1])]
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        [self.0.and(a[0], b[0]), self.0.and(a[1], b[1])]
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        [self.0.or(a[0], b[0]), self.0.or(a[1], b[1])]
    }
    #[inline(always)]
    fn xor(self, a: Self::M, b: Self::M) -> Self::M {
        [self.0.xor(a[0], b[0]), self.0.xor(a[1], b[1])]
    }
    #[inline(always)]
    fn without(self, a: Self::M, b: Self::M) -> Self::M {
        [self.0.without(a[0], b[0]), self.0.without(a[1], b[1])]
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u32 {
        self.0.bits(m[0]) | self.0.bits(m[1]) << S::WIDTH
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        [self.0.mask(bits), self.0.mask(bits >> S::WIDTH)]
    }
    #[inline(always)]
    fn gather(self, table: &Gathered, index: Self::I) -> Self::F {
        [self.0.gather(table, index[0]), self.0.gather(table, index[1])]
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::F {
        [self.0.load(from), self.0.load(&from[S::WIDTH..])]
    }
    #[inline(always)]
    fn load_i(self, from: &[i32]) -> Self::I {
        [self.0.load_i(from), self.0.load_i(&from[S::WIDTH..])]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32], a: Self::F) {
        self.0.store(to, a[0]);
        self.0.store(&mut to[S::WIDTH..], a[1]);
    }
    #[inline(always)]
    fn store_i(self, to: &mut [i32], a: Self::I) {
        self.0.store_i(to, a[0]);
        self.0.store_i(&mut to[S::WIDTH..], a[1]);
    }
    #[inline(always)]
    fn expand(self, old: Self::F, bits: u32, from: &[f32]) -> Self::F {
        let (first, second) = halves::<S>(bits);
        let rest = &from[first.count_ones() as usize..];
        [self.0.expand(old[0], first, from), self.0.expand(old[1], second, rest)]
    }
    #[inline(always)]
    fn expand_i(self, old: Self::I, bits: u32, from: &[i32]) -> Self::I {
        let (first, second) = halves::<S>(bits);
        let rest = &from[first.count_ones() as usize..];
        [self.0.expand_i(old[0], first, from), self.0.expand_i(old[1], second, rest)]
    }
    #[inline(always)]
    fn compress(self, to: &mut [f32], bits: u32, a: Self::F) {
        let (first, second) = halves::<S>(bits);
        self.0.compress(to, first, a[0]);
        self.0.compress(&mut to[first.count_ones() as usize..], second, a[1]);
    }
    #[inline(always)]
    fn compress_i(self, to: &mut [i32], bits: u32, a: Self::I) {
        let (first, second) = halves::<S>(bits);
        self.0.compress_i(to, first, a[0]);
        self.0.compress_i(&mut to[first.count_ones() as usize..], second, a[1]);
    }
}

/// The bits of both vectors' lanes.
#[inline(always)]
fn halves<S: Lanes>(bits: u32) -> (u32, u32) {
    (bits & (u32::MAX >> (32 - S::WIDTH)), bits >> S::WIDTH)
}
