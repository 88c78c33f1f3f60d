"""Formulas of microfacet theory over NumPy arrays: D, Lambda, G1, G2, F, BRDFs and their means over bins.

    surface = gonio.models.Surface(alpha=0.3)
    surface.brdf(30, 0, theta_r, 180, f0=0.9)

Angles in degrees; polar angles from the normal, azimuths from x. All arguments are broadcast against each other, those
of the surface too; ``xarray.DataArray`` are joined by their dimensions. BRDFs in 1/sr without cosine. What a formula is
not defined for is a ``ValueError`` that names the argument and its domain.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _gonio

__all__ = ["Surface", "fresnel"]


@dataclass(frozen=True)
class Surface:
    """A rough surface.

    ``alpha``, or ``alpha_x`` and ``alpha_y``: slope scales, above 0. ``law`` of the normals: ``ggx``, ``beckmann``,
    ``student_t`` with ``gamma`` >= 2, ``blinn_phong`` (alpha up to 1), or ``grains`` with ``coverage`` between 0 and 1.
    ``rotation`` turns the sample counter-clockwise, degrees.
    """

    alpha: npt.ArrayLike | None = None
    alpha_x: npt.ArrayLike | None = None
    alpha_y: npt.ArrayLike | None = None
    law: str = "ggx"
    gamma: npt.ArrayLike | None = None
    coverage: npt.ArrayLike | None = None
    rotation: npt.ArrayLike = 0.0

    def ndf(self, theta_h: npt.ArrayLike, phi_h: npt.ArrayLike = 0.0) -> Any:
        """D of the normal (theta_h, phi_h), 1/sr; its integral with the cosine is 1 (of grains the coverage)."""
        return self._evaluate("ndf", [theta_h, phi_h])

    def smith_lambda(self, theta: npt.ArrayLike, phi: npt.ArrayLike = 0.0) -> Any:
        """Smith's Lambda of an arm, [0, inf]; infinite at 90 degrees."""
        return self._evaluate("smith_lambda", [theta, phi])

    def g1(self, theta: npt.ArrayLike, phi: npt.ArrayLike = 0.0) -> Any:
        """Smith's masking of an arm, 1/(1 + Lambda), [0, 1]."""
        return self._evaluate("g1", [theta, phi])

    def g2(
        self,
        theta_i: npt.ArrayLike,
        phi_i: npt.ArrayLike,
        theta_r: npt.ArrayLike,
        phi_r: npt.ArrayLike,
        *,
        masking: str | None = None,
    ) -> Any:
        """Masking of both arms, [0, 1].

        ``masking``: ``none``, ``separable``, ``height_correlated``, ``direction_correlated``; of grains also ``grains``
        and ``grains_product``. Without one the height-correlated, of grains their own.
        """
        return self._evaluate("g2", [theta_i, phi_i, theta_r, phi_r], masking)

    def brdf(
        self,
        theta_i: npt.ArrayLike,
        phi_i: npt.ArrayLike,
        theta_r: npt.ArrayLike,
        phi_r: npt.ArrayLike,
        *,
        masking: str | None = None,
        f0: npt.ArrayLike | None = None,
        eta: npt.ArrayLike | None = None,
        k: npt.ArrayLike | None = None,
        polarisation: str = "none",
    ) -> Any:
        """D G2 F/(4 cos_i cos_r) of light reflected once, 1/sr; the material as of ``fresnel``, the masking as of ``g2``."""
        material = _material(f0, eta, k)
        return self._evaluate("brdf", [theta_i, phi_i, theta_r, phi_r], masking, material, polarisation)

    def btdf(
        self,
        theta_i: npt.ArrayLike,
        phi_i: npt.ArrayLike,
        theta_r: npt.ArrayLike,
        phi_r: npt.ArrayLike,
        *,
        eta: npt.ArrayLike,
        masking: str | None = None,
    ) -> Any:
        """Light that has gone through, theta_r from 90 to 180, 1/sr: flux by |cos_r|, without the factor eta^2 of radiance.

        ``eta``: the index beyond over the index on the light's side.
        """
        return self._evaluate("btdf", [theta_i, phi_i, theta_r, phi_r], masking, ("eta", eta, None))

    def diffuse(
        self,
        theta_i: npt.ArrayLike,
        phi_i: npt.ArrayLike,
        theta_r: npt.ArrayLike,
        phi_r: npt.ArrayLike,
        *,
        albedo: npt.ArrayLike = 1.0,
        masking: str | None = None,
    ) -> Any:
        """Matt facets of this albedo, one bounce, 1/sr. About 30 us a value."""
        return self._evaluate("diffuse", [theta_i, phi_i, theta_r, phi_r], masking, ("albedo", albedo, None))

    def bin_means(
        self,
        theta_i: npt.ArrayLike,
        phi_i: npt.ArrayLike,
        theta_r_edges: npt.ArrayLike,
        phi_r_edges: npt.ArrayLike,
        *,
        masking: str | None = None,
        f0: npt.ArrayLike | None = None,
        eta: npt.ArrayLike | None = None,
        k: npt.ArrayLike | None = None,
        polarisation: str = "none",
    ) -> Any:
        """Means of ``brdf`` (beyond 90 degrees of ``btdf``) over bins by projected solid angle, 1/sr.

        ``theta_r_edges`` and ``phi_r_edges``: increasing, of n + 1 and m + 1 edges. The result has the shape of theta_i
        and phi_i, then (n, m). To 1e-6 of a bin.
        """
        theta, phi = np.asarray(theta_r_edges, float), np.asarray(phi_r_edges, float)
        if theta.ndim != 1 or phi.ndim != 1 or len(theta) < 2 or len(phi) < 2:
            raise ValueError("theta_r_edges and phi_r_edges: lists of at least two edges")
        light = [np.asarray(angle, float)[..., None, None] for angle in (theta_i, phi_i)]
        rows, columns = theta[:, None], phi
        bins = [rows[:-1], rows[1:], columns[:-1], columns[1:]]
        return self._evaluate("bin_mean", [*light, *bins], masking, _material(f0, eta, k), polarisation, 2)

    def _evaluate(
        self,
        quantity: str,
        angles: list[Any],
        masking: str | None = None,
        material: tuple[str, Any, Any] = ("perfect", None, None),
        polarisation: str = "none",
        further: int = 0,
    ) -> Any:
        own = "grains" if self.law == "grains" and quantity in ("g2", "brdf", "bin_mean") else "height_correlated"
        shape = self.coverage if self.law == "grains" else self.gamma
        constants = [*self._alphas(), shape, self.rotation, *material[1:]]
        if further:
            constants = [None if c is None else np.asarray(c, float)[(..., *[None] * further)] for c in constants]
        choices = [self.law, masking or own, material[0], polarisation]
        return _over(quantity, choices, [*constants, *angles])

    def _alphas(self) -> tuple[Any, Any]:
        if self.alpha is None and self.alpha_x is not None and self.alpha_y is not None:
            return self.alpha_x, self.alpha_y
        if self.alpha is not None and self.alpha_x is None and self.alpha_y is None:
            return self.alpha, self.alpha
        raise ValueError("alpha, or alpha_x and alpha_y, are needed")


