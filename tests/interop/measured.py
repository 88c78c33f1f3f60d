"""A table that the program has measured, read and rendered by Mitsuba."""

import subprocess

import numpy as np

from tables import GONIO, check, direction, gonio

CAMPAIGN = """
name = "measured"
seed = 5
[surface]
realisations = 16
cells = 256
correlation_cells = 8.0
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = { from = 0, to = 75, step = 15 }
azimuth = "relative"
[sensor.hemisphere]
theta_r_bins = 18
phi_r_bins = 36
bins = "centred"
[stop]
samples = 131_072
"""
# Student's t of 15 degrees of freedom, two-sided 95 %.
T_95 = 2.131


def pairs_and_sphere(folder):
    """Bin means of Mitsuba's `measured` within the 95 % intervals of the table, and a sphere in a uniform light."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    (folder / "measured.toml").write_text(CAMPAIGN)
    summary = gonio("measure", folder / "measured.toml", "-o", folder / "measured")
    exr = folder / "measured" / "measured.exr"
    gonio("export", exr, "--to", "rgl", "-o", folder / "measured.bsdf")
    gonio("export", exr, "--to", "npz", "-o", folder / "measured.npz")
    arrays = np.load(folder / "measured.npz")
    theta, phi = arrays["theta_r_edges_deg"], arrays["phi_r_edges_deg"]
    x, w = np.polynomial.legendre.leggauss(3)
    x, w = 0.5 * x + 0.5, 0.5 * w
    bsdf = mi.load_dict({"type": "measured", "filename": str(folder / "measured.bsdf")})
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()

    def mean(theta_i, row, column):
        si.wi = mi.Vector3f(*direction(np.radians(theta_i), 0.0))
        s0, s1 = np.sin(np.radians(theta[row : row + 2])) ** 2
        sensors = np.radians(phi[column] + x * (phi[column + 1] - phi[column]))
        total = 0.0
        for a, wa in zip(np.arcsin(np.sqrt(s0 + x * (s1 - s0))), w):
            for wo, wb in zip(direction(a, sensors), w):
                total += wa * wb * bsdf.eval(context, si, mi.Vector3f(*wo))[0] / wo[2]
        return total

    rng = np.random.default_rng(9)
    rows = int(np.searchsorted(theta, 75.0, side="right")) - 1
    inside = count = 0
    for stop, row, column in zip(rng.integers(6, size=2000), rng.integers(rows, size=2000), rng.integers(36, size=2000)):
        value, se = (float(arrays[name][stop, 0, row, column]) for name in ("brdf", "stderr"))
        inside += abs(mean(15.0 * stop, row, column) - value) <= T_95 * se
        count += 1
    ok = check(f"rgl measured: share of {count} pairs outside their 95 % interval in Mitsuba", 1 - inside / count, 0.05)
    ok &= sphere(mi, folder, summary)
    return ok & picture(mi, folder, exr)


def sphere(mi, folder, summary):
    """In a uniform light of 1 the middle of a sphere shows the albedo at normal incidence; nothing shines more."""
    scene = mi.load_dict({
        "type": "scene", "integrator": {"type": "direct"}, "emitter": {"type": "constant"},
        "shape": {"type": "sphere", "bsdf": {"type": "measured", "filename": str(folder / "measured.bsdf")}},
        "sensor": {"type": "perspective", "to_world": mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0]),
                   "fov": 26, "film": {"type": "hdrfilm", "width": 48, "height": 48, "rfilter": {"type": "box"}}},
    })
    image = np.array(mi.render(scene, spp=64))[..., 0]
    tables_albedo = summary_of(summary)["stops"][0]["albedo_total"]
    middle = image[20:28, 20:28].mean()
    ok = check("rgl measured: middle of the sphere against the albedo of the summary, relative",
               abs(middle / tables_albedo - 1), 0.02)
    ok &= check("  (pixels of the sphere that are black or not finite)",
                float((~np.isfinite(image)).sum() + (image[12:36, 12:36] <= 0).sum()), 0)
    # Pixels are means of 64 samples; towards the limb the albedo falls.
    return ok & check("  (mean of the sphere's inner half, above the middle)", image[16:32, 16:32].mean() / middle - 1, 0.01)


def picture(mi, folder, exr):
    """Mitsuba's picture of the scene that `gonio render --scene mitsuba` writes is the PNG of `gonio render`."""
    size = 96
    ok = True
    for light, allowed in (("sky", 0.01), ("lamp", 0.01)):
        render = [GONIO, "render", str(exr), "--size", str(size), "--light", light]
        subprocess.run([*render, "-o", str(folder / f"{light}.png"), "--exposure=-3"], check=True, capture_output=True)
        subprocess.run([*render, "-o", str(folder / light), "--scene", "mitsuba"], check=True, capture_output=True)
        scene = mi.load_file(str(folder / light / "scene.xml"))
        image = np.array(mi.render(scene, spp=1024))[..., :3]
        bytes_ = np.array(mi.Bitmap(str(folder / f"{light}.png")).convert(
            mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)) * 8
        y, x = np.mgrid[:size, :size] - 0.5 * (size - 1)
        # Within the sphere and away from its edge, whose pixels are cut otherwise; blocks of 8 x 8 against the noise of 1,024 rays.
        inside = (np.hypot(x, y) < 0.72 * size / 2)[..., None]
        blocks = [(a * inside).reshape(size // 8, 8, size // 8, 8, 3).mean(axis=(1, 3)) for a in (bytes_, image)]
        rms = np.sqrt(((blocks[0] - blocks[1]) ** 2).mean() / (blocks[1] ** 2).mean())
        ok &= check(f"render: Mitsuba's picture under the {light} against the PNG, relative rms", rms, allowed)
    return ok


def summary_of(answer):
    """The summary of the first table in the answer of `measure`."""
    return answer if "stops" in answer else answer["tables"][0]
