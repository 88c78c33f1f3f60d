"""Transmission through rough clear surfaces: the Beta function of two Lambdas, points of the BTDF, means over bins.

    python3 transmission_means.py transmission_means.csv          five minutes; needs mpmath and numpy
    python3 transmission_means.py --check transmission_means.csv   five of the means again, by mpmath alone

Points and Beta: mpmath, 50 digits, from the definitions. Means: Gauss-Legendre (nodes by mpmath) in 80-bit numbers over
panels that end where facets do, graded towards the lobe, those ends and the horizon; panels of 14 and of 20 nodes must
agree to 1e-12. Nothing of src/ is used.
"""
import csv, random, sys
import mpmath
import numpy as np
from mpmath import mp, mpf

mp.dps = 50
L = np.longdouble
COLUMNS = ["kind", "ndf", "alpha_x", "alpha_y", "eta"] + [f"p{k}" for k in range(1, 7)] + [
    "none", "separable", "height_correlated", "cond"]


def text(x):
    return mpmath.nstr(mpf(x), 20, min_fixed=0, max_fixed=0)


def beta_rows():
    grid = ["0", "1e-300", "1e-9", "0.001", "0.3", "1", "4.7", "8.5", "9", "9.5", "40", "333.3", "1e5", "1e8"]
    for k, a in enumerate(grid):
        for b in grid[k:]:
            value = mpmath.beta(1 + mpf(float(a)), 1 + mpf(float(b)))
            if value > mpf("1e-300"):
                yield dict(kind="beta", p1=a, p2=b, height_correlated=text(value))


def lam(ndf, ax, ay, w):
    s2 = (ax*w[0])**2 + (ay*w[1])**2
    if s2 == 0:
        return mpf(0)
    a = abs(w[2])/mpmath.sqrt(s2)
    if ndf == "ggx":
        return (mpmath.sqrt(1 + 1/a**2) - 1)/2
    return (mpmath.exp(-a*a)/(a*mpmath.sqrt(mp.pi)) - mpmath.erfc(a))/2


def btdf(ndf, ax, ay, eta, wi, wo):
    """By the definitions: normalised half vector, Fresnel's equations with cosines."""
    wi, wo = [[x/mpmath.norm(w) for x in w] for w in (wi, wo)]
    h = [-(x + eta*y) for x, y in zip(wi, wo)]
    length = mpmath.norm(h)*(1 if h[2] > 0 else -1)
    if eta < 1:
        length = -mpmath.norm(h)
    h = [x/length for x in h]
    ci, ct = mpmath.fdot(wi, h), -mpmath.fdot(wo, h)
    if ci <= 0 or ct <= 0 or h[2] <= 0:
        return [mpf(0)]*3
    rs, rp = (ci - eta*ct)/(ci + eta*ct), (eta*ci - ct)/(eta*ci + ct)
    slope2 = ((h[0]/ax)**2 + (h[1]/ay)**2)/h[2]**2
    d = 1/(mp.pi*ax*ay*h[2]**4)*(1/(1 + slope2)**2 if ndf == "ggx" else mpmath.exp(-slope2))
    base = ci*ct*eta**2*(1 - (rs**2 + rp**2)/2)*d/(ci - eta*ct)**2/(wi[2]*-wo[2])
    li, lo = lam(ndf, ax, ay, wi), lam(ndf, ax, ay, wo)
    return [base, base/((1 + li)*(1 + lo)), base*mpmath.beta(1 + li, 1 + lo)]


ALPHAS = [(0.05, 0.05), (0.2, 0.2), (0.2, 0.5), (0.5, 0.5), (1.0, 1.0)]
ETAS = [1.0001, 1.1, 1.5, 2.4, 1/2.4, 1/1.5, 1/1.1, 1/1.0001]


def direction(theta, phi):
    return [mpmath.sin(theta)*mpmath.cos(phi), mpmath.sin(theta)*mpmath.sin(phi), mpmath.cos(theta)]


def refracted(wi, n, eta):
    c = mpmath.fdot(wi, n)
    g2 = eta**2 - 1 + c*c
    if c <= 0 or g2 <= 0:
        return None
    k = mpmath.sqrt(g2) - c
    return [-(x + k*y)/eta for x, y in zip(wi, n)]


