"""Layered facets in twelve digits and more (mpmath): the reflectance of an interface under diffuse light by Duntley's closed form
(held against an integral), and the integral of D(m) <i.m><o.m> T(i.m) T(o.m)/(1 - F_de) over the facets' normals as one over
slopes, cut where an arm meets a facet's plane. T by Fresnel's equations as they stand in text books.

    python3 layered_values.py layered_values.csv

Columns: what (outside, inside, ggx, beckmann), eta, alpha_x, alpha_y, angles (0 where there are none), value.
"""
import csv, sys
import mpmath
from mpmath import mp, mpf, sin, cos, sqrt, pi, exp, atan2, log, quad, radians

mp.dps = 20


def outside(n):
    """F_de; Duntley 1942, as in Egan and Hilgeman 1979."""
    with mp.workdps(60):
        n = mpf(n)
        return (mpf(1)/2 + (n - 1)*(3*n + 1)/(6*(n + 1)**2) + n**2*(n**2 - 1)**2/(n**2 + 1)**3*log((n - 1)/(n + 1))
                - 2*n**3*(n**2 + 2*n - 1)/((n**2 + 1)*(n**4 - 1)) + 8*n**4*(n**4 + 1)/((n**2 + 1)*(n**4 - 1)**2)*log(n))


def transmittance(c, n):
    ct = sqrt(1 - (1 - c*c)/(n*n))
    rs, rp = (c - n*ct)/(c + n*ct), (n*c - ct)/(n*c + ct)
    return 1 - (rs*rs + rp*rp)/2


def overlap(ndf, n, ax, ay, ti, pi_, to, po):
    wi = (sin(ti)*cos(pi_), sin(ti)*sin(pi_), cos(ti))
    wo = (sin(to)*cos(po), sin(to)*sin(po), cos(to))
    p22 = (lambda r: 1/(pi*(1 + r*r)**2)) if ndf == "ggx" else (lambda r: exp(-r*r)/pi)
    lean = lambda w: (ax*w[0], ay*w[1])
    ki, ko = lean(wi), lean(wo)
    gain = 1/(1 - outside(n))

    def radial(f):
        c, s = cos(f), sin(f)
        a, b = ki[0]*c + ki[1]*s, ko[0]*c + ko[1]*s
        e = (ax*c)**2 + (ay*s)**2
        ends = [w[2]/-k for w, k in ((wi, a), (wo, b)) if k < 0]
        end = min(ends) if ends else mpmath.inf

        def g(r):
            length = sqrt(1 + e*r*r)
            ci, co = max(wi[2] + r*a, mpf(0)), max(wo[2] + r*b, mpf(0))
            return p22(r)*r*ci*co/length*transmittance(ci/length, n)*transmittance(co/length, n)*gain
        breaks = [mpf(0), mpf(1), mpf(6), mpf(60), 1/max(ax, ay)*20]
        breaks = sorted(x for x in breaks if x < end) + [end]
        return quad(g, breaks, maxdegree=5)

    marks = set()
    for x, y in (ki, ko, (wi[2]*ko[0] - wo[2]*ki[0], wi[2]*ko[1] - wo[2]*ki[1])):
        for turn in (pi/2, -pi/2):
            marks.add((atan2(y, x) + turn) % (2*pi))
    marks = sorted(marks)
    marks = [m for k, m in enumerate(marks) if k == 0 or m - marks[k-1] > mpf("1e-12")]
    marks.append(marks[0] + 2*pi)
    return quad(radial, marks, maxdegree=5)


def rows():
    for n in ("1.0001", "1.001", "1.01", "1.1", "1.3", "1.33", "1.5", "1.7", "2", "2.4", "3", "4"):
        value = outside(n)
        assert abs(quad(lambda c: 2*c*(1 - transmittance(c, mpf(n))), [0, mpf("0.01"), mpf("0.1"), 1]) - value) < mpf("1e-15")
        yield ["outside", n, 0, 0, 0, 0, 0, 0, mpmath.nstr(value, 17)]
        with mp.workdps(60):
            inside = 1 - (1 - value)/mpf(n)**2
        yield ["inside", n, 0, 0, 0, 0, 0, 0, mpmath.nstr(inside, 17)]
    angles = [(30, 0, 40, 180), (60, 20, 70, 80), (85, 0, 80, 10), (0, 0, 60, 0), (89, 10, 20, 200)]
    surfaces = [("ggx", 0.05, 0.05, "1.5"), ("ggx", 0.2, 0.5, "1.5"), ("ggx", 1.0, 1.0, "1.5"), ("ggx", 0.3, 0.3, "1.01"),
                ("ggx", 0.3, 0.3, "4"), ("beckmann", 0.4, 0.4, "1.5"), ("beckmann", 0.2, 1.0, "2.4")]
    for ndf, ax, ay, n in surfaces:
        for ti, p, to, q in angles:
            value = overlap(ndf, mpf(n), mpf(ax), mpf(ay), *[radians(mpf(x)) for x in (ti, p, to, q)])
            print(ndf, n, ax, ay, ti, p, to, q, mpmath.nstr(value, 12), flush=True)
            yield [ndf, n, ax, ay, ti, p, to, q, mpmath.nstr(value, 14)]


with open(sys.argv[1], "w", newline="") as file:
    out = csv.writer(file, lineterminator="\n")
    out.writerow("what,eta,alpha_x,alpha_y,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value".split(","))
    for row in rows():
        out.writerow(row)
        file.flush()
