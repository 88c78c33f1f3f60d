"""pyradiance's own readers of Klems matrices, tensor trees and gonio text, and Radiance's programs on them."""

import os
import pathlib
import re
import subprocess

import numpy as np
import pyradiance
from pyradiance import bsdf

import readers
from tables import COARSE, check, direction, ggx, gonio, pairs, table

# IEC 61966-2-1, rows X, Y, Z.
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
TINT = [0.9, 0.5, 0.2]


# pyradiance looks through every file that it has loaded, also through those that Python has freed: none is freed.
LOADED = []


def loaded(path):
    """The functions in a file of Radiance."""
    LOADED.append(bsdf.load_file(str(path)))
    return LOADED[-1]


def query(s, wi, wo):
    """X, Y, Z of a pair of directions."""
    angles = [np.degrees(a) for w in (wi, wo) for a in (np.arctan2(np.hypot(w[0], w[1]), w[2]), np.arctan2(w[1], w[0]))]
    return np.array(bsdf.query(s, *angles))


def run(*words, to=None):
    """One of the wheel's programs."""
    home = pathlib.Path(pyradiance.__file__).parent
    paths = {"PATH": f"{home / 'bin'}:{os.environ['PATH']}", "RAYPATH": f".:{home / 'lib'}"}
    done = subprocess.run([str(word) for word in words], capture_output=True, env={**os.environ, **paths}, check=True)
    if to is not None:
        to.write_bytes(done.stdout)
    return done.stdout.decode(errors="replace")


def matrices(folder):
    """The Klems matrix, patch by patch, against what the program's own reader finds.

    The query multiplies what it has split off as not diffuse by a factor that depends on the pair of patches alone: the
    same for any matrix, up to 3e-4 off 1. It is measured with a matrix of one value (and a single 0, so that nothing is
    diffuse), and taken out.
    """
    table(folder, "aniso4", 0.4, 0.7, list(np.arange(0, 90, 10.0)), list(np.arange(0, 360, 15.0)), 45, 72)
    gonio("export", folder / "aniso4.exr", "--to", "klems", "-o", folder / "aniso4.klems.xml", *COARSE)
    gonio("import", folder / "aniso4.klems.xml", "--from", "klems", "-o", folder / "klems.exr")
    gonio("export", folder / "klems.exr", "--to", "npz", "-o", folder / "klems.npz")
    matrix = np.load(folder / "klems.npz")
    grid, values = readers.grid(matrix), matrix["brdf"].astype(float)
    text = (folder / "aniso4.klems.xml").read_text()
    cells = ("0," + "0.2," * (145 * 145 - 1)).join(["<ScatteringData>", "</ScatteringData>"])
    (folder / "control.xml").write_text(re.sub(r"<ScatteringData>[^<]*</ScatteringData>", cells, text))
    found, control = (loaded(folder / name) for name in ("aniso4.klems.xml", "control.xml"))
    raw = distance = total = worst = 0.0
    rng = np.random.default_rng(3)
    for stop, bin in zip(rng.integers(145, size=1000), rng.integers(1, 145, size=1000)):
        theta_i, phi_i = grid["stops_deg"][stop]
        t0, t1, p0, p1 = grid["patches_deg"][bin]
        wi = direction(np.radians(theta_i), np.radians(phi_i))
        wo = direction(np.radians((t0 + t1) / 2), np.radians((p0 + p1) / 2))
        value, factor = values[stop, bin], query(control, wi, wo)[1] / 0.2
        f = query(found, wi, wo)[1]
        raw += abs(f - value)
        off = abs(values.min() + (f - values.min()) / factor - value)
        worst, distance, total = max(worst, off / value), distance + off, total + value
    ok = check("klems: pyradiance against the matrix, L1 of 1000 pairs of patches", distance / total, 1e-4)
    ok &= check("  (worst pair, relative)", worst, 1e-4)
    return ok & check("  (L1 with the factors of its query left in)", raw / total, 2e-4)


def trees(folder):
    """Tensor trees of both ranks against the formula."""
    ok = True
    # Cells are divided until their steps are 1 % of the sum, half as much again for the pairs that are drawn; in four
    # dimensions the number of values ends it before.
    for name, ax, ay, limit in [("iso", 0.3, 0.3, 0.015), ("aniso4", 0.4, 0.7, 0.03)]:
        gonio("export", folder / f"{name}.exr", "--to", "tensor_tree", "-o", folder / f"{name}.tree.xml", *COARSE)
        s = loaded(folder / f"{name}.tree.xml")
        f, g = np.array([(query(s, wi, wo)[1], ggx(wi, wo, ax, ay)) for wi, wo in zip(*pairs(4000, 75, 2))]).T
        size = (folder / f"{name}.tree.xml").stat().st_size / 1e6
        ok &= check(f"tensor_tree {name} ({size:.1f} MB): pyradiance against the formula, L1", np.abs(f - g).sum() / g.sum(), limit)
    return ok


