//! A cubic spline through the samples of a map, along y and then along x.

use crate::surface::Heightfield;
use crate::surface::transpose::transpose;

/// Samples by which a periodic line is continued on both sides: the spline's influence falls by 3.73 with each,
/// to below 1e-18.
const CONTINUED: usize = 32;

/// The map on `steps` times as many cells along x and y; its own samples keep their bits.
pub fn refined(field: &Heightfield, steps: usize) -> Heightfield {
    if steps == 1 {
        return field.clone();
    }
    let periodic = field.is_periodic();
    let extra = usize::from(!periodic);
    let (columns, rows) = (field.cells_x() + extra, field.cells_y() + extra);
    let across = finer(&transposed(field.heights(), columns), rows, periodic, steps);
    let (cells_x, cells_y) = (field.cells_x() * steps, field.cells_y() * steps);
    let heights = finer(&transposed(&across, rows), cells_x + extra, periodic, steps);
    Heightfield::new(cells_x, cells_y, periodic, heights)
}

/// Rows of `width` values, and between each two of them `steps - 1` more: a cubic spline down every column.
fn finer(values: &[f64], width: usize, periodic: bool, steps: usize) -> Vec<f64> {
    let rows = values.len() / width;
    let bends = second_derivatives(values, width, periodic);
    let row = |from: &[f64], i: usize| -> std::ops::Range<usize> {
        debug_assert!((i + 1) * width <= from.len());
        i * width..(i + 1) * width
    };
    let intervals = if periodic { rows } else { rows - 1 };
    let mut out = Vec::with_capacity((intervals * steps + rows - intervals) * width);
    for i in 0..intervals {
        let j = if i + 1 == rows { 0 } else { i + 1 };
        let near = values[row(values, i)].iter().zip(&bends[row(&bends, i)]);
        let far = values[row(values, j)].iter().zip(&bends[row(&bends, j)]);
        for step in 0..steps {
            let t = step as f64 / steps as f64;
            let s = 1.0 - t;
            let pull = -s * t / 6.0;
            let between = |((a, a2), (b, b2)): ((&f64, &f64), (&f64, &f64))| {
                s * a + t * b + pull * ((1.0 + s) * a2 + (1.0 + t) * b2)
            };
            out.extend(near.clone().zip(far.clone()).map(between));
        }
    }
    if !periodic {
        out.extend_from_slice(&values[row(values, rows - 1)]);
    }
    out
}

/// Second derivatives of the spline at the rows of `values`, per squared row: of a closed spline, or of an open one whose
/// first two intervals are one cubic, as are its last two ("not a knot").
///
/// Interior rows: m[i-1] + 4 m[i] + m[i+1] = 6 (h[i-1] - 2 h[i] + h[i+1]). At an open end that condition makes m[1] the
/// second difference itself, and m[0] = 2 m[1] - m[2].
fn second_derivatives(values: &[f64], width: usize, periodic: bool) -> Vec<f64> {
    let rows = values.len() / width;
    let at = |i: usize| &values[i * width..][..width];
    let difference = |i: usize, factor: f64| {
        let (before, after) = (at((i + rows - 1) % rows), at((i + 1) % rows));
        let around = before.iter().zip(after).zip(at(i));
        around.map(move |((before, after), here)| factor * ((before - here) + (after - here)))
    };
    if periodic {
        let wrapped = |k: usize| (k + CONTINUED * (rows - 1)) % rows;
        let lines = rows + 2 * CONTINUED;
        let mut bends: Vec<f64> = (0..lines).flat_map(|k| difference(wrapped(k), 6.0)).collect();
        solve(&mut bends, width);
        return bends[CONTINUED * width..][..rows * width].to_vec();
    }
    let ends = [1, rows - 2].map(|i| difference(i, 1.0).collect::<Vec<f64>>());
    let mut inner: Vec<f64> = (2..rows - 2).flat_map(|i| difference(i, 6.0)).collect();
    let last = inner.len() - width;
    inner[..width].iter_mut().zip(&ends[0]).for_each(|(value, end)| *value -= end);
    inner[last..].iter_mut().zip(&ends[1]).for_each(|(value, end)| *value -= end);
    solve(&mut inner, width);
    let outside = |end: &[f64], next: &[f64]| -> Vec<f64> {
        end.iter().zip(next).map(|(end, next)| 2.0 * end - next).collect()
    };
    let [first, final_] = [outside(&ends[0], &inner[..width]), outside(&ends[1], &inner[last..])];
    [first, ends[0].clone(), inner, ends[1].clone(), final_].concat()
}

/// Solves m[k-1] + 4 m[k] + m[k+1] = b[k] down every column of rows of `width`, with 0 beyond both ends, in place.
fn solve(b: &mut [f64], width: usize) {
    let rows = b.len() / width;
    let mut factors = Vec::with_capacity(rows);
    let mut factor = 0.0;
    for k in 0..rows {
        factor = 1.0 / (4.0 - factor);
        factors.push(factor);
        let (before, here) = b.split_at_mut(k * width);
        let before = before.len().checked_sub(width).map(|start| &before[start..]);
        match before {
            Some(before) => here[..width].iter_mut().zip(before).for_each(|(v, p)| *v = (*v - p) * factor),
            None => here[..width].iter_mut().for_each(|v| *v *= factor),
        }
    }
    for k in (0..rows - 1).rev() {
        let (here, after) = b.split_at_mut((k + 1) * width);
        let here = &mut here[k * width..];
        here.iter_mut().zip(&after[..width]).for_each(|(v, next)| *v -= factors[k] * next);
    }
}

/// Rows become columns; `columns`: values in a row.
fn transposed(values: &[f64], columns: usize) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    transpose(values, columns, &mut out);
    out
}
