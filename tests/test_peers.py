"""The benchmarks' own parts: the peers that `refine` is compared with are no straw men, and the ideal power is what it says."""

import json

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks import ideal_power
from benchmarks.peers import weak_form, weak_laws
from benchmarks.peers.weak_fit import Regression
from benchmarks.peers.weak_rows import Rows, dahl, follower
from tests.independent.rigs import Excitation, Rig

J, B, K, C = 3.0, 0.024, 12000.0, 20.0
BASE = ((0.035, 1.1, 0.3), (0.02, 2.9, 1.1), (0.008, 5.3, 2.0), (0.003, 8.9, 0.5))  # rad, Hz, rad


def driven(extra, seconds=8.0, rate=500.0, fine=20):
    """t, x, z of the joint with a torque extra(y, v, z, dz) on top, by RK4 in steps of 0.1 ms."""
    h = 1.0 / (rate * fine)
    t = np.arange(round(seconds * rate * fine) + 1) * h
    half = np.arange(2 * t.size - 1) * (h / 2)
    x, dx = (sum(a * (2 * np.pi * f) ** order * wave(2 * np.pi * f * half + p) for a, f, p in BASE)
             for order, wave in ((0, np.sin), (1, np.cos)))  # fmt: skip

    def rate_of(y, v, i):
        z, dz = y - x[i], v - dx[i]
        d = z - min(max(z, -B / 2), B / 2)
        return v, (-K * d - C * dz + extra(y, v, z, dz)) / J

    y, v, path = x[0], dx[0], np.empty(t.size)
    for n in range(t.size):
        path[n] = y
        if n == t.size - 1:
            break
        a = rate_of(y, v, 2 * n)
        b = rate_of(y + h / 2 * a[0], v + h / 2 * a[1], 2 * n + 1)
        c = rate_of(y + h / 2 * b[0], v + h / 2 * b[1], 2 * n + 1)
        d = rate_of(y + h * c[0], v + h * c[1], 2 * n + 2)
        y, v = y + h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]), v + h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    x = x[::2]
    return t[::fine], x[::fine], (path - x)[::fine]


def test_the_bump_carries_derivatives():
    """Weak derivatives of a sine are those of the sine, to rounding, also read late."""
    t = np.arange(2001) * 2e-3
    wave = np.sin(7.0 * t)
    rows = Rows(t, wave, wave)
    centres = t[rows.centres]
    weight = rows.raw("x", 0) / np.sin(7.0 * centres)
    np.testing.assert_allclose(rows.raw("x", 2), -49.0 * weight.mean() * np.sin(7.0 * centres), atol=1e-4)
    np.testing.assert_allclose(rows.raw("x", 1), 7.0 * weight.mean() * np.cos(7.0 * centres), atol=1e-6)
    late = rows.raw("z", 0, 3e-3)
    np.testing.assert_allclose(late, weight.mean() * np.sin(7.0 * (centres + 3e-3)), atol=1e-6)
    np.testing.assert_allclose(rows.over(np.sin(7.0 * rows.middles))[:, 0], rows.raw("x", 0), atol=1e-6)


def test_hysteresis_and_follower_agree_with_their_equations():
    """Dahl's law along a motion and the inertia hung on it, against small steps of their differential equations."""
    t = np.arange(200001) * 1e-5
    z = 0.01 * np.sin(9.0 * t) + 0.004 * np.sin(31.0 * t)
    u = np.zeros_like(z)
    for i, step in enumerate(np.diff(z)):
        u[i + 1] = u[i] + step / 2e-3 * (1.0 - u[i] * np.sign(step))
    np.testing.assert_allclose(dahl(z, 2e-3), u, atol=5e-3)
    coarse = slice(None, None, 100)
    y2, v2, path = z[0], 0.0, np.empty_like(z)
    slope = np.gradient(z, 1e-5)
    for i in range(z.size):
        path[i] = y2
        v2 += 1e-5 * (150.0**2 * (z[i] - y2) + 2 * 0.05 * 150.0 * (slope[i] - v2))
        y2 += 1e-5 * v2
    # From rest on a moving link, the free decay of the start is the difference; it is gone after half a second or so.
    found = follower(z[coarse], 1e-3, 150.0, 0.05)
    np.testing.assert_allclose(found[1200:], path[coarse][1200:], atol=2e-5)


