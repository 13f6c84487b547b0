"""Draw the picture that opens the README: the demo's record, its model, and the error before and after gravity.

    python -m benchmarks.make_readme_picture [--out readme.svg] [--tiny]

Everything in it is computed here from the record that ships with the package. The picture brings its own card as
background and follows the reader's light or dark setting, so that it reads on any page.
"""

from __future__ import annotations

import argparse
import io
import re
import tempfile
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import jaxbacklash as jb
from jaxbacklash.commands.demo import shipped
from jaxbacklash.plot.drawing import SETTINGS, inked
from jaxbacklash.plot.motion import Motion
from jaxbacklash.plot.style import GAP, INK, MEASURED, MODEL
from jaxbacklash.plot.thinning import envelope

ROOT = Path(__file__).resolve().parents[1]
STRETCH = (1.2, 2.6)  # s, drawn in full
NEAR = np.radians(2.4)  # half width of the picture of the torque
LOOK = SETTINGS | inked(INK) | {"svg.fonttype": "path", "font.size": 10.0, "axes.titlesize": 11.0, "axes.titleweight": "bold"}
CARD, DARK_CARD, DARK_INK = "#ffffff", "#161b22", "#e6edf3"


def fits() -> tuple[jb.Fit, jb.Fit]:
    """The demo's record fitted by the base model, and with gravity."""
    record, _, inertia = shipped()
    return jb.fit(record, inertia=inertia, starts=1), jb.fit(record, inertia=inertia, effects=["gravity"], starts=1)


def draw_motion(ax: Axes, fit: jb.Fit) -> None:
    """A stretch of the record as points, the prediction as a line, the play as a band."""
    score = fit.score
    shown = (score.t >= STRETCH[0]) & (score.t <= STRETCH[1])
    low, high = (np.degrees(float(edge)) for edge in fit.system.edges(0.0))
    ax.axhspan(low, high, color=GAP, alpha=0.18, lw=0)
    ax.annotate("the play", (0.01, high - 0.05), xycoords=("axes fraction", "data"), va="top")
    ax.plot(score.t[shown], np.degrees(score.predicted[shown]), color=MODEL, lw=1.2, label="model with gravity")
    measured = np.degrees(score.measured[shown])
    ax.plot(score.t[shown][::6], measured[::6], "o", color=MEASURED, ms=4.2, mew=0, label="measured")
    reach = 1.12 * np.max(np.abs(measured))
    ax.set(title="Motion across the joint", xlabel="time [s]", ylabel="z [deg]", xlim=STRETCH, ylim=(-reach, reach))
    legend(ax)


def draw_law(ax: Axes, fit: jb.Fit) -> None:
    """Torque against relative motion: points from the smoothed record, the fitted play and stiffness as a line."""
    motion = Motion(fit.records[0], "z")
    near = (np.abs(motion.z) < NEAR) & (np.arange(motion.z.size) % 5 == 0)
    near[:50] = near[-50:] = False  # where a record begins and ends its acceleration is not known
    z, torque = motion.z[near], motion.restoring_torque(fit.system)[near]
    low, high = (float(edge) for edge in fit.system.edges(0.0))
    line = np.array([z.min(), low, high, z.max()])
    law = fit.parameters["stiffness"].value * (line - np.clip(line, low, high))
    ax.axvspan(np.degrees(low), np.degrees(high), color=GAP, alpha=0.18, lw=0)
    ax.plot(np.degrees(line), law, color=MODEL, lw=1.6, zorder=3)
    ax.plot(np.degrees(z), torque, "o", color=MEASURED, ms=2.2, mew=0, alpha=0.6)
    play = fit.parameters["backlash"]
    text = f"play {np.degrees(play.value):.4f}°\n± {np.degrees(play.stderr):.4f}°"
    ax.annotate(text, (0.0, 0.04), xycoords=("data", "axes fraction"), ha="center", va="bottom")
    reach = 1.1 * float(np.max(np.abs(law)))
    ax.set(title="Restoring torque", xlabel="z [deg]", ylabel="torque [N m]", ylim=(-reach, reach))


def draw_error(ax: Axes, before: jb.Fit, after: jb.Fit) -> None:
    """Prediction error in units of the noise, over the whole record, for both models."""
    for fit, colour, name in ((before, GAP, "backlash + stiffness + damping"), (after, MODEL, "the same + gravity")):
        score = fit.score
        times, low, high = envelope(score.t, score.residual, 1200)
        label = f"{name}: {score.rms:.2f} times the noise"
        ax.fill_between(times, low, high, color=colour, lw=0.6, label=label)
    reach = 1.05 * float(np.max(np.abs(before.score.residual)))
    ax.set(
        title="What each model leaves", xlabel="time [s]", ylabel="error / noise",
        xlim=(before.score.t[0], before.score.t[-1]), ylim=(-reach, reach),
    )  # fmt: skip
    legend(ax)


def legend(ax: Axes) -> None:
    """Names of the marks on the title's line, where no curve can run through them."""
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.99), ncols=2, borderaxespad=0.0, handlelength=1.3, fontsize=9.0)


def picture(before: jb.Fit, after: jb.Fit) -> str:
    """The three panels as SVG text."""
    with matplotlib.rc_context(LOOK):
        figure = Figure(figsize=(10.0, 5.2), layout="constrained")
        figure.get_layout_engine().set(w_pad=0.14, h_pad=0.1, hspace=0.0)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.75, 1.0), height_ratios=(1.25, 1.0))
        draw_motion(figure.add_subplot(grid[0, 0]), after)
        draw_law(figure.add_subplot(grid[0, 1]), after)
        draw_error(figure.add_subplot(grid[1, :]), before, after)
        buffer = io.StringIO()
        nothing: dict[str, Any] = dict.fromkeys(["Date", "Creator", "Format", "Type"])
        figure.savefig(buffer, format="svg", transparent=True, dpi=160, metadata=nothing)
    return on_card(buffer.getvalue())


def on_card(svg: str) -> str:
    """The drawing on a rounded card; its ink and card change places where the reader prefers dark pages."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL).replace(INK, "currentColor")
    # Hundredths of a point are finer than any screen.
    svg = re.sub(r'(?<= d=")[^"]*', lambda path: re.sub(r"(\.\d{2})\d+", r"\1", path[0]), svg)
    style = (
        f"<style>svg{{color:{INK}}}.card{{fill:{CARD};stroke:#8a8f98;stroke-opacity:.35}}"
        f"@media(prefers-color-scheme:dark){{svg{{color:{DARK_INK}}}.card{{fill:{DARK_CARD}}}}}</style>"
    )
    width, height = (float(v) for v in re.search(r'viewBox="0 0 (\S+) (\S+)"', svg).groups())
    card = f'<rect class="card" x=".5" y=".5" width="{width - 1:g}" height="{height - 1:g}" rx="9"/>'
    opening, rest = svg.split(">", 1)
    return f"{opening}>\n{style}\n{card}{rest}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "readme.svg")
    parser.add_argument("--tiny", action="store_true", help="only see that it works; write into a temporary folder")
    chosen = parser.parse_args()
    jb.start(brief=chosen.tiny)
    before, after = fits()
    text = picture(before, after)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "readme.svg" if chosen.tiny else chosen.out
        out.write_text(text, encoding="utf-8")
        size = out.stat().st_size / 1e3
        print(f"{out.name}: {size:.0f} kB, error {before.score.rms:.2f} to {after.score.rms:.2f} times the noise")


if __name__ == "__main__":
    main()
