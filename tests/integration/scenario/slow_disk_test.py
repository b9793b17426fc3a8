# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A disk that takes its time at the end of a recording spoils no run: nobody waits for it but the launcher."""
import os
import signal
import unittest

from harness import BASE, BIN, CASE_1, INTERRUPTED, OK, PACED, ScenarioTest

PRELOAD = BIN.parent / "tests/libslow_disk.so"


class SlowDisk(ScenarioTest):
    def prefix(self, seconds):
        self.assertTrue(PRELOAD.exists())
        return ["env", f"LD_PRELOAD={PRELOAD}", f"GRIDSPACE_TEST_FSYNC_S={seconds}"]

    def test_the_simulator_does_not_wait_for_the_disk(self):
        """Longer than its patience with a member."""
        run = self.run_to_end("run", [*BASE, "--until", "600s", "--set", "expect=~", "--set", "clock.member_timeout_s=10"], CASE_1, OK, self.prefix(13))
        self.assert_recording_complete(run)

    def test_deadlines_that_are_raised_or_removed_are_so_at_the_end_too(self):
        for value in ("0", "8"):
            run = self.run_to_end(f"run{value}", [*BASE, "--until", "60s", "--set", "expect=~", "--set", f"clock.member_timeout_s={value}"], CASE_1, OK,
                                  self.prefix(12))
            self.assert_recording_complete(run)

    def test_a_recorder_that_is_asked_to_end_may_finish_its_file(self):
        run = self.start("run", PACED, prefix=self.prefix(5))
        run.wait_for_time(1000)
        os.kill(run.pid, signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())
        self.assert_recording_complete(run)
        self.assertEqual(run.manifest()["processes"]["recorder"]["end"], "exit code 0")


if __name__ == "__main__":
    unittest.main()
