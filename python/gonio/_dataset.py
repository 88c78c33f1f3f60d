"""A table as ``xarray.Dataset``: dimensions, coordinates, units, conventions."""

import io
import json
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from . import _gonio
from .errors import GonioWarning, UsageError

_VALUES = {
    "brdf": ("brdf", "BRDF, all orders"),
    "single": ("single", "BRDF, one bounce"),
    "multiple": ("multiple", "BRDF, more than one bounce"),
    "stderr": ("brdf_stderr", "standard error of brdf over the realisations"),
    "stderr_single": ("single_stderr", "standard error of single over the realisations"),
}
# Errors of a table that say that there is none, and that nothing was measured.
_UNKNOWN, _GAP = -1.0, -2.0
_LIST_KINDS = {"patches": "patch", "points": "direction"}


class _Layout:
    """Dimensions and coordinates of a geometry: ``light`` and ``sensor`` are names and lengths of axes."""

    def __init__(self, grid: Mapping[str, Any]) -> None:
        self.kind: str = grid["kind"]
        self.light: dict[str, int] = {}
        self.sensor: dict[str, int] = {}
        self.coordinates: dict[str, Any] = {}
        if self.kind == "half_difference":
            self._axes(self.light, {name: grid[f"{name}_deg"] for name in ("theta_h", "phi_h")})
            self._axes(self.sensor, {name: grid[f"{name}_deg"] for name in ("theta_d", "phi_d")})
            return
        if grid.get("stops_deg"):
            self._list(self.light, "incidence", ("theta_i", "phi_i"), np.array(grid["stops_deg"], float))
        else:
            self._axes(self.light, {name: grid[f"{name}_deg"] for name in ("theta_i", "phi_i")})
        if self.kind == "hemisphere":
            edges = {name: np.array(grid[f"{name}_edges_deg"], float) for name in ("theta_r", "phi_r")}
            self._axes(self.sensor, {name: (edge[1:] + edge[:-1]) / 2 for name, edge in edges.items()})
            for name, edge in edges.items():
                self._edges(name, name, np.stack([edge[:-1], edge[1:]], -1))
        elif self.kind == "arm":
            self._axes(self.sensor, {name: grid[f"{name}_deg"] for name in ("theta_r", "phi_r")})
        elif self.kind == "patches":
            patches = np.array(grid["patches_deg"], float)
            middles = np.stack([patches[:, :2].mean(1), patches[:, 2:].mean(1)], -1)
            self._list(self.sensor, "patch", ("theta_r", "phi_r"), middles)
            self._edges("theta_r", "patch", patches[:, :2])
            self._edges("phi_r", "patch", patches[:, 2:])
        else:
            self._list(self.sensor, "direction", ("theta_r", "phi_r"), np.array(grid["points_deg"], float))

    def _axes(self, where: dict[str, int], axes: Mapping[str, Any]) -> None:
        for name, values in axes.items():
            where[name] = len(values)
            self.coordinates[name] = ((name,), np.array(values, float), {"units": "degree"})

    def _list(self, where: dict[str, int], dimension: str, names: Sequence[str], values: Any) -> None:
        where[dimension] = len(values)
        for column, name in enumerate(names):
            self.coordinates[name] = ((dimension,), values[:, column], {"units": "degree"})

    def _edges(self, name: str, dimension: str, edges: Any) -> None:
        attributes = {"units": "degree", "long_name": f"edges of {name}"}
        self.coordinates[f"{name}_edges"] = ((dimension, "edge"), edges, attributes)

    @property
    def dimensions(self) -> tuple[str, ...]:
        return (*self.light, *self.sensor)

    @property
    def shape(self) -> tuple[int, ...]:
        return (*self.light.values(), *self.sensor.values())


