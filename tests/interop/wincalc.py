"""LBNL's own engine of WINDOW (pywincalc) on Klems matrices."""

import os
import re

import numpy as np
import pywincalc

import readers
from tables import check, gonio

DIRECTIONS = ("Transmission Front", "Transmission Back", "Reflection Front")


def matrices(folder):
    """Matrices of all bases load, and the engine's reflectance of the full one is its sum at the light's patches."""
    standards = os.path.join(os.path.dirname(pywincalc.__file__), "standards")
    standard = pywincalc.load_standard(os.path.join(standards, "W5_NFRC_2003.std"))
    failed = 0
    for basis in ("half", "quarter", "full"):
        xml = folder / f"window.{basis}.xml"
        gonio("export", folder / "iso.exr", "--to", "klems", "--klems", basis, "-o", xml, "--allow-albedo-error", "20")
        try:
            pywincalc.parse_bsdf_xml_file(str(xml))
        except RuntimeError as why:
            print(f"{basis}: {why}")
            failed += 1
    ok = check("klems: files that pywincalc does not load", failed, 0)
    gonio("import", xml, "--from", "klems", "-o", folder / "window.exr")
    gonio("export", folder / "window.exr", "--to", "npz", "-o", folder / "window.npz")
    arrays = np.load(folder / "window.npz")
    grid, values = readers.grid(arrays), arrays["brdf"].astype(float)
    low, high, left, right = np.array(grid["patches_deg"]).T
    size = np.radians(right - left) / 2 * (np.sin(np.radians(high)) ** 2 - np.sin(np.radians(low)) ** 2)
    # The engine wants all that a window has: what a reflector lacks is 0, and the solar blocks are the visible ones.
    text = xml.read_text()
    block = re.search(r"<WavelengthData>.*?</WavelengthData>", text, re.S)[0]
    dark = re.sub(r"<ScatteringData>.*?</ScatteringData>", "<ScatteringData>" + "0," * 145**2 + "</ScatteringData>", block, flags=re.S)
    blocks = [block, *(dark.replace("Reflection Back", direction) for direction in DIRECTIONS)]
    blocks += [block.replace(">Visible<", ">Solar<") for block in blocks]
    whole = text.replace(block, "".join(blocks))
    layer = pywincalc.parse_bsdf_xml_string(whole)
    full = pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL)
    system = pywincalc.GlazingSystem(optical_standard=standard, solid_layers=[layer], bsdf_hemisphere=full)
    off = 0.0
    for stop in (0, 3, 30, 100, 140):
        theta, phi = grid["stops_deg"][stop]
        found = system.optical_method_results("PHOTOPIC", theta, phi).system_results.back.reflectance.direct_hemispherical
        wanted = (size * values[stop]).sum()
        off = max(off, abs(found / wanted - 1))
    # Its own patch sizes, five digits of them.
    return ok & check("klems: reflectance of the engine against the sums of the matrix, relative", off, 1e-4)
