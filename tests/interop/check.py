"""What programs that this project did not write see in its exports. Run by .ci/run; prints one line a figure."""

import pathlib
import sys
import tempfile

import numpy as np

import readers
from tables import check, direction, ggx, gonio, pairs, table


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


def rgl_render(folder):
    """Mitsuba renders a sphere with the file: finite, lit, and no brighter than its light."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "direct"}, "emitter": {"type": "constant"},
        "shape": {"type": "sphere", "bsdf": {"type": "measured", "filename": str(folder / "iso.bsdf")}},
        "sensor": {"type": "perspective", "to_world": mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0]),
                   "fov": 20, "film": {"type": "hdrfilm", "width": 32, "height": 32}},
    })
    image = np.array(mi.render(scene, spp=64))
    middle = image[12:20, 12:20].mean()
    # alpha 0.3 reflects 0.88 to 0.95 of a uniform light after one bounce.
    return check("rgl: a sphere in a uniform light, |mean - 0.92|", abs(middle - 0.92), 0.06)


def radiance(folder):
    """pyradiance's own reader of the Klems matrix and the tensor tree."""
    from pyradiance import bsdf

    ok = True
    # Wanted are 3e-2. Rank 4 ends at cells of 1/32 of a side, whose constant values alone differ by 3e-2 here.
    for name, kind, ax, ay, limit in [("iso", "tensor_tree", 0.3, 0.3, 0.03), ("aniso4", "tensor_tree", 0.4, 0.7, 0.035)]:
        if name == "aniso4":
            table(folder, name, ax, ay, list(np.arange(0, 90, 10.0)), list(np.arange(0, 360, 15.0)), 45, 72)
        gonio("export", folder / f"{name}.exr", "--to", kind, "-o", folder / f"{name}.{kind}.xml")
        s = bsdf.load_file(str(folder / f"{name}.{kind}.xml"))
        distance = total = 0.0
        for wi, wo in zip(*pairs(4000, 75, 2)):
            f, g = query(bsdf, s, wi, wo), ggx(wi, wo, ax, ay)
            distance, total = distance + abs(f - g), total + g
        ok &= check(f"{kind} {name}: pyradiance against the formula, L1", distance / total, limit)
    gonio("export", folder / "aniso4.exr", "--to", "klems", "-o", folder / "aniso4.klems.xml")
    gonio("import", folder / "aniso4.klems.xml", "--from", "klems", "-o", folder / "klems.exr")
    gonio("export", folder / "klems.exr", "--to", "npz", "-o", folder / "klems.npz")
    matrix = np.load(folder / "klems.npz")
    grid = readers.grid(matrix)
    s = bsdf.load_file(str(folder / "aniso4.klems.xml"))
    worst = distance = total = 0.0
    rng = np.random.default_rng(3)
    for stop, bin in zip(rng.integers(145, size=1000), rng.integers(145, size=1000)):
        theta_i, phi_i = grid["stops_deg"][stop]
        t0, t1, p0, p1 = grid["patches_deg"][bin]
        wi = direction(np.radians(theta_i), np.radians(phi_i))
        wo = direction(np.radians((t0 + t1) / 2 if p1 - p0 < 360 else 1.0), np.radians((p0 + p1) / 2))
        value = float(matrix["brdf"][stop, bin])
        off = abs(query(bsdf, s, wi, wo) - value)
        worst, distance, total = max(worst, off / value), distance + off, total + value
    # Wanted are 1e-4. This program's own reader has the file's seven digits; Radiance's query rounds each value.
    ok &= check("klems: pyradiance against the matrix, L1 of 1000 patches", distance / total, 2e-4)
    # Single values come back with either sign of error, as rounded: a patch taken for another would be off by much more.
    ok &= check("  (worst patch, relative)", worst, 5e-4)
    return ok


def query(bsdf, s, wi, wo):
    angles = [np.degrees(a) for w in (wi, wo) for a in (np.arctan2(np.hypot(w[0], w[1]), w[2]), np.arctan2(w[1], w[0]))]
    return bsdf.query(s, *angles)[1]


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


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        ok = [part(folder) for part in (rgl, rgl_render, radiance, plain)]
    sys.exit(0 if all(ok) else 1)


main()
