//! The XML that Radiance and WINDOW read, written: the frame round matrices and tensor trees.

use super::sample_side::SampleSide;

/// What the values of light that goes through are.
const THROUGH: &str = "Transmission: flux per projected solid angle and incident flux, no factor n^2";

/// A format's convention, and that of light that has gone through where there is any.
pub fn convention(of_all: &str, through: bool) -> String {
    if through { format!("{of_all}; {THROUGH}") } else { of_all.into() }
}

/// A block that is written.
pub struct Block {
    /// The side that light comes from.
    pub light: SampleSide,
    /// Whether it is light that has gone through.
    pub through: bool,
    /// The elements that name its bases.
    pub bases: String,
    /// `Visible`, `CIE-X`, ..
    pub wavelength: &'static str,
    /// The values as text.
    pub data: String,
}

/// A file of some blocks; `basis` describes the bases.
pub fn write(structure: &str, basis: &str, blocks: &[Block]) -> String {
    let through = blocks.iter().any(|block| block.through);
    let said = if through {
        format!("<!-- {THROUGH}; Back is light from +z, Front light from -z -->\n")
    } else {
        String::new()
    };
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         {said}<WindowElement xmlns=\"http://windows.lbl.gov\">\n\
         <WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\
         <Material>\n<Name>gonio</Name>\n<Manufacturer>gonio {}</Manufacturer>\n\
         <Thickness unit=\"meter\">0</Thickness>\n<DeviceType>Other</DeviceType>\n</Material>\n\
         <DataDefinition>\n<IncidentDataStructure>{structure}</IncidentDataStructure>\n{basis}</DataDefinition>\n",
        env!("CARGO_PKG_VERSION")
    );
    for Block { light, through, bases, wavelength, data } in blocks {
        let detector = if *wavelength == "Visible" { "ASTM E308 1931 Y.dsp" } else { "none" };
        let (direction, kind) = (light.direction(*through), if *through { "BTDF" } else { "BRDF" });
        text += &format!(
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">{wavelength}</Wavelength>\n\
             <SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n\
             <DetectorSpectrum>{detector}</DetectorSpectrum>\n<WavelengthDataBlock>\n\
             <WavelengthDataDirection>{direction}</WavelengthDataDirection>\n{bases}\
             <ScatteringDataType>{kind}</ScatteringDataType>\n<ScatteringData>\n"
        );
        text += data;
        text += "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n";
    }
    text + "</Layer>\n</Optical>\n</WindowElement>\n"
}
