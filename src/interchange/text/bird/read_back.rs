//! A file that was just written against its table, number by number: neither the file nor a second table is in memory.

use std::io::BufRead;

use crate::error::wrong;
use crate::interchange::Checked;
use crate::interchange::read_back::{Listing, ReadBack};
use crate::interchange::text::spectral_rows::each_bin;
use crate::sphere;
use crate::table::BrdfTable;

/// Compares the lists of these names, in the order in which [`super::write`] has them.
pub fn compared(
    file: impl BufRead,
    table: &BrdfTable,
    colours: &[(f64, usize)],
    names: &[&str],
) -> Checked<Option<ReadBack>> {
    let mut lists = Lists { file, text: vec![] };
    while !lists.until(|byte| byte == b'\n')?.starts_with("\"data\": {") {}
    let (mut listing, bins) = (Listing::new(table), table.grid.bins());
    for &name in names {
        if !lists.until(|byte| byte == b'[')?.contains(&format!("\"{name}\"")) {
            return Err(wrong!("no list {name}"));
        }
        for &(nm, colour) in colours {
            each_bin(table, |entry, [light, sensor]| {
                let word = lists.until(|byte| byte == b',' || byte == b']')?;
                let none = || wrong!("{name}: `{word:.40}` is no number");
                let wanted = match name {
                    "wavelength_i" => nm,
                    "theta_i" => light[0],
                    "phi_i" => sphere::reduced_deg(light[1]),
                    "theta_r" => sensor[0],
                    "phi_r" => sphere::reduced_deg(sensor[1]),
                    "BRDF" => {
                        let value = word.parse().map_err(|_| none())?;
                        listing.add(entry / bins, entry % bins, colour, value);
                        return Ok(());
                    }
                    _ => f64::from(table.colours[colour].stderr[entry]),
                };
                let found: f64 = word.parse().map_err(|_| none())?;
                if found as f32 != wanted as f32 {
                    return Err(wrong!("{name} of entry {entry} is {found}, in the table {wanted}"));
                }
                Ok(())
            })?;
        }
    }
    listing.finish()
}

/// A file of lists, piece by piece.
struct Lists<R> {
    file: R,
    text: Vec<u8>,
}

impl<R: BufRead> Lists<R> {
    /// The text before the next byte that `ends` it.
    fn until(&mut self, ends: impl Fn(u8) -> bool) -> Checked<&str> {
        self.text.clear();
        loop {
            let buffer = self.file.fill_buf()?;
            if buffer.is_empty() {
                return Err("the file ends early".into());
            }
            let end = buffer.iter().position(|byte| ends(*byte));
            self.text.extend_from_slice(&buffer[..end.unwrap_or(buffer.len())]);
            let used = end.map_or(buffer.len(), |end| end + 1);
            self.file.consume(used);
            if end.is_some() {
                return std::str::from_utf8(&self.text).map_err(|e| e.to_string().into());
            }
        }
    }
}
