"""Where a model fails, in words: the right place, the right dependence, and silence on clean records."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import jaxbacklash as jb
from jaxbacklash.commands import diagnose as command
from jaxbacklash.commands.reading import Reading
from jaxbacklash.model_file import load_model
from jaxbacklash.residuals.failures import depends, ranks_of

from .hidden import hidden


def found_in(name, kind="multisine", seed=5, **values):
    record, rig, _, _ = hidden(name, kind, seed, **values)
    return jb.where_it_fails(jb.fit(record, inertia=rig.inertia, starts=1))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("gravity", ["absolute angle y"]),
        ("contact_damping", ["in contact on the positive side", "relative speed z'"]),
        ("asymmetric_stiffness", ["in contact"]),
        ("coulomb_joint", ["opposes the relative motion, with the sign of z'"]),
        ("coulomb_ground", ["opposes the motion of the link, with the sign of y'"]),
    ],
)
def test_findings_name_the_place(name, words):
    found = found_in(name)
    text = str(found)
    assert not found.adequate
    assert "times the noise" in found.sentences[0]
    for word in words:
        assert word in text
    assert 2 <= len(found.sentences) <= 6
    assert len(found.significant) >= 1
    told = found.as_json()
    json.dumps(told, allow_nan=False)
    assert told["latent_torque"]["explained_by"] == list(found.surface.coordinates)


def test_ranks_are_those_of_scipy():
    values = np.random.default_rng(2).integers(-9, 9, 300).astype(float)
    np.testing.assert_array_equal(ranks_of(values), stats.rankdata(values))


def test_a_link_that_stands_still_is_not_asked_where_it_stood():
    latent = found_in("gravity").latent
    still = replace(latent, y=np.full_like(latent.y, 0.1), dy=np.zeros_like(latent.y))
    # ... or rests for all but a few moments, so that nearly all quantiles are one number
    resting = replace(latent, y=np.where(np.arange(latent.y.size) < 3, 0.2, 0.1))
    for moved in (still, resting):
        asked = {entry.coordinate for entry in depends(moved, moved.torque, np.ones(moved.t.size))}
        assert "y" not in asked
        assert {"z", "dz", "t"} <= asked


def test_clean_record_is_noise():
    found = found_in(None)
    assert found.adequate
    assert len(found.sentences) == 1
    assert "What is left is noise" in found.sentences[0]
    assert found.significant == ()
    assert found.as_json()["latent_torque"]["explained_by"] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["multisine", "chirp"])
def test_no_false_findings_on_clean_records(kind):
    false = sum(not found_in(None, kind, seed, seconds=10.0).adequate for seed in range(20))
    assert false <= 1


def test_command(tmp_path, capsys):
    record, rig, _, _ = hidden("gravity", "stepped", 3)
    jb.write_record(record, tmp_path / "run.csv")
    options = {
        "inertia": rig.inertia, "effects": None, "reading": Reading(), "window": 0.2, "starts": 1, "translational": False,
        "seed": 0,
    }  # fmt: skip
    command.run(tmp_path / "run.csv", model="joint", out=tmp_path / "why", as_json=False, **options)
    text = capsys.readouterr().out
    assert "The misfit is" in text
    assert "absolute angle y" in text
    result = json.loads((tmp_path / "why" / "result.json").read_text())
    assert result["command"] == "diagnose"
    assert result["verdict"] == "incomplete"
    assert result["findings"]
    assert result["latent_torque"]["explained_by"] == ["y"]
    assert result["latent_torque"]["share"] > 0.9
    assert load_model(tmp_path / "why" / "model.toml").has_play
    page = (tmp_path / "why" / "report.html").read_text()
    for title in ("Where the model fails", "The missing torque in time", "What the missing torque depends on"):
        assert title in page
    given = {**options, "inertia": None, "effects": "gravity"}
    command.run(tmp_path / "run.csv", model=str(tmp_path / "why" / "model.toml"), out=None, as_json=True, **given)
    cured = json.loads(capsys.readouterr().out)
    assert cured["verdict"] == "complete"
    assert "What is left is noise" in cured["findings"][0]
