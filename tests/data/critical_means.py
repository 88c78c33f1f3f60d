"""Means of D G2 F/(4 cos cos) over bins where total reflection begins: tests/it/facets/critical_means.rs.

GGX, height-correlated masking, light from the denser side. Nested Gauss-Kronrod of QUADPACK (scipy), the azimuth cut where
facets reach the critical angle. Needs scipy.

    python3 tests/data/critical_means.py > tests/data/critical_means.csv
"""
from math import acos, cos, degrees, pi, radians, sin, sqrt

from scipy.integrate import quad


def direction(theta, phi):
    return sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)


def lam(w, ax, ay):
    t2 = ((ax * w[0]) ** 2 + (ay * w[1]) ** 2) / w[2] ** 2
    return 0.5 * (sqrt(1 + t2) - 1)


def flux(i, o, ax, ay, eta):
    """D G2 F/(4 cos_i): flux per solid angle."""
    h = [a + b for a, b in zip(i, o)]
    length = sqrt(sum(x * x for x in h))
    h = [x / length for x in h]
    d = 1 / (pi * ax * ay * ((h[0] / ax) ** 2 + (h[1] / ay) ** 2 + h[2] ** 2) ** 2)
    c = sum(a * b for a, b in zip(i, h))
    g2 = eta * eta - 1 + c * c
    if g2 <= 0:
        f = 1.0
    else:
        g = sqrt(g2)
        f = 0.5 * (((c - g) / (c + g)) ** 2 + ((eta * eta * c - g) / (eta * eta * c + g)) ** 2)
    return d * f / (4 * i[2] * (1 + lam(i, ax, ay) + lam(o, ax, ay)))


def mean(ax, ay, eta, theta_i, phi_i, bin_deg):
    t1, t2, p1, p2 = map(radians, bin_deg)
    i = direction(theta_i, phi_i)
    k = 1 - 2 * eta * eta

    def row(theta):
        cuts = []
        r = sin(theta) * sin(theta_i)
        q = (k - cos(theta) * cos(theta_i)) / r if r else 2
        if abs(q) < 1:
            for turn in range(-2, 3):
                cuts += [phi_i + s * acos(q) + 2 * pi * turn for s in (1, -1)]
        marks = [p1] + sorted(c for c in cuts if p1 < c < p2) + [p2]
        both = zip(marks, marks[1:])
        parts = [quad(lambda p: flux(i, direction(theta, p), ax, ay, eta), a, b, epsabs=0, epsrel=1e-11)[0] for a, b in both]
        return sum(parts) * sin(theta)

    # Where the circle of critical facets enters or leaves the bin.
    marks = {t1, t2}
    for phi in (p1, p2, phi_i, phi_i + pi):
        along = sin(theta_i) * cos(phi - phi_i)
        ratio = k / sqrt(cos(theta_i) ** 2 + along**2)
        if abs(ratio) < 1:
            from math import atan2
            for s in (1, -1):
                t = atan2(along, cos(theta_i)) + s * acos(ratio)
                if t1 < t < t2:
                    marks.add(t)
    marks = sorted(marks)
    total = sum(quad(row, a, b, epsabs=0, epsrel=1e-10, limit=200)[0] for a, b in zip(marks, marks[1:]))
    return total / (0.5 * (p2 - p1) * (sin(t2) ** 2 - sin(t1) ** 2))


print("alpha_x,alpha_y,eta,theta_i,phi_i,theta_lo,theta_hi,phi_lo,phi_hi,mean")
for ax, ay in ((0.5, 0.5), (0.1, 0.1), (0.2, 0.5)):
    for eta in (1 / 1.5, 1 / 2.4, 1 / 1.05):
        for theta_i in (5.0, 30.0, 60.0, 80.0):
            ring = degrees(acos(1 - 2 * eta * eta))  # From the light, where facets become critical.
            for phi in (180.0, 120.0, 20.0):
                # The nearest direction in that azimuth on the ring, where there is one; a bin of 5 x 10 degrees about it.
                a, b = cos(radians(theta_i)), sin(radians(theta_i)) * cos(radians(phi))
                ratio = (1 - 2 * eta * eta) / sqrt(a * a + b * b)
                if abs(ratio) >= 1:
                    continue
                from math import atan2
                theta = degrees(atan2(b, a) + acos(ratio))
                if not 2.6 < theta < 87:
                    continue
                lo = round(theta - 2.3, 1)
                bin_deg = (lo, lo + 5.0, phi - 4.0, phi + 6.0)
                value = mean(ax, ay, eta, radians(theta_i), radians(0.0), bin_deg)
                row = (ax, ay, repr(eta), theta_i, 0.0, *bin_deg, f"{value:.13e}")
                print(",".join(map(str, row)))