@pytest.mark.parametrize(
    ("name", "strength", "extra"),
    [
        ("gravity", -30.0, lambda y, v, z, dz: -30.0 * np.sin(y)),
        ("gap_spring", 500.0, lambda y, v, z, dz: -500.0 * z),
        ("quadratic_drag", 8.0, lambda y, v, z, dz: -8.0 * abs(v) * v),
    ],
)  # fmt: skip
def test_the_regression_recovers_what_is_linear_in_its_parameters(name, strength, extra):
    """Without noise the named model gives play, stiffness, damping and strength back, from a play that is 20 % off."""
    rows = Rows(*driven(extra))
    found = Regression(rows, J).fit((name,), {"b": 1.2 * B})
    assert found.eta["b"] == pytest.approx(B, rel=2e-4)
    assert found.theta == pytest.approx([K, C, strength], rel=2e-3)
    assert found.allowed


def test_the_expert_names_the_effect_and_leaves_the_clean_record_alone():
    """At an encoder's noise: nothing on a clean record, gravity where it hides; and both are complete."""
    rng = np.random.default_rng(5)
    for extra, hidden in ((lambda y, v, z, dz: 0.0, ()), (lambda y, v, z, dz: 25.0 * np.sin(y), ("gravity",))):
        t, x, z = driven(extra)
        x, z = (v + 3e-5 * rng.standard_normal(v.size) for v in (x, z))
        found = weak_form.identify(t, x, z, J)
        assert found.effects == hidden
        assert found.complete
        assert found.backlash == pytest.approx(B, rel=1e-3)
        assert found.stiffness == pytest.approx(K, rel=2e-3)


def test_the_expert_admits_what_is_not_in_its_catalogue():
    """A spring that stiffens with speed: whatever is named, the rest is not noise."""
    t, x, z = driven(lambda y, v, z, dz: -4000.0 * abs(dz) * (z - min(max(z, -B / 2), B / 2)))
    rng = np.random.default_rng(6)
    x, z = (v + 3e-5 * rng.standard_normal(v.size) for v in (x, z))
    assert not weak_form.identify(t, x, z, J).complete


def test_every_effect_that_the_laboratory_records_hide_is_known_to_the_expert():
    from benchmarks.effect_recovery import SINGLES

    assert set(SINGLES) - {"lugre", "bouc_wen"} <= set(weak_laws.LAWS)  # dahl stands for these two


def test_ideal_power_against_simulation():
    """The formula, against noise drawn and a linear model's fall of twice the cost counted."""
    rng = np.random.default_rng(1)
    limit = ideal_power.threshold(5001)
    assert 14.0 < limit < 16.0
    column = rng.standard_normal(40)
    column /= np.linalg.norm(column)
    for m in (0.0, 2.0, 4.0, 6.0):
        data = rng.standard_normal((100000, 40)) + m * column
        along = data @ column
        both = np.mean(along**2 > limit)
        one = np.mean((along > 0.0) & (along**2 > limit))
        spread = 4.0 * np.sqrt(0.25 / 100000)
        assert both == pytest.approx(float(ideal_power.ideal_power(m, limit, False)), abs=spread)
        assert one == pytest.approx(float(ideal_power.ideal_power(m, limit, True)), abs=spread)
    assert ideal_power.ideal_power(0.0, limit, False) == pytest.approx(chi2.sf(limit, 1))


