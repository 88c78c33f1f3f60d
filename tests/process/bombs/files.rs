//! Files that ask for far more memory than they are long, or are longer than memory.

mod makers;

use gonio::measure::persist::header::KIND;
use makers::{
    Maker, attributes, beside_a_table, exr, gaps, lights, map, needles, npy, npz, overlapping, sparse, texts,
};

/// A file, and the command line that reads it.
pub struct Bomb {
    pub name: String,
    pub arguments: String,
    /// Puts it into a folder.
    pub write: Maker,
}

const XML: &str = "<WindowElement><DataDefinition><IncidentDataStructure>";
const BLOCK: &str = "<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock><WavelengthDataDirection>Reflection \
    Back</WavelengthDataDirection>";
const KLEMS: &str =
    "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Full</RowAngleBasis>";
const CSV: &str = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n";
const ASTM: &str = "VARS theta_i,phi_i,theta_s,phi_s,Y\n";
const OPENMATERIAL: &str = "{\"brdf\":{\"lookupTable\":[";
const BIRD: &str = "{\"data\":{\"BRDF\":{\"unit\":\"1/sr\",\"values\":[";
const FRED: &str = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n0 0\n";
const SSDD: &str =
    "VERSION 1.0\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n";

fn xml(structure: &str, pieces: Vec<(String, u64)>) -> Maker {
    let head = format!("{XML}{structure}</IncidentDataStructure>");
    let end = "</ScatteringData></WavelengthDataBlock></WavelengthData></WindowElement>";
    texts("b", [(head, 1)].into_iter().chain(pieces).chain([(end.to_string(), 1)]).collect())
}

/// A bomb's name, the command that is to read it, and what makes it.
type Made<'a> = (&'a str, String, Maker);

