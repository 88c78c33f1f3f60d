"""Mueller matrices by the electric field itself, in 40 digits: the oracle of tests/it/facets/mueller.rs.

A field vector E exp(-i w t) in space is taken apart at each facet into s = k x n and p = k x s, each part is multiplied by
Fresnel's amplitude as the textbook has it (Born and Wolf 1999, 1.5.2), and put together along the new ray. No Stokes vector
is turned on the way. Of the 2 x 2 matrix J between the frames of both arms M_ij = tr(s_i J s_j J^+)/2.

    python3 tests/data/mueller.py > tests/data/mueller.csv

Rows: kind, what is given, what is expected, numbers apart by spaces.
facet: eta k theta_deg through -> a b c, the matrix of one facet over its first element.
path: eta k count, then x y z of wi; for each facet x y z of its normal and 1 where the light goes through; the answer is wo,
then 16 elements over the product of the facets' unpolarised reflectances or transmittances. Frames: s along z x arm.
groove: eta k theta_deg -> the matrix of light that meets both sides of a groove along x, of slope 1, from above x, as a share
of the light that meets the groove.
"""
import random
from mpmath import mp, mpf, mpc, sqrt, sin, cos, pi, matrix, conj, re

mp.dps = 40


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def scaled(s, a):
    return [s * x for x in a]


def plus(a, b):
    return [x + y for x, y in zip(a, b)]


def unit(a):
    return scaled(1 / sqrt(dot(a, a)), a)


def amplitudes(n, c, through):
    """s and p of the field, p = k x s on each ray, and the power that goes along each, unpolarised."""
    s2 = 1 - c * c
    w = sqrt(mpc(n * n - s2))
    if w.imag < 0 or (w.imag == 0 and w.real < 0):
        w = -w
    if not through:
        r = [(c - w) / (c + w), (n * n * c - w) / (n * n * c + w)]
        return r, (abs(r[0]) ** 2 + abs(r[1]) ** 2) / 2
    t = [2 * c / (c + w), 2 * n * c / (n * n * c + w)]
    power = re(w) / c
    return t, power * (abs(t[0]) ** 2 + abs(t[1]) ** 2) / 2


def onward(k, n, eta, through):
    c = dot(k, n)
    if not through:
        return plus(k, scaled(-2 * c, n))
    # n points against the light.
    root = sqrt(eta * eta - 1 + c * c)
    return unit(plus(scaled(1 / eta, k), scaled((-c - root) / eta, n)))


def arm(w):
    return unit(cross([0, 0, 1], w))


def mueller(j):
    sigma = [matrix([[1, 0], [0, 1]]), matrix([[1, 0], [0, -1]]), matrix([[0, 1], [1, 0]]), matrix([[0, mpc(0, -1)], [mpc(0, 1), 0]])]
    # V = 2 Im(E_s conj(E_p)) is minus the mean of the usual third Pauli matrix.
    sign = [1, 1, 1, -1]
    jh = matrix([[conj(j[0, 0]), conj(j[1, 0])], [conj(j[0, 1]), conj(j[1, 1])]])
    m = []
    for a in range(4):
        for b in range(4):
            x = sigma[a] * j * sigma[b] * jh
            m.append(sign[a] * sign[b] * re(x[0, 0] + x[1, 1]) / 2)
    return m


def trace(n, wi, facets):
    """wo, and the matrix over the product of unpolarised powers; facets: normal, through."""
    k = scaled(-1, wi)
    s = arm(wi)
    fields = [s, cross(k, s)]
    scale, below = mpf(1), False
    for normal, through in facets:
        n_here = 1 / n if below else n
        if dot(k, normal) > 0:
            normal = scaled(-1, normal)
        c = -dot(k, normal)
        s = unit(cross(k, normal))
        p = cross(k, s)
        amps, power = amplitudes(n_here, c, through)
        to = onward(k, normal, n_here, through)
        fields = [plus(scaled(amps[0] * dot(e, s), s), scaled(amps[1] * dot(e, p), cross(to, s))) for e in fields]
        if through:
            # Power over |E|^2: the ratio of index times cosine.
            out = -dot(to, normal)
            power = power / (re(n_here) * out / c)
            below = not below
        scale *= power
        k = to
    s = arm(k)
    p = cross(k, s)
    j = matrix([[dot(fields[0], s), dot(fields[1], s)], [dot(fields[0], p), dot(fields[1], p)]])
    return k, [x / scale for x in mueller(j)], scale


def text(values):
    return " ".join(mp.nstr(re(mpf(v) if not isinstance(v, mpc) else v), 20) for v in values)


def direction(theta, phi):
    return [sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)]


print("kind,given,expected")
METALS = [("0.2", "3.4"), ("1.5", "7.6"), ("2.9", "3.1"), ("0.04", "4.6")]
for eta, k in [("1.5", "0"), ("1.0001", "0"), ("2.4", "0"), ("0.66666666666666666667", "0"), ("0.41666666666666666667", "0")] + METALS:
    for theta in ["1e-4", "10", "33", "41.8", "41.82", "56.309932474020213086", "75", "89", "89.99"]:
        c = cos(mpf(theta) * pi / 180)
        n = mpc(mpf(eta), mpf(k))
        for through in [0, 1] if k == "0" and mpf(eta) ** 2 > 1 - c * c else [0]:
            amps, power = amplitudes(n, c, bool(through))
            s2, p2 = abs(amps[0]) ** 2, abs(amps[1]) ** 2
            z = amps[0] * conj(amps[1])
            mean = (s2 + p2) / 2
            print(f"facet,{eta} {k} {theta} {through},{text([(s2 - p2) / 2 / mean, re(z) / mean, z.imag / mean])}")

random.seed(18)
for eta, k in [("1.5", "0"), ("0.66666666666666666667", "0"), ("2.4", "0"), ("0.2", "3.4")]:
    found = 0
    n = mpc(mpf(eta), mpf(k)) if k != "0" else mpf(eta)
    while found < 8:
        count = random.choice([1, 2, 3, 4])
        wi = unit([mpf(random.uniform(-1, 1)) for _ in range(2)] + [mpf(random.uniform(0.05, 1))])
        ray, below, facets = scaled(-1, wi), False, []
        for _ in range(count):
            normal = unit([mpf(random.uniform(-1, 1)) for _ in range(3)])
            if dot(ray, normal) > 0:
                normal = scaled(-1, normal)
            here = 1 / n if below else n
            through = k == "0" and random.random() < 0.6
            if through and here * here < 1 - dot(ray, normal) ** 2:
                through = False
            ray = onward(ray, normal, here, through)
            below ^= through
            facets.append((normal, through))
        wo, m, _ = trace(n, wi, facets)
        given = [eta, k, str(count)] + [text(wi)] + [text(f[0]) + f" {int(f[1])}" for f in facets]
        print(f"path,{' '.join(given)},{text(list(wo) + m)}")
        found += 1

for eta, k in METALS[:2]:
    for theta in [20, 50]:
        n = mpc(mpf(eta), mpf(k))
        wi = direction(mpf(theta) * pi / 180, mpf(0))
        h = sqrt(mpf(1) / 2)
        total = [mpf(0)] * 16
        for side in [1, -1]:
            _, m, scale = trace(n, wi, [([0, -side * h, h], False), ([0, side * h, h], False)])
            total = [t + x * scale / 2 for t, x in zip(total, m)]
        print(f"groove,{eta} {k} {theta},{text(total)}")
