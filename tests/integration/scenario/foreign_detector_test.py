# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A detector that is not Gridspace's, in Python, permits the trip of a relay in lockstep."""
import unittest

from harness import EXPECTATION, OK, SOURCE, USAGE, ScenarioTest, gridspace

SCENARIO = SOURCE / "examples/detectors/in_the_loop/masquerade.yaml"


MUTE = """#!/usr/bin/env python3
import gridspace

class Mute(gridspace.Agent):
    verdicts = gridspace.Writes("verdicts", "IdsVerdict")

if __name__ == "__main__":
    Mute.main()
"""


class ForeignDetector(ScenarioTest):
    def told(self, run):
        return [(e["event"], e["text"]) for e in run.events() if e["source"] == "relay2" and e["event"] in ("trip", "trip_withheld", "trip_permitted")]

    def test_a_forged_fault_is_withheld_a_real_one_trips_and_both_repeat_to_the_octet(self):
        first, second = (self.run_to_end(name, scenario=SCENARIO) for name in ("first", "second"))
        self.assert_identical(first, second)
        told = self.told(first)
        self.assertIn(("trip_withheld", "detector: the detector flags the samples"), told)
        self.assertEqual([kind for kind, _ in told if kind == "trip"], ["trip"])

    def test_without_it_the_relay_trips_by_the_forgery(self):
        run = self.run_to_end("alone", ["--set", "processes.relay2.foreign_detector=null", "--set", "expect.flagged=null"], SCENARIO, EXPECTATION)
        self.assertLess(next(e["time_s"] for e in run.events() if e["event"] == "trip"), 0.15)

    def test_a_detector_that_never_speaks_costs_the_wait_or_blocks_as_is_asked(self):
        mute = self.write("mute.py", MUTE)
        mute.chmod(0o755)
        base = self.write("mute.yaml", f"---\ngridspace: 1\nextends: {SCENARIO}\nname: mute\nexpect: ~\nprocesses: {{detector: ~, mute: {{program: {{path: mute.py}}, host: detector}}}}\n")
        run = self.run_to_end("trip", scenario=base)
        self.assertIn(("trip_permitted", "the detector has said nothing"), self.told(run))
        run = self.run_to_end("block", ["--set", "processes.relay2.foreign_detector.unheard=block"], base)
        self.assertNotIn("trip", [kind for kind, _ in self.told(run)])

    def test_verdicts_that_nobody_gives_are_said_before_anything_runs(self):
        code, out, err = gridspace("validate", SCENARIO, "--set", "processes.relay2.foreign_detector.verdicts=nobody")
        self.assertEqual(code, USAGE)
        self.assertIn("reads the topic 'nobody', which nobody writes", out + err)
        self.assertEqual(gridspace("validate", SCENARIO)[0], OK)


if __name__ == "__main__":
    unittest.main()
