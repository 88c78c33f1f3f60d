//! The operations that lanes have.

use std::ops::Deref;

/// A table that lanes gather from: what an index is masked with is its last one, and an empty table has none.
#[derive(Debug, Clone)]
pub(crate) struct Gathered(Vec<f32>);

impl Gathered {
    /// The table of 1 to 2^31 values; another number is a fault of the program.
    // Tested by `an_empty_table_cannot_be_gathered_from`.
    pub fn new(values: Vec<f32>) -> Self {
        assert!((1..=1usize << 31).contains(&values.len()), "{} values to gather from", values.len());
        Gathered(values)
    }

    /// The last index, never negative.
    #[inline(always)]
    pub fn last(&self) -> i32 {
        (self.0.len() - 1) as i32
    }
}

impl Deref for Gathered {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.0
    }
}

#[cfg(test)]
#[test]
#[should_panic(expected = "0 values to gather from")]
fn an_empty_table_cannot_be_gathered_from() {
    Gathered::new(vec![]);
}

/// Vectors of `WIDTH` lanes: floats, integers, and masks of lanes.
pub(crate) trait Lanes: Copy {
    type F: Copy;
    type I: Copy;
    type M: Copy;
    const WIDTH: usize;

    fn splat(self, value: f32) -> Self::F;
    fn splat_i(self, value: i32) -> Self::I;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn sqrt(self, a: Self::F) -> Self::F;
    /// a < b ? a : b
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// a > b ? a : b
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// Exact for integers below 2^24.
    fn to_f(self, a: Self::I) -> Self::F;
    /// Towards zero; the value must fit.
    fn trunc(self, a: Self::F) -> Self::I;
    /// The same bits.
    fn to_bits(self, a: Self::F) -> Self::I;
    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn and_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn or_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn xor_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// Each lane by its own count, below 32.
    fn shl(self, a: Self::I, by: Self::I) -> Self::I;
    /// Each lane by its own count, below 32; zeros enter.
    fn shr(self, a: Self::I, by: Self::I) -> Self::I;
    /// a != 0
    fn nonzero(self, a: Self::I) -> Self::M;
    /// a < 0 ? -1 : 0
    fn sign(self, a: Self::I) -> Self::I;
    /// a < 0
    fn negative(self, a: Self::I) -> Self::M;
    /// m ? a : b
    fn pick(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// m ? a : b
    fn pick_i(self, m: Self::M, a: Self::I, b: Self::I) -> Self::I;
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    fn xor(self, a: Self::M, b: Self::M) -> Self::M;
    /// a and not b
    fn without(self, a: Self::M, b: Self::M) -> Self::M;
    /// Lane k is bit k.
    fn bits(self, m: Self::M) -> u32;
    fn mask(self, bits: u32) -> Self::M;
    /// `table[index & table.last()]`; the length is a power of two.
    fn gather(self, table: &Gathered, index: Self::I) -> Self::F;
    /// `table[index & 7]`, without reading memory for each lane.
    fn look_up(self, table: &[f32; 8], index: Self::I) -> Self::F;
    fn load(self, from: &[f32]) -> Self::F;
    fn load_i(self, from: &[i32]) -> Self::I;
    fn store(self, to: &mut [f32], a: Self::F);
    fn store_i(self, to: &mut [i32], a: Self::I);
    /// The lanes of `bits` take the first values of `from` in order; the others keep `old`. Reads `WIDTH` values.
    fn expand(self, old: Self::F, bits: u32, from: &[f32]) -> Self::F;
    fn expand_i(self, old: Self::I, bits: u32, from: &[i32]) -> Self::I;
    /// The lanes of `bits`, in order, go to the front of `to`; writes `WIDTH` values.
    fn compress(self, to: &mut [f32], bits: u32, a: Self::F);
    fn compress_i(self, to: &mut [i32], bits: u32, a: Self::I);
}

/// Operations of [`Lanes`] that are one expression of their arguments each.
macro_rules! operations {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $kind),*) -> $result {
            $value
        }
    )*};
}
pub(crate) use operations;
