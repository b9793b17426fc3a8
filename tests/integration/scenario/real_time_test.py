# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run in real time says how late its ticks were, beside what `gridspace doctor --latency` has found of this machine."""
import json
import os
import pathlib
import re
import unittest

import harness


class RealTime(harness.ScenarioTest):
    def run_short(self, scenario="protection", *changes):
        file = self.write("short.yaml", harness.short_case_2(scenario, 0.2, "{}"))
        out = self.folder / "run"
        env = {**os.environ, "GRIDSPACE_CACHE": str(self.folder / "cache")}
        code, _, err = harness.gridspace("run", file, "--out", out, "--quiet", *changes, env=env)
        self.assertEqual(code, harness.OK, err)
        return json.loads((out / "report/summary.json").read_text()), (out / "report/index.html").read_text(encoding="utf-8")

    def keeps_awake(self, processors):
        """Whether the launcher holds the request while the run is under way, and none of its processes does."""
        file = self.write("long.yaml", harness.short_case_2("protection", 30, "{}"))
        run = self.start(processors, ["--set", f"clock.processors={processors}"], file)
        run.wait_for_time(0.1)

        def holds(pid):
            return "/dev/cpu_dma_latency" in [os.readlink(fd) for fd in pathlib.Path(f"/proc/{pid}/fd").iterdir() if fd.is_symlink()]

        self.assertFalse(holds(run.pid_of("sim")))
        held = holds(run.pid_of("launcher"))
        run.end_by_force()
        return held

    def test_the_ticks_of_a_run_are_counted_and_a_machine_that_was_not_measured_is_said_to_be_so(self):
        summary, page = self.run_short()
        ticks = summary["ticks"]
        self.assertEqual(ticks["instants"], 240)  # 0.2 s of 4 samples of 4800 Hz
        self.assertAlmostEqual(ticks["period_us"], 833.333, places=3)
        self.assertLessEqual(ticks["p50_us"], ticks["p99_us"])
        self.assertLessEqual(ticks["p99_us"], ticks["p999_us"])
        self.assertLessEqual(ticks["p999_us"], ticks["worst_us"])
        self.assertIn("How real-time it was", page)
        self.assertIn("was not measured before the run", page)

    def test_where_it_is_permitted_the_simulator_is_above_those_who_wait_for_its_samples(self):
        self.run_short()
        logs = {log.stem: re.search(r"SCHED_FIFO (\d+)", log.read_text()) for log in (self.folder / "run/logs").glob("*.log")}
        priorities = {name: int(found[1]) for name, found in logs.items() if found}
        if json.loads((self.folder / "run/manifest.json").read_text())["scheduling"] == "SCHED_FIFO":
            self.assertEqual(set(priorities), {"sim", "mu21", "mu22", "relay2", "breaker2"})
        for name in set(priorities) - {"sim"}:
            self.assertGreater(priorities["sim"], priorities[name], name)

    def test_idle_processors_stay_awake_where_that_is_permitted_and_the_scenario_does_not_refuse_it(self):
        summary, page = self.run_short()
        driver = pathlib.Path("/sys/devices/system/cpu/cpuidle/current_driver")
        may = os.access("/dev/cpu_dma_latency", os.W_OK) and (not driver.exists() or driver.read_text().strip() != "none")
        self.assertRegex(summary["idle_processors"], "^awake$" if may else "^may sleep: ")
        self.assertIn("<dt>idle processors</dt>", page)
        self.assertEqual(self.keeps_awake("awake"), may)
        self.assertFalse(self.keeps_awake("sleep"))
        self.folder = self.folder / "refused"
        self.folder.mkdir()
        summary, _ = self.run_short("protection", "--set", "clock.processors=sleep")
        self.assertEqual(summary["idle_processors"], "may sleep, as the scenario asks")

    def test_at_half_the_pace_a_tick_is_twice_as_long(self):
        summary, _ = self.run_short("protection", "--set", "clock.speed=0.5", "--set", "clock.start_at=~")
        self.assertAlmostEqual(summary["ticks"]["period_us"], 1666.667, places=3)

    def test_what_the_doctor_has_measured_stands_beside_them(self):
        env = {**os.environ, "GRIDSPACE_CACHE": str(self.folder / "cache")}
        code, told, err = harness.gridspace("doctor", "--latency", "--seconds", "0.1", env=env)
        self.assertEqual(code, harness.OK, err)
        self.assertIn(str(self.folder / "cache/latency.json"), told)
        _, page = self.run_short()
        self.assertIn("this machine: sleeping", page)
        other = self.folder / "other"  # what another machine can do says nothing here
        (other / "cache").mkdir(parents=True)
        kept = json.loads((self.folder / "cache/latency.json").read_text())
        (other / "cache/latency.json").write_text(json.dumps({**kept, "machine": "another one"}))
        self.folder = other
        _, page = self.run_short()
        self.assertNotIn("this machine: ", page)

    def test_lockstep_knows_no_late_ticks(self):
        summary, page = self.run_short("protection_lockstep")
        self.assertIsNone(summary["ticks"])
        self.assertNotIn("How real-time it was", page)


if __name__ == "__main__":
    unittest.main()
