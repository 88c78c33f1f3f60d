"""Makes eight small fields and `areal.csv`: their areal parameters by surfalize 0.19.2, and those of two scans beside.

Needs numpy, surfalize and gwyddionpy. Lengths are in um; Sdr is in percent; an empty cell is not defined.
"""

import warnings
from pathlib import Path

import gwyddionpy
import numpy as np
from surfalize import Surface

warnings.simplefilter("ignore")
HERE = Path(__file__).parent
ROWS, COLUMNS = 48, 64


def smooth(rng, length_x, length_y):
    """White noise under a Gaussian of these lengths, of variance 1."""
    x, y = np.fft.fftfreq(COLUMNS)[None, :], np.fft.fftfreq(ROWS)[:, None]
    damped = np.fft.fft2(rng.standard_normal((ROWS, COLUMNS))) * np.exp(-2 * ((length_x * x) ** 2 + (length_y * y) ** 2))
    field = np.fft.ifft2(damped).real
    return (field - field.mean()) / field.std()


def fields():
    rng = np.random.default_rng(12)
    y, x = np.mgrid[:ROWS, :COLUMNS]
    noise = rng.standard_normal((ROWS, COLUMNS))
    yield "isotropic", 0.2 * smooth(rng, 4, 4), 0.5, 0.5
    yield "fine", 0.1 * smooth(rng, 2, 2), 0.25, 0.25
    yield "brushed", 0.3 * smooth(rng, 3, 9), 0.5, 0.5
    yield "oblong", 0.2 * smooth(rng, 5, 5), 0.4, 0.8
    yield "turned", 0.5 * np.sin(0.9 * x + 0.1 * y) + 0.05 * noise, 1.0, 1.0
    yield "steps", 0.4 * np.sign(smooth(rng, 6, 6)) + 0.01 * noise, 0.5, 0.5
    yield "pits", -0.2 * np.exp(1.2 * smooth(rng, 4, 4)), 0.5, 0.5
    yield "white", 0.1 * noise, 0.3, 0.3


def line(name, heights, pitch_x, pitch_y):
    surface = Surface(heights.astype(float), pitch_x, pitch_y)
    values = [getattr(surface, key)() for key in ("Sa", "Sq", "Ssk", "Sku", "Sdq", "Sdr", "Sal", "Str")]
    return ",".join([name, repr(pitch_x), repr(pitch_y)] + ["" if np.isnan(value) else f"{value:.10g}" for value in values])


def main():
    lines = ["file,pitch_x_um,pitch_y_um,Sa,Sq,Ssk,Sku,Sdq,Sdr,Sal,Str"]
    for name, heights, pitch_x, pitch_y in fields():
        heights = heights.astype("<f4")
        np.save(HERE / f"{name}.npy", heights)
        lines.append(line(f"areal/{name}.npy", heights, pitch_x, pitch_y))
    for name in ("two_channels.gwy", "by_gwyddion.gwy"):
        channels = gwyddionpy.load(str(HERE.parent / "scans" / name)).channels
        channel = next(channel for channel in channels.values() if channel.si_unit_z == "m")
        heights = np.array(channel.data) * 1e6
        rows, columns = heights.shape
        lines.append(line(f"scans/{name}", heights, channel.xreal * 1e6 / columns, channel.yreal * 1e6 / rows))
    (HERE / "areal.csv").write_text("\n".join(lines) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