def point_rows():
    rng = random.Random(1)
    for ndf in ["ggx", "beckmann"]:
        for ax, ay in ALPHAS:
            for eta in ETAS:
                while True:
                    wi = direction(mpmath.radians(rng.choice([0, 5, 30, 50, 70, 85])), mpf(rng.uniform(0, 6.28)))
                    p, q = rng.gauss(0, 1.2)*ax, rng.gauss(0, 1.2)*ay
                    n = [mpf(-p), mpf(-q), mpf(1)]
                    wo = refracted(wi, [x/mpmath.norm(n) for x in n], mpf(eta))
                    if wo and wo[2] < -0.001:
                        break
                w = [float(x) for x in wi + wo]
                args = [mpf(x) for x in (ax, ay, eta)]
                at = lambda w: btdf(ndf, *args, w[:3], w[3:])
                value = at([mpf(x) for x in w])
                step, cond = mpf("1e-20"), mpf(0)
                for k in range(6):
                    moved = [mpf(x) + (step if j == k else 0) for j, x in enumerate(w)]
                    cond += abs(at(moved)[2]/value[2] - 1)/step
                cells = dict(zip([f"p{k}" for k in range(1, 7)], map(repr, w)))
                yield dict(kind="point", ndf=ndf, alpha_x=ax, alpha_y=ay, eta=repr(eta), **cells, none=text(value[0]),
                           separable=text(value[1]), height_correlated=text(value[2]), cond=mpmath.nstr(cond, 3))


# Means, in 80-bit numbers.

def gauss(n):
    found = []
    for k in range(n):
        guess = mpmath.cos(mp.pi*(k + mpf(3)/4)/(n + mpf(1)/2))
        x = mpmath.findroot(lambda x: mpmath.legendre(n, x), (guess, guess + mpf("1e-6")))
        slope = mpmath.diff(lambda x: mpmath.legendre(n, x), x)
        found.append((x, 2/((1 - x*x)*slope**2)))
    as_long = lambda xs: np.array([L(mpmath.nstr(x, 25)) for x in xs])
    return as_long([x for x, _ in found]), as_long([w for _, w in found])


def nodes(breaks, rule):
    x, w = rule
    a, b = np.array(breaks[:-1]), np.array(breaks[1:])
    half, middle = (b - a)/2, (a + b)/2
    return (middle[:, None] + half[:, None]*x).ravel(), (half[:, None]*w).ravel()


def graded(ends, points):
    """Breaks between the ends: the points, and about each panels that double from its width on."""
    a, b = ends
    marks = {a, b}
    for at, width in points:
        for sign in (-1, 1):
            step = width
            while step < 4:
                if a < at + sign*step < b:
                    marks.add(at + sign*step)
                step *= 2
        if a < at < b:
            marks.add(at)
    marks = sorted(marks)
    return [m for k, m in enumerate(marks) if k == 0 or m > marks[k-1]]


def log_gamma(z):
    shift = np.zeros_like(z)
    for k in range(14):
        shift += np.log(z + k)
    z = z + 14
    series = [L(1)/12, -L(1)/360, L(1)/1260, -L(1)/1680, L(1)/1188, -L(691)/360360, L(1)/156, -L(3617)/122400]
    total = sum(c/z**(2*k + 1) for k, c in enumerate(series))
    return (z - L(0.5))*np.log(z) - z + np.log(2*L(np.pi))/2 + total - shift


PI = 4*np.arctan(L(1))


