# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case study 1 over its eight hours: the published hours of charging, what the summary says of the run, and the same once more."""
import unittest

from harness import BASE, OK, ScenarioTest


class Case1(ScenarioTest):
    def test_case_1_meets_all_its_expectations(self):
        run = self.run_to_end("run", BASE)
        summary = run.summary()
        self.assertEqual(summary["scenario"], "ev_charging")
        self.assertEqual(summary["mode"], "lockstep")
        self.assertEqual(summary["simulated_s"], 28800)
        self.assertEqual(summary["exit"], OK)
        expectations = {e["name"]: e for e in summary["expectations"]}
        self.assertEqual(set(expectations), {"ev1_done_h", "ev2_done_h", "ev3_done_h", "ev4_done_h", "v_min_pu", "v_max_pu",
                                             "b1_highest", "b3_lowest", "b4_held_up", "mcca_curtailed"})
        for name, e in expectations.items():
            self.assertTrue(e["pass"], f"{name}: {e}")
            for key in ("value", "unit", "low", "high"):
                self.assertIn(key, e)
        published = {"ev1_done_h": 4.2, "ev2_done_h": 6.2, "ev3_done_h": 7.0, "ev4_done_h": 5.1}
        for name, hours in published.items():
            self.assertEqual(expectations[name]["unit"], "h")
            self.assertAlmostEqual(expectations[name]["value"], hours, delta=0.1)
        self.assertEqual({p["name"] for p in summary["processes"]}, {"sim", "ev1", "ev2", "ev3", "ev4", "mcca", "recorder"})
        samples = {t["name"]: t["samples"] for t in summary["topics"]}
        self.assertEqual(samples["bus_measurements"], 4 * 28801)  # every bus at every step and at the start
        self.assertGreaterEqual(samples["requests"], 4 * 80)
        self.assert_identical(run, self.run_to_end("again", BASE))


if __name__ == "__main__":
    unittest.main(verbosity=2)
