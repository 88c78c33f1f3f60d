//! One lane, in plain Rust: what every processor runs.

use super::vector::{Gathered, Lanes, operations};

/// One lane.
#[derive(Clone, Copy)]
pub(crate) struct One;

impl Lanes for One {
    type F = f32;
    type I = i32;
    type M = bool;
    const WIDTH: usize = 1;

    operations! {
        splat(value: f32) -> Self::F = value;
        splat_i(value: i32) -> Self::I = value;
        add(a: Self::F, b: Self::F) -> Self::F = a + b;
        sub(a: Self::F, b: Self::F) -> Self::F = a - b;
        mul(a: Self::F, b: Self::F) -> Self::F = a * b;
        div(a: Self::F, b: Self::F) -> Self::F = a / b;
        sqrt(a: Self::F) -> Self::F = a.sqrt();
        min(a: Self::F, b: Self::F) -> Self::F = if a < b { a } else { b };
        max(a: Self::F, b: Self::F) -> Self::F = if a > b { a } else { b };
        sign(a: Self::I) -> Self::I = a >> 31;
        abs(a: Self::F) -> Self::F = a.abs();
        lt(a: Self::F, b: Self::F) -> Self::M = a < b;
        to_f(a: Self::I) -> Self::F = a as f32;
        trunc(a: Self::F) -> Self::I = a as i32;
        to_bits(a: Self::F) -> Self::I = a.to_bits() as i32;
        add_i(a: Self::I, b: Self::I) -> Self::I = a.wrapping_add(b);
        sub_i(a: Self::I, b: Self::I) -> Self::I = a.wrapping_sub(b);
        and_i(a: Self::I, b: Self::I) -> Self::I = a & b;
        or_i(a: Self::I, b: Self::I) -> Self::I = a | b;
        xor_i(a: Self::I, b: Self::I) -> Self::I = a ^ b;
        min_i(a: Self::I, b: Self::I) -> Self::I = a.min(b);
        max_i(a: Self::I, b: Self::I) -> Self::I = a.max(b);
        shl(a: Self::I, by: Self::I) -> Self::I = a.wrapping_shl(by as u32);
        shr(a: Self::I, by: Self::I) -> Self::I = (a as u32).wrapping_shr(by as u32) as i32;
        nonzero(a: Self::I) -> Self::M = a != 0;
        negative(a: Self::I) -> Self::M = a < 0;
        pick(m: Self::M, a: Self::F, b: Self::F) -> Self::F = if m { a } else { b };
        pick_i(m: Self::M, a: Self::I, b: Self::I) -> Self::I = if m { a } else { b };
        and(a: Self::M, b: Self::M) -> Self::M = a & b;
        or(a: Self::M, b: Self::M) -> Self::M = a | b;
        xor(a: Self::M, b: Self::M) -> Self::M = a ^ b;
        without(a: Self::M, b: Self::M) -> Self::M = a & !b;
        bits(m: Self::M) -> u32 = u32::from(m);
        mask(bits: u32) -> Self::M = bits & 1 != 0;
        gather(table: &Gathered, index: Self::I) -> Self::F = table[index as usize & table.last() as usize];
        look_up(table: &[f32; 8], index: Self::I) -> Self::F = table[index as usize & 7];
        load(from: &[f32]) -> Self::F = from[0];
        load_i(from: &[i32]) -> Self::I = from[0];
        expand(old: Self::F, bits: u32, from: &[f32]) -> Self::F = if bits & 1 != 0 { from[0] } else { old };
        expand_i(old: Self::I, bits: u32, from: &[i32]) -> Self::I = if bits & 1 != 0 { from[0] } else { old };
    }
    #[inline(always)]
    fn store(self, to: &mut [f32], a: Self::F) {
        to[0] = a;
    }
    #[inline(always)]
    fn store_i(self, to: &mut [i32], a: Self::I) {
        to[0] = a;
    }
    #[inline(always)]
    fn compress(self, to: &mut [f32], bits: u32, a: Self::F) {
        if bits & 1 != 0 {
            to[0] = a;
        }
    }
    #[inline(always)]
    fn compress_i(self, to: &mut [i32], bits: u32, a: Self::I) {
        if bits & 1 != 0 {
            to[0] = a;
        }
    }
}