def normal(folder):
    """Light from the normal: the matrix's value of its first patch, and the tree against the formula.

    The normal is the end of a cell of sin theta_i, not its middle: up to twice the error of a random direction, which
    `trees` holds to 0.015.
    """
    gonio("export", folder / "iso.exr", "--to", "klems", "-o", folder / "normal.klems.xml", *COARSE)
    gonio("import", folder / "normal.klems.xml", "--from", "klems", "-o", folder / "normal.exr")
    gonio("export", folder / "normal.exr", "--to", "npz", "-o", folder / "normal.npz")
    matrix = np.load(folder / "normal.npz")
    grid, values = readers.grid(matrix), matrix["brdf"].astype(float)
    s, up = loaded(folder / "normal.klems.xml"), np.array([0.0, 0.0, 1.0])
    off = 0.0
    for bin, (t0, t1, p0, p1) in enumerate(grid["patches_deg"]):
        wo = direction(np.radians((t0 + t1) / 2), np.radians((p0 + p1) / 2))
        off = max(off, abs(query(s, up, wo)[1] / values[0, bin] - 1))
    # The factors of the query, as in `matrices`.
    ok = check("klems: light from the normal, worst of 145 patches, relative", off, 5e-4)
    s = loaded(folder / "iso.tree.xml")
    _, outs = pairs(1000, 75, 6)
    f, g = np.array([(query(s, up, wo)[1], ggx(up, wo, 0.3, 0.3)) for wo in outs]).T
    ok &= check("tensor_tree: light from the normal against the formula, L1", np.abs(f - g).sum() / g.sum(), 2 * 0.015)
    # And back through the program's own reader.
    gonio("import", folder / "iso.tree.xml", "--from", "tensor_tree", "--like", folder / "iso.exr", "-o", folder / "tree.exr")
    gonio("export", folder / "tree.exr", "--to", "npz", "-o", folder / "tree.npz")
    own, back = (np.load(folder / f"{name}.npz")["brdf"][0, 0].astype(float) for name in ("iso", "tree"))
    edges = np.sin(np.radians(np.linspace(0, 90, own.shape[0] + 1))) ** 2
    size = np.pi * np.diff(edges)[:, None] / own.shape[1]
    return ok & check("tensor_tree: albedo at the normal, read by the program, relative",
                      abs((size * back).sum() / (size * own).sum() - 1), 0.01)


def colours(folder):
    """X, Y and Z of a tinted table: by the query for a matrix, by checkBSDF's diffuse share for a tree.

    The query is no judge of coloured trees: of a tree whose u' and v' are those of X = Y = Z everywhere it gives X/Y from
    1.5 to 1.8.
    """
    table(folder, "tint", 0.5, 0.5, list(np.arange(0, 90, 10.0)), None, 45, 72, tint=TINT)
    for kind in ("klems", "tensor_tree"):
        gonio("export", folder / "tint.exr", "--to", kind, "-o", folder / f"tint.{kind}.xml", *COARSE)
    wanted = XYZ @ TINT
    s = loaded(folder / "tint.klems.xml")
    found = np.array([query(s, wi, wo) for wi, wo in zip(*pairs(500, 75, 5))]).sum(axis=0)
    off = np.abs(found / found[1] * wanted[1] / wanted - 1).max()
    ok = check("klems: colour of the mean of 500 pairs, X/Y and Z/Y relative", off, 0.03)
    text = re.findall(r"Interior Refl.*", run("checkBSDF", folder / "tint.tensor_tree.xml"))[0]
    found = np.array([float(number) for number in re.findall(r"[0-9.]+", text)[:3]])
    off = np.abs(found / found[1] * wanted[1] / wanted - 1).max()
    # Percent with one digit after the point, of which Z has some seven.
    return ok & check("tensor_tree: colour of the diffuse share, X/Y and Z/Y relative", off, 0.015)


def tools(folder):
    """checkBSDF on reciprocity and flux, and gonio text through pabopto2bsdf and bsdf2ttree."""
    ok = True
    gonio("export", folder / "iso.exr", "--to", "klems", "-o", folder / "iso.klems.xml", *COARSE)
    for name in ("iso.klems", "iso.tree"):
        text = run("checkBSDF", folder / f"{name}.xml")
        flux, errors = re.findall(r"Interior Refl.*", text)
        # alpha 0.3, F = 1, separable masking: 0.95 at normal incidence, the largest.
        largest = float(re.findall(r"([0-9.]+)%", flux)[0]) / 100
        ok &= check(f"checkBSDF {name}: largest albedo, |0.93 - x|", abs(0.93 - largest), 0.07)
        mean = float(errors.split()[-2]) / 100
        ok &= check(f"checkBSDF {name}: mean error of reciprocity", mean, 0.05)
    # Some lobes of some hundred points: its fit is a sum of Gaussians of its own choice.
    table(folder, "text", 0.4, 0.4, [0.0, 15.0, 30.0, 45.0, 60.0, 75.0], None, 30, 48)
    gonio("export", folder / "text.exr", "--to", "pabopto", "-o", folder / "text")
    run("pabopto2bsdf", "-n", "2", *sorted((folder / "text").glob("*.txt")), to=folder / "text.sir")
    run("bsdf2ttree", "-g", "4", folder / "text.sir", to=folder / "text.xml")
    s = loaded(folder / "text.xml")
    f, g = np.array([(query(s, wi, wo)[1], ggx(wi, wo, 0.4, 0.4)) for wi, wo in zip(*pairs(2000, 75, 2))]).T
    return ok & check("pabopto2bsdf: its fit against the formula, L1", np.abs(f - g).sum() / g.sum(), 0.2)
