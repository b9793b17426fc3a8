# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""How the expectations stand is told while a run goes on, and what is told for good is what the report says."""
import json
import os
import signal
import unittest

import client
import harness

CASE_2 = harness.SOURCE / "configs/scenarios/protection_lockstep.yaml"
EXPECT = """{
  trips: {time_of: relay.relay2.trip == true, since: fault, unit: ms, between: [1, 40]},
  quiet_before: {never: relay.relay2.trip == true, until: fault},
  current_within: {max_of: ct.CT21.i.a, below: 1e6},
  current_below_a_tenth_of_the_load: {max_of: ct.CT21.i.a, below: 1},
  opens_too_early: {time_of: breaker.CB3.position == open, since: fault, unit: ms, below: 1}
}"""
# The control: what fails for good fails by its bound alone.
WIDER = EXPECT.replace("max_of: ct.CT21.i.a, below: 1}", "max_of: ct.CT21.i.a, below: 1e7}")


class Standing(harness.ScenarioTest):
    def run_watched(self, name, expect):
        """A run's standings as they were told, newest last, and its summary."""
        run = self.start(name, ["--set", "simulation.duration_s=0.6", "--set", "events.fault.at_s=0.2", "--set", f"expect={expect}", "--speed", "0.05"],
                         scenario=CASE_2)
        monitor = client.monitor_of(run)
        told = [monitor.until("/api/v1/verdict", lambda v: at(v, "current_within")["standing"] == "holds", "a value before the end")]
        told.append(monitor.until("/api/v1/verdict", lambda v: at(v, "trips")["standing"] not in ("unknown", None), "the trip, before the end"))
        self.assertIsNone(run.process.poll(), "the run was over")
        run.finish()
        return told, json.loads((run.folder / "report/summary.json").read_text()), run

    def test_what_is_told_for_good_is_what_the_report_says(self):
        told, summary, run = self.run_watched("run", EXPECT)
        early, late = told
        self.assertFalse(early["judged"])
        self.assertLess(early["reached_s"], 0.4)
        self.assertIsNotNone(at(early, "current_within")["value"])
        standings = {e["name"]: e["standing"] for e in late["expectations"]}
        self.assertEqual((standings["trips"], standings["quiet_before"], standings["current_within"]), ("passed", "passed", "holds"))
        self.assertEqual((standings["current_below_a_tenth_of_the_load"], standings["opens_too_early"]), ("failed", "failed"))
        decided = 0
        for said in told:
            for e in said["expectations"]:
                if e["standing"] in ("passed", "failed"):
                    self.assertEqual(at(summary, e["name"])["pass"], e["standing"] == "passed", e)
                    decided += 1
        self.assertGreaterEqual(decided, 4)
        self.assertEqual(at(summary, "trips")["value"], at(late, "trips")["value"], "the same judge")
        self.assertGreaterEqual(at(summary, "current_within")["value"], at(late, "current_within")["value"])
        self.assertFalse((run.folder / "so_far.json").exists(), "the report has taken its place")

    def test_who_judges_while_it_runs_decides_nothing(self):
        run = self.start("killed", ["--set", "simulation.duration_s=0.6", "--set", "events.fault.at_s=0.2", "--set", f"expect={EXPECT}", "--speed", "0.05"], scenario=CASE_2)
        monitor = client.monitor_of(run)
        monitor.until("/api/v1/verdict", lambda v: at(v, "current_within")["standing"] == "holds", "a value before the end")
        judges = [pid for pid, name in harness.processes_of_session(run.pid).items() if name == "gridspace-judge"]
        self.assertEqual(len(judges), 1)
        os.kill(judges[0], signal.SIGKILL)
        self.assertEqual(run.finish(), harness.EXPECTATION, "it ends as it does beside its judge")
        wanted = {"trips": True, "quiet_before": True, "current_within": True, "current_below_a_tenth_of_the_load": False, "opens_too_early": False}
        self.assertEqual({name: at(run.summary(), name)["pass"] for name in wanted}, wanted)
        self.assertEqual(run.left_over(), {})
        self.assertFalse((run.folder / "so_far.json").exists())

    def test_without_a_monitor_nobody_judges_while_it_runs(self):
        run = self.start("alone", ["--set", "processes.monitor=~", "--set", "simulation.duration_s=0.4", "--set", "events.fault.at_s=0.2", "--set", f"expect={EXPECT}",
                                   "--speed", "0.2"], scenario=CASE_2)
        run.wait_for_time(0.1)
        self.assertNotIn("gridspace-judge", harness.processes_of_session(run.pid).values())
        self.assertEqual(run.finish(), harness.EXPECTATION)

    def test_with_a_wider_bound_it_does_not_fail(self):
        told, summary, _ = self.run_watched("wider", WIDER)
        self.assertEqual(at(told[-1], "current_below_a_tenth_of_the_load")["standing"], "holds")
        self.assertIs(at(summary, "current_below_a_tenth_of_the_load")["pass"], True)


def at(verdict, name):
    return next(e for e in verdict["expectations"] if e["name"] == name)


if __name__ == "__main__":
    unittest.main()
