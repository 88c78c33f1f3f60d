"""Areal densities of K-correlation surfaces, from their profile density alone: the inverse Abel transform by quadrature in
30 digits. Writes psd_values.csv; needs mpmath."""

import mpmath as mp

mp.mp.dps = 30


def areal(a, b, c, f):
    """-1/(2 pi) integral from f of S1'(x)/sqrt(x^2 - f^2) dx, S1 = A/(1 + (B x)^2)^(C/2); x = sqrt(f^2 + u^2)."""

    def integrand(u):
        x2 = f * f + u * u
        return a * c * b * b * (1 + b * b * x2) ** (-c / 2 - 1)

    scale = mp.sqrt(1 + b * b * f * f) / b
    return mp.quad(integrand, [0, scale, 10 * scale, 100 * scale, mp.inf]) / (2 * mp.pi)


with open("psd_values.csv", "w") as out:
    out.write("a_um3,b_um,c,f_per_um,areal_um4\n")
    for a, b, c in [("0.02", "12", "1.3"), ("3", "0.7", "2"), ("1e-4", "60", "2.7"), ("5e-6", "150", "5.5")]:
        for f in ["1e-4", "0.03", "1.7"]:
            value = areal(*(mp.mpf(x) for x in (a, b, c, f)))
            out.write(f"{a},{b},{c},{f},{mp.nstr(value, 17)}\n")