def fresnel(
    theta_d: npt.ArrayLike,
    *,
    f0: npt.ArrayLike | None = None,
    eta: npt.ArrayLike | None = None,
    k: npt.ArrayLike | None = None,
    polarisation: str = "none",
) -> Any:
    """Reflectance of a facet at the angle ``theta_d`` to its normal, [0, 1].

    ``f0``: Schlick's formula; ``eta``: a clear medium; ``eta`` and ``k``: a metal; none of them: a perfect mirror. Indices
    are relative to the outer medium. ``polarisation``: ``none``, ``s`` (field across the plane of incidence) or ``p``.
    """
    material = _material(f0, eta, k)
    choices = ["ggx", "height_correlated", material[0], polarisation]
    return _over("fresnel", choices, [1.0, 1.0, None, 0.0, *material[1:], theta_d])


def _material(f0: Any, eta: Any, k: Any) -> tuple[str, Any, Any]:
    if f0 is not None and eta is None and k is None:
        return "f0", f0, None
    if f0 is None and eta is not None:
        return ("eta", eta, None) if k is None else ("eta_k", eta, k)
    if f0 is None and k is None:
        return "perfect", None, None
    raise ValueError("f0, or eta, or eta and k: one material")


def _over(quantity: str, choices: list[str], columns: list[Any]) -> Any:
    columns = [np.nan if column is None else column for column in columns]

    def values(*columns: Any) -> Any:
        arrays = np.broadcast_arrays(*(np.asarray(column, float) for column in columns))
        answer = _gonio.evaluate(quantity, choices, [array.tobytes() for array in arrays])
        return np.frombuffer(answer).reshape(arrays[0].shape)[()].copy()

    if any(hasattr(column, "dims") for column in columns):
        import xarray as xr

        return xr.apply_ufunc(values, *columns)
    return values(*columns)