/// All of them; `size` is their length as a share of the usual one.
pub fn all(size: f64) -> Vec<Bomb> {
    let mb = |count: f64| (count * size * 1e6) as u64;
    let once = |text: &str| (text.to_string(), 1);
    let of = |text: &str, megabytes: f64| (text.to_string(), mb(megabytes) / text.len() as u64);
    let data = |bases: &str| once(&format!("</DataDefinition>{BLOCK}{bases}<ScatteringData>"));
    let side = ((size * 4e8).sqrt() as u64).max(8);
    let root = |count: f64| (count * size.sqrt()) as u64;
    let import = |format: &str| format!("import b --from {format} -o t.exr");
    let check = "measure c.toml -o out";
    let array = |zeros: u64| (npy("<f4", &format!("(1, 1, 1, {})", zeros / 4)), zeros);
    let named = |name: String, (head, zeros): (Vec<u8>, u64)| (name, head, zeros);
    let whole = |megabytes: f64| array(mb(megabytes).next_multiple_of(1 << 16));
    let orders = (2..22).map(|k| named(format!("order{k}.npy"), whole(40.0))).collect();
    let wide: String =
        CSV.encode_utf16().map(|unit| char::from(unit as u8)).flat_map(|c| [c, '\0']).collect();
    let list: Vec<Made> = vec![
        ("npz of zeros", import("npz"), npz(vec![("brdf.npy".into(), vec![], mb(600.0))])),
        ("npz array", import("npz"), npz(vec![named("brdf.npy".into(), whole(300.0))])),
        ("npz orders", import("npz"), npz(orders)),
        ("npz false shape", import("npz"), npz(vec![("grid.npy".into(), npy("<U1", "(9,)"), mb(300.0))])),
        ("npz texts", import("npz"), npz(vec![("grid.npy".into(), npy("<U1", "(70000000,)"), mb(280.0))])),
        ("npz members", import("npz"), npz((0..mb(0.06)).map(|k| (format!("{k}"), vec![], 0)).collect())),
        ("npz cut short", import("npz"), sparse("b", b"PK\x03\x04".to_vec(), mb(3000.0))),
        ("exr wide", import("utia"), exr("b", [1 << 24, 16], mb(4.0))),
        ("exr high", import("exr_parts"), exr("b", [1 << 10, (size * 1e6) as u32], mb(40.0))),
        ("exr table", "export b --to npy -o t.npy".into(), exr("b", [1 << 24, 16], mb(4.0))),
        ("exr attributes", "validate b".into(), attributes(mb(5.0))),
        ("exr maps", "import . --from maps --every 1 -o m".into(), {
            let alpha = exr("ax_ay.exr", [1 << 24, 8], mb(4.0));
            let f0 = exr("ps.exr", [1 << 24, 8], mb(4.0));
            Box::new(move |folder| (alpha(folder), f0(folder)).0)
        }),
        ("csv line", import("csv"), texts("b", vec![once(CSV), of("0,", 300.0)])),
        ("csv header", import("csv"), texts("b", vec![of("theta_i_deg,", 300.0)])),
        ("csv quoted", import("csv"), texts("b", vec![once(CSV), once("0,0,0,0,\""), of("0\n", 300.0)])),
        ("csv lines", import("csv"), texts("b", vec![once(CSV), of("0,0,0,0,1\n", 300.0)])),
        ("csv empty lines", import("csv"), texts("b", vec![once(CSV), of("\n", 300.0)])),
        ("csv comments", import("csv"), texts("b", vec![of("#\n", 300.0)])),
        ("csv wide", import("csv"), texts("b", vec![once(&wide.to_string()), of("0\0,\0", 300.0)])),
        ("csv gaps", import("csv"), gaps(root(2300.0), 1)),
        ("csv gaps of colours", import("csv"), gaps(root(2048.0), 60)),
        ("astm line", import("astm"), texts("b", vec![once(ASTM), of("0,", 300.0)])),
        ("astm lines", import("astm"), texts("b", vec![once(ASTM), of("0,0,0,0,1\n", 300.0)])),
        (
            "openmaterial rows",
            import("openmaterial"),
            texts("b", vec![once(OPENMATERIAL), of("[5e-7,1,0,0,1],", 300.0), once("[5e-7,1,0,0,1]]}}")]),
        ),
        ("openmaterial nested", import("openmaterial"), texts("b", vec![once(OPENMATERIAL), of("[", 300.0)])),
        ("bird values", import("bird"), texts("b", vec![once(BIRD), of("0,", 300.0), once("0]}}}")])),
        (
            "bird states",
            import("bird"),
            texts("b", vec![once("{\"data\":{\"polarization_i\":{\"values\":["), of("\"s\",", 300.0)]),
        ),
        ("bird nested", import("bird"), texts("b", vec![once(BIRD), of("[", 300.0)])),
        ("fred line", import("fred"), texts("b", vec![once(FRED), of("0 ", 300.0)])),
        ("fred lines", import("fred"), texts("b", vec![once(FRED), of("0 0 1\n", 300.0)])),
        ("ssdd line", import("ssdd"), texts("b", vec![once(SSDD), once("PARAM0_LIST "), of("0 ", 300.0)])),
        (
            "ssdd binary",
            import("ssdd"),
            sparse("b", format!("{SSDD}PARAM0_LIST 0\nDATA binary\n").into_bytes(), mb(900.0)),
        ),
        ("ssdd ascii", import("ssdd"), texts("b", vec![once(SSDD), once("DATA ascii\n"), of("0\n", 200.0)])),
        ("klems data", import("klems"), xml("Columns", vec![data(KLEMS), of("0 ", 200.0)])),
        (
            "klems cells",
            import("klems"),
            xml("Columns", vec![data(KLEMS), once(&"0".repeat(9)), of("0", 400.0)]),
        ),
        (
            "klems rings",
            import("klems"),
            xml(
                "Columns",
                vec![
                    once("<AngleBasis><AngleBasisName>LBNL/Klems Full</AngleBasisName>"),
                    of("<AngleBasisBlock><nPhis>360</nPhis></AngleBasisBlock>", 20.0),
                    once("</AngleBasis>"),
                    data(KLEMS),
                ],
            ),
        ),
        (
            "klems names",
            import("klems"),
            xml(
                "Columns",
                vec![
                    once("<Wavelength>"),
                    of("V", 1.0),
                    once("</Wavelength>"),
                    of("<WavelengthDataBlock></WavelengthDataBlock>", 1.0),
                    data(KLEMS),
                ],
            ),
        ),
        (
            "klems elements",
            import("klems"),
            xml("Columns", vec![of("<AngleBasis></AngleBasis>", 300.0), data("")]),
        ),
        (
            "tensor tree",
            import("tensor_tree"),
            xml("TensorTree4", vec![data(""), once("{"), of("{0}", 100.0)]),
        ),
        (
            "tensor leaf",
            import("tensor_tree"),
            xml("TensorTree4", vec![data(""), once("{"), of("0 ", 200.0)]),
        ),
        ("zemax", import("zemax"), texts("b", vec![once("Source Measured\n"), of("0 ", 300.0)])),
        ("merl", import("merl"), sparse("b", vec![], mb(3000.0))),
        ("utia", import("utia"), sparse("b", vec![], mb(3000.0))),
        ("rgl", import("rgl"), sparse("b", b"tensor_file\0\x01\0".to_vec(), mb(900.0))),
        ("rgl overlap", import("rgl"), overlapping(mb(20.0))),
        ("rgl lights", import("rgl"), lights(root(300.0))),
        (
            "map npy",
            check.into(),
            map(
                "scan.npy",
                sparse("scan.npy", npy("|u1", &format!("({side}, {side})")), {
                    side * side + npy("|u1", &format!("({side}, {side})")).len() as u64
                }),
            ),
        ),
        (
            "map gsf",
            check.into(),
            map("scan.gsf", {
                let head = format!("Gwyddion Simple Field 1.0\nXRes = {side}\nYRes = {side}\n");
                let start = head.len() as u64 + 4 - head.len() as u64 % 4;
                sparse("scan.gsf", head.into_bytes(), start + 4 * side * side)
            }),
        ),
        ("map exr", check.into(), map("scan.exr", exr("scan.exr", [1 << 24, 16], mb(4.0)))),
        ("map needles", check.into(), map("scan.npy", needles("scan.npy", root(1000.0)))),
        ("map line", check.into(), map("scan.txt", texts("scan.txt", vec![of("0 0 0 ", 300.0)]))),
        ("map points", check.into(), map("scan.xyz", texts("scan.xyz", vec![of("0 0 0\n", 300.0)]))),
        (
            "map matrix",
            check.into(),
            map("scan.txt", texts("scan.txt", vec![of("0 0 0 0 0 0 0 0\n", 300.0)])),
        ),
        (
            "map arc",
            check.into(),
            map("scan.asc", texts("scan.asc", vec![once("ncols 1\n"), of("a 1 ", 300.0)])),
        ),
        ("toml", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 200.0)])),
        ("toml values", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 16.0)])),
        ("toml fewer values", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 4.0), once("0]")])),
        ("toml tables", check.into(), texts("c.toml", vec![once("a = ["), of("{},", 5.0), once("0]")])),
        (
            "json nodes",
            "report t.exr --bench j.json".into(),
            beside_a_table(texts("j.json", vec![once("["), of("0,", 100.0)])),
        ),
        (
            "json text",
            "report t.exr --bench j.json".into(),
            beside_a_table(texts("j.json", vec![once("\""), of("0", 900.0)])),
        ),
        ("shard", "merge b.shard_1_of_1 -o out".into(), sparse("b.shard_1_of_1", vec![], mb(3000.0))),
        ("shard content", "merge b.shard_1_of_1 -o out".into(), {
            sparse("b.shard_1_of_1", format!("{KIND}\n").into_bytes(), mb(900.0))
        }),
    ];
    list.into_iter().map(|(name, arguments, write)| Bomb { name: name.into(), arguments, write }).collect()
}
