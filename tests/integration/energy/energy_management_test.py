#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case study 4: what the meter and the plans say is calculated again from the recorded powers and the tariff, with and without the agents."""
import bisect
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
sys.path[:0] = [str(SOURCE / "tests/integration/scenario"), str(SOURCE / "python")]
import harness  # noqa: E402

import gridspace  # noqa: E402

AGENTS = SOURCE / "examples/agents/energy_management"
SCENARIOS = SOURCE / "configs/scenarios"
NOBODY = ["--set", "processes.ems=~", "--set", "simulation.controls=~", "--set", "report=~"]
DAY_S = 24 * 3600


class Day:
    """The energies of a recorded day and what they cost, from the powers of the simulator: trapezoids, cut at the hours."""

    def __init__(self, folder):
        self.run = gridspace.open(folder)
        with (SOURCE / "configs/energy/tariff.csv").open(newline="") as stream:
            self.prices = [(float(row["import_eur_per_kwh"]), float(row["export_eur_per_kwh"])) for row in csv.DictReader(stream)]
        self.cost_eur = self.taken_kwh = self.given_kwh = 0.0
        for hour, kw in self.pieces("generator.UTILITY.p_kw"):
            self.taken_kwh += max(kw, 0)
            self.given_kwh += max(-kw, 0)
            self.cost_eur += max(kw, 0) * self.prices[hour][0] - max(-kw, 0) * self.prices[hour][1]
        self.generated_kwh = sum(self.kwh(name) for name in ("pv.ROOF.p_kw", "pv.TURBINE.p_kw"))
        self.consumed_kwh = sum(self.kwh(name) for name in ("load.WORKSHOP.p_kw", "load.COMPRESSORS.p_kw"))

    def pieces(self, name):
        """(hour, kWh) from each row to the next."""
        signal = self.run.signal(name)
        rows = list(zip(signal.time_s, signal.values, strict=True))
        for (begin_s, first), (end_s, second) in zip(rows, rows[1:], strict=False):
            yield min(int(begin_s // 3600), 23), (first + second) / 2 * (end_s - begin_s) / 3600

    def kwh(self, name):
        return sum(kwh for _, kwh in self.pieces(name))

    def last(self, name):
        return self.run.signal(name).values[-1]


class EnergyManagement(harness.ScenarioTest):
    def day(self, name, scenario, arguments=(), code=harness.OK):
        return Day(self.run_to_end(name, arguments, SCENARIOS / f"{scenario}.yaml", code).folder)

    def assert_in_the_tutorial(self, eur):
        told = [float(n) for n in re.findall(r"(\d+\.\d\d) EUR", (SOURCE / "docs/tutorials/energy_management.md").read_text())]
        self.assertTrue(any(abs(number - eur) < 0.05 for number in told), f"{eur} EUR, and the tutorial says {told}")

    def assert_metered(self, day):
        """The meter's figures, within what rectangles of ten seconds differ from trapezoids."""
        self.assertAlmostEqual(day.last("agent.meter.cost_eur"), day.cost_eur, delta=0.1)
        for name in ("generated", "consumed"):
            self.assertAlmostEqual(day.last(f"agent.meter.{name}_kwh"), getattr(day, f"{name}_kwh"), delta=0.5)
        self.assertAlmostEqual(day.last("agent.meter.self_consumption_percent"), 100 * (1 - day.given_kwh / day.generated_kwh), delta=0.1)
        self.assertAlmostEqual(day.last("agent.meter.self_sufficiency_percent"), 100 * (1 - day.taken_kwh / day.consumed_kwh), delta=0.1)
        lost = day.generated_kwh + day.taken_kwh + day.kwh("battery.STORE.p_kw") - day.consumed_kwh - day.given_kwh
        self.assertTrue(0 < lost < 0.02 * day.consumed_kwh, f"{lost} kWh are lost in the cables")
        self.assertAlmostEqual(day.last("agent.meter.cold_store_ahead_kwh"), day.kwh("load.COMPRESSORS.p_kw") - 24 * 5, delta=0.1)

    def assert_charge_follows_the_power(self, day, capacity_kwh=150, efficiency=0.96, start_percent=40):
        cells_kwh = sum(kwh / efficiency if kwh > 0 else kwh * efficiency for _, kwh in day.pieces("battery.STORE.p_kw"))
        self.assertAlmostEqual(day.last("battery.STORE.soc_percent"), start_percent - 100 * cells_kwh / capacity_kwh, delta=0.5)

    def test_rules_save_what_the_recorded_powers_say_and_a_lost_agent_costs(self):
        managed = self.day("managed", "energy_management")
        alone = self.day("alone", "energy_management", NOBODY, code=harness.EXPECTATION)
        lost = self.day("lost", "energy_management_agent_lost")
        for day in (managed, alone, lost):
            self.assert_metered(day)
            self.assert_charge_follows_the_power(day)
            self.assert_in_the_tutorial(day.last("agent.meter.cost_eur"))
        failed = {e.name for e in alone.run.expectations if e.passed is False}
        self.assertLessEqual({"cost_eur", "self_consumption_percent", "self_sufficiency_percent"}, failed, "without the agent it is not as expected")
        self.assertGreater(alone.cost_eur, managed.cost_eur + 25)
        self.assertTrue(managed.cost_eur + 15 < lost.cost_eur < alone.cost_eur - 3, f"{managed.cost_eur}, {lost.cost_eur}, {alone.cost_eur} EUR")
        self.assertEqual([e.time_s for e in lost.run.events if e.event == "control_fallback"], [51190, 51190])
        same, other = managed.run.signal("battery.STORE.p_kw"), lost.run.signal("battery.STORE.p_kw")
        before = bisect.bisect_right(same.time_s, 14 * 3600)
        self.assertEqual(same.values[:before], other.values[:before], "until it is lost the day is the same")

    def test_a_plan_is_better_than_rules_and_what_it_promises_is_what_its_powers_cost(self):
        planned = self.day("planned", "energy_management_predictive")
        self.assert_metered(planned)
        self.assert_charge_follows_the_power(planned)
        self.assertLess(planned.cost_eur, 34, "rules end at 34.68")
        grid = planned.run.signal("agent.ems.day_ahead_grid_kw")
        promised = sum(max(kw, 0) * planned.prices[h // 2][0] - max(-kw, 0) * planned.prices[h // 2][1]
                       for h in range(48) for kw in [grid.at(h * 1800 + 900)]) / 2
        self.assertAlmostEqual(planned.last("agent.ems.day_ahead_cost_eur"), promised, delta=0.01)
        for eur in (promised, planned.last("agent.meter.cost_eur")):
            self.assert_in_the_tutorial(eur)
        self.assertGreater(planned.cost_eur, promised, "the weather was worse than forecast")
        log = (planned.run.folder / "logs/ems.log").read_text()
        self.assertNotIn("Traceback", log)

    def test_a_mistake_in_a_table_is_named_with_its_line(self):
        shutil.copytree(SOURCE / "configs", self.folder / "configs")
        shutil.copytree(SOURCE / "examples/agents/energy_management", self.folder / "examples/agents/energy_management")
        tariff = self.folder / "configs/energy/tariff.csv"
        tariff.write_text(tariff.read_text().replace("\n5,0.22,0.06\n", "\n5,cheap,0.06\n"))
        run = self.run_to_end("wrong", ["--until", "1min", "--set", "expect=~"], self.folder / "configs/scenarios/energy_management.yaml",
                              harness.CHILD_DIED)
        self.assertIn(f"{tariff}:7: import_eur_per_kwh is 'cheap', expected a number", run.summary()["cause"])

    def test_a_python_without_scipy_is_refused_before_anything_starts(self):
        scenario = json.dumps({"extends": str(SCENARIOS / "energy_management_predictive.yaml"), "processes": {
            "ems": {"program": {"path": "/usr/bin/python3", "arguments": ["-S", str(AGENTS / "predictive.py")]}}}})  # -S: no packages of the system
        code, out, err = harness.gridspace("validate", self.write("bare.yaml", scenario))
        self.assertEqual(code, harness.USAGE)
        self.assertIn("has no scipy: on Debian, apt install python3-scipy", out + err)


class Plans(harness.ScenarioTest):
    def plan(self, question):
        """What plan.py answers, in the Python that the agent runs in."""
        code = ("import json, sys, dataclasses, plan; q = json.load(sys.stdin); "
                "print(json.dumps([dataclasses.asdict(plan.cheapest(plan.Site(**q['site']), **a)) for a in q['ask']]))")
        done = subprocess.run([(AGENTS / "predictive.py").read_text().splitlines()[0][2:], "-c", code], input=json.dumps(question), text=True,
                              capture_output=True, cwd=AGENTS, timeout=harness.HANG_S, check=False, env={**os.environ, "PYTHONPATH": str(AGENTS)})
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_no_other_schedule_of_whole_compressors_and_whole_kilowatts_is_cheaper(self):
        site = {"capacity_kwh": 12, "battery_kw": 3, "efficiency": 1.0, "low_percent": 0, "high_percent": 100, "compressor_kw": 2,
                "compressor_count": 2, "buffer_kwh": 3, "connection_kw": 9}
        ask = {"need_kw": [3, -4, 5, 6], "import_price": [0.2, 0.25, 0.5, 0.4], "export_price": [0.05, 0.02, 0.1, 0.1], "step_h": 1.0,
               "soc_percent": 25, "ahead_kwh": 0.0, "end_percent": 25}
        answer = self.plan({"site": site, "ask": [ask]})[0]

        def best(step, stored, ahead):
            """The least cost from a step on, by trying everything."""
            if step == 4:
                return 0 if stored >= 3 and ahead >= 0 else float("inf")
            costs = []
            for battery in range(-3, 4):
                for running in range(3):
                    if 0 <= stored - battery <= 12 and abs(ahead + 2 * running - 2) <= 3:
                        grid = ask["need_kw"][step] + 2 * running - battery
                        if grid <= 9:
                            own = max(grid, 0) * ask["import_price"][step] - max(-grid, 0) * ask["export_price"][step]
                            costs.append(own + best(step + 1, stored - battery, ahead + 2 * running - 2))
            return min(costs, default=float("inf"))

        self.assertLessEqual(answer["cost_eur"], best(0, 3, 0) * 1.002 + 0.03, "wear, and the gap that the solver may leave")
        self.assertGreaterEqual(answer["cost_eur"], best(0, 3, 0) - 0.3, "half kilowatts help it a little, and no more")
        self.assertEqual(sum(answer["running"]), 4)
        self.assertTrue(all(n == int(n) for n in answer["running"]))

    def test_what_cannot_be_is_planned_as_well_as_it_goes(self):
        site = {"capacity_kwh": 10, "battery_kw": 2, "efficiency": 0.9, "low_percent": 10, "high_percent": 90, "compressor_kw": 1,
                "compressor_count": 1, "buffer_kwh": 1, "connection_kw": 4}
        ask = {"import_price": [0.3, 0.3], "export_price": [0.1, 0.1], "step_h": 1.0, "ahead_kwh": 0.0}
        empty, over = self.plan({"site": site, "ask": [{**ask, "need_kw": [0, 0], "soc_percent": 5, "end_percent": 90},
                                                       {**ask, "need_kw": [9, 9], "soc_percent": 90, "end_percent": 10}]})
        self.assertAlmostEqual(empty["battery_kw"][0], -2, places=6)
        self.assertAlmostEqual(empty["soc_percent"][1], 10 + 2 * 2 * 0.9 * 10, places=6)
        self.assertAlmostEqual(sum(over["battery_kw"]), 2 + 2, places=6)
        self.assertGreater(over["grid_kw"][0], 4)


if __name__ == "__main__":
    import unittest

    unittest.main()
