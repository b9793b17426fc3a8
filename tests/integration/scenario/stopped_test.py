# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A process that is stopped (SIGSTOP) is named itself, whoever notices first; one that ends as it should is not called killed."""
import os
import signal
import unittest

from harness import PACED, STALL, ScenarioTest
from many_hosts import write_case


class Stopped(ScenarioTest):
    def stop_in_mid_run(self, victim, *extra):
        run = self.start("run", [*PACED, "--set", "clock.member_timeout_s=2", *extra])
        run.wait_for_time(1000)
        os.kill(run.pid_of(victim), signal.SIGSTOP)
        self.assertEqual(run.finish(), STALL, run.stderr())
        self.assertEqual(run.left_over(), {})
        self.assertRegex(run.summary()["cause"], f"^process '{victim}' is stopped|^the simulator '{victim}' stands still")

    def test_the_simulator_is_named(self):
        self.stop_in_mid_run("sim")

    def test_an_agent_is_named(self):
        self.stop_in_mid_run("ev3")

    def test_the_controller_is_named(self):
        self.stop_in_mid_run("mcca")

    def test_the_recorder_is_named(self):
        self.stop_in_mid_run("recorder")

    def test_a_program_that_is_told_to_end_and_does_is_not_called_killed(self):
        run = self.run_to_end("run", ["--set", "processes.own={program: exec, host: h0, command: [sleep, '1000']}"],
                              write_case(self.folder, 1, duration_s=1))
        own = run.manifest()["processes"]["own"]
        self.assertEqual((own["exit"], own["end"]), (0, "ended when asked"))


if __name__ == "__main__":
    unittest.main()
