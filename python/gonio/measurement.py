"""Measurements: run, load, judge, fit, write, look at."""

import json
import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _gonio
from ._work import Progress, finished
from .errors import FileError

if TYPE_CHECKING:
    import xarray

FilePath = str | os.PathLike[str]
Campaign = FilePath | Mapping[str, Any]


def measure(
    campaign: Campaign,
    /,
    *,
    output: FilePath | None = None,
    threads: int = 0,
    memory_mb: int | None = None,
    resume: bool = False,
    force: bool = False,
    keep_realisations: bool = False,
    progress: Progress = True,
    **overrides: Any,
) -> "Measurement":
    """Measures a campaign of one table.

    ``campaign`` is a file (a path, or a string without line breaks and ``=``), TOML text, or a dictionary of the same
    keys. ``overrides`` are keys of the campaign that are set besides: tables are joined key by key, dotted names are
    tables, and None takes a key away::

        gonio.measure("gold.toml", seed=2, surface={"ggx": {"alpha": 0.2}})
        gonio.measure("gold.toml", **{"surface.ggx.alpha": 0.2, "stop.samples": 65_536})

    ``output`` is the folder of the files, the same bytes as ``gonio measure -o`` writes; without one they live as long as
    the measurement. ``threads`` 0 is one a core; results do not depend on it. ``memory_mb``: MiB that may be used.
    ``resume``, ``force`` and ``keep_realisations`` are the command's options. ``progress``: a bar in terminals and
    notebooks, or a function of the samples done and of all.

    Python's other threads go on meanwhile. Ctrl-C ends the measurement within a second; with ``output``,
    ``resume=True`` goes on from there to the same bytes.

    Raises ``CampaignError`` with all faults of the campaign, ``RefusedError`` where it would not fit memory or time,
    ``FileError`` where something else lies in the folder, ``UsageError`` where the campaign has several tables.
    """
    options = _options(threads, memory_mb, resume, force, keep_realisations)
    return _measured(campaign, overrides, output, progress, {**options, "several": False})[0]


def measure_all(
    campaign: Campaign,
    /,
    *,
    output: FilePath | None = None,
    threads: int = 0,
    memory_mb: int | None = None,
    resume: bool = False,
    force: bool = False,
    keep_realisations: bool = False,
    progress: Progress = True,
    **overrides: Any,
) -> list["Measurement"]:
    """Measures a campaign of several tables: one for each roughness, material or side. Arguments as of ``measure``."""
    options = _options(threads, memory_mb, resume, force, keep_realisations)
    return _measured(campaign, overrides, output, progress, {**options, "several": True})


def budget(campaign: Campaign, /, **overrides: Any) -> dict[str, Any]:
    """The uncertainty budget of a campaign with ``[uncertainty]``, as ``gonio budget --json``.

    ``campaign`` and ``overrides`` as of ``measure``. ``values``: for each pair of directions and colour the value, ``u``,
    ``nu_eff``, ``k`` and ``U`` at 95 %, in 1/sr, and its components; ``covariance`` of all values, 1/sr^2; ``check``: the
    comparison with Monte Carlo; ``left_out``.

    Raises ``UsageError`` where the campaign says nothing of its instrument's uncertainty, and as ``measure``.
    """
    found: dict[str, Any] = json.loads(finished(_gonio.Task.budget(_source(campaign, overrides))))
    return found


def load(path: FilePath) -> "Measurement":
    """A table from its file, ``<name>.exr``, with the realisations and the summary that lie next to it.

    Raises ``FileError`` where it is no table, or is damaged.
    """
    measurement = Measurement(Path(path))
    # Read at once, so that a damaged file is told here.
    _ = measurement.dataset
    return measurement


def _options(threads: int, memory_mb: int | None, resume: bool, force: bool, keep: bool) -> dict[str, Any]:
    options = {"threads": threads, "memory_mb": memory_mb, "resume": resume, "force": force}
    return {**options, "keep_realisations": keep}


def _measured(
    campaign: Campaign,
    overrides: Mapping[str, Any],
    output: FilePath | None,
    progress: Progress,
    options: dict[str, Any],
) -> list["Measurement"]:
    source = _source(campaign, overrides)
    keep = tempfile.TemporaryDirectory(prefix="gonio-", ignore_cleanup_errors=True) if output is None else None
    folder = keep.name if keep else output
    task = _gonio.Task.measure(source, {**options, "output": folder})
    return [Measurement(Path(path), keep) for path in json.loads(finished(task, progress))]


def _source(campaign: Campaign, overrides: Mapping[str, Any]) -> dict[str, Any]:
    keys = _document(overrides)
    if isinstance(campaign, Mapping):
        return {"path": None, "text": "", "keys": _json(_joined(_document(campaign), keys))}
    further = _json(keys) if keys else None
    if isinstance(campaign, str) and ("\n" in campaign or "=" in campaign):
        return {"path": None, "text": campaign, "keys": further}
    return {"path": os.fspath(campaign), "text": "", "keys": further}


def _document(keys: Mapping[str, Any]) -> dict[str, Any]:
    """The keys with dotted names as tables."""
    document: dict[str, Any] = {}
    for name, value in keys.items():
        for part in reversed(str(name).split(".")[1:]):
            value = {part: value}
        document = _joined(document, {str(name).split(".")[0]: value})
    return document


def _joined(table: Mapping[str, Any], keys: Mapping[str, Any]) -> dict[str, Any]:
    joined = dict(table)
    for name, value in keys.items():
        below = joined.get(name)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = _joined(below, value)
        joined[name] = value
    return joined


