"""``jaxbacklash diagnose``."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from ..causes import Cause, find_causes
from ..criticism import Ranking, rank_effects
from ..criticism.ranking import table
from ..errors import BadInput
from ..fitting import Fit
from ..fitting import fit as fit_records
from ..fitting.result import causes_text
from ..fitting.setup import add_effects
from ..model_file import dump_model
from ..records.force import between
from ..records.not_taken import require_encoders
from ..report.refine_result import candidates_json
from ..report.result import as_json as result_of
from ..residuals import Findings, where_it_fails
from .common import check_window, json_text, model_of_file, names, out_folder, progress, write_text
from .reading import Reading


def run(
    path: Path,
    *,
    inertia: float | None,
    model: str,
    effects: str | None,
    out: Path | None,
    as_json: bool,
    reading: Reading,
    window: float | None,
    starts: int,
    translational: bool,
    seed: int,
) -> None:
    """Read, fit, find what is missing, print; write the result, the model and the report when a folder is given."""
    check_window(window)
    if starts < 1:
        raise BadInput(f"--starts {starts}: wanted one or more")
    record = reading.record(path)
    require_encoders([record], "diagnose", ("motor",))
    folder = out_folder(out)
    system = model_of_file(model, inertia)
    if system is not None:
        system = add_effects(system, names(effects))
    with progress(as_json) as tell:
        fit = fit_records(
            record, model=model if system is None else "joint", inertia=inertia, effects=names(effects), system=system,
            window=window, starts=starts, seed=seed, translational=translational, progress=tell,
        )  # fmt: skip
        causes = find_causes(fit, tell)
        tell("looking for the missing torque", 0.88)
        found = where_it_fails(fit)
        tell("judging absent effects", 0.92)
        ranking = rank_effects(fit, window=window)
        words = shlex.join(["jaxbacklash", *sys.argv[1:]])
        result = diagnosis(fit, found, ranking, causes, command_line=words)
        if folder is not None:
            from ..report.diagnose_report import diagnose_report  # pictures bring matplotlib, which a plain run need not wait for

            tell("drawing the report", 0.95)
            write_text(folder / "result.json", json_text(result))
            heading = f"{record.summary()}\n{found.sentences[0]}"
            write_text(
                folder / "model.toml",
                dump_model(
                    fit.system,
                    translational=translational,
                    per_inertia=fit.per_inertia,
                    heading=heading,
                    between=between([record]),
                    known_noise=fit.known_noise,
                ),
            )
            diagnose_report(fit, found, result, folder / "report.html")
    if as_json:
        sys.stdout.write(json_text(result))
        return
    print(text(fit, found, ranking, causes))
    if folder is not None:
        print(f"written: {folder}/result.json, model.toml, report.html")


def diagnosis(
    fit: Fit, found: Findings, ranking: Ranking, causes: Sequence[Cause] = (), *, command_line: str = ""
) -> dict[str, Any]:
    """The whole result of ``diagnose``: a fit's, with causes in the record, the findings, the missing torque and the ranking of
    absent effects."""
    result = result_of(fit, command="diagnose", command_line=command_line, version=__version__, causes=causes)
    result |= found.as_json()
    result["verdict"] = "complete" if found.adequate and not causes else "incomplete"
    result["verdict_text"] = " ".join([*([causes_text(causes)] if causes else []), *found.sentences[:2]])
    result["stages"][0]["candidates"] = candidates_json(ranking)
    return result


def text(fit: Fit, found: Findings, ranking: Ranking, causes: Sequence[Cause] = ()) -> str:
    """What a person reads: causes in the record, the findings, tables of what was asked and of what effects would bring."""
    lines = [fit.records[0].summary(), *([causes_text(causes)] if causes else []), *found.sentences]
    if found.surface is not None:
        lines += ["", "what the missing torque depends on, alone or in pairs: share explained out of sample"]
        lines += [f"  {' x '.join(names):<16} {100 * share:5.1f} %" for names, share, _ in found.surface.tried[:5]]
        lines += ["", "tested against                    of the torque   strength  chance"]
        lines += [f"  {d.label:<31} {d.of:<14} {d.strength:8.2f}  {_chance(d.p)}" for d in found.dependences[:8]]
        lines += ["", "the fit's parameters, as fitted and beside the missing torque"]
        for name, (a, b) in found.surface.moved.items():
            unit = fit.parameters[name].unit if name in fit.parameters else ""
            lines.append(f"  {name:<24} {a:12.6g} {b:12.6g} {unit}".rstrip())
    if found.adequate:
        return "\n".join(lines)
    if causes:
        lines += ["", "the ranking below is of the record as it stands: undo the cause first"]
    lines += ["", f"what one more effect would bring ({ranking.current:.3g} now); add one with fit --effects NAME"]
    lines += table(ranking)
    return "\n".join(lines)


def _chance(p: float) -> str:
    return "below 1e-6" if p < 1e-6 else f"{p:.2g}"
