"""Promises: the formulas over arrays are the program's own, to the digits of their references; arguments are broadcast;
what a formula is not defined for is a ValueError that names it."""

import csv
import re

import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from gonio import models

EPSILON = np.finfo(float).eps


def rows(name):
    with open(ROOT / "tests/data" / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def reference(quantity, fresnel=""):
    """The rows by angles of a quantity, whose arms do not lie in the horizon, and what a value may be off, relative."""
    wanted = ("angle", quantity, fresnel)
    found = [row for row in rows("reference_values.csv") if (row["kind"], row["quantity"], row["fresnel"]) == wanted]
    found = [row for row in found if "90" not in (row["theta_i_deg"], row["theta_o_deg"])]
    assert len(found) > 50
    # tol_f64 = 2^-52 (16 + 4 cond), as the program's own test has it; without a condition number 64 ulp.
    tolerance = np.array([float(row["tol_f64"] or 64 * EPSILON) for row in found])
    return found, column(found, "value"), tolerance


def surface(rows, **other):
    return models.Surface(alpha_x=column(rows, "alpha_x"), alpha_y=column(rows, "alpha_y"), **other)


def arms(rows):
    names = ("theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg")
    return [column(rows, name) for name in names]


def assert_met(found, expected, tolerance):
    # Values that are 0 by nature are held to 1e-15.
    allowed = np.where(np.abs(expected) < 1e-30, 1e-15, tolerance * np.abs(expected))
    assert found.shape == expected.shape and (np.abs(found - expected) <= allowed).all()


def test_distribution_and_masking_meet_sixty_digits():
    found, expected, tolerance = reference("D")
    angles = column(found, "theta_h_deg"), column(found, "phi_h_deg")
    assert_met(surface(found).ndf(*angles), expected, tolerance)
    for quantity, of in (("Lambda", models.Surface.smith_lambda), ("G1", models.Surface.g1)):
        found, expected, tolerance = reference(quantity)
        angles = column(found, "theta_i_deg"), column(found, "phi_i_deg")
        assert_met(of(surface(found), *angles), expected, tolerance)
    for quantity, masking in (("G2_sep", "separable"), ("G2_corr", "height_correlated")):
        found, expected, tolerance = reference(quantity)
        assert_met(surface(found).g2(*arms(found), masking=masking), expected, tolerance)


@pytest.mark.parametrize("fresnel", ["one", "schlick", "dielectric", "conductor"])
@pytest.mark.parametrize("masking", ["separable", "height_correlated"])
def test_brdfs_meet_sixty_digits(fresnel, masking):
    found, expected, tolerance = reference("brdf_sep" if masking == "separable" else "brdf_corr", fresnel)
    names = {"one": [], "schlick": ["f0"], "dielectric": ["eta"], "conductor": ["eta", "k"]}[fresnel]
    material = {name: column(found, name) for name in names}
    assert_met(surface(found).brdf(*arms(found), masking=masking, **material), expected, tolerance)


@pytest.mark.parametrize("quantity", ["F_schlick", "F_diel", "F_diel_s", "F_diel_p", "F_cond", "F_cond_s", "F_cond_p"])
def test_fresnel_meets_sixty_digits(quantity):
    found, expected, tolerance = reference(quantity)
    names = {"schlick": ["f0"], "diel": ["eta"], "cond": ["eta", "k"]}[quantity.split("_")[1]]
    material = {name: column(found, name) for name in names}
    polarisation = quantity[-1] if quantity.endswith(("_s", "_p")) else "none"
    assert_met(models.fresnel(column(found, "theta_i_deg"), polarisation=polarisation, **material), expected, tolerance)


def test_matt_facets_and_grains_meet_their_references():
    for law in ("ggx", "beckmann"):
        found = [row for row in rows("diffuse_values.csv") if row["model"] == law]
        value = column(found, "value")
        # Rows hold the integral over the facets alone; the BRDF is 4 V/pi of it, V = G2/(4 cos_i cos_o). 5e-6: the rule's.
        of = surface(found, law=law)
        cosines = np.cos(np.radians(column(found, "theta_i_deg"))) * np.cos(np.radians(column(found, "theta_o_deg")))
        expected = of.g2(*arms(found), masking="separable") / (np.pi * cosines) * value
        assert np.allclose(of.diffuse(*arms(found), masking="separable"), expected, rtol=5e-6, atol=0)
    found = rows("grains_digits.csv")
    names = ("theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg")
    of = surface(found, law="grains", coverage=column(found, "coverage"))
    value = of.brdf(*(column(found, name) for name in names))
    # As in the program's own test, 1e-13 times the slopes of arms and facets, in its canonical frame.
    alpha = np.stack([of.alpha_x, of.alpha_y])
    lowest = np.cos(np.radians(np.maximum(column(found, names[0]), column(found, names[2]))))
    tolerance = 1e-13 * (1 + alpha.max(0) / lowest) / np.minimum(alpha.min(0), 1)
    assert_met(value, column(found, "f"), tolerance)


def test_closed_forms():
    theta, alpha = np.linspace(0, 89, 90)[:, None], np.array([0.05, 0.3, 1.0])
    cos, tan2 = np.cos(np.radians(theta)), np.tan(np.radians(theta)) ** 2
    # Beckmann: exp(-tan^2/alpha^2)/(pi alpha^2 cos^4); the exponent's rounding grows with it, up to 745.
    expected = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * cos**4)
    assert np.allclose(models.Surface(alpha=alpha, law="beckmann").ndf(theta), expected, rtol=1e-10, atol=1e-300)
    # Student's t with gamma = 2 is GGX: a dozen roundings of either form.
    ggx, student = models.Surface(alpha=alpha), models.Surface(alpha=alpha, law="student_t", gamma=2.0)
    assert np.allclose(ggx.ndf(theta), student.ndf(theta), rtol=12 * EPSILON, atol=0)
    # 2/(1 + sqrt(1 + alpha^2 tan^2)): a dozen roundings, tan^2 by NumPy among them.
    assert np.allclose(ggx.g1(theta), 2 / (1 + np.sqrt(1 + alpha**2 * tan2)), rtol=1e-13, atol=0)


