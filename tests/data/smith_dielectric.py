"""Rough glass at all orders by an own random walk: the oracle of tests/it/facets/smith_walk.rs.

Heitz, Hanika, d'Eon, Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the Smith model", the walk of its section
on dielectrics, with Gaussian heights and normals by spherical caps (Dupuy, Benyoub 2023). Below the surface direction and
height change sign, as in the paper. Light is incident flux 1 from theta_i, phi_i = 25 degrees.

    python3 tests/data/smith_dielectric.py > tests/data/smith_dielectric.csv

A row is a case and a class of exits: r or t, the order (3: three and more), theta from the pole of its side below or above
30 degrees; the share of paths and its standard error. Needs numpy and scipy.
"""
import sys
import numpy as np
from scipy.special import ndtr, ndtri

PATHS = 1 << 22
CHUNK = 1 << 20
BOUNCES = 64


def lam(w, ax, ay):
    """Lambda of GGX for any direction."""
    a2 = w[2] ** 2 / np.maximum((ax * w[0]) ** 2 + (ay * w[1]) ** 2, 1e-300)
    root = np.sqrt(1 + 1 / a2)
    return np.where(w[2] > 0, 0.5 * (root - 1), -0.5 * (root + 1))


def visible_normal(wi, ax, ay, rng):
    """Normals in proportion to their area turned to wi, by spherical caps; wi may point down."""
    n = wi.shape[1]
    s = np.stack([ax * wi[0], ay * wi[1], wi[2]])
    s /= np.linalg.norm(s, axis=0)
    phi = 2 * np.pi * rng.random(n)
    z = 1 - rng.random(n) * (1 + s[2])
    r = np.sqrt(np.clip(1 - z * z, 0, 1))
    m = np.stack([r * np.cos(phi), r * np.sin(phi), z]) + s
    m = np.stack([ax * m[0], ay * m[1], m[2]])
    return m / np.linalg.norm(m, axis=0)


def fresnel(c, eta):
    """Reflectance and the cosine inside; eta is the index beyond over the index here."""
    g2 = 1 - (1 - c * c) / eta**2
    g = np.sqrt(np.clip(g2, 0, None))
    rs = (c - eta * g) / (c + eta * g)
    rp = (eta * c - g) / (eta * c + g)
    return np.where(g2 <= 0, 1.0, 0.5 * (rs**2 + rp**2)), g


def next_height(w, h, rng):
    """The height of the next collision of rays along w from h; infinite where they leave."""
    u = 1 - rng.random(h.size)
    level = lam(w, *next_height.alpha)
    c = ndtr(h)
    with np.errstate(all="ignore"):
        up = c / u ** (1 / level)
    leaves = (level > 0) & (up >= 1)
    return np.where(leaves, np.inf, ndtri(np.clip(up, 0, 1)))


def walk(eta, ax, ay, theta_i, count, rng):
    next_height.alpha = (ax, ay)
    t, p = np.radians(theta_i), np.radians(25.0)
    wi = np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
    w = np.repeat(-wi[:, None], count, axis=1)
    h = np.full(count, 9.0)
    outside = np.ones(count, bool)
    order = np.zeros(count, int)
    alive = np.arange(count)
    ended = np.zeros((3, count))
    through = np.zeros(count, bool)
    for _ in range(BOUNCES):
        sign = np.where(outside[alive], 1.0, -1.0)
        new = next_height(sign * w[:, alive], sign * h[alive], rng)
        gone = np.isinf(new) & (new > 0)
        leaving = alive[gone]
        ended[:, leaving] = w[:, leaving]
        through[leaving] = ~outside[leaving]
        h[alive] = sign * new
        alive = alive[~gone]
        if alive.size == 0:
            break
        sign = np.where(outside[alive], 1.0, -1.0)
        back = -sign * w[:, alive]
        m = visible_normal(back, ax, ay, rng)
        c = np.einsum("ij,ij->j", back, m)
        e = np.where(outside[alive], eta, 1 / eta)
        f, g = fresnel(c, e)
        reflect = rng.random(alive.size) < f
        onward = np.where(reflect, 2 * c * m - back, (c / e - g) * m - back / e)
        w[:, alive] = sign * onward
        order[alive] += 1
        outside[alive] = outside[alive] == reflect
    if alive.size:
        order[alive] = -1
    return ended, through, order


def main():
    print("eta,alpha_x,alpha_y,theta_i,side,order,ring,share,se")
    rng = np.random.default_rng(20260101)
    for eta in (1.5, 1 / 1.5):
        for ax, ay in ((0.1, 0.1), (0.5, 0.5), (0.2, 0.5)):
            for theta_i in (0, 30, 60, 80):
                counts = {}
                for _ in range(PATHS // CHUNK):
                    w, through, order = walk(eta, ax, ay, theta_i, CHUNK, rng)
                    assert (order > 0).all()
                    ring = (np.abs(w[2]) < np.cos(np.radians(30))).astype(int)
                    keys = 100 * through + 10 * np.minimum(order, 3) + ring
                    for key, n in zip(*np.unique(keys, return_counts=True)):
                        counts[key] = counts.get(key, 0) + int(n)
                for key in sorted(counts):
                    share = counts[key] / PATHS
                    se = np.sqrt(share * (1 - share) / PATHS)
                    side, rest = "rt"[key // 100], key % 100
                    print(f"{eta:.17g},{ax},{ay},{theta_i},{side},{rest // 10},{rest % 10},{share:.9f},{se:.3e}")
                sys.stdout.flush()


main()
