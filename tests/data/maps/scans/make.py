"""Makes the scans of this folder, and `heights.csv`: what other programs read in them.

The files are written by other packages or were written by other programs (see README.md); none by gonio. Needs numpy, sdfio,
x3pio, surfalize, SurfaceTopography, gwyfile, gwyddionpy with its converter (Gwyddion itself), tifffile and pillow, and the
unpacked source distributions of sdfio and x3pio as the first two arguments.

    python make.py sdfio-2.0.0 x3pio-2.0.0

A line of `heights.csv` is a file, its columns and rows, its pitches in um (0: none), the number of samples without data, and one
sample: row, column, height in um less the mean of all heights, and the range of the heights.
"""

import shutil
import struct
import sys
from pathlib import Path

import gwyddionpy
import gwyfile
import numpy as np
import sdfio
import tifffile
import x3pio
from PIL import Image
from surfalize import Surface
from SurfaceTopography.IO import open_topography

SDF, X3P = (Path(argument) for argument in sys.argv[1:3])
HERE = Path(__file__).parent
ROWS, COLUMNS, PITCH_X, PITCH_Y = 36, 48, 0.5, 0.8
PUBLISHED = {
    "mountains_iso1_int32.sdf": SDF / "tests/interop_samples/mm11_iso1_binary_int32.sdf",
    "mountains_iso2_double.sdf": SDF / "tests/interop_samples/mm11_iso2_ascii_binary64.sdf",
    "bcr_uint16.sdf": SDF / "tests/samples/bcr-1.0/bcr1_surface_uint16_binary.sdf",
    "iso1_text.sdf": SDF / "tests/samples/iso25178-71-2026/iso1_surface_ascii.sdf",
    "iso2_int16.sdf": SDF / "tests/samples/iso25178-71-2026/iso2_surface_binary.sdf",
    "valid_points.x3p": X3P / "tests/samples/iso25178-72-fdam1/surface_int32_binary.x3p",
    "as_text.x3p": X3P / "tests/samples/iso25178-72-fdam1/surface_int32_xml.x3p",
    "revision_2017.x3p": X3P / "tests/samples/iso25178-72-2017/surface_binary.x3p",
}


def scan():
    """Ground waves with noise, um, without data in a blot and at single places."""
    rng = np.random.default_rng(20)
    y, x = np.mgrid[:ROWS, :COLUMNS]
    heights = 0.4 * np.sin(0.6 * x + 0.2 * y) + 0.1 * rng.standard_normal((ROWS, COLUMNS)) + 3.0
    heights[(x - 30) ** 2 + (y - 12) ** 2 < 10] = np.nan
    heights[rng.random((ROWS, COLUMNS)) < 0.01] = np.nan
    return heights


def metropro(path, heights):
    """Zygo's MetroPro: nothing writes it. The fields are at the places that SurfaceTopography reads them at."""
    wavelength, scale, obliquity, resolution = 0.6328e-6, 0.5, 1.0, 32768
    header = bytearray(834)
    struct.pack_into(">IHI", header, 0, 0x881B036F, 1, 834)
    struct.pack_into(">HH", header, 68, COLUMNS, ROWS)
    struct.pack_into(">I", header, 72, 4 * COLUMNS * ROWS)
    struct.pack_into(">ff", header, 164, scale, wavelength)
    struct.pack_into(">f", header, 176, obliquity)
    struct.pack_into(">f", header, 184, PITCH_X * 1e-6)
    struct.pack_into(">h", header, 218, 1)
    phase = np.where(np.isnan(heights), 0, heights * 1e-6 * resolution / (scale * obliquity * wavelength))
    phase = np.where(np.isnan(heights), 2147483640, np.rint(phase)).astype(">i4")
    path.write_bytes(bytes(header) + phase.tobytes())


