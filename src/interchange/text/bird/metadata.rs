//! The section `metadata` of a BiRD file: what is known of a table, in the fields that the schema has for it.
//!
//! What the schema asks of a laboratory and a table does not know says NA. The fields of `instrumentation` are of real
//! lamps and sensors, and the schema takes NA of a simulation: apertures are in `adhoc_section`.

use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Map, Value, json};

use crate::interchange::text::identity;
use crate::table::BrdfTable;

/// Where the schema is.
const SCHEMA: &str = "https://raw.githubusercontent.com/BiRD-project/BiRD_view/master/BRDF_JSON_schema/brdf_json_schema_v1.0.json";
/// What is not known.
const NOT_APPLICABLE: &str = "NA";
/// An address of nobody: the domain is reserved (RFC 2606).
const NO_ADDRESS: &str = "NA@example.invalid";
/// How a campaign's keys end in their units, and the schema's word for those.
const UNITS: [(&str, &str); 5] =
    [("_deg", "deg"), ("_um", "\u{3bc}m"), ("_nm", "nm"), ("_mm", "mm"), ("_um2", "\u{3bc}m^2")];

/// What the sample is said to be where its azimuths make no difference.
pub const ISOTROPIC: &str = "isotropic";

/// The section of a table that is written now.
pub fn metadata(table: &BrdfTable) -> Value {
    let simulated = !table.campaign.is_empty();
    let name = identity::name(table);
    let description = if simulated {
        format!("{name}: the BRDF of a virtual rough surface, measured by tracing rays")
    } else {
        format!("{name}: the values of another program's file")
    };
    json!({
        "schema": SCHEMA,
        "id": format!("urn:uuid:{}", identity::uuid(table)),
        "type": "BRDF",
        "timestamp": timestamp(now()),
        "provenance": provenance(),
        "description": description,
        "method": if simulated { "simulation" } else { "measurement" },
        "instrumentation": NOT_APPLICABLE,
        "software": software(table),
        "sample": sample(table, &name),
        "environment": NOT_APPLICABLE,
        "adhoc_section": adhoc(table),
    })
}

fn provenance() -> Value {
    let place: Map<String, Value> = ["country", "city", "street", "building_nr", "postal_code"]
        .into_iter()
        .map(|key| (key.to_string(), NOT_APPLICABLE.into()))
        .collect();
    json!({
        "organization": NOT_APPLICABLE,
        "location": place,
        "email": NO_ADDRESS,
        "contact_person": NOT_APPLICABLE,
    })
}

/// The program and, of a simulation, the numbers of its campaign.
fn software(table: &BrdfTable) -> Value {
    let mut software = json!({
        "name": "gonio",
        "version": table.version,
        "description": "a virtual gonioreflectometer: rays traced on random or measured rough surfaces",
    });
    if let Some(campaign) = identity::campaign(table) {
        let mut parameters = vec![];
        add_parameters(&campaign, "", &mut parameters);
        software["simulation_model"] = json!({
            "name": "geometric optics on a height field",
            "description": "rays traced from facet to facet; each facet reflects or refracts by its own optics",
            "parameters": parameters,
        });
    }
    software
}

/// The numbers of a campaign, each with the path of its key.
fn add_parameters(table: &toml::Table, path: &str, parameters: &mut Vec<Value>) {
    for (key, value) in table {
        let name = format!("{path}{key}");
        let number = match value {
            toml::Value::Integer(number) => json!(number),
            toml::Value::Float(number) => json!(number),
            toml::Value::Table(table) => {
                add_parameters(table, &format!("{name}."), parameters);
                continue;
            }
            _ => continue,
        };
        let unit = UNITS.iter().find(|(ending, _)| key.ends_with(ending)).map_or("", |(_, unit)| unit);
        parameters.push(json!({
            "name": name,
            "description": "a key of the campaign",
            "value": number,
            "unit": unit,
        }));
    }
}

fn sample(table: &BrdfTable, name: &str) -> Value {
    let simulated = !table.campaign.is_empty();
    let mut sample = json!({
        "name": name,
        "type": if simulated { "virtual rough surface" } else { NOT_APPLICABLE },
        "shape": if simulated { "square patches of a height field" } else { NOT_APPLICABLE },
        "dimensions": {},
        "zero_azimuth_location": if simulated { "x of the height field" } else { NOT_APPLICABLE },
    });
    if table.grid.is_isotropic() {
        sample["properties_symmetry"] = ISOTROPIC.into();
    }
    sample
}

/// What the schema has no field for: the apertures, and the campaign as it was.
fn adhoc(table: &BrdfTable) -> Value {
    let mut adhoc = json!({ "seed": table.seed });
    if let Some(angle) = identity::receiver(table) {
        adhoc["detection_system"] = json!({ "solid_angle": { "value": angle, "unit": "sr" } });
    }
    if !table.campaign.is_empty() {
        adhoc["campaign"] = table.campaign.as_str().into();
    }
    adhoc
}

/// Seconds since 1970 at the end of the year 9999, the last that a date of ISO 8601 can say.
const LAST_SECOND: u64 = 253_402_300_799;

/// Seconds since 1970: those of `SOURCE_DATE_EPOCH` where it is set, so that the same table can give the same bytes.
fn now() -> u64 {
    let set = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|text| text.parse().ok());
    let set = set.filter(|&seconds: &u64| seconds <= LAST_SECOND);
    set.unwrap_or_else(|| SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs()))
}

/// Seconds since 1970 as a date and time of ISO 8601, UTC.
fn timestamp(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Days of years that begin in March, so that a leap day is the last: 146,097 in 400 years.
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let date = day - (153 * month + 2) / 5 + 1;
    let (month, year) = if month < 10 { (month + 3, year) } else { (month - 9, year + 1) };
    format!(
        "{:04}-{month:02}-{date:02}T{:02}:{:02}:{:02}Z",
        era * 400 + year,
        second / 3_600,
        second / 60 % 60,
        second % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds and dates as the tables of POSIX time have them: leap days, ends of years and centuries.
    #[test]
    fn seconds_become_dates() {
        for (seconds, date) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_799, "2000-02-29T23:59:59Z"),
            (1_000_000_000, "2001-09-09T01:46:40Z"),
            (1_234_567_890, "2009-02-13T23:31:30Z"),
            (1_609_459_199, "2020-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(timestamp(seconds), date);
        }
    }
}
