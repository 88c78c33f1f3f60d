"""What programs that this project did not write see in its exports, and what it sees in their scans. Run by .ci/run; prints one
line a figure."""

import csv
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import energy
import measured
import radiance
import readers
import scans
import through
import wincalc
from tables import GONIO, check, ggx, gonio, pairs, table


def rgl(folder):
    """Mitsuba's `measured` against its own `roughconductor` (no material, separable Smith)."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    ok = True
    cases = [
        ("iso", 0.3, 0.3, list(np.arange(0, 90, 5.0)), None, 90, 180, 1e-3),
        ("aniso", 0.2, 0.5, list(np.arange(0, 88, 5.5)), list(np.arange(0, 360, 15.0)), 90, 120, 5e-3),
    ]
    for name, ax, ay, theta_i, phi_i, rows, columns, limit in cases:
        exr = table(folder, name, ax, ay, theta_i, phi_i, rows, columns)
        gonio("export", exr, "--to", "rgl", "-o", folder / f"{name}.bsdf")
        found = mi.load_dict({"type": "measured", "filename": str(folder / f"{name}.bsdf")})
        wanted = mi.load_dict({"type": "roughconductor", "material": "none", "distribution": "ggx",
                               "alpha_u": ax, "alpha_v": ay, "sample_visible": True})
        context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
        distance = total = own = 0.0
        for wi, wo in zip(*pairs(2000, 69, 1)):
            si.wi = mi.Vector3f(*wi)
            f = found.eval(context, si, mi.Vector3f(*wo))[0]
            g = wanted.eval(context, si, mi.Vector3f(*wo))[0]
            distance, total = distance + abs(f - g), total + g
            own += abs(ggx(wi, wo, ax, ay) * wo[2] - g)
        ok &= check(f"rgl {name}: Mitsuba measured against roughconductor, L1", distance / total, limit)
        ok &= check(f"  (formula of this test against roughconductor, L1)", own / total, 1e-5)
    return ok


def plain(folder):
    """Readers written from the layouts: MERL, UTIA, NPZ, EXR parts."""
    import OpenEXR

    exr = table(folder, "merl", 0.1, 0.1, list(np.arange(0, 90, 3.0)), None, 90, 180)
    gonio("export", exr, "--to", "merl", "-o", folder / "merl.binary")
    ok = check("merl: bytes off 34,992,012", abs((folder / "merl.binary").stat().st_size - 34_992_012), 0)
    merl = readers.Merl(folder / "merl.binary")
    wi, wo = pairs(20000, 75, 4)
    wanted = ggx(wi, wo, 0.1, 0.1)
    ok &= check("merl: interpolating reader against the formula, L1",
                np.abs(merl(wi, wo) - wanted).sum() / wanted.sum(), 3e-3)
    gonio("export", folder / "aniso4.exr", "--to", "utia", "-o", folder / "utia.bin")
    gonio("import", folder / "utia.bin", "--from", "utia", "-o", folder / "utia.exr")
    gonio("export", folder / "utia.exr", "--to", "npz", "-o", folder / "utia.npz")
    values = np.load(folder / "utia.npz")["brdf"]
    raw = np.fromfile(folder / "utia.bin", "<f8").reshape(3, 288, 288)
    # The table holds f32, the file f64.
    raw = np.moveaxis(raw, 0, -1).reshape(-1).astype("f4")
    ok &= check("utia: largest difference of raw values", np.abs(raw - values.reshape(-1)).max(), 0)
    gonio("export", folder / "utia.exr", "--to", "utia", "-o", folder / "utia_image.exr")
    image = OpenEXR.File(str(folder / "utia_image.exr"), separate_channels=True).channels()
    off = max(np.abs(image[c].pixels - raw.reshape(288 * 288, 3)[:, k].reshape(288, 288)).max() for k, c in enumerate("RGB"))
    ok &= check("utia: largest difference of the image form", off, 0)
    gonio("import", folder / "merl.binary", "--from", "merl", "-o", folder / "cells.exr")
    gonio("export", folder / "cells.exr", "--to", "merl", "-o", folder / "cells.binary")
    once, twice = (np.fromfile(folder / f"{name}.binary", "<f8", offset=12) for name in ("merl", "cells"))
    ok &= check("merl: cells through a table and out again, largest relative difference (of f32)",
                np.abs(twice - once).max() / once.max(), 6e-8)
    source = np.load(folder / "aniso4.npz")["brdf"]
    gonio("export", folder / "aniso4.exr", "--to", "npz", "-o", folder / "again.npz")
    back = np.load(folder / "again.npz")["brdf"]
    ok &= check("npz: values that differ", float((source.view("u4") != back.view("u4")).sum()), 0)
    gonio("export", folder / "aniso4.exr", "--to", "exr_parts", "-o", folder / "parts.exr")
    parts = OpenEXR.File(str(folder / "parts.exr"), separate_channels=True).parts
    off = max(np.abs(p.channels["Y"].pixels - source.reshape(-1, *source.shape[2:])[int(np.ravel(p.header["gonio.stop"])[0])]).max()
              for p in parts)
    ok &= check(f"exr_parts: largest difference over {len(parts)} parts", off, 0)
    return ok


def albedos(folder):
    """NumPy and OpenEXR see the values of an albedo table that the program prints."""
    import OpenEXR

    files = [word for end in ("npz", "exr") for word in ("-o", folder / f"albedo.{end}")]
    answer = gonio("albedo", "--grid", "--mu", "8", "--alpha", "0.1,0.5", *files)
    arrays = np.load(folder / "albedo.npz")
    parts = OpenEXR.File(str(folder / "albedo.exr"), separate_channels=True).parts
    off = in_image = 0.0
    for quantity, part in zip(answer["quantities"], parts):
        wanted = np.array([cell["value"] for cell in quantity["cells"]]).reshape(2, 8)
        off = max(off, np.abs(arrays[quantity["name"]] - wanted).max())
        in_image = max(in_image, np.abs(part.channels["Y"].pixels - wanted.astype("f4")).max())
    ok = check("albedo npz: largest difference", off, 0)
    return ok & check("albedo exr: largest difference", in_image, 0)


def sweep(folder):
    """SciPy's reader of NetCDF sees what the CSV of the same tables says."""
    from scipy.io import netcdf_file

    exr = [table(folder, f"sweep_{alpha}", alpha, alpha, [0.0, 40.0], None, 18, 36) for alpha in (0.3, 0.5)]
    for end in ("csv", "nc"):
        subprocess.run([GONIO, "report", *exr, "--fit", "-o", folder / f"sweep.{end}"], check=True, capture_output=True)
    with open(folder / "sweep.csv", newline="") as file:
        head, *rows = csv.reader(file)
    off = 0.0
    with netcdf_file(folder / "sweep.nc", mmap=False, maskandscale=True) as file:
        for name, cells in zip(head, zip(*rows)):
            values = file.variables["".join(c if c.isalnum() else "_" for c in name)][:]
            if values.dtype.kind == "S":
                off += sum(b"".join(row).rstrip(b"\0").decode() != cell for row, cell in zip(values, cells))
            else:
                wanted = np.array([float(cell) if cell else np.nan for cell in cells])
                off += (np.ma.filled(values.astype("f8"), np.nan) != wanted)[~np.isnan(wanted)].sum()
                off += (np.ma.getmaskarray(values) != np.isnan(wanted)).sum()
        variables = len(file.variables)
    return check(f"netcdf: values of {variables} variables that differ from the CSV", off + abs(variables - len(head)), 0)


