//! A C header, which is C++ too: constants with their errors, the nodes of the axes, and lookups between them.

use std::io::Write;

use crate::albedo::table::{AlbedoTable, Cell, Quantity};
use crate::error::Checked;

/// Numbers in a line of a table.
const A_LINE: usize = 6;
/// Letters in a line of a comment.
const WIDTH: usize = 96;

pub(super) fn write(table: &AlbedoTable, stem: &str, out: &mut dyn Write) -> Checked<()> {
    let name = identifier(stem);
    let macro_name = name.to_uppercase();
    writeln!(out, "/* A table of albedos, made by gonio.")?;
    let abouts = table.quantities.iter().map(|quantity| (quantity.name.as_str(), quantity.about.clone()));
    for (key, text) in table.texts().into_iter().chain(abouts) {
        for line in text.lines() {
            comment(&format!("{key}: {line}"), out)?;
        }
    }
    writeln!(out, " */\n#ifndef {macro_name}_ALBEDO_H\n#define {macro_name}_ALBEDO_H\n")?;
    let axes = table.axes.named();
    for (axis, nodes) in &axes {
        writeln!(out, "#define {macro_name}_{} {}", axis.to_uppercase(), nodes.len())?;
        let values = nodes.iter().map(|&node| node as f32);
        array(&format!("{name}_{axis}[{macro_name}_{}]", axis.to_uppercase()), values, out)?;
    }
    let sizes: Vec<String> =
        axes.iter().map(|(axis, _)| format!("[{macro_name}_{}]", axis.to_uppercase())).collect();
    for quantity in &table.quantities {
        constants(&name, &sizes, quantity, out)?;
    }
    let lookups = if table.axes.eta.is_empty() { TWO_AXES } else { THREE_AXES };
    let code = format!("{PLACE}{lookups}").replace("NAME", &macro_name).replace("name", &name);
    Ok(write!(out, "{code}\n#endif\n")?)
}

/// The values of a quantity, its errors, and both of its averages. One flat list each: C99 and C++ take it alike.
fn constants(name: &str, sizes: &[String], quantity: &Quantity, out: &mut dyn Write) -> Checked<()> {
    let value = |cell: &Cell| cell.value as f32;
    let error = |cell: &Cell| cell.error.map_or(-1.0, |error| error as f32);
    let product = |sizes: &[String]| {
        let sizes: Vec<&str> = sizes.iter().map(|size| size.trim_matches(['[', ']'])).collect();
        format!("[{}]", sizes.join("*"))
    };
    let (all, rows) = (product(sizes), product(&sizes[..sizes.len() - 1]));
    let q = &quantity.name;
    array(&format!("{name}_{q}{all}"), quantity.cells.iter().map(value), out)?;
    array(&format!("{name}_{q}_error{all}"), quantity.cells.iter().map(error), out)?;
    array(&format!("{name}_{q}_avg{rows}"), quantity.averages.iter().map(value), out)?;
    array(&format!("{name}_{q}_avg_error{rows}"), quantity.averages.iter().map(error), out)
}

fn array(declared: &str, values: impl Iterator<Item = f32>, out: &mut dyn Write) -> Checked<()> {
    let words: Vec<String> = values.map(|value| format!("{value:?}f")).collect();
    let lines: Vec<String> = words.chunks(A_LINE).map(|line| format!("    {}", line.join(", "))).collect();
    Ok(writeln!(out, "static const float {declared} = {{\n{}\n}};\n", lines.join(",\n"))?)
}

/// Lines of a comment that nothing in the text can end.
fn comment(text: &str, out: &mut dyn Write) -> Checked<()> {
    let mut line = String::from(" *");
    for word in text.replace("*/", "* /").replace("/*", "/ *").split_whitespace() {
        if line.len() > 2 && line.len() + 1 + word.len() > WIDTH {
            writeln!(out, "{line}")?;
            line = " *  ".into();
        }
        line = format!("{line} {word}");
    }
    // A backslash at the end would join two lines.
    Ok(writeln!(out, "{}", line.trim_end_matches('\\'))?)
}

/// A C identifier out of a name.
fn identifier(stem: &str) -> String {
    let plain: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("albedo_{plain}") }
}

const PLACE: &str = "\
/* The node at or below x, and in *t the place between it and the next; constant beyond the ends. */
static inline int name_place(const float *nodes, int count, float x, float *t)
{
    int k = 0;
    *t = 0.0f;
    if (count < 2 || x <= nodes[0]) return 0;
    if (x >= nodes[count - 1]) { *t = 1.0f; return count - 2; }
    while (k < count - 2 && x >= nodes[k + 1]) ++k;
    *t = (x - nodes[k])/(nodes[k + 1] - nodes[k]);
    return k;
}

/* Between the values of two nodes. */
static inline float name_mix(float a, float b, float t)
{
    return a + (b - a)*t;
}

/* Bilinear in a slab of [alpha][mu]. */
static inline float name_bilinear(const float *slab, float alpha, float mu)
{
    float s, t;
    int i = name_place(name_alpha, NAME_ALPHA, alpha, &s), j = name_place(name_mu, NAME_MU, mu, &t);
    int i1 = i + (NAME_ALPHA > 1), j1 = j + (NAME_MU > 1);
    return name_mix(name_mix(slab[i*NAME_MU + j], slab[i*NAME_MU + j1], t),
                    name_mix(slab[i1*NAME_MU + j], slab[i1*NAME_MU + j1], t), s);
}

/* Linear in a row of averages. */
static inline float name_linear(const float *row, float alpha)
{
    float s;
    int i = name_place(name_alpha, NAME_ALPHA, alpha, &s);
    return name_mix(row[i], row[i + (NAME_ALPHA > 1)], s);
}
";

const TWO_AXES: &str = "
/* A table of this file, such as name_E, at a roughness and a cosine. */
static inline float name_lookup(const float *table, float alpha, float mu)
{
    return name_bilinear(table, alpha, mu);
}

/* Averages of this file, such as name_E_avg, at a roughness. */
static inline float name_lookup_avg(const float *averages, float alpha)
{
    return name_linear(averages, alpha);
}
";

const THREE_AXES: &str = "
/* A table of this file, such as name_R_outside, at an index, a roughness and a cosine. */
static inline float name_lookup(const float *table, float eta, float alpha, float mu)
{
    float r;
    int h = name_place(name_eta, NAME_ETA, eta, &r), h1 = h + (NAME_ETA > 1);
    return name_mix(name_bilinear(table + h*NAME_ALPHA*NAME_MU, alpha, mu),
                    name_bilinear(table + h1*NAME_ALPHA*NAME_MU, alpha, mu), r);
}

/* Averages of this file, such as name_R_outside_avg, at an index and a roughness. */
static inline float name_lookup_avg(const float *averages, float eta, float alpha)
{
    float r;
    int h = name_place(name_eta, NAME_ETA, eta, &r), h1 = h + (NAME_ETA > 1);
    return name_mix(name_linear(averages + h*NAME_ALPHA, alpha), name_linear(averages + h1*NAME_ALPHA, alpha), r);
}
";
