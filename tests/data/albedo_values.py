"""Albedos of order 1 of rough surfaces: mirror facets (F = 1, and (1 - c)^5) and clear ones (what comes back, what goes through).

    python3 albedo_values.py albedo_values.csv             a quarter of an hour; needs numpy and scipy
    python3 albedo_values.py --check albedo_values.csv     some of them again: mpmath alone, by directions, 20 digits

By slopes of facets and not by directions: with (p, q) = alpha r (cos f, sin f), p along the light, D(m) (m.z) dm is du df/(2 pi),
u = r^2/(1 + r^2) of GGX and 1 - exp(-r^2) of Beckmann. A facet takes (mu - p sin)/mu of the light. Each row of f is cut where
facets turn away, where light is reflected below the horizon or refracted above it, and where total reflection begins; f is
cut where a row gains or loses such a place. Double exponential rules in 80-bit numbers (Beckmann's Lambda in 1e-15); half the
step must agree to 1e-8. Nothing of src/ is used.
"""
import csv, sys
from concurrent.futures import ProcessPoolExecutor
import numpy as np
from scipy.special import erfcx

L = np.longdouble
PI = 4*np.arctan(L(1))
QUANTITIES = ["E", "F90", "R", "T"]
MASKINGS = ["separable", "height_correlated"]
COLUMNS = ["ndf", "alpha", "eta", "mu"] + [f"{q}_{m}" for m in MASKINGS for q in QUANTITIES] + ["agree"]


def tanh_sinh(step):
    t = np.arange(-L(3.6), L(3.6) + step/2, step)
    s = PI/2*np.sinh(t)
    # Distance from the nearer end, and which one: nodes keep their digits next to both.
    near = 1/(1 + np.exp(2*np.abs(s)))
    return near, t > 0, step*PI/2*np.cosh(t)/(2*np.cosh(s)**2)


def log_gamma(z):
    shift = np.zeros_like(z)
    for k in range(14):
        shift += np.log(z + k)
    z = z + 14
    series = [L(1)/12, -L(1)/360, L(1)/1260, -L(1)/1680, L(1)/1188, -L(691)/360360, L(1)/156, -L(3617)/122400]
    return (z - L(0.5))*np.log(z) - z + np.log(2*PI)/2 + sum(c/z**(2*k + 1) for k, c in enumerate(series)) - shift


def beckmann_lambda(a):
    """exp(-a^2) (1/(a sqrt(pi)) - erfcx(a))/2, to 1e-15."""
    a64 = np.asarray(a, dtype=float)
    value = np.exp(-a64**2)*(1/(a64*np.sqrt(np.pi)) - erfcx(a64))/2
    return np.where(a64 > 26, 0, value).astype(L)


