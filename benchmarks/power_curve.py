"""How strong must an effect be to be found? Detection against strength, beside what the Cramer-Rao bound allows.

    python -m benchmarks.power_curve [--seeds 12] [--multiples 1 2 3 4 6 9] [--cheap] [--work DIR] [--out curve.svg] [--tiny]

Strengths are multiples of the least standard error any unbiased method can have, from `tests.independent.cramer_rao` at the
joint without the effect, base motion unknown too: each seed is a rig, an excitation and a noise of its own. Two columns are
counted: `refine` names the effect (the full search), and the score test of the joint alone ranks it first and above the
threshold (cheap: one fit and one set of sensitivities; with --cheap that is all that is run). Records without an effect
(multiple 0) count false alarms.

The ideal is `benchmarks.ideal_power`: the power of a test that attains the bound, at the threshold that `refine` has. Every
answer is a JSON file in --work, so that a killed run goes on where it was. Needs numba.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import beta

from benchmarks.ideal_power import (
    DEEP,
    RATE,
    SIGMA,
    STRENGTH,
    Setting,
    ideal_power,
    least_errors,
    one_sided,
    setting,
    threshold,
)
from jaxbacklash.mechanics import catalogue
from jaxbacklash.parameters import free_specs, specs
from jaxbacklash.records import Record
from tests.independent.generator import measure, simulate_truth

MULTIPLES = (1.0, 2.0, 3.0, 4.0, 6.0, 9.0)


def make_record(of: Setting, name: str | None, strength: float, multiple: float, duration: float) -> Record:
    """The joint with one weak effect, or none, as it is measured; every strength has a noise of its own."""
    truth = simulate_truth(of.rig, weak(name, strength), of.excitation, RATE, duration)
    rng = np.random.default_rng([37, of.seed, round(10 * multiple), list(STRENGTH).index(name) if name else 99])
    seen = measure(truth, rng, SIGMA, SIGMA)
    return Record(seen["t"], {"x": seen["x"], "z": seen["z"]})


def weak(name: str | None, strength: float) -> dict[str, dict[str, float]]:
    """An effect so far from the value at which it vanishes, ready for `simulate_truth`."""
    if name is None:
        return {}
    value = strength + float(specs(catalogue()[name]())[STRENGTH[name]].null or 0.0)
    return {name: {STRENGTH[name]: value, **({"d0": DEEP} if name == "contact_exponent" else {})}}


def trial(
    of: Setting, name: str | None, errors: dict[str, float], multiple: float, duration: float, cheap: bool
) -> dict[str, Any]:
    """One record and what was found in it."""
    from jaxbacklash.criticism.model_fitter import ModelFitter
    from jaxbacklash.criticism.refine import refine
    from jaxbacklash.criticism.screening import screen
    from jaxbacklash.fitting.setup import base_system
    from jaxbacklash.shooting.lengths import SCORE_WINDOW

    sign = -1.0 if name is not None and not one_sided(name) and of.seed % 2 else 1.0
    strength = 0.0 if name is None else sign * multiple * errors[name]
    record = make_record(of, name, strength, multiple, duration)
    begin = time.perf_counter()
    row: dict[str, Any] = {"effect": name, "seed": of.seed, "kind": of.kind, "multiple": multiple, "strength": strength}
    if cheap:
        system, free, _ = base_system(record, "joint", of.rig.inertia)
        fitter = ModelFitter(record, system, free, SCORE_WINDOW)
        candidates = tuple(screen(fitter, fitter.fit_model({})))
    else:
        found = refine(record, inertia=of.rig.inertia)
        row["found"], candidates = list(found.effects), found.stages[0].ranking
    evidence, best = max((c.gain - np.log(record.samples) * _strengths(c.name), c.name) for c in candidates)
    bar = threshold(record.samples) - np.log(record.samples)
    row |= {"first": best, "evidence": float(evidence), "ranked": bool(evidence > bar) and best == (name or best)}
    return row | {"seconds": time.perf_counter() - begin, "samples": record.samples}


def _strengths(name: str) -> int:
    """Parameters a law brings to the criterion."""
    return len(free_specs(catalogue()[name]()))


def kept(path: Path, make: Any) -> Any:
    """What is in a JSON file, made and written first if it is not there."""
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        half = path.with_suffix(".part")
        half.write_text(json.dumps(make(), indent=1), encoding="utf-8")
        half.replace(path)
    return json.loads(path.read_text(encoding="utf-8"))


def shares(rows: list[dict[str, Any]], name: str, how: str) -> dict[float, tuple[int, int]]:
    """How often an effect was found, and of how many, by multiple; how: "refine" or "ranked"."""
    counted: dict[float, tuple[int, int]] = {}
    for r in rows:
        if r["effect"] == name and (how == "ranked" or "found" in r):
            hit, of = counted.get(r["multiple"], (0, 0))
            counted[r["multiple"]] = hit + (r["ranked"] if how == "ranked" else name in r["found"]), of + 1
    return dict(sorted(counted.items()))


def table(rows: list[dict[str, Any]]) -> str:
    """Detections against strength, and false alarms."""
    limit = threshold(rows[0]["samples"])
    false = float(ideal_power(0.0, limit, False))
    lines = [f"accepted above sqrt(T) = {np.sqrt(limit):.2f} standard errors; ideal false alarms of one law {false:.1e}"]
    multiples = sorted({r["multiple"] for r in rows if r["effect"]})
    lines.append(f"  {'strength / bound':<34}" + "".join(f"{m:>10g}" for m in multiples))
    for name in STRENGTH:
        told = [("ideal", "".join(f"{ideal_power(m, limit, one_sided(name)):>10.2f}" for m in multiples))]
        for how in ("refine", "ranked"):
            if seen := shares(rows, name, how):
                cells = (f"{seen[m][0]} of {seen[m][1]}" if m in seen else "-" for m in multiples)
                told.append(("refine names it" if how == "refine" else "score test alone", "".join(f"{c:>10}" for c in cells)))
        lines += [f"  {name if i == 0 else '':<16}{how:<18}{cells}" for i, (how, cells) in enumerate(told)]
    clean = [r for r in rows if r["effect"] is None]
    named = [r for r in clean if "found" in r]
    if clean:
        alarms = f"{sum(bool(r['found']) for r in named)} of {len(named)}", f"{sum(r['ranked'] for r in clean)} of {len(clean)}"
        lines.append(f"  nothing hidden: refine names something in {alarms[0]}, the score test alone in {alarms[1]}")
    for how in ("refine", "ranked"):
        for m in multiples:
            seen = [(*shares(rows, n, how).get(m, (0, 0)), float(ideal_power(m, limit, one_sided(n)))) for n in STRENGTH]
            hits, count, wanted = (sum(v) for v in zip(*((h, c, c * p) for h, c, p in seen)))
            if count:
                lines.append(f"  all of them, {m:g} standard errors, {how}: {hits} of {count}, ideal {wanted:.1f}")
    return "\n".join(lines)


def draw(rows: list[dict[str, Any]], out: Path) -> None:
    """The picture: a panel an effect; found shares with 68 % intervals on the ideal curve."""
    import matplotlib
    from matplotlib.figure import Figure

    from jaxbacklash.plot.style import GAP, HELDOUT, INK, MEASURED, MODEL

    limit = threshold(rows[0]["samples"])
    with matplotlib.rc_context(
        {"svg.fonttype": "none", "svg.hashsalt": "power", "text.color": INK, "axes.labelcolor": INK, "font.size": 9}
    ):
        figure = Figure(figsize=(11.0, 5.2), layout="constrained")
        axes = figure.subplots(2, -(-len(STRENGTH) // 2), sharey=True).ravel()
        fine = np.linspace(0.0, 10.0, 201)
        for ax, name in zip(axes, STRENGTH):
            ax.axvline(np.sqrt(limit), color=GAP, lw=0.8, ls=":", label="threshold of `refine`")
            ax.plot(fine, ideal_power(fine, limit, one_sided(name)), color=MEASURED, lw=1.5, label="Cramér–Rao allows")
            for how, color, mark, shift, label in (
                ("refine", MODEL, "o", -0.08, "refine names it"), ("ranked", HELDOUT, "s", 0.08, "score test alone"),
            ):  # fmt: skip
                seen = shares(rows, name, how)
                if not seen:
                    continue
                m = np.array(list(seen)) + shift
                hit, of = np.array(list(seen.values()), float).T
                share = hit / of
                low, high = beta.ppf(0.16, hit, of - hit + 1), beta.ppf(0.84, hit + 1, of - hit)
                low, high = np.where(hit == 0, 0.0, low), np.where(hit == of, 1.0, high)
                ax.errorbar(
                    m,
                    share,
                    (np.maximum(share - low, 0), np.maximum(high - share, 0)),
                    fmt=mark,
                    ms=4,
                    color=color,
                    lw=1,
                    label=label,
                )
            ax.set_title(name.replace("_", " "), fontsize=9)
            ax.set_xlim(0.0, 10.0)
            ax.set_ylim(-0.04, 1.04)
            ax.spines[["top", "right"]].set_visible(False)
        for ax in axes[:: axes.size // 2]:
            ax.set_ylabel("share of records in which it is found")
        for ax in axes[len(STRENGTH) :]:
            ax.set_axis_off()
        figure.supxlabel("strength in least standard errors any unbiased method can have", fontsize=9)
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4, frameon=False)
        figure.savefig(out, dpi=150)


def run(
    work: Path, seeds: int, multiples: tuple[float, ...], duration: float, cheap: bool, names: tuple[str, ...]
) -> list[dict[str, Any]]:
    """All answers, those in the folder first; seeds outermost, so that a stopped run is a smaller study."""
    rows = []
    for seed in range(seeds):
        of = setting(seed, duration)
        errors = kept(work / f"{duration:g}s" / f"{seed:03d}-bound.json", lambda of=of: least_errors(of, duration))
        jobs = [(None, 0.0), *((n, m) for n in names for m in multiples)]
        for name, m in jobs:
            path = work / f"{duration:g}s" / f"{seed:03d}-{name or 'clean'}-{m:g}{'-cheap' if cheap else ''}.json"
            new = not path.exists()
            row = kept(path, lambda of=of, name=name, m=m, e=errors: trial(of, name, e, m, duration, cheap))
            rows.append(row)
            if new:
                told = "+".join(row["found"]) or "nothing" if "found" in row else "-"
                print(seed, of.kind, name, f"{m:g}: refine {told}; first {row['first']}, {row['seconds']:.1f} s", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--multiples", type=float, nargs="+", default=list(MULTIPLES))
    parser.add_argument("--effects", nargs="+", choices=tuple(STRENGTH), default=list(STRENGTH))
    parser.add_argument("--duration", type=float, default=10.0, help="of every record [s]")
    parser.add_argument("--cheap", action="store_true", help="the score test alone")
    parser.add_argument(
        "--work", type=Path, default=Path("power_curve"), help="folder of the answers; a run goes on from what is there"
    )
    parser.add_argument("--out", type=Path, default=None, help="the picture, .svg or .png")
    parser.add_argument(
        "--tiny", action="store_true", help="one joint with and without one effect, by the score test; keeps nothing"
    )
    options = parser.parse_args()
    from jaxbacklash.program import start

    start(brief=options.tiny)
    if options.tiny:
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            rows = run(Path(folder), 1, (9.0,), 8.0, True, ("gravity",))
            print(table(rows))
            draw(rows, Path(folder) / "curve.svg")
        return
    rows = run(options.work, options.seeds, tuple(options.multiples), options.duration, options.cheap, tuple(options.effects))
    print(f"\n{table(rows)}")
    if options.out is not None:
        draw(rows, options.out)
        print(f"written: {options.out}")


if __name__ == "__main__":
    main()