class Light:
    """Light at azimuth 0, through GGX; wo at polar angle t from the nadir and azimuth pi + f."""

    def __init__(self, ax, ay, eta, theta, phi, ndf):
        self.ax, self.ay, self.eta, self.phi, self.ndf = L(ax), L(ay), L(eta), L(phi), ndf
        self.theta, self.sin, self.cos = L(theta), np.sin(L(theta)), np.cos(L(theta))
        self.cone = np.arccos(min(self.eta, 1/self.eta))
        m = (self.eta - 1)*(self.eta + 1)
        g2 = m + self.cos**2
        self.h = abs(m)/(self.cos + np.sqrt(abs(g2)))
        self.peak = np.arcsin(self.sin/self.eta) if g2 > 0 else None
        self.end = np.arccos(self.cos/self.eta) if self.cos < self.eta else None
        self.width = self.h*min(ax, ay, 0.5)/4*max(np.sqrt(max(g2, L(0)))/self.eta, self.h)

    def lam(self, x, y, z):
        s2 = (self.ax*x)**2 + (self.ay*y)**2
        return s2/(2*z*(z + np.sqrt(z*z + s2)))

    def values(self, t, f):
        """f_t |cos_o| of the three maskings."""
        eta, d = self.eta, abs(self.eta - 1)
        sin_t, cos_t = np.sin(t), np.cos(t)
        # q/2 = 1 + wi.wo = 2 sin^2((t - theta)/2) + 2 sin_i sin_t sin^2(f/2)
        half_q = 2*np.sin((t - self.theta)/2)**2 + 2*self.sin*sin_t*np.sin(f/2)**2
        sign = 1 if eta > 1 else -1
        # The sample's frame: the light's azimuth is phi.
        xi, yi = self.sin*np.cos(self.phi), self.sin*np.sin(self.phi)
        xo, yo = -sin_t*np.cos(self.phi + f), -sin_t*np.sin(self.phi + f)
        hx, hy, hz = -sign*(xi + eta*xo), -sign*(yi + eta*yo), -sign*(self.cos - eta*cos_t)
        length2 = d*d + 2*eta*half_q
        ci = (d - eta*half_q if eta > 1 else d + eta*half_q)/np.sqrt(length2)
        ct = (d + half_q if eta > 1 else d - half_q)/np.sqrt(length2)
        good = (ci > 0) & (ct > 0) & (hz > 0)
        ci, ct, hz = np.where(good, ci, 1), np.where(good, ct, 1), np.where(good, hz, 1)
        g = eta*ct
        through = 2*ci*g*(1/(ci + g)**2 + eta**2/(eta**2*ci + g)**2)
        slope2 = (hx/self.ax)**2 + (hy/self.ay)**2
        if self.ndf == "ggx":
            dens = (length2/(slope2 + hz*hz))**2/(PI*self.ax*self.ay)
        else:
            dens = np.exp(-slope2/hz**2)*(length2/hz**2)**2/(PI*self.ax*self.ay)
        base = np.where(good, ci*ct*eta**2*through*dens/length2/self.cos, 0)
        if self.ndf != "ggx":
            return [base]
        li, lo = self.lam(xi, yi, self.cos), self.lam(xo, yo, cos_t)
        beta = np.exp(log_gamma(1 + li) + log_gamma(1 + lo) - log_gamma(2 + li + lo))
        return [base, base/((1 + li)*(1 + lo)), base*beta]

    def over_azimuth(self, t, ends, rule):
        """The integral over f for one t; f is cut at the cone about -wi in which facets lie."""
        pieces, total = [], 0
        lowest = np.cos(t - self.theta) - np.cos(self.cone)
        if lowest <= 0:
            return 0
        if self.sin == 0 or np.sin(t) == 0:
            limit = PI
        else:
            limit = 2*np.arcsin(np.sqrt(min(L(1), lowest/(2*self.sin*np.sin(t)))))
        for k in range(-3, 4):
            a, b = max(ends[0], 2*PI*k - limit), min(ends[1], 2*PI*k + limit)
            if a < b:
                pieces.append((a, b, 2*PI*k))
        for a, b, middle in pieces:
            width = max(self.width, abs(t - self.theta)/8)/max(self.sin, L(0.1))
            f, w = nodes(graded((a, b), [(middle, min(width, L(0.5)))]), rule)
            total = total + np.array([np.sum(v*w) for v in self.values(t, f)])
        return total

    def mean(self, t1, t2, p1, p2, rule):
        ends = (L(p1) - self.phi - PI, L(p2) - self.phi - PI)
        lower, upper = PI - L(t2), PI - L(t1)
        points = [(abs(self.theta - self.cone), L(1e-9)), (self.theta + self.cone, L(1e-9)), (PI/2, L(1e-9))]
        points += [(2*PI - self.theta - self.cone, L(1e-9)), (self.theta, abs(self.eta - 1)/8)]
        if self.peak is not None:
            points.append((self.peak, self.width))
        if self.end is not None:
            points.append((self.end, L(1e-6)))
        ts, ws = nodes(graded((lower, upper), points), rule)
        total = sum(w*np.sin(t)*self.over_azimuth(t, ends, rule) for t, w in zip(ts, ws))
        size = (ends[1] - ends[0])*np.sin(upper + lower)*np.sin(upper - lower)/2
        return total/size


