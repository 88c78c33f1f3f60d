"""Light that goes through, in files of Radiance: pyradiance's queries and integrals of all four blocks."""

import re

import numpy as np
from pyradiance import bsdf

from radiance import loaded, query, run
from tables import check, direction, gonio

# How much light comes back and goes through, from the front and from the back; half as much as from the front.
SHARES = {1: 1.0, -1: 0.5}


def pane(wi, wo, scale):
    """Smooth, its own mirror image about no plane: a turned azimuth or an exchanged side shows. z points to the light."""
    up = 0.05 * (1 + 0.3 * wo[..., 0] + 0.2 * wo[..., 1] + 0.2 * wi[0] * wo[..., 1])
    down = 0.2 * (1 + 0.2 * wo[..., 0] - 0.3 * wo[..., 1] - 0.3 * wi[1] * wo[..., 0])
    return scale * np.where(wo[..., 2] < 0, down, up)


def table(folder, name, scale):
    """Bin means over both hemispheres, as the program's EXR."""
    x, w = np.polynomial.legendre.leggauss(4)
    x, w = 0.5 * x + 0.5, 0.5 * w
    theta_i, phi_i = np.arange(0, 90, 10.0), np.arange(0, 360, 30.0)
    theta_edges, phi_edges = np.linspace(0, 180, 37), np.linspace(0, 360, 25)
    s = np.sin(np.radians(theta_edges)) ** 2
    theta = np.arcsin(np.sqrt(s[:-1, None] + x * np.diff(s)[:, None]))
    theta[18:] = np.pi - theta[18:]
    wo = direction(theta[:, None, :, None], np.radians(phi_edges[:-1, None] + 15 * x)[None, :, None, :])
    brdf = np.empty((9, 12, 36, 24), np.float32)
    for i, t in enumerate(np.radians(theta_i)):
        for j, p in enumerate(np.radians(phi_i)):
            brdf[i, j] = np.einsum("rcst,s,t->rc", pane(direction(t, p), wo, scale), w, w)
    np.savez(folder / f"{name}.npz", brdf=brdf, theta_i_deg=theta_i, phi_i_deg=phi_i, theta_r_edges_deg=theta_edges,
             phi_r_edges_deg=phi_edges, phi_r_relative=np.array([0], np.uint8))
    gonio("import", folder / f"{name}.npz", "--from", "npz", "-o", folder / f"{name}.exr")
    return folder / f"{name}.exr"


def blocks(folder):
    """Four blocks of a matrix and of a tree against the formula."""
    front, back = table(folder, "front", SHARES[1]), table(folder, "back", SHARES[-1])
    ok = True
    for kind in ("klems", "tensor_tree"):
        path = folder / f"through.{kind}.xml"
        gonio("export", front, "--back", back, "--to", kind, "-o", path)
        s, rng = loaded(path), np.random.default_rng(8)
        for light, scale in SHARES.items():
            # Radiance's frame is the sample's: its z is that of the light only on the front.
            flip = np.array([1, 1, light])
            off, total = np.zeros(2), np.zeros(2)
            for _ in range(1500):
                sines = np.sqrt(rng.random(2)) * np.sin(np.radians(75))
                theta, phi = np.arcsin(sines), rng.random(2) * 2 * np.pi
                wi = direction(theta[0], phi[0])
                for half, side in enumerate((1, -1)):
                    wo = direction(theta[1], phi[1]) * [1, 1, side]
                    wanted = pane(wi, wo, scale)
                    off[half] += abs(query(s, wi * flip, wo * flip)[1] - wanted)
                    total[half] += wanted
            # Constant over patches of 10 to 15 degrees, in cells of the same: a quarter of that times the slopes, 0.5, of
            # light and sensor. A turned azimuth is 0.2 or more off.
            for what, l1 in zip(("comes back", "goes through"), off / total):
                ok &= check(f"{kind}: light from z {light:+d} that {what}: pyradiance against the formula, L1", l1, 0.06)
            # Odd terms integrate to nothing: 0.05 pi and 0.2 pi, in closed form.
            worst = 0.0
            for theta, phi in ((20.0, 40.0), (55.0, 200.0)):
                polar = theta if light > 0 else 180 - theta
                for wanted, other in ((0.05, bsdf.SAMPLE_T), (0.2, bsdf.SAMPLE_R)):
                    found = bsdf.direct_hemi(s, polar, phi, bsdf.SAMPLE_ALL & ~other)
                    worst = max(worst, abs(found / (wanted * np.pi * scale) - 1))
            # The table's interpolant between incidences, and what its file may be off.
            ok &= check(f"  (its direct-hemispherical reflectance and transmittance, relative)", worst, 0.01)
        # Interior is +z. Percent with a digit after the point, of integrals within 0.2 % of 5 pi to 20 pi.
        found = [float(percent) for percent in re.findall(r"([0-9.]+)%\s+[0-9.]+ deg", run("checkBSDF", path))]
        wanted = np.pi * np.array([5, 2.5, 20, 10])
        off = np.abs(np.array(found) - wanted).max() if len(found) == 4 else np.inf
        ok &= check(f"{kind}: checkBSDF's largest sums: interior, exterior, through to out and to in, in per cent", off, 0.2)
    return ok