def test_bin_means_add_up_to_the_directional_albedo():
    found = [row for row in rows("reference_albedo.csv") if float(row["theta_o_deg"]) < 89]
    found = [row for row in found if row["alpha_x"] == row["alpha_y"] and float(row["alpha_x"]) >= 0.2][:12]
    theta, phi = np.linspace(0, 90, 19), np.linspace(0, 360, 19)
    size = np.diff(np.sin(np.radians(theta)) ** 2)[:, None] / 2 * np.diff(np.radians(phi))
    light = column(found, "theta_o_deg"), column(found, "phi_o_deg")
    for masking, name in (("separable", "E_sep_F1"), ("height_correlated", "E_corr_F1")):
        means = surface(found).bin_means(*light, theta, phi, masking=masking)
        assert means.shape == (len(found), 18, 18)
        # Bins to 1e-6; the reference to 13 digits.
        assert np.allclose((means * size).sum((1, 2)), column(found, name), rtol=1e-6, atol=0)


def test_light_that_goes_through_meets_its_reference():
    found = [row for row in rows("transmission_means.csv") if row["kind"] == "mean" and row["ndf"] == "ggx"][::10]
    for row in found:
        number = {name: float(row[name]) for name in ("alpha_x", "alpha_y", "eta", *(f"p{k}" for k in range(1, 7)))}
        of = models.Surface(alpha_x=number["alpha_x"], alpha_y=number["alpha_y"])
        light, theta, phi = (number["p1"], number["p2"]), (number["p3"], number["p4"]), (number["p5"], number["p6"])
        value = of.bin_means(*light, theta, phi, eta=number["eta"])
        # Of the bin's flux, to 1e-6, or of the light's, to 1e-9.
        assert value.shape == (1, 1) and np.isclose(value[0, 0], float(row["height_correlated"]), rtol=2e-6, atol=1e-8)


