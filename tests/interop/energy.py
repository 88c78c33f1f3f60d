"""Light that Mitsuba's `measured` sends back, between the measured incidences and beyond them."""

import numpy as np

from tables import check, direction, gonio, table

# Incidences of `[preset] name = "rgl"`, and an even grid.
PRESET = [80 * (k / 7) ** 2 for k in range(8)]
EVEN = list(np.arange(0, 90, 15.0))
THETA = [5, 20, 35, 50, 60, 70, 75, 80, 85]
# The lattice's own error is below a tenth of the limits of 1 % (`roughconductor` by 750, 1500 and 3000 directions).
COUNT = 1500


def lattice(wi, ax, ay):
    """Directions after a GGX lobe's half vectors and after cosines, and their weights (balance heuristic)."""
    u = (np.arange(COUNT) + 0.5) / COUNT
    turn = 2 * np.pi * ((np.arange(COUNT) * 0.6180339887498949) % 1)
    slope = np.sqrt(u / (1 - u))
    h = np.stack([ax * slope * np.cos(turn), ay * slope * np.sin(turn), np.ones(COUNT)], axis=-1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    wo = np.concatenate([2 * (h @ wi)[:, None] * h - wi, direction(np.arcsin(np.sqrt(u)), turn)])
    wo = wo[wo[:, 2] > 0]
    h = wi + wo
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    q = (h[:, 0] / ax) ** 2 + (h[:, 1] / ay) ** 2 + h[:, 2] ** 2
    density = h[:, 2] / (np.pi * ax * ay * q * q) / (4 * (h @ wi)) + wo[:, 2] / np.pi
    return wo, 1 / (COUNT * density)


def albedo(mi, bsdf, wi, directions):
    """The integral of what `eval` returns, which has the cosine."""
    context, si = mi.BSDFContext(), mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*map(float, wi))
    return sum(w * bsdf.eval(context, si, mi.Vector3f(*map(float, wo)))[0] for wo, w in zip(*directions))


def between(folder):
    """`measured` against `roughconductor` (no material, separable Smith) at 5 to 85 degrees."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    ok = True
    cases = [
        ("preset, alpha 0.1", 0.1, 0.1, PRESET, None, 90, 180),
        ("preset, alpha 0.3", 0.3, 0.3, PRESET, None, 45, 120),
        ("15 degrees, alpha 0.1", 0.1, 0.1, EVEN, None, 90, 180),
        ("preset, brushed 0.1 x 0.3", 0.1, 0.3, PRESET, list(np.arange(0, 360, 22.5)), 60, 120),
    ]
    for k, (name, ax, ay, theta_i, phi_i, rows, columns) in enumerate(cases):
        exr = table(folder, f"energy{k}", ax, ay, theta_i, phi_i, rows, columns)
        gonio("export", exr, "--to", "rgl", "-o", folder / f"energy{k}.bsdf")
        found = mi.load_dict({"type": "measured", "filename": str(folder / f"energy{k}.bsdf")})
        wanted = mi.load_dict({"type": "roughconductor", "material": "none", "distribution": "ggx",
                               "alpha_u": ax, "alpha_v": ay, "sample_visible": True})
        worst = (0.0, 0, 0)
        for theta in THETA:
            for phi in [0] if phi_i is None else [11.25, 78.75]:
                wi = direction(np.radians(theta), np.radians(phi))
                directions = lattice(wi, ax, ay)
                off = albedo(mi, found, wi, directions) / albedo(mi, wanted, wi, directions) - 1
                worst = max(worst, (abs(off), theta, phi))
        ok &= check(f"rgl {name}: albedo in Mitsuba, 5 to 85 degrees (worst at {worst[1]} {worst[2]}), relative", worst[0], 0.01)
    return ok
