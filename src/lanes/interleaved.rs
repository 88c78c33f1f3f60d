//! Two vectors side by side, as one: while one waits for memory or for its last result, the other works.

use super::vector::{Gathered, Lanes};

/// Lanes of two vectors; the second one's lanes follow the first one's.
#[derive(Clone, Copy)]
pub(crate) struct Interleaved<S>(pub S);

/// Operations that each vector does with its own arguments.
macro_rules! both {
    ($($name:ident($($argument:ident: $kind:ident),*) -> $result:ident;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: Self::$kind),*) -> Self::$result {
            [self.0.$name($($argument[0]),*), self.0.$name($($argument[1]),*)]
        }
    )*};
}

impl<S: Lanes> Lanes for Interleaved<S> {
    type F = [S::F; 2];
    type I = [S::I; 2];
    type M = [S::M; 2];
    const WIDTH: usize = 2 * S::WIDTH;

    both! {
        add(a: F, b: F) -> F;
        sub(a: F, b: F) -> F;
        mul(a: F, b: F) -> F;
        div(a: F, b: F) -> F;
        sqrt(a: F) -> F;
        min(a: F, b: F) -> F;
        max(a: F, b: F) -> F;
        abs(a: F) -> F;
        lt(a: F, b: F) -> M;
        to_f(a: I) -> F;
        trunc(a: F) -> I;
        to_bits(a: F) -> I;
        add_i(a: I, b: I) -> I;
        sub_i(a: I, b: I) -> I;
        and_i(a: I, b: I) -> I;
        or_i(a: I, b: I) -> I;
        xor_i(a: I, b: I) -> I;
        min_i(a: I, b: I) -> I;
        max_i(a: I, b: I) -> I;
        shl(a: I, by: I) -> I;
        shr(a: I, by: I) -> I;
        nonzero(a: I) -> M;
        sign(a: I) -> I;
        negative(a: I) -> M;
        pick(m: M, a: F, b: F) -> F;
        pick_i(m: M, a: I, b: I) -> I;
        and(a: M, b: M) -> M;
        or(a: M, b: M) -> M;
        xor(a: M, b: M) -> M;
        without(a: M, b: M) -> M;
    }
    #[inline(always)]
    fn splat(self, value: f32) -> Self::F {
        [self.0.splat(value); 2]
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> Self::I {
        [self.0.splat_i(value); 2]
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
    fn look_up(self, table: &[f32; 8], index: Self::I) -> Self::F {
        [self.0.look_up(table, index[0]), self.0.look_up(table, index[1])]
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