def cases():
    """Bins of 5 by 10 degrees about the lobe, beside it, at the ends of facets, and whole rings."""
    rng = random.Random(2)
    for eta in ETAS:
        for ax, ay in ALPHAS:
            for theta in rng.sample([0, 10, 30, 45, 60, 75, 85], 2):
                phi = 0 if ax == ay else 25
                s = np.sin(np.radians(theta))/eta
                peak = np.degrees(np.arcsin(s)) if s < 1 else 80.0
                shift = rng.choice([0, 0, 0, 10, -10]) if eta not in (ETAS[0], ETAS[-1]) else 0
                at = min(max(peak + shift + rng.uniform(-2, 2), 2.5), 87.5)
                t = [180 - at - 2.5, 180 - at + 2.5]
                # On the horizon at times, as tables have bins.
                t = [90.0, 95.0] if t[0] < 91 else [round(float(x), 3) for x in t]
                off = rng.choice([0, 0, 0, 20])
                p = [phi + 180 + off - 4.0, phi + 180 + off + 6.0]
                yield "ggx", ax, ay, eta, theta, phi, t, p
    for eta in (1.5, 1/1.5, 1.0001):
        for alpha in (0.2, 0.5):
            yield "beckmann", alpha, alpha, eta, 40, 0, [140.0, 160.0], [150.0, 200.0]
            yield "ggx", alpha, alpha, eta, 40, 0, [90.0, 180.0], [0.0, 360.0]


def mean_rows():
    rules = gauss(14), gauss(20)
    for ndf, ax, ay, eta, theta, phi, t, p in cases():
        light = Light(ax, ay, eta, np.radians(L(theta)), np.radians(L(phi)), ndf)
        few, many = [light.mean(*map(np.radians, map(L, t + p)), rule) for rule in rules]
        if np.ndim(many) == 0:
            continue
        gap = max(abs(few/many - 1)) if many[0] > 0 else 0
        print(ndf, ax, ay, eta, theta, t, p, many, "gap", gap, flush=True)
        if not gap < 1e-12:
            print("  not converged: left out")
            continue
        values = [np.format_float_scientific(v, precision=17) for v in many] + ["", ""]
        yield dict(kind="mean", ndf=ndf, alpha_x=ax, alpha_y=ay, eta=repr(eta), p1=theta, p2=phi, p3=t[0], p4=t[1], p5=p[0],
                   p6=p[1], none=values[0], separable=values[1], height_correlated=values[2])


def check(name):
    """Five smooth means once more: mpmath's own rule over the whole bin, from the definitions, 20 digits."""
    mp.dps = 20
    rows = [row for row in csv.DictReader(open(name)) if row["kind"] == "mean" and row["ndf"] == "ggx"]
    rows = [row for row in rows if float(row["alpha_x"]) >= 0.5 and abs(float(row["eta"]) - 1) > 0.05]
    for row in rows[::len(rows)//5]:
        ax, ay, eta = [mpf(float(row[k])) for k in ("alpha_x", "alpha_y", "eta")]
        theta, phi, t1, t2, p1, p2 = [mpmath.radians(mpf(row[f"p{k}"])) for k in range(1, 7)]
        wi = direction(theta, phi)
        flux = lambda t, f: btdf("ggx", ax, ay, eta, wi, direction(t, f))[2]*-mpmath.cos(t)*mpmath.sin(t)
        size = (p2 - p1)*(mpmath.sin(t1)**2 - mpmath.sin(t2)**2)/2
        found = mpmath.quad(flux, [t1, t2], [p1, (p1 + p2)/2, p2], maxdegree=4)/size
        print(row["eta"], row["p1"], row["p3"], mpmath.nstr(found/mpf(row["height_correlated"]) - 1, 3), flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        check(sys.argv[2])
    else:
        with open(sys.argv[1], "w", newline="") as file:
            out = csv.DictWriter(file, COLUMNS, restval="", lineterminator="\n")
            out.writeheader()
            for rows in (beta_rows(), point_rows(), mean_rows()):
                out.writerows(rows)
