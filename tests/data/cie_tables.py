"""Writes src/appearance/colorimetry/cie_5nm.csv and tests/data/lab_values.csv with colour-science 0.4.7 (pip install colour-science).

The first is CIE's own data as that package quotes them (CIE 015:2018, tables of 5 nm): colour-matching functions and
illuminants, rounded to the digits that CIE prints. The second are the package's XYZ and L*a*b* of some spectra.
"""

import csv
import os
import warnings

import numpy as np

warnings.filterwarnings("ignore")
import colour  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
SHAPE = colour.SpectralShape(380, 780, 5)
OBSERVERS = {"2": "CIE 1931 2 Degree Standard Observer", "10": "CIE 1964 10 Degree Standard Observer"}
ILLUMINANTS = {"A": "A", "C": "C", "D65": "D65", "F11": "FL11"}

nm = SHAPE.wavelengths
cmfs = {k: colour.MSDS_CMFS[name].copy().align(SHAPE) for k, name in OBSERVERS.items()}
lights = {k: colour.SDS_ILLUMINANTS[name].copy().align(SHAPE) for k, name in ILLUMINANTS.items()}

with open(os.path.join(HERE, "../../src/appearance/colorimetry/cie_5nm.csv"), "w", newline="") as file:
    out = csv.writer(file, lineterminator="\n")
    out.writerow(["nm", "x2", "y2", "z2", "x10", "y10", "z10", "A", "C", "D65", "F11"])
    for k, at in enumerate(nm):
        values = [v for o in OBSERVERS for v in cmfs[o].values[k]] + [lights[i].values[k] for i in ILLUMINANTS]
        out.writerow([f"{at:.0f}"] + [f"{v:.10g}" for v in values])

SPECTRA = {
    "half": 0.5 + 0.0 * nm,
    "bell": 0.1 + 0.7 * np.exp(-(((nm - 600) / 40) ** 2)),
    "step": 0.05 + 0.9 / (1 + np.exp(-(nm - 500) / 8)),
    "bright": 2.5 + 1.5 * np.sin(nm / 60),
}

with open(os.path.join(HERE, "lab_values.csv"), "w", newline="") as file:
    out = csv.writer(file, lineterminator="\n")
    out.writerow(["spectrum", "observer", "illuminant", "X", "Y", "Z", "L", "a", "b"])
    for name, values in SPECTRA.items():
        for o in OBSERVERS:
            for i in ["D65", "A", "F11"]:
                of = lambda v: colour.sd_to_XYZ(
                    colour.SpectralDistribution(v, nm), cmfs[o], lights[i], method="Integration"
                )
                xyz, white = of(values), of(1.0 + 0.0 * nm)
                lab = colour.XYZ_to_Lab(xyz / white[1], colour.XYZ_to_xy(white))
                out.writerow([name, o, i] + [f"{v:.9f}" for v in [*xyz, *lab]])
