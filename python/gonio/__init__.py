"""gonio: a virtual gonioreflectometer.

    import gonio
    measurement = gonio.measure("configs/quickstart.toml")
    measurement.dataset.brdf.sel(theta_i=30)

A campaign goes in (a TOML file, its text or a dictionary), and a BRDF table with error bars comes out, as an
``xarray.Dataset``. ``gonio.models`` holds the formulas of microfacet theory over NumPy arrays. Angles are degrees, BRDFs
1/sr without cosine, and the frame is the program's: z along the normal, x the tangent, arms point away from the surface.
"""

from typing import TYPE_CHECKING, Any

from ._gonio import version as _version
from .errors import (
    CampaignError,
    DisagreementError,
    FileError,
    GonioError,
    GonioWarning,
    InternalError,
    RefusedError,
    UsageError,
)
from .measurement import Measurement, budget, load, measure, measure_all

if TYPE_CHECKING:
    from . import models

__version__: str = _version()

__all__ = [
    "CampaignError",
    "DisagreementError",
    "FileError",
    "GonioError",
    "GonioWarning",
    "InternalError",
    "Measurement",
    "RefusedError",
    "UsageError",
    "budget",
    "load",
    "measure",
    "measure_all",
    "models",
]


def __getattr__(name: str) -> Any:
    # NumPy is imported where it is used: the command starts without it.
    if name == "models":
        from importlib import import_module

        return import_module("gonio.models")
    raise AttributeError(f"module 'gonio' has no attribute {name!r}")
