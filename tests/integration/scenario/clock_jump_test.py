# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a device's machine is set, or is another than the simulator's: in lockstep nothing changes, in real time the run ends."""
import unittest

from harness import BASE, BIN, CASE_1, ENVIRONMENT, OK, ScenarioTest

PRELOAD = BIN.parent / "tests/libclock_jump.so"
REAL_TIME = [*BASE, "--speed", "60", "--set", "clock.mode=realtime", "--set", "expect=~"]


class ClockJump(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.switch = self.folder / "an_hour_ahead"
        self.prefix = ["env", f"LD_PRELOAD={PRELOAD}", f"GRIDSPACE_TEST_CLOCK={self.switch}", "GRIDSPACE_TEST_CLOCK_PROCESS=ev1"]
        self.assertTrue(PRELOAD.exists())

    def test_in_real_time_a_clock_that_is_set_ends_the_run_with_its_name_and_what_to_do(self):
        run = self.start("set", REAL_TIME, CASE_1, self.prefix)
        run.wait_for_time(60)
        self.switch.touch()
        self.assertEqual(run.finish(), ENVIRONMENT, run.stderr())
        self.assertIn("ev1: the clock of this machine was set forward by 3600.", run.stderr())
        self.assertIn("chrony", run.stderr())

    def test_in_real_time_another_clock_than_the_simulators_ends_the_run(self):
        self.switch.touch()
        run = self.start("other", REAL_TIME, CASE_1, self.prefix)
        self.assertEqual(run.finish(), ENVIRONMENT, run.stderr())
        self.assertRegex(run.stderr(), r"ev1: the clock of this machine is (3600\.\d|3599\.9)\d* s ahead of that of the simulator's machine")

    def test_a_clock_that_nobody_touches_disturbs_nobody(self):
        self.run_to_end("untouched", [*REAL_TIME, "--until", "120s"], CASE_1, OK, self.prefix)

    def test_in_lockstep_no_clock_counts(self):
        short = [*BASE, "--until", "1200s", "--set", "expect=~"]
        still = self.run_to_end("still", short)
        run = self.start("set", [*short, "--speed", "600"], CASE_1, self.prefix)
        run.wait_for_time(300)
        self.switch.touch()
        self.assertEqual(run.finish(), OK, run.stderr())
        self.assert_identical(still, run)


if __name__ == "__main__":
    unittest.main()
