"""Matt facets in ten digits: the integral of D(m) max(0, wi.m) max(0, wo.m) over the facets' normals as one over slopes, and
the two models of Oren and Nayar 1994 (mpmath, double exponential rules, cut where an arm meets a facet's plane).

    python3 diffuse_values.py diffuse_values.csv

Columns: model (ggx, beckmann, or oren_nayar_full, oren_nayar_inter), alpha_x, alpha_y (or sigma, albedo), angles, value.
"""
import csv, sys
import mpmath
from mpmath import mp, mpf, sin, cos, tan, sqrt, pi, exp, atan2, quad, radians

mp.dps = 20


def overlap(ndf, ax, ay, ti, pi_, to, po):
    wi = (sin(ti)*cos(pi_), sin(ti)*sin(pi_), cos(ti))
    wo = (sin(to)*cos(po), sin(to)*sin(po), cos(to))
    p22 = (lambda r: 1/(pi*(1 + r*r)**2)) if ndf == "ggx" else (lambda r: exp(-r*r)/pi)
    lean = lambda w: (ax*w[0], ay*w[1])
    ki, ko = lean(wi), lean(wo)

    def radial(f):
        c, s = cos(f), sin(f)
        a, b = ki[0]*c + ki[1]*s, ko[0]*c + ko[1]*s
        e = (ax*c)**2 + (ay*s)**2
        ends = [w[2]/-k for w, k in ((wi, a), (wo, b)) if k < 0]
        end = min(ends) if ends else mpmath.inf
        g = lambda r: p22(r)*r*(wi[2] + r*a)*(wo[2] + r*b)/sqrt(1 + e*r*r)
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


def oren_nayar(sigma, albedo, ti, to, dphi):
    """Direct light and light that was reflected twice: the full model, C1 to C3 (equations 41 to 44 of the SIGGRAPH
    version), albedo/pi times its first part, (albedo^2/pi) times the second."""
    a, b, c = max(ti, to), min(ti, to), cos(dphi)
    s2 = sigma**2
    c1 = 1 - s2/(2*(s2 + mpf("0.33")))
    c2 = mpf("0.45")*s2/(s2 + mpf("0.09"))*(sin(a) if c >= 0 else sin(a) - (2*b/pi)**3)
    c3 = mpf("0.125")*s2/(s2 + mpf("0.09"))*(4*a*b/pi**2)**2
    direct = c1 + c*c2*tan(b) + (1 - abs(c))*c3*tan((a + b)/2)
    twice = mpf("0.17")*s2/(s2 + mpf("0.13"))*(1 - c*(2*b/pi)**2)
    return albedo*direct/pi, albedo**2*twice/pi


def rows():
    cases = [(30, 0, 40, 0), (30, 0, 40, 180), (60, 20, 70, 80), (85, 0, 80, 10), (85, 0, 80, 170), (0, 0, 60, 0),
             (89, 10, 20, 200)]
    for ndf in ("ggx", "beckmann"):
        for ax, ay in ((0.05, 0.05), (0.3, 0.3), (0.2, 0.5), (1.0, 1.0), (0.001, 0.001), (2.0, 0.1)):
            for ti, p, to, q in cases[::1 if ax in (0.3, 0.2, 1.0) else 3]:
                value = overlap(ndf, mpf(ax), mpf(ay), *[radians(mpf(x)) for x in (ti, p, to, q)])
                print(ndf, ax, ay, ti, p, to, q, mpmath.nstr(value, 12), flush=True)
                yield [ndf, ax, ay, ti, p, to, q, mpmath.nstr(value, 14)]
    for sigma in (0.0, 0.1, 0.35, 0.7):
        for ti, to, dphi in ((0, 0, 0), (30, 60, 20), (60, 30, 120), (75, 75, 180), (80, 10, 90), (50, 70, 0)):
            both = oren_nayar(mpf(sigma), mpf("0.8"), *[radians(mpf(x)) for x in (ti, to, dphi)])
            for name, value in zip(("oren_nayar_full", "oren_nayar_inter"), both):
                yield [name, sigma, 0.8, ti, 0, to, dphi, mpmath.nstr(value, 17)]


with open(sys.argv[1], "w", newline="") as file:
    out = csv.writer(file, lineterminator="\n")
    out.writerow("model,alpha_x,alpha_y,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value".split(","))
    out.writerows(rows())
