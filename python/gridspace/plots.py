# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Drawings of recorded signals, with matplotlib."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gridspace.launcher import Error

if TYPE_CHECKING:
    from gridspace.recording import Run

UNITS = ((7200, "h", 3600), (600, "min", 60), (0.5, "s", 1), (0, "ms", 1e-3))  # from so many seconds on, as in the report
CLOCK = {"h": (1, 2, 3, 6, 12, 24, 48, 72, 168), "min": (1, 2, 5, 10, 15, 30, 60)}


def plot(run: Run, patterns: tuple[str, ...], *, from_s: float, until_s: float | None, events: bool, axes: Any, style: dict[str, Any]) -> Any:
    try:
        from matplotlib import pyplot, ticker
    except ImportError as e:
        raise Error("matplotlib is not installed: on Debian python3-matplotlib, elsewhere pip install matplotlib", 2) from e
    signals = run.signals(*patterns)
    if axes is None:
        _, axes = pyplot.subplots(figsize=(9, 3.2), layout="constrained")
    end_s = until_s if until_s is not None else max((s.time_s[-1] for s in signals.values() if len(s)), default=1.0)
    unit, seconds = next((name, seconds) for least_s, name, seconds in UNITS if end_s - from_s > least_s or least_s == 0)
    for name, signal in signals.items():
        shown = [i for i, t in enumerate(signal.time_s) if from_s <= t <= end_s]
        axes.plot([signal.time_s[i] / seconds for i in shown], [signal.values[i] for i in shown], **{"label": name, "linewidth": 1.2, **style})
    happened: dict[float, list[str]] = {}
    for event in run.events if events else ():
        if from_s <= event.time_s <= end_s and event.event not in happened.setdefault(event.time_s, []):
            happened[event.time_s].append(event.event)
    for row, (time_s, names) in enumerate(sorted(happened.items())):  # below each other: close ones stay legible
        axes.axvline(time_s / seconds, color="0.4", linestyle="--", linewidth=0.8)
        axes.annotate(", ".join(names), (time_s / seconds, 0.97 - 0.06 * (row % 12)), xycoords=("data", "axes fraction"), fontsize=8, va="top",
                      xytext=(3, 0), textcoords="offset points")
    step = next((step for step in CLOCK.get(unit, ()) if step >= (end_s - from_s) / seconds / 10), None)
    if step is not None:
        axes.xaxis.set_major_locator(ticker.MultipleLocator(step))
    axes.set(xlim=(from_s / seconds, end_s / seconds), xlabel=f"time, {unit}")
    quantities = {name.rpartition(".")[2] for name in signals}
    if len(quantities) == 1:
        axes.set_ylabel(quantities.pop())
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    return axes
