"""Promises: a table is a dataset with dimensions, edges, units and errors; its sums are the summary's; it goes through
netCDF and comes back; every geometry that the program knows has its shape."""

import json
import subprocess

import gonio
import numpy as np
import pytest
import xarray as xr
from conftest import CAMPAIGN, ROOT

QUICK = {"surface.cells": 32, "surface.realisations": 2, "stop.samples": 4096}


def test_dimensions_and_coordinates(small):
    table = small.dataset
    assert table.brdf.dims == ("theta_i", "phi_i", "theta_r", "phi_r", "wavelength")
    # Centred bins: one row more than asked for, the first and the last half as wide; gold as R, G and B.
    assert dict(table.sizes) == {
        "theta_i": 2,
        "phi_i": 1,
        "theta_r": 10,
        "phi_r": 18,
        "wavelength": 3,
        "edge": 2,
        "realisation": 4,
    }
    assert table.theta_r_edges.values[:2].tolist() == [[0, 5], [5, 15]]
    assert table.theta_r.values[:2].tolist() == [2.5, 10]
    assert table.phi_r.values[:2].tolist() == [0, 20] and table.phi_r.attrs["units"] == "degree"
    assert table.colour.values.tolist() == ["R", "G", "B"]
    assert table.brdf.attrs["units"] == "sr-1" and "1/sr" in table.attrs["convention"]
    assert table.attrs["phi_r"] == "counts from the light's azimuth" and table.attrs["seed"] == "3"


def test_sums_over_bins_are_the_albedo_of_the_summary(small):
    table, stops = small.dataset, small.summary["stops"]
    # The whole hemisphere; 10 rows and 18 columns, each right to a few ulp.
    assert abs(float(table.projected_solid_angle.sum()) - np.pi) < 180 * 4 * np.finfo(float).eps
    mean = table.albedo.mean("wavelength").values[:, 0]
    expected = np.array([stop["albedo_total"] for stop in stops])
    # Positive values in f32, each off by half an ulp: the sum by 2^-24 of itself; the mean of four patches likewise.
    assert np.abs(mean / expected - 1).max() < 2**-22
    by_hand = (table.brdf * table.projected_solid_angle).sum(["theta_r", "phi_r"])
    assert np.allclose(by_hand, table.albedo, rtol=2**-20, atol=0)


def test_errors_are_those_of_the_realisations(small):
    table = small.dataset
    parts = table.realisation_brdf.astype(float)
    assert np.allclose(parts.mean("realisation"), table.brdf, rtol=2**-23, atol=0)
    lit = table.hits > 0
    error = (parts.std("realisation", ddof=1) / 2).where(lit)
    # s/sqrt(4), rounded to f32; by another sum: the spread is a difference of numbers that are up to 100 times larger.
    assert np.allclose(error, table.brdf_stderr.where(lit), rtol=1e-5, atol=1e-9, equal_nan=True)
    assert int(table.hits.sum()) > 50_000 and (table.brdf_stderr > 0).all()


def test_one_realisation_has_no_errors():
    table = gonio.measure(CAMPAIGN, progress=False, **{**QUICK, "surface.realisations": 1}).dataset
    assert bool(np.isnan(table.brdf_stderr).all()) and "albedo_stderr" not in table


@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_netcdf_comes_back(small, tmp_path, engine):
    pytest.importorskip(engine)
    path = tmp_path / "table.nc"
    small.dataset.to_netcdf(path, engine=engine)
    with xr.open_dataset(path, engine=engine) as found:
        xr.testing.assert_equal(found.load(), small.dataset)
        assert found.brdf.attrs == small.dataset.brdf.attrs
        assert found.attrs["campaign"] == small.dataset.attrs["campaign"]


def test_the_models_means_have_the_tables_shape(small):
    model, table = small.theory(), small.dataset
    assert model.dims == table.single.dims and model.shape == table.single.shape
    # The measured flux of a surface of alpha 0.3 is within some per cent of the formula's; 5 % is several times its noise.
    flux = (model * table.projected_solid_angle).sum(["theta_r", "phi_r"])
    single = (table.single * table.projected_solid_angle).sum(["theta_r", "phi_r"])
    assert np.abs(flux / single - 1).max() < 0.05
    with pytest.raises(gonio.UsageError, match="height_correlated"):
        small.theory("nothing")


GEOMETRIES = {
    "arm": (
        {"sensor": {"hemisphere": None, "arm": {"theta_r_deg": [-60, 0, 60], "aperture_deg": 5.0}}},
        {"theta_i": 2, "phi_i": 1, "theta_r": 3, "phi_r": 1, "wavelength": 3},
    ),
    "klems": (
        {
            "light": None,
            "preset": {"name": "klems_full"},
            "sensor": None,
            "surface.realisations": 1,
            "trace.visibility": False,
        },
        {"incidence": 145, "patch": 145, "wavelength": 3},
    ),
    "azimuths": (
        {"light": {"azimuth": "absolute", "phi_i_deg": [0, 90]}},
        {"theta_i": 2, "phi_i": 2, "theta_r": 10, "phi_r": 18, "wavelength": 3},
    ),
    "spectrum": (
        {"optics": {"wavelength_nm": [450, 550, 650, 750], "fresnel": "exact"}},
        {"theta_i": 2, "phi_i": 1, "theta_r": 10, "phi_r": 18, "wavelength": 4},
    ),
    "mueller": (
        {"optics": {"polarisation": "mueller", "wavelength_nm": [550], "fresnel": "exact"}},
        {"theta_i": 2, "phi_i": 1, "theta_r": 10, "phi_r": 18, "wavelength": 1},
    ),
    "both_sides": (
        {"optics": {"material": None, "facet": "dielectric", "eta": 1.5}, "sensor.hemisphere.side": "both"},
        {"theta_i": 2, "phi_i": 1, "theta_r": 20, "phi_r": 18, "wavelength": 1},
    ),
}