def test_which_strengths_are_one_sided():
    sided = {name for name in ideal_power.STRENGTH if ideal_power.one_sided(name)}
    assert sided == {"coulomb_joint", "contact_damping", "load_friction"}


def test_the_bound_of_a_strength_against_finite_differences(monkeypatch):
    """x known and the start known well enough: the bound of gravity is that of plain simulations with G moved."""
    from tests.independent.cramer_rao import base_motion_bound
    from tests.independent.motions import Multisine

    rig = Rig(J, B, K, C)
    amplitudes, frequencies, phases = np.array(BASE).T
    base = Multisine(amplitudes, frequencies, phases)
    pytest.importorskip("numba")
    from tests.independent.generator import simulate_truth

    excitation = Excitation("multisine", base)
    truth = simulate_truth(rig, {}, excitation, 500.0, 1.2)
    torque = ideal_power.unit_torques(rig, truth)["gravity"]
    found = base_motion_bound(rig, truth["t"], truth["y"], truth["v"], base.x, sigma_x=0.0, sigma_z=3e-5, spacing=0.01,
                              torques={"gravity": torque})  # fmt: skip

    def z_of(dB=0.0, dK=0.0, dC=0.0, G=0.0, dy=0.0, dv=0.0):
        moved = Excitation("multisine", base, y0=dy, v0=dv)
        return simulate_truth(Rig(J, B + dB, K + dK, C + dC), {"gravity": {"G": G}}, moved, 500.0, 1.2)["z"]

    steps = {"dB": 1e-6, "dK": 1.0, "dC": 0.01, "G": 0.02, "dy": 1e-7, "dv": 1e-5}
    columns = np.stack([(z_of(**{n: s}) - z_of(**{n: -s})) / (2 * s) for n, s in steps.items()], axis=1) / 3e-5
    size = np.linalg.norm(columns, axis=0)
    covariance = np.linalg.inv((columns / size).T @ (columns / size)) / np.outer(size, size)
    assert found.stderr["gravity"] == pytest.approx(np.sqrt(covariance[3, 3]), rel=0.02)


def test_answers_are_kept_and_counted(tmp_path):
    """A killed run goes on: what is in a file is not found again; the table counts sets, families and clean records."""
    pytest.importorskip("numba")
    from benchmarks import effect_peers

    path = effect_peers.where(tmp_path, 21, "x1", 5.0, "weak")
    path.parent.mkdir()
    truth = {"backlash": 0.02, "stiffness": 1e4, "damping": 20.0}
    row = {"number": 21, "hidden": [], "kind": "multisine", "truth": truth, "found": ["gravity"], "joint": truth,
           "complete": True, "inside": None, "seconds": 1.0, "cpu": 1.0}  # fmt: skip
    path.write_text(json.dumps(row))
    assert effect_peers.answered(tmp_path, 21, "x1", 5.0, "weak") == row
    again = {"number": 0, "hidden": ["gravity"], "kind": "chirp", "found": ["gravity"], "alternatives": [], "verdict": "complete",
             "inside": {"backlash": True}, "seconds": 9.0}  # fmt: skip
    recovery = tmp_path / "recovery.json"
    recovery.write_text(json.dumps({"1": [again], "3": [again]}))
    effect_peers.take_over(tmp_path, [recovery], 5.0)
    assert effect_peers.answered(tmp_path, 0, "x1", 5.0, "refine")["found"] == ["gravity"]
    rows = [row, {**row, "hidden": ["lugre"], "found": ["dahl"]}, {**row, "hidden": ["speed_stiffness"], "complete": False}]
    counted = effect_peers.summary(rows)
    assert (counted["exact"], counted["of"], counted["false_on_clean"], counted["admitted"]) == (1, 2, 1, 1)
    assert "weak form, expert" in effect_peers.table("x1", {"weak": rows, "sindy": None})
    assert "not installed" in effect_peers.table("x1", {"weak": rows, "sindy": None})