class Surface:
    def __init__(self, ndf, alpha, eta, mu):
        self.ndf, self.alpha, self.eta, self.mu = ndf, L(alpha), L(eta), L(mu)
        self.sin = np.sqrt((1 - self.mu)*(1 + self.mu))

    def lam(self, sin2, cos):
        cot = cos/np.sqrt(np.maximum(sin2, L(1e-60)))
        a = cot/self.alpha
        if self.ndf == "ggx":
            return 1/(2*a*(a + np.sqrt(a*a + 1)))
        return beckmann_lambda(a)

    def u_of(self, r):
        return r*r/(1 + r*r) if self.ndf == "ggx" else -np.expm1(-r*r)

    def r_of(self, u, rest):
        """rest = 1 - u."""
        return np.sqrt(u/rest) if self.ndf == "ggx" else np.sqrt(np.where(u < 0.5, -np.log1p(-u), -np.log(rest)))

    def at(self, r, f):
        """c = wi.m, cosine of the reflected and of the refracted arm (positive below), by slope."""
        cos_f = np.cos(f)
        up2 = 1 + (self.alpha*r)**2
        towards = self.mu - self.sin*self.alpha*r*cos_f
        c = towards/np.sqrt(up2)
        above = 2*towards/up2 - self.mu
        ct2 = 1 - (1 - c*c)/self.eta**2
        ct = np.sqrt(np.maximum(ct2, 0))
        below = self.mu/self.eta - (c/self.eta - ct)/np.sqrt(up2)
        return c, above, ct2, ct, below

    def marks(self, f):
        """r where a row of f is cut."""
        grid = np.concatenate([np.geomspace(1e-6, 1e-2, 60), np.linspace(0.0101, 8, 800), np.geomspace(8.01, 1e7, 400)]).astype(L)
        found = []
        for pick in (lambda r: self.at(r, f)[0], lambda r: self.at(r, f)[1], lambda r: self.at(r, f)[2],
                     lambda r: np.where(self.at(r, f)[2] > 0, self.at(r, f)[4], L(1))):
            values = pick(grid)
            for k in np.nonzero(np.sign(values[1:]) != np.sign(values[:-1]))[0]:
                a, b, sa = grid[k], grid[k + 1], np.sign(values[k])
                for _ in range(70):
                    m = (a + b)/2
                    a, b = (m, b) if np.sign(pick(m)) == sa else (a, m)
                found.append((a + b)/2)
        return sorted(found)

    def values(self, r, f):
        c, above, ct2, ct, below = self.at(r, f)
        seen = c > 0
        c = np.where(seen, c, 1)
        through = seen & (ct2 > 0)
        g = self.eta*np.where(through, ct, 1)
        refl = ((c - g)/(c + g))**2*(1 + ((c*(c + g) - 1)/(c*(g - c) + 1))**2)/2
        # Fresnel's equations as c and g of Cook and Torrance; total reflection: 1.
        refl = np.where(through, refl, 1)
        weight = np.where(seen, (self.mu - self.sin*self.alpha*r*np.cos(f))/self.mu, 0)/PI
        li = self.lam(self.sin**2, self.mu)
        up = seen & (above > 0)
        o = np.where(up, above, 1)
        lo = self.lam(np.where(up, (1 - o)*(1 + o), 0), o)
        down = through & (below > 0)
        t = np.where(down, below, 1)
        lt = self.lam(np.where(down, (1 - t)*(1 + t), 0), t)
        out = []
        for joint, opposite in ((1/((1 + li)*(1 + lo)), 1/((1 + li)*(1 + lt))),
                                (1/(1 + li + lo), np.exp(log_gamma(1 + li) + log_gamma(1 + lt) - log_gamma(2 + li + lt)))):
            unit = np.where(up, weight*joint, 0)
            out += [unit, unit*(1 - c)**5, unit*refl, np.where(down, weight*opposite*(1 - refl), 0)]
        return np.array(out)

    def row(self, f, rule):
        near, upper, w = rule
        us = [(L(0), L(1))] + [(self.u_of(r), 1/(1 + r*r) if self.ndf == "ggx" else np.exp(-r*r)) for r in self.marks(f)] + [(L(1), L(0))]
        total = 0
        for (u0, v0), (u1, v1) in zip(us, us[1:]):
            span = min(u1 - u0, L(1)) if u1 < 0.5 else v0 - v1
            if span <= 0:
                continue
            u = np.where(upper, u1 - span*near, u0 + span*near)
            rest = np.where(upper, v1 + span*near, v0 - span*near)
            good = (u > 0) & (rest > 0)
            r = self.r_of(np.where(good, u, L(0.5)), np.where(good, rest, L(0.5)))
            total = total + np.sum(np.where(good, self.values(r, f)*w*span, 0), axis=1)
        return total

    def integral(self, step):
        rule = tanh_sinh(step)
        near, upper, w = rule
        scan = np.linspace(L(0), PI, 181)
        counts = [len(self.marks(f)) for f in scan]
        cuts = [L(0), PI/2, PI]
        for k in range(180):
            if counts[k] != counts[k + 1]:
                a, b, ca = scan[k], scan[k + 1], counts[k]
                for _ in range(50):
                    m = (a + b)/2
                    a, b = (m, b) if len(self.marks(m)) == ca else (a, m)
                cuts.append((a + b)/2)
        cuts = sorted(set(cuts))
        total = 0
        for a, b in zip(cuts, cuts[1:]):
            if b - a < 1e-12:
                continue
            for n, up, weight in zip(near, upper, w):
                f = b - (b - a)*n if up else a + (b - a)*n
                total = total + self.row(f, rule)*weight*(b - a)
        return total