@pytest.mark.parametrize("name", GEOMETRIES)
def test_every_geometry_has_its_shape(name):
    keys, shape = GEOMETRIES[name]
    measurement = gonio.measure(CAMPAIGN, progress=False, **{**QUICK, **keys})
    table = measurement.dataset
    assert dict(zip(table.brdf.dims, table.brdf.shape)) == shape
    assert float(table.brdf.max()) > 0 and table.brdf.dims[-1] == "wavelength"
    if name == "spectrum":
        assert table.wavelength.values.tolist() == [450, 550, 650, 750] and table.wavelength.attrs["units"] == "nm"
    if name == "mueller":
        assert table.mueller.dims[-2:] == ("row", "column") and table.mueller.shape[-2:] == (4, 4)
        # Columns and rows of the matrix: what comes unpolarised leaves with at most as much polarised light.
        polarised = np.sqrt((table.mueller.isel(column=0, row=slice(1, 4)) ** 2).sum("row"))
        assert bool((polarised <= table.mueller.isel(row=0, column=0) * (1 + 1e-5)).all())
    if name == "both_sides":
        stops = measurement.summary["stops"]
        for key in ("albedo", "transmittance"):
            found = table[key].values.ravel()
            # As in the test of albedos.
            assert np.abs(found / [stop[f"{key}_total"] for stop in stops] - 1).max() < 2**-22, key
    assert name == "klems" or "svg" in measurement._repr_html_()


def imported(binary, path, kind):
    """The dataset of another program's file."""
    table = path.with_name(f"{kind}.exr")
    subprocess.run([binary, "import", path, "--from", kind, "-o", table], check=True, capture_output=True)
    return gonio.load(table).dataset


def test_foreign_tables_have_angles_of_their_own(binary, small, tmp_path):
    small.export(tmp_path / "a.binary", "merl", allow_albedo_error=5)
    merl = imported(binary, tmp_path / "a.binary", "merl")
    assert merl.brdf.dims == ("theta_h", "phi_h", "theta_d", "phi_d", "wavelength")
    assert merl.brdf.shape == (90, 1, 90, 180, 3)
    (tmp_path / "b.ssdd").write_bytes((ROOT / "tests/data/ssdd_comments.ssdd").read_bytes())
    ssdd = imported(binary, tmp_path / "b.ssdd", "ssdd")
    assert ssdd.brdf.dims == ("theta_i", "phi_i", "direction", "wavelength")
    # The file's first block: theta_r 0, phi_r 0 under its three incidences.
    at_first = ssdd.brdf.isel(direction=0, wavelength=0, phi_i=0)
    assert np.allclose(at_first, [0.8841941282883075, 0.3602185253606872, 0.1336132025623553], rtol=2**-24, atol=0)
    assert ssdd.theta_r[0] == ssdd.phi_r[0] == 0 and ssdd.theta_i.values.tolist() == [0, 30, 60]


def test_what_was_not_measured_is_no_number(binary, tmp_path):
    axes = {"theta_i_deg": [0.0], "phi_i_deg": [0.0], "theta_r_edges_deg": [0.0, 45.0, 90.0]}
    brdf = np.array([0.1, 0.2, 0.3, 0.4], np.float32).reshape(1, 1, 2, 2)
    stderr = np.array([0.01, -1, -2, 0.04], np.float32).reshape(1, 1, 2, 2)
    np.savez(tmp_path / "a.npz", brdf=brdf, stderr=stderr, phi_r_edges_deg=[0.0, 180.0, 360.0], **axes)
    table = imported(binary, tmp_path / "a.npz", "npz")
    assert np.isnan(table.brdf.values.ravel()).tolist() == [False, False, True, False]
    assert np.isnan(table.brdf_stderr.values.ravel()).tolist() == [False, True, True, False]
    assert bool(np.isnan(table.albedo).all())


def test_a_notebook_shows_lobes_and_figures_without_a_network(small):
    html = small._repr_html_()
    assert "<svg" in html and "theta_i" in html and len(html) < 50_000
    assert "http:" not in html and "https:" not in html and "<script" not in html
    albedo = small.summary["stops"][0]["albedo_total"]
    assert f"{albedo:.5f}" in html


def test_summaries_are_the_files(small):
    assert small.summary == json.loads(small.path.with_suffix(".json").read_text())
    assert (ROOT / "configs/quickstart.toml").is_file()
