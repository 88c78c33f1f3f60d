//! Matrices, rows to columns.

/// Transposes a matrix with rows of `width` into `out`, in tiles that stay in the cache.
pub(crate) fn transpose<T: Copy>(matrix: &[T], width: usize, out: &mut [T]) {
    const TILE: usize = 16;
    let height = matrix.len() / width;
    for y0 in (0..height).step_by(TILE) {
        for x0 in (0..width).step_by(TILE) {
            for y in y0..(y0 + TILE).min(height) {
                for x in x0..(x0 + TILE).min(width) {
                    out[x * height + y] = matrix[y * width + x];
                }
            }
        }
    }
}