def dataset(path: Path) -> xr.Dataset:
    """The table at ``path`` with its realisations."""
    answer = _gonio.load(path, True)
    for text in answer["warnings"]:
        warnings.warn(text, GonioWarning, stacklevel=4)
    with np.load(io.BytesIO(answer["npz"]), allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    grid = json.loads(str(arrays["grid"]))
    layout, colours = _Layout(grid), len(answer["colours"])
    dims, shape = (*layout.dimensions, "wavelength"), (*layout.shape, colours)
    coordinates = {**layout.coordinates, "colour": (("wavelength",), answer["colours"])}
    if "wavelength_nm" in arrays:
        nm = {"units": "nm", "long_name": "wavelength"}
        coordinates["wavelength"] = (("wavelength",), arrays["wavelength_nm"], nm)
    per_sr = {"units": "sr-1"}
    variables: dict[str, Any] = {}
    gap = arrays["stderr"].reshape(shape) == _GAP
    for name, (known, text) in _named(arrays).items():
        values = arrays[name].reshape(shape)
        missing = gap | ((values == _UNKNOWN) if known.endswith("_stderr") else False)
        values = np.where(missing, np.float32(np.nan), values)
        variables[known] = (dims, values, {**per_sr, "long_name": text})
    hits = {"units": "1", "long_name": "paths that arrived in the bin"}
    variables["hits"] = (dims[:-1], arrays["hits"].reshape(layout.shape), hits)
    variables.update(_mueller(arrays, dims, shape))
    sizes = _array(answer["sizes"], np.float64, tuple(layout.sensor.values()))
    if sizes.any():
        what = {"units": "sr", "long_name": "projected solid angle of the bin"}
        variables["projected_solid_angle"] = (tuple(layout.sensor), sizes, what)
    for name in ("total", "single"):
        if answer["parts"]:
            parts = _array(answer[name], np.float32, (answer["parts"], *shape))
            known = "realisation_brdf" if name == "total" else "realisation_single"
            what = {**per_sr, "long_name": f"{name} of each realisation"}
            variables[known] = (("realisation", *dims), parts, what)
    result = xr.Dataset(variables, coordinates, _attributes(arrays, grid, answer))
    return _with_albedos(result, layout)


def _array(values: bytes, kind: Any, shape: tuple[int, ...]) -> Any:
    # A copy: bytes cannot be written to.
    return np.frombuffer(values, kind).reshape(shape).copy()


def _named(arrays: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    orders = [name for name in arrays if name.startswith("order") and name[5:].isdigit()]
    return {**_VALUES, **{name: (name, f"BRDF, {name[5:]} bounces") for name in orders}}


def _mueller(arrays: Mapping[str, Any], dims: tuple[str, ...], shape: tuple[int, ...]) -> dict[str, Any]:
    found = {}
    for layer, name in (("", "mueller"), ("stderr.", "mueller_stderr")):
        elements = [f"{layer}m{row}{column}" for row in range(4) for column in range(4)]
        if all(element in arrays for element in elements):
            stack = np.stack([arrays[element].reshape(shape) for element in elements], -1)
            stack = np.where(stack == _UNKNOWN, np.float32(np.nan), stack) if layer else stack
            text = "Mueller matrix, row of the light that leaves, column of the light that comes"
            what = {"units": "sr-1", "long_name": "standard error of mueller" if layer else text}
            found[name] = ((*dims, "row", "column"), stack.reshape((*shape, 4, 4)), what)
    return found


def _attributes(arrays: Mapping[str, Any], grid: Mapping[str, Any], answer: Mapping[str, Any]) -> dict[str, Any]:
    attributes = {
        "title": "BRDF table of gonio",
        "gonio_version": str(arrays["version"]),
        "geometry": grid["kind"],
        "phi_r": "counts from the light's azimuth" if grid["phi_r_relative"] else "counts from x",
        "convention": answer["convention"],
        "seed": str(arrays["seed"]),
        "campaign": str(arrays["campaign"]),
        "patch_digest": str(arrays["patch_digest"]),
        "realisations_in_a_part": int(answer["group_size"]),
    }
    if grid.get("aperture_deg") is not None:
        attributes["aperture_deg"] = float(grid["aperture_deg"])
    return attributes


def _with_albedos(table: xr.Dataset, layout: _Layout) -> xr.Dataset:
    """With the share of the light that comes back, and that has gone through, where the bins cover a hemisphere."""
    if layout.kind not in ("hemisphere", "patches"):
        return table

    def flux(values: xr.DataArray, side: xr.DataArray) -> xr.DataArray:
        sizes = table.projected_solid_angle.where(side, 0.0)
        total: xr.DataArray = (values.astype(float) * sizes).sum(list(layout.sensor), skipna=False)
        return total

    below = table.theta_r > 90
    for name, text, side in (("albedo", "comes back", ~below), ("transmittance", "has gone through", below)):
        if not side.any():
            continue
        albedo = flux(table.brdf, side)
        table[name] = albedo.assign_attrs(units="1", long_name=f"share of the light that {text}")
        if table.sizes.get("realisation", 0) > 1:
            parts = flux(table.realisation_brdf, side)
            error = parts.std("realisation", ddof=1) / np.sqrt(parts.sizes["realisation"])
            table[f"{name}_stderr"] = error.assign_attrs(units="1", long_name=f"standard error of {name}")
    return table


def theory(path: Path, table: xr.Dataset, masking: str) -> xr.DataArray:
    """The means of the table's own model."""
    answer = _gonio.model_means(path)
    if answer is None:
        raise UsageError(f"{path}: theory has no model of this surface")
    name, means = answer[0], dict(answer[1])
    if masking not in means:
        raise UsageError(f"masking = {masking}: the model of {path} has {', '.join(means)}")
    values = _array(means[masking], np.float64, table.single.shape)
    what = {"units": "sr-1", "long_name": f"{name}, {masking}"}
    return xr.DataArray(values, table.single.coords, table.single.dims, "model", what)