def _json(document: Mapping[str, Any]) -> str:
    def plain(value: Any) -> Any:
        # NumPy's numbers and arrays.
        return value.tolist() if hasattr(value, "tolist") else os.fspath(value)

    return json.dumps(document, default=plain)


class Measurement:
    """A measured table, with the files that lie next to it.

    ``path`` is the table, ``<name>.exr``.
    """

    def __init__(self, path: Path, keep: "tempfile.TemporaryDirectory[str] | None" = None) -> None:
        self.path = path
        self._keep = keep

    @cached_property
    def summary(self) -> dict[str, Any] | None:
        """What ``measure`` says of the table (albedos, verdicts, cost), as in ``<name>.json``; None where it is absent."""
        beside = self.path.with_suffix(".json")
        if not beside.is_file():
            return None
        document: dict[str, Any] = json.loads(beside.read_text("utf-8"))
        return document

    @cached_property
    def dataset(self) -> "xarray.Dataset":
        """The table.

        Dimensions ``theta_i, phi_i, theta_r, phi_r, wavelength`` for bins between edges and for arms; ``incidence`` for
        light that is a list, ``patch`` for Klems patches, ``direction`` for lists of directions; ``theta_h, phi_h,
        theta_d, phi_d`` for half/difference angles. Angles in degrees, at the middle of a bin, whose edges are
        ``theta_r_edges`` and ``phi_r_edges``; light that has gone through has theta_r beyond 90. ``wavelength`` in nm
        where the table is spectral; else ``colour`` names Y, or R, G and B.

        ``brdf``, ``single`` (one bounce) and ``multiple`` in 1/sr without cosine, means over a bin by projected solid
        angle, which is ``projected_solid_angle`` in sr; ``brdf_stderr`` and ``single_stderr``, the standard error of
        the mean over the realisations, NaN where it is not known; ``hits``; ``albedo`` and ``transmittance`` with their
        errors; ``realisation_brdf`` of each realisation or group of them; ``mueller`` where it was asked for.
        """
        from ._dataset import dataset

        return dataset(self.path)

    def theory(self, masking: str = "height_correlated") -> "xarray.DataArray":
        """Means of the surface's own model over the same bins, 1/sr, of the shape of ``dataset.single``.

        Raises ``UsageError`` where theory has no such model.
        """
        from ._dataset import theory

        return theory(self.path, self.dataset, masking)

    def validate(self) -> dict[str, Any]:
        """The table against the laws and the models: ``ok``, ``failures``, ``comparisons``, as ``gonio validate --json``."""
        return self._answer("validate", self.path)

    def fit(self, model: str | None = None) -> dict[str, Any]:
        """Analytic models fitted to the table, best first, as ``gonio fit --json``; ``model``: one of them alone."""
        return self._answer("fit", self.path, *(["--model", model] if model else []))

    def appearance(self) -> dict[str, Any]:
        """Gloss, haze, scatter, reflectance and colour by azimuth of the light, as ``gonio appearance --json``."""
        return self._answer("appearance", self.path)

    def export(
        self,
        path: FilePath,
        to: str,
        *,
        force: bool = False,
        merl_centre: bool = False,
        wavelengths_nm: Sequence[float] = (),
        klems: str | None = None,
        side: str | None = None,
        back: "Measurement | FilePath | None" = None,
        allow_albedo_error: float | None = None,
    ) -> dict[str, Any]:
        """Writes the table in another program's format and says how far the file is from it, as ``gonio export --json``.

        ``to``: npz npy csv merl rgl utia exr_parts klems tensor_tree zemax astm ssdd pabopto
        openmaterial bird fred speos. Options are the command's.
        """
        words: list[Any] = ["--to", to, "-o", path]
        words += ["--force"] if force else []
        words += ["--merl-centre"] if merl_centre else []
        words += ["--wavelengths-nm", ",".join(map(str, wavelengths_nm))] if len(wavelengths_nm) else []
        words += ["--klems", klems] if klems else []
        words += ["--side", side] if side else []
        words += ["--back", back.path if isinstance(back, Measurement) else back] if back is not None else []
        words += [] if allow_albedo_error is None else ["--allow-albedo-error", str(allow_albedo_error)]
        return self._answer("export", self.path, *words)

    def report(self, path: FilePath | None = None, *, force: bool = False) -> Path:
        """Makes the page of the table, one HTML file that needs no network, and returns its path.

        Without ``path`` it is the page next to the table; a name that ends in ``.md`` gives the provenance card.
        """
        page = self.path.with_suffix(".html") if path is None else Path(path)
        self._command("report", self.path, "-o", page, *(["--force"] if force else []))
        return page

    def save(self, folder: FilePath, *, force: bool = False) -> "Measurement":
        """Copies the table and what lies next to it to a folder. Raises ``FileError`` where something is there already."""
        stem = self.path.name[: -len(self.path.suffix)]
        names = [f"{stem}{end}" for end in (".exr", ".realisations.exr", ".html", ".card.md", ".json")]
        there = [Path(folder, name) for name in names if Path(folder, name).exists()]
        if there and not force:
            raise FileError(f"{there[0]}: is there already; force=True replaces it")
        Path(folder).mkdir(parents=True, exist_ok=True)
        # The summary last: where it is, the table is whole.
        for name in names:
            if (self.path.parent / name).is_file():
                shutil.copyfile(self.path.parent / name, Path(folder, name))
        return Measurement(Path(folder, f"{stem}.exr"))

    def _answer(self, *words: Any) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(self._command(*words, "--json"))
        return answer

    def _command(self, *words: Any) -> str:
        return finished(_gonio.Task.command(["gonio", *words]))

    def __repr__(self) -> str:
        return f"<gonio.Measurement {self.path}>"

    def _repr_html_(self) -> str:
        from ._html import html

        return html(self)