def test_shapes_are_broadcast_and_labels_joined():
    of = models.Surface(alpha=np.array([0.1, 0.3])[:, None, None])
    value = of.brdf(np.array([0, 30])[:, None], 0, np.array([10, 20, 30, 40, 50]), 180, f0=0.9)
    assert value.shape == (2, 2, 5)
    one = models.Surface(alpha=0.3).brdf(30, 0, 20, 180, f0=0.9)
    assert one.shape == () and one == value[1, 1, 1]
    theta_i = xr.DataArray([0.0, 30.0], dims="theta_i")
    theta_r = xr.DataArray([10.0, 20.0, 30.0], dims="theta_r")
    labelled = models.Surface(alpha=0.3).brdf(theta_i, 0, theta_r, 180, f0=0.9)
    assert labelled.dims == ("theta_i", "theta_r") and np.array_equal(labelled, value[1, :, :3])
    assert models.Surface(alpha=0.3).ndf([]).shape == (0,)


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda s: models.Surface(alpha=0.0).ndf(0), "alpha_x = 0: must be above 0"),
        (lambda s: models.Surface(alpha=[0.1, np.nan]).ndf(0), "alpha_x = NaN"),
        (lambda s: models.Surface().ndf(0), "alpha, or alpha_x and alpha_y"),
        (lambda s: models.Surface(alpha=0.1, alpha_x=0.1).ndf(0), "alpha, or alpha_x and alpha_y"),
        (lambda s: models.Surface(alpha=0.1, law="phong").ndf(0), "law = phong: ggx"),
        (lambda s: models.Surface(alpha=0.1, law="student_t", gamma=1.5).ndf(0), "gamma = 1.5"),
        (lambda s: models.Surface(alpha=0.1, law="student_t").ndf(0), "gamma = NaN"),
        (lambda s: models.Surface(alpha=0.1, law="grains", coverage=1).ndf(0), "coverage = 1"),
        (lambda s: models.Surface(alpha=2, law="blinn_phong").ndf(0), "blinn_phong ends at 1"),
        (lambda s: s.ndf([0, 91]), "theta_h = 91: must lie in [0, 90]"),
        (lambda s: s.ndf(0, np.inf), "phi of theta_h = inf"),
        (lambda s: s.brdf(90, 0, 90, 0), "horizon"),
        (lambda s: s.brdf(0, 0, 0, 0, masking="smith"), "masking = smith: one of none, separable"),
        (lambda s: s.brdf(0, 0, 0, 0, masking="grains"), "of law = grains alone"),
        (lambda s: s.brdf(0, 0, 0, 0, f0=1.1), "f0 = 1.1"),
        (lambda s: s.brdf(0, 0, 0, 0, f0=0.5, eta=1.5), "one material"),
        (lambda s: s.brdf(0, 0, 0, 0, eta=0), "eta = 0: must be above 0"),
        (lambda s: s.brdf(0, 0, 0, 0, eta=1, k=-1), "k = -1"),
        (lambda s: s.brdf(0, 0, 0, 0, eta=1.5, polarisation="x"), "polarisation = x"),
        (lambda s: s.btdf(0, 0, 60, 0, eta=1.5), "theta_r = 60: must lie in [90, 180]"),
        (lambda s: s.btdf(0, 0, 160, 0, eta=1), "is not 1"),
        (lambda s: s.diffuse(0, 0, 0, 0, albedo=2), "albedo = 2"),
        (lambda s: s.bin_means(0, 0, [0, 10, 5], [0, 360]), "theta_r from 10 to 5"),
        (lambda s: s.bin_means(0, 0, [80, 100], [0, 360], eta=1.5), "on one side of 90"),
        (lambda s: s.bin_means(0, 0, [0, 10], [0, 361]), "by 360 at most"),
        (lambda s: s.bin_means(0, 0, 10, [0, 360]), "at least two edges"),
        (lambda s: s.ndf(np.zeros(2), np.zeros(3)), "shape mismatch"),
    ],
)
def test_what_has_no_value_is_named(call, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        call(models.Surface(alpha=0.3))
