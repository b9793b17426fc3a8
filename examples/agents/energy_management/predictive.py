#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# The first line names the Python of the system, because Debian's scipy (python3-scipy) is there and in no other.
import importlib.util
import sys

import hourly
from managed_site import ManagedSite

from gridspace import Setting, Signal


class Predictive(ManagedSite):
    """Manages the energy of a site by a forecast: every half hour it plans the rest of the day anew, as cheaply as can be."""

    program = "predictive-energy-manager"

    forecast = Setting("file", doc="what is expected, by the hour: hour, pv_kw, wind_kw, load_kw")
    plan_period_s = Setting("fraction", 1800, above=0, whole_steps=True, doc="time between two plans, and length of their steps")
    efficiency = Setting("number", 0.96, above=0, max=1, doc="of the battery, each way")
    connection_kw = Setting("number", above=0, doc="the most that shall be taken from the grid")
    end_percent = Setting("number", min=0, max=100, doc="state of charge at the end of the day, at least")

    planned_grid_kw = Signal("agent.{process}.planned_grid_kw", "kW")
    planned_battery_kw = Signal("agent.{process}.planned_battery_kw", "kW")
    day_ahead_grid_kw = Signal("agent.{process}.day_ahead_grid_kw", "kW")
    day_ahead_soc_percent = Signal("agent.{process}.day_ahead_soc_percent", "%")
    day_ahead_cost_eur = Signal("agent.{process}.day_ahead_cost_eur", "EUR")

    def begin(self):
        import plan  # takes a second, which who asks --describe need not wait for

        self.planning = plan
        self.site = plan.Site(self.capacity_kwh, self.battery_kw, self.efficiency, self.low_percent, self.high_percent, self.compressor_kw,
                              self.compressor_count, self.buffer_kwh, self.connection_kw)
        self.expected = hourly.forecast(self.forecast)
        self.day_ahead = self.plan = None
        self.planned_until_s = 0.0
        super().begin()

    def expected_need_kw(self, time_s):
        return self.expected.at("load_kw", time_s) - self.expected.at("pv_kw", time_s) - self.expected.at("wind_kw", time_s)

    def make_plan(self):
        step_s = float(self.plan_period_s)
        steps = max(1, round(self.hours_left * 3600 / step_s))
        times = [self.now_s + i * step_s for i in range(steps)]
        need = [self.expected_need_kw(t + step_s / 2) for t in times]
        if self.plan is not None:
            need[0] = self.need_kw  # the next half hour as it is now: nearer than any forecast
        self.planned_need_kw = need[0]
        self.plan = self.planning.cheapest(self.site, need, [self.prices.at("import_eur_per_kwh", t) for t in times],
                                           [self.prices.at("export_eur_per_kwh", t) for t in times], step_s / 3600, self.soc_percent, self.ahead_kwh,
                                           self.end_percent)
        self.planned_until_s = self.now_s + step_s
        if self.day_ahead is None:
            self.day_ahead, self.day_ahead_cost_eur = self.plan, self.plan.cost_eur
        step = min(round(self.now_s / step_s), len(self.day_ahead.grid_kw) - 1)
        self.day_ahead_grid_kw = self.day_ahead.grid_kw[step]
        self.day_ahead_soc_percent = self.day_ahead.soc_percent[step - 1] if step > 0 else self.soc_percent
        self.planned_grid_kw, self.planned_battery_kw = self.plan.grid_kw[0], self.plan.battery_kw[0]

    def decide(self):
        if self.now_s >= self.planned_until_s:
            self.make_plan()
        battery_kw = self.plan.battery_kw[0]
        if abs(self.plan.grid_kw[0]) < 0.1:  # the plan is to live on what there is: the battery takes what comes otherwise
            battery_kw += self.need_kw - self.planned_need_kw
        at_least_kw = self.need_kw + self.plan.running[0] * self.compressor_kw - self.connection_kw
        if self.soc_percent > self.low_percent:  # what was agreed for the connection holds for what happens, too
            battery_kw = max(battery_kw, at_least_kw)
        return round(min(max(battery_kw, -self.battery_kw), self.battery_kw), 3), self.plan.running[0]


if __name__ == "__main__":
    if importlib.util.find_spec("scipy") is None:
        sys.exit(f"{sys.executable} has no scipy: on Debian, apt install python3-scipy; elsewhere name a Python that has it in the first line of {__file__}")
    Predictive.main()