def cases():
    etas = [1.0001, 1.1, 1.5, 2.4]
    plain = [("ggx", a, e, m) for a, m in [(0.02, 0.01), (0.1, 0.05), (0.3, 0.4), (0.5, 0.9), (1.0, 1.0), (1.0, 0.01)]
             for e in (1.5, 1/1.5)]
    mixed = []
    mus, alphas = [0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0], [0.02, 0.05, 0.1, 0.2, 0.5, 1.0]
    k = 0
    for e in etas + [1/e for e in etas]:
        for ndf in ("ggx", "beckmann"):
            for _ in range(3):
                mixed.append((ndf, alphas[(5*k) % 6], e, mus[(3*k + k//6) % 7]))
                k += 1
    return plain + mixed


def main(name):
    with open(name, "w", newline="") as file, ProcessPoolExecutor(2) as pool:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        for case, row in zip(cases(), pool.map(one, cases())):
            print(*case, row["agree"], flush=True)
            if float(row["agree"]) < 1e-8:
                out.writerow(row)
            else:
                print("  not converged: left out")


def one(case):
    surface = Surface(*case)
    few, many = surface.integral(L(1)/20), surface.integral(L(1)/40)
    gap = np.max(np.abs(few - many))
    names = [f"{q}_{m}" for m in MASKINGS for q in QUANTITIES]
    values = {n: np.format_float_scientific(v, precision=16) for n, v in zip(names, many)}
    return dict(ndf=case[0], alpha=case[1], eta=repr(case[2]), mu=case[3], agree=f"{float(gap):.1e}", **values)


def check(name):
    """By directions and from the definitions, as mpmath integrates: D G2/(4 cos cos), Walter's BTDF."""
    import mpmath
    from mpmath import mp, mpf
    mp.dps = 20

    def lam(w, alpha):
        tan2 = (1 - w[2]**2)/w[2]**2
        return (mpmath.sqrt(1 + alpha**2*tan2) - 1)/2

    def dot(a, b):
        return mpmath.fdot(a, b)

    def density(alpha, h):
        return alpha**2/(mp.pi*(h[2]**2*(alpha**2 - 1) + 1)**2)

    rows = [row for row in csv.DictReader(open(name)) if row["ndf"] == "ggx" and float(row["alpha"]) == 1.0]
    rows = [row for row in rows if float(row["mu"]) > 0.3 and float(row["eta"]) > 1.05]
    for row in rows[:4]:
        alpha, eta, mu = [mpf(float(row[k])) for k in ("alpha", "eta", "mu")]
        wi = [mpmath.sqrt(1 - mu*mu), mpf(0), mu]
        li = lam(wi, alpha)

        def flux(t, f, through):
            z = mpmath.cos(t)*(-1 if through else 1)
            wo = [mpmath.sin(t)*mpmath.cos(f), mpmath.sin(t)*mpmath.sin(f), z]
            h = [(-(a + eta*b) if through else a + b) for a, b in zip(wi, wo)]
            length = mpmath.norm(h)
            h = [x/length for x in h]
            ci, co = dot(wi, h), dot(wo, h)
            if ci <= 0 or h[2] <= 0 or (through and co >= 0):
                return mpf(0)
            g = mpmath.sqrt(eta**2 - 1 + ci*ci)
            fresnel = ((ci - g)/(ci + g))**2*(1 + ((ci*(ci + g) - 1)/(ci*(g - ci) + 1))**2)/2
            lo = lam(wo, alpha)
            if through:
                g2 = mpmath.beta(1 + li, 1 + lo)
                value = ci*-co*eta**2*(1 - fresnel)*g2*density(alpha, h)/(ci + eta*co)**2/mu
            else:
                value = fresnel*density(alpha, h)/(1 + li + lo)/(4*mu)
            return 2*value*mpmath.sin(t)

        # Facets that let light through end where it is turned by acos(1/eta): known cuts at normal incidence alone.
        for quantity, through in (("R", False), ("T", True))[:2 if mu == 1 else 1]:
            cut = mpmath.acos(1/eta) if through else mp.pi/4
            thetas = [0, cut/2, cut] if through else [0, cut, mp.pi/2]
            found = mpmath.quad(lambda t, f: flux(t, f, through), thetas, [0, mp.pi/2, mp.pi], maxdegree=6)
            wanted = mpf(row[f"{quantity}_height_correlated"])
            print(row["eta"], row["mu"], quantity, mpmath.nstr(found - wanted, 3), flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        check(sys.argv[2])
    else:
        main(sys.argv[1])
