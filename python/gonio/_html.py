"""A measurement as a notebook shows it."""

from html import escape
from typing import TYPE_CHECKING, Any

from . import _gonio

if TYPE_CHECKING:
    from .measurement import Measurement

_STYLE = """<style>.gonio svg { max-width: 480px; background: #fff; font: 14px sans-serif; fill: #1a1a1a; }
.gonio .grid { stroke: #ddd; } .gonio .frame { fill: none; stroke: #333; } .gonio .band { opacity: .16; }
.gonio .open { fill: #fff; fill-opacity: .7; stroke-width: 1.5; }
.gonio .halo { paint-order: stroke; stroke: #fff; stroke-width: 4px; }</style>"""
# Rows of a table beyond which the rest is left out.
_MOST_ROWS = 12


def html(measurement: "Measurement") -> str:
    """The lobes in the plane of incidence, and the albedos; nothing is asked over the network."""
    picture = _gonio.picture(measurement.path) or ""
    summary = measurement.summary or {}
    name = escape(str(summary.get("name", measurement.path.stem)))
    parts = [f"<b>{name}</b>{_verdict(summary)}", picture, _albedos(summary)]
    return f"{_STYLE}<div class='gonio'>{''.join(parts)}</div>"


def _verdict(summary: dict[str, Any]) -> str:
    verdict = summary.get("verdict")
    return f", verdict: {escape(str(verdict))}" if isinstance(verdict, str) else ""


def _albedos(summary: dict[str, Any]) -> str:
    stops = summary.get("stops") or []
    if not stops:
        return ""

    def cell(value: float | None, error: float | None) -> str:
        known = "" if value is None else f"{value:.5f}"
        return f"<td>{known}{'' if error is None else f' ± {error:.5f}'}</td>"

    def row(stop: dict[str, Any]) -> str:
        angles = f"<td>{stop['theta_i_deg']:g}°</td><td>{stop['phi_i_deg']:g}°</td>"
        single = cell(stop.get("albedo_single"), stop.get("albedo_single_se"))
        return f"<tr>{angles}{single}{cell(stop.get('albedo_total'), stop.get('albedo_total_se'))}</tr>"

    heads = "<tr><th>theta_i</th><th>phi_i</th><th>albedo, one bounce</th><th>all</th></tr>"
    rows = "".join(map(row, stops[:_MOST_ROWS]))
    rest = f"<p>{len(stops) - _MOST_ROWS} further incidences</p>" if len(stops) > _MOST_ROWS else ""
    return f"<table>{heads}{rows}</table>{rest}"
