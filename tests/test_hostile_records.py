"""Records whose numbers no fit can compute with, and held-out records that say nothing."""

import warnings

import numpy as np
import pytest

from jaxbacklash.commands.heldout import check_heldout
from jaxbacklash.errors import BadInput
from jaxbacklash.records import Record, read_series
from jaxbacklash.signals.resolution import rounding_noise


def record(path="one.csv", seed=0, **factors):
    rng = np.random.default_rng(seed)
    t = np.arange(400) / 200.0
    channels = {"x": 0.05 * np.sin(19.0 * t), "z": 0.01 * np.cos(31.0 * t) + 1e-4 * rng.standard_normal(t.size)}
    channels = {name: values * factors.get(name, 1.0) for name, values in channels.items()}
    return Record(t, channels, path, confirmed=frozenset("txzy"))


@pytest.mark.parametrize(("name", "factor", "fragment"), [
    ("x", 1e300, "values of up to 4.99999e+298"), ("z", 1e30, "at most 1e+12"), ("z", 1e-300, "a range of"),
    ("x", 1e-20, "at least 1e-12"),
])  # fmt: skip
def test_numbers_that_no_fit_can_compute_with(name, factor, fragment):
    with pytest.raises(BadInput) as caught:
        record(**{name: factor})
    assert f"one.csv, column {name}" in str(caught.value)
    assert fragment in str(caught.value)
    assert "--unit" in str(caught.value)


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_micrometres_and_meganewtons_are_numbers(factor):
    assert record(x=factor, z=factor).samples == 400


def other_kinds():
    good = record("two.csv", 1)
    yield Record(good.t, {"z": good.channels["z"]}, "two.csv")
    yield Record(good.t, {"F": good.channels["x"], "y": good.channels["z"]}, "two.csv")
    yield Record(good.t, {"x": good.channels["x"], "y": good.channels["z"] + good.channels["x"]}, "two.csv")


@pytest.mark.parametrize("other", [*other_kinds()], ids=["a decay", "a force", "y for z"])
def test_a_heldout_record_of_another_kind_is_refused(other):
    with pytest.raises(BadInput, match=r"--heldout two\.csv: .* one\.csv"):
        check_heldout([record()], other)


def test_a_heldout_record_that_is_fitted_too_is_told():
    with pytest.warns(UserWarning, match="is a record that is fitted too"):
        check_heldout([record("a.csv", 1), record()], record("copy.csv"))


def test_another_record_of_the_kind_is_taken_without_a_word():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_heldout([record()], record("two.csv", 1))
        check_heldout([record()], None)


def test_small_values_are_no_coarse_ones():
    """Not all of them are nought to no decimals, which would be a step of one."""
    assert rounding_noise(1e-9 * np.random.default_rng(2).standard_normal(400)) < 1e-15


@pytest.mark.parametrize(("factor", "fragment"), [(1e200, "values of up to"), (1e-200, "a range of")])
def test_a_series_of_any_unit_has_bounds_too(tmp_path, factor, fragment):
    values = factor * np.random.default_rng(3).uniform(0.5, 1.0, 400)
    (tmp_path / "s.csv").write_text("t,z\n" + "".join(f"{k / 100},{v!r}\n" for k, v in enumerate(values.tolist())))
    with pytest.raises(BadInput, match=fragment):
        read_series(tmp_path / "s.csv", "z")