def mesh(folder):
    """trimesh sees the heights of a patch, every facet turned upwards."""
    import trimesh

    (folder / "mesh.toml").write_text(CAMPAIGN)
    gonio("surface", folder / "mesh.toml", "-o", folder / "mesh", "--npy", "--glb")
    heights = np.load(folder / "mesh" / "patch_000.npy")
    found = trimesh.load(folder / "mesh" / "patch_000.glb", force="mesh", process=False)
    # The first row and column stand again at the end; y of the file is up, z of the file runs against the rows.
    wanted = np.pad(heights, ((0, 1), (0, 1)), mode="wrap")
    x, y, z = found.vertices.T.reshape(3, *wanted.shape)
    ok = check("glb: vertices whose height differs", float((y != wanted).sum()), 0)
    pitch = 1 / 0.5
    places = np.abs(x - pitch * np.arange(65)[None, :]).max() + np.abs(z + pitch * np.arange(65)[:, None]).max()
    ok &= check("glb: distance of the vertices from the grid, cells", places / pitch, 1e-6)
    upright = found.triangles_cross[:, 1] / pitch**2
    # A cross product is twice a facet's area; its upright part is that of the facet's shadow, here of half a cell. f32.
    return ok & check(f"glb: shadow of the {len(upright)} facets off a cell's half", np.abs(upright - 1).max(), 1e-5)


CAMPAIGN = """name = "mesh"
[surface]
realisations = 1
cells = 64
[surface.ggx]
alpha = 0.5
[light]
theta_i_deg = [0]
[sensor.hemisphere]
[stop]
samples = 1
"""


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        parts = (rgl, energy.between, measured.pairs_and_sphere, radiance.matrices, radiance.trees, radiance.normal,
                 radiance.colours, radiance.tools, through.blocks, wincalc.matrices, plain, albedos, sweep, mesh, scans.compared)
        ok = [part(folder) for part in parts]
    sys.exit(0 if all(ok) else 1)


main()
