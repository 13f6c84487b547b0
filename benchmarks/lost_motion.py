"""The play of slow records: does the interval hold it, and is it refused, with the right reason, where it does not show?

    python -m benchmarks.lost_motion [--rigs 100] [--seed 0] [--tiny] [--each]

Rigs are drawn at random (`benchmarks.slow_rigs`): gears and cables whose link friction carries, simulated by a non-smooth
scheme of its own; tendons whose contact begins little by little and which creep; servos pulled to and fro by a force of which
the sign is written down; loops of torque over angle. Encoders count, read with noise, sit off their centre and lag by part of
a sample; the gear has an error once a turn of the motor; z drifts; strokes are few. "holds" is the share of intervals with the
lost motion inside, which is the play with the wind-up under friction; "refused" are rigs that got no number though they should
have one; "width" is the interval's half width as a share of the play (median). Then rigs that do not show their play: "right"
were refused for the reason that is true, "given" got a number all the same.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections import defaultdict

import numpy as np

import jaxbacklash as jb

from .slow_rigs import HIDDEN, SHOWN, Rig, hidden_rigs, shown_rigs


def read(rig: Rig) -> jb.LostMotion:
    """What the package says of one rig's record."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return jb.lost_motion(rig.record, gear_ratio=rig.ratio)


def shown(rigs: list[Rig], each: bool) -> None:
    rows: dict[str, list[tuple[bool, bool, float, float, float]]] = defaultdict(list)
    for rig in rigs:
        begun = time.perf_counter()
        found = read(rig)
        took = time.perf_counter() - begun
        value = found.parameters["backlash"]
        if value.value is None or value.ci95 is None:
            rows[rig.kind].append((True, False, np.nan, np.nan, took))
        else:
            low, high = value.ci95
            rows[rig.kind].append((False, low <= rig.truth <= high, 0.5 * (high - low) / rig.truth,
                                   abs(value.value / rig.truth - 1.0), took))  # fmt: skip
        if each:
            inside = "refused: " + value.why if value.value is None else ("" if rows[rig.kind][-1][1] else "OUTSIDE ")
            print(f"    {rig.name}: truth {rig.truth:.5g}, {inside}{value.value} {value.ci95}; {rig.words}")
    print(f"{'kind':<12}{'rigs':>6}{'refused':>9}{'read':>6}{'holds':>8}{'width':>9}{'error':>9}{'seconds':>9}")
    rows["all"] = [one for kind in SHOWN for one in rows[kind]]
    for kind, told in rows.items():
        if told:
            table = np.array(told, float)
            kept = table[table[:, 0] == 0.0]
            holds = f"{100 * kept[:, 1].mean():6.1f} %" if len(kept) else "    none"
            width, error = (100 * np.median(kept[:, at]) if len(kept) else np.nan for at in (2, 3))
            print(f"{kind:<12}{len(table):6d}{int(table[:, 0].sum()):9d}{len(kept):6d}{holds}{width:7.2f} %{error:7.2f} %"
                  f"{np.median(table[:, 4]):9.2f}")  # fmt: skip


def hidden(rigs: list[Rig], each: bool) -> None:
    rows: dict[str, list[tuple[bool, bool]]] = defaultdict(list)
    for rig in rigs:
        found = read(rig)
        why = found.parameters["backlash"].why
        right = any(word in why for word in rig.words)
        rows[rig.kind].append((right, found.applies))
        if each or not right:
            print(f"    {rig.name}: {why or found.parameters['backlash'].ci95}")
    print(f"{'does not show because':<34}{'rigs':>6}{'right':>7}{'given':>7}")
    rows["all"] = [one for kind in HIDDEN for one in rows[kind]]
    for kind, told in rows.items():
        if told:
            print(f"{kind:<34}{len(told):6d}{sum(one for one, _ in told):7d}{sum(two for _, two in told):7d}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tiny", action="store_true", help="eight rigs, and one of each that does not show")
    parser.add_argument("--each", action="store_true", help="a line for each rig")
    options = parser.parse_args()
    jb.start(brief=options.tiny)
    count = 8 if options.tiny else options.rigs
    shown(shown_rigs(count, options.seed), options.each)
    hidden(hidden_rigs(1 if options.tiny else max(1, count // 12), options.seed), options.each)


if __name__ == "__main__":
    main()
