"""A small campaign, and the program without Python to hold the package against."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

CAMPAIGN = """
name = "small"
seed = 3
[surface]
realisations = 4
cells = 64
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 60]
[sensor.hemisphere]
theta_r_bins = 9
phi_r_bins = 18
bins = "centred"
[optics]
material = "gold"
[stop]
samples = 16_384
"""


@pytest.fixture(scope="session")
def binary() -> Path:
    """The program, as `cargo build` makes it."""
    path = Path(os.environ.get("GONIO_BINARY", ROOT / "target/debug/gonio"))
    if not path.is_file():
        pytest.skip(f"{path} is not built")
    return path


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(CAMPAIGN)
    return path


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory):
    import gonio

    return gonio.measure(CAMPAIGN, output=tmp_path_factory.mktemp("small"), progress=False)