def write(heights):
    for name, source in PUBLISHED.items():
        shutil.copy(source, HERE / name)
    surface = Surface(heights, PITCH_X, PITCH_Y)
    surface.save(HERE / "plain.sur")
    surface.save(HERE / "compressed.sur", compressed=True)
    surface.save(HERE / "floats.x3p", dtype="F")
    whole = np.nan_to_num(heights, nan=3.0)
    field = gwyfile.objects.GwyDataField(
        whole * 1e-6,
        xreal=COLUMNS * PITCH_X * 1e-6,
        yreal=ROWS * PITCH_Y * 1e-6,
        si_unit_xy=gwyfile.objects.GwySIUnit(unitstr="m"),
        si_unit_z=gwyfile.objects.GwySIUnit(unitstr="m"),
    )
    phase = gwyfile.objects.GwyDataField(whole, si_unit_z=gwyfile.objects.GwySIUnit(unitstr="deg"))
    container = gwyfile.objects.GwyContainer()
    container["/0/data"], container["/0/data/title"] = phase, "Phase"
    container["/1/data"], container["/1/data/title"] = field, "Height"
    container.tofile(str(HERE / "two_channels.gwy"))
    # Gwyddion's own file of what it reads in a file of MountainsMap.
    gwyddionpy._run.run_converter(HERE / "mountains_iso1_int32.sdf", HERE / "by_gwyddion.gwy")
    metropro(HERE / "metropro.dat", heights)
    counts = np.rint(1e4 * whole).astype(np.uint16)
    tifffile.imwrite(HERE / "counts.tif", counts, compression="zlib", predictor=True)
    tifffile.imwrite(HERE / "floats.tif", heights.astype(np.float32), bigtiff=True)
    Image.fromarray(counts).save(HERE / "counts.png")
    np.savetxt(HERE / "matrix.csv", heights, delimiter=",", fmt="%.7g")


def read(name):
    """Heights in um and pitches in um by an independent reader."""
    path = str(HERE / name)
    end = name.rsplit(".", 1)[1]
    if end == "sdf" and name != "bcr_uint16.sdf":
        sdf = sdfio.read(path)
        return sdf.data * 1e6, sdf.header.x_scale * 1e6, sdf.header.y_scale * 1e6
    if end in ("sdf", "gwy"):
        channels = gwyddionpy.load(path).channels
        channel = next(channel for channel in channels.values() if channel.si_unit_z == "m")
        heights = np.array(channel.data)
        if end == "sdf":
            # Gwyddion fills what has no data; sdfio knows where it is, with its rows the other way round.
            heights[np.isnan(sdfio.read(path).data[::-1])] = np.nan
        rows, columns = heights.shape
        return heights * 1e6, channel.xreal * 1e6 / columns, channel.yreal * 1e6 / rows
    if end == "x3p" and name != "floats.x3p":
        x3p = x3pio.read(path)
        return x3p.layers[0].z * 1e6, x3p.header.x.increment * 1e6, x3p.header.y.increment * 1e6
    if end in ("sur", "x3p"):
        surface = Surface.load(path)
        return surface.data, surface.step_x, surface.step_y
    if end == "dat":
        topography = open_topography(path).topography()
        heights = np.ma.filled(topography.heights().T * 1e6, np.nan)
        size = topography.physical_sizes
        return heights, size[0] * 1e6 / COLUMNS, size[1] * 1e6 / ROWS
    if end == "tif":
        return tifffile.imread(path).astype(float), 0, 0
    if end == "png":
        return np.array(Image.open(path)).astype(float), 0, 0
    return np.genfromtxt(path, delimiter=","), 0, 0


def main():
    write(scan())
    files = sorted(path.name for path in HERE.iterdir() if path.suffix not in (".py", ".md") and path.name != "heights.csv")
    with open(HERE / "heights.csv", "w", encoding="ascii") as out:
        out.write("file,columns,rows,pitch_x_um,pitch_y_um,gaps,row,column,height_um,range_um\n")
        for name in files:
            heights, pitch_x, pitch_y = read(name)
            rows, columns = heights.shape
            known = np.argwhere(np.isfinite(heights))
            chosen = known[np.random.default_rng(7).choice(len(known), 24, replace=False)]
            mean, gaps = np.nanmean(heights), rows * columns - len(known)
            extent = np.nanmax(heights) - np.nanmin(heights)
            for row, column in [known[0], known[-1], *chosen]:
                height = heights[row, column] - mean
                out.write(f"{name},{columns},{rows},{pitch_x:.9g},{pitch_y:.9g},{gaps},{row},{column},{height:.12g},{extent:.9g}\n")


if __name__ == "__main__":
    main()
