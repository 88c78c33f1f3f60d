"""Analytic tables in the program's own NPZ, made by NumPy alone, and the program's commands."""

import json
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Another build may be named: check.py target/release/gonio.
GONIO = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT / "target" / "debug" / "gonio"
# Of files of cells: patches as wide as 15 degrees, and trees of four dimensions whose number of cells is limited, do not
# hold the albedo of grazing light within 1 % (measured: 2.1 % at 80 degrees, alpha 0.3). What is tested is how they are read.
COARSE = ("--allow-albedo-error", "10")


def gonio(*words):
    """Runs the program and returns its JSON answer."""
    done = subprocess.run([GONIO, *map(str, words), "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"gonio {' '.join(map(str, words))}: {done.stderr}")
    return json.loads(done.stdout)


def direction(theta, phi):
    """Unit vectors of angles in radians, the last axis x, y, z."""
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def ggx(wi, wo, ax, ay):
    """D G1 G1 / (4 cos cos) of GGX with separable Smith masking, F = 1 (Walter et al. 2007; Heitz 2014)."""
    h = wi + wo
    h = h / np.linalg.norm(h, axis=-1, keepdims=True)
    q = (h[..., 0] / ax) ** 2 + (h[..., 1] / ay) ** 2 + h[..., 2] ** 2
    d = 1.0 / (np.pi * ax * ay * q * q)

    def sigma(w):
        # cos / G1, finite at grazing light.
        return 0.5 * (w[..., 2] + np.sqrt(w[..., 2] ** 2 + (ax * w[..., 0]) ** 2 + (ay * w[..., 1]) ** 2))

    return d / (4.0 * sigma(wi) * sigma(wo))


def analytic(path, ax, ay, theta_i, phi_i, rows, columns, tint=None):
    """Writes bin means (4 x 4 Gauss points in sin^2 theta, phi) as NPZ; with a tint as R, G, B."""
    x, w = np.polynomial.legendre.leggauss(4)
    x, w = 0.5 * x + 0.5, 0.5 * w
    theta_edges = np.linspace(0, 90, rows + 1)
    phi_edges = np.linspace(0, 360, columns + 1)
    s = np.sin(np.radians(theta_edges)) ** 2
    nodes_s = s[:-1, None] + x * (s[1:] - s[:-1])[:, None]
    step = np.radians(360 / columns)
    nodes_phi = np.radians(phi_edges[:-1, None]) + x * step
    theta = np.arcsin(np.sqrt(nodes_s))[:, None, :, None]
    wo = direction(theta, nodes_phi[None, :, None, :])
    phis = phi_i if phi_i is not None else [0.0]
    brdf = np.empty((len(theta_i), len(phis), rows, columns), np.float32)
    for i, t in enumerate(theta_i):
        for j, p in enumerate(phis):
            wi = direction(np.radians(t), np.radians(p))
            brdf[i, j] = np.einsum("rcst,s,t->rc", ggx(wi, wo, ax, ay), w, w)
    if tint is not None:
        brdf = brdf[..., None] * np.array(tint, np.float32)
    np.savez(path, brdf=brdf, theta_i_deg=np.array(theta_i, float), phi_i_deg=np.array(phis, float),
             theta_r_edges_deg=theta_edges, phi_r_edges_deg=phi_edges,
             phi_r_relative=np.array([phi_i is None], np.uint8))


def table(folder, name, *what, **colours):
    """An analytic table as the program's EXR."""
    analytic(folder / f"{name}.npz", *what, **colours)
    gonio("import", folder / f"{name}.npz", "--from", "npz", "-o", folder / f"{name}.exr")
    return folder / f"{name}.exr"


def pairs(count, last_deg, seed):
    """Random pairs of directions below `last_deg`, even in projected solid angle."""
    rng = np.random.default_rng(seed)
    theta = np.arcsin(np.sqrt(rng.random((2, count)) * np.sin(np.radians(last_deg)) ** 2))
    phi = rng.random((2, count)) * 2 * np.pi
    return direction(theta[0], phi[0]), direction(theta[1], phi[1])


def check(what, found, limit):
    """Prints a figure and remembers whether it is within its limit."""
    ok = found <= limit
    print(f"{'ok  ' if ok else 'MISS'} {what}: {found:.3e} (limit {limit:g})")
    return ok
