"""Published scans that other people's software wrote: the program's heights and pitches against those of independent readers.

Rows are compared in the order of the file: its first row is y = 0 of the map, where x grows along a row and y from row to row.
An Arc grid alone begins with its northern row, the map's last one. Heights are compared less their means, over the points
that the reader has; where a file does not say what its heights are, both take UNIT_UM for their unit.
"""

import zipfile

import gsffile
import gwyfile
import numpy as np
import rasterio
import sdfio
import verity_x3p
import x3pio
from rsciio import digitalsurf

import published
from tables import check, gonio

CAMPAIGN = """name = "scan"
[surface.file]
path = "{path}"
detrend = "none"
outliers = "keep"
gaps = "interpolate"
refine = 1
tiles = 1
{keys}
[light]
theta_i_deg = [0]
azimuth = "absolute"
phi_i_deg = [0]
[sensor.hemisphere]
[stop]
samples = 4096
"""
# Counts, volts and slopes become heights of slopes that a surface may have.
UNIT_UM = 1e-4
LENGTH_UM = {"m": 1e6, "mm": 1e3, "um": 1.0, "nm": 1e-3}


def sur(path):
    """RosettaSciIO; heights in arbitrary units."""
    signal = digitalsurf.file_reader(str(path))[0]
    y, x = signal["axes"]
    return signal["data"], None, [LENGTH_UM[axis["units"]] * axis["scale"] for axis in (x, y)]


def gwy(title):
    """gwyfile: the field of a title, in metres."""

    def read(path):
        container = gwyfile.load(str(path))
        number = next(key.split("/")[1] for key in container if key.endswith("/data/title") and container[key] == title)
        field = container[f"/{number}/data"]
        assert field["si_unit_xy"]["unitstr"] == field["si_unit_z"]["unitstr"] == "m"
        rows, columns = field.data.shape
        return field.data, 1e6, [1e6 * field.xreal / columns, 1e6 * field.yreal / rows]

    return read


def gsf(path):
    """gsffile; heights without a unit, sizes in metres."""
    data, head = gsffile.read_gsf(str(path))
    return data, None, [1e6 * head["XReal"] / data.shape[1], 1e6 * head["YReal"] / data.shape[0]]


def spip(path):
    """NumPy; the lengths at the head are nm."""
    with open(path, encoding="latin-1") as file:
        head = dict(line[1:].split("=", 1) for line in file if line.startswith("#") and "=" in line)
    head = {name.strip(): value.strip() for name, value in head.items()}
    data = np.loadtxt(path)
    assert data.shape == (int(head["y-pixels"]), int(head["x-pixels"]))
    lengths = [1e-3 * float(head[name]) for name in ("x-length", "y-length")]
    return data, LENGTH_UM[head["z-unit"]], [lengths[0] / data.shape[1], lengths[1] / data.shape[0]]


def raster(path):
    """GDAL: its rows run from north to south."""
    with rasterio.open(path) as file:
        return file.read(1, masked=True).astype(float).filled(np.nan), None, list(file.res)


def arc(path):
    heights, unit_um, pitches = raster(path)
    return heights[::-1], unit_um, pitches


def npy(path):
    """NumPy; metres on a grid of angles, here of any pitch."""
    return np.load(path), None, [20.0, 30.0]


def sdf(path):
    """sdfio; metres."""
    file = sdfio.read(path)
    return file.data, 1e6, [1e6 * file.header.x_scale, 1e6 * file.header.y_scale]


def x3p(path):
    """verity-x3p, where x3pio, whose author wrote the file, has a point; metres."""
    surface, own = verity_x3p.read_x3p(str(path)), x3pio.read(path)
    there = np.isfinite(own.layers[0].z)
    pitches = [1e6 * surface.increment_x, 1e6 * surface.increment_y]
    return np.where(there, surface.data, np.nan), 1e6, pitches


# Name, what it is, its reader, and whether the file has pitches and a unit of its own.
SCANS = [
    ("attolight.sur", "Digital Surf", sur, False),
    ("peak_force.gwy", "Gwyddion", gwy("ZSensor"), True),
    ("snom.gwy", "Gwyddion", gwy("Z raw"), True),
    ("snom.gsf", "Gwyddion simple field", gsf, False),
    ("whitelight.gsf", "Gwyddion simple field", gsf, False),
    ("spip.asc", "SPIP text", spip, True),
    ("spip_unfiltered.asc", "SPIP text", spip, True),
    ("hugo_site.asc", "Arc grid", arc, False),
    ("slope.tif", "TIFF", raster, False),
    ("jacksboro.npy", "NPY", npy, False),
    ("mountains_iso1_int32.sdf", "SDF, binary", sdf, True),
    ("mountains_iso2_text.sdf", "SDF, text", sdf, True),
    ("int16.x3p", "X3P", x3p, True),
    ("placed.x3p", "X3P", x3p, True),
]
# The channel of files of several, by number and by title.
CHANNELS = {"peak_force.gwy": "channel = 0", "snom.gwy": 'channel = "Z raw"'}


def one(folder, path, kind, reader, is_sized):
    wanted, unit_um, pitches = reader(path)
    keys = CHANNELS.get(path.name, "")
    if not is_sized:
        keys += f"\npitch_x_um = {pitches[0]!r}\npitch_y_um = {pitches[1]!r}\nheight_unit_um = {UNIT_UM}"
    (folder / "scan.toml").write_text(CAMPAIGN.format(path=path, keys=keys))
    out = folder / f"{path.name}_patch"
    said = gonio("surface", folder / "scan.toml", "-o", out, "--npy")["map"]
    found = np.load(out / "patch_000.npy").astype(float) * said["unit_um"]
    if found.shape != wanted.shape:
        return check(f"{path.name} ({kind}): rows x columns {found.shape} for {wanted.shape}", 1, 0)
    wanted = wanted.astype(float) * (unit_um or UNIT_UM)
    there = np.isfinite(wanted)
    found, wanted = found[there] - found[there].mean(), wanted[there] - wanted[there].mean()
    rows, columns = there.shape
    # f32 of heights about their mean: 2^-25 of at most the range, and sums.
    ok = check(f"{path.name} ({kind}, {columns} x {rows}): largest difference of heights over their range",
               np.abs(found - wanted).max() / np.ptp(wanted), 1e-6)
    if is_sized:
        off = max(abs(a / b - 1) for a, b in zip(said["pitch_um"], pitches))
        # Pitches that files hold in f32.
        ok &= check("  its pitches, relative", off, 1e-6)
    return ok


def compared(folder):
    """Every file that can be had."""
    had, missing = published.fetch()
    if missing:
        print(f"scans: skipped, {', '.join(missing)} cannot be had: {next(iter(missing.values()))}")
    if "jacksboro.npz" in had:
        with zipfile.ZipFile(had["jacksboro.npz"]) as archive:
            (folder / "jacksboro.npy").write_bytes(archive.read("elevation.npy"))
        had["jacksboro.npy"] = folder / "jacksboro.npy"
    return all([one(folder, had[name], *how) for name, *how in SCANS if name in had])
