"""A table that the program has measured, read and rendered by Mitsuba."""

import numpy as np

from tables import check, direction, gonio

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
    return ok & sphere(mi, folder, summary)


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


def summary_of(answer):
    """The summary of the first table in the answer of `measure`."""
    return answer if "stops" in answer else answer["tables"][0]
