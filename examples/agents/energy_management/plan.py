# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The cheapest plan for the rest of a day, as a mixed-integer linear program (scipy's milp, which is HiGHS)."""
import dataclasses
from collections.abc import Sequence

import numpy
from scipy.optimize import Bounds, LinearConstraint, milp

OVER_LIMIT_EUR_PER_KWH = 5.0  # what the plan pays for more than the agreed connection, and for an end below the beginning:
BELOW_END_EUR_PER_KWH = 2.0  # so much that it does so only where nothing else is possible
WEAR_EUR_PER_KWH = 0.005  # of the battery: it does not move for nothing


@dataclasses.dataclass(frozen=True)
class Site:
    """What is to be planned. Efficiency is that of each way."""

    capacity_kwh: float
    battery_kw: float
    efficiency: float
    low_percent: float
    high_percent: float
    compressor_kw: float
    compressor_count: int
    buffer_kwh: float
    connection_kw: float


@dataclasses.dataclass(frozen=True)
class Plan:
    """For each step: mean powers, and what battery and store hold at its end. grid_kw: positive is taken from the grid."""

    step_h: float
    grid_kw: list[float]
    battery_kw: list[float]
    running: list[int]
    soc_percent: list[float]
    ahead_kwh: list[float]
    cost_eur: float


def cheapest(site: Site, need_kw: Sequence[float], import_price: Sequence[float], export_price: Sequence[float], step_h: float,
             soc_percent: float, ahead_kwh: float, end_percent: float) -> Plan:
    """need_kw: what all that nobody steers takes in each step. Raises RuntimeError when the solver has no answer."""
    steps = len(need_kw)
    names = ("taken", "given", "discharge", "charge", "stored", "running", "ahead", "over")
    at = {name: slice(i * steps, (i + 1) * steps) for i, name in enumerate(names)}
    below_stored, below_ahead, count = len(names) * steps, len(names) * steps + 1, len(names) * steps + 2
    one, before = numpy.eye(steps), numpy.eye(steps, k=-1)
    kwh = site.capacity_kwh / 100
    start_kwh = min(max(soc_percent, site.low_percent), site.high_percent) * kwh
    start_ahead = min(max(ahead_kwh, -site.buffer_kwh), site.buffer_kwh)

    cost, low, high, whole = numpy.zeros(count), numpy.zeros(count), numpy.full(count, numpy.inf), numpy.zeros(count)
    cost[at["taken"]], cost[at["given"]] = step_h * numpy.asarray(import_price), -step_h * numpy.asarray(export_price)
    cost[at["discharge"]], cost[at["over"]] = step_h * WEAR_EUR_PER_KWH, step_h * OVER_LIMIT_EUR_PER_KWH
    cost[[below_stored, below_ahead]] = BELOW_END_EUR_PER_KWH
    high[at["discharge"]] = high[at["charge"]] = site.battery_kw
    low[at["stored"]], high[at["stored"]] = site.low_percent * kwh, site.high_percent * kwh
    high[at["running"]], whole[at["running"]] = site.compressor_count, 1
    low[at["ahead"]], high[at["ahead"]] = -site.buffer_kwh, site.buffer_kwh

    def rows(parts, lower, upper):
        matrix = numpy.zeros((steps, count))
        for name, block in parts.items():
            matrix[:, at[name]] = block
        return LinearConstraint(matrix, lower, upper)

    def last_row(name, slack, lower):
        row = numpy.zeros((1, count))
        row[0, at[name].stop - 1] = row[0, slack] = 1
        return LinearConstraint(row, lower, numpy.inf)

    begins_with = numpy.zeros(steps)
    begins_with[0] = 1
    need, stays = numpy.asarray(need_kw, float), begins_with * start_ahead - site.compressor_kw * step_h
    constraints = [
        rows({"taken": one, "given": -one, "discharge": one, "charge": -one, "running": -site.compressor_kw * one}, need, need),
        rows({"stored": one - before, "charge": -site.efficiency * step_h * one, "discharge": step_h / site.efficiency * one},
             begins_with * start_kwh, begins_with * start_kwh),
        rows({"ahead": one - before, "running": -site.compressor_kw * step_h * one}, stays, stays),
        rows({"taken": one, "over": -one}, -numpy.inf, site.connection_kw),
        last_row("stored", below_stored, end_percent * kwh),
        last_row("ahead", below_ahead, 0),
    ]
    # Limits of work and not of time: the same question has the same answer on a slow machine.
    found = milp(cost, integrality=whole, bounds=Bounds(low, high), constraints=constraints, options={"mip_rel_gap": 1e-3, "node_limit": 2000})
    if found.x is None:
        raise RuntimeError(f"no plan: {found.message}")
    x = {name: found.x[place] for name, place in at.items()}
    return Plan(step_h, (x["taken"] - x["given"]).tolist(), (x["discharge"] - x["charge"]).tolist(), [round(n) for n in x["running"]],
                (x["stored"] / kwh).tolist(), x["ahead"].tolist(), float(cost[at["taken"]] @ x["taken"] + cost[at["given"]] @ x["given"]))
