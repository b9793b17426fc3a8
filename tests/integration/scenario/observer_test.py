# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Who only looks decides nothing: a monitor that is killed comes back, one that stands still is not waited for."""
import os
import signal
import unittest

from harness import OK, ScenarioTest

TWO_HOURS = ["--until", "2h", "--set", "expect=~"]


class Observer(ScenarioTest):
    def test_a_killed_and_a_stopped_monitor_change_nothing_and_it_comes_back(self):
        alone = self.run_to_end("alone", [*TWO_HOURS, "--set", "processes.monitor=~"])
        watched = self.start("watched", [*TWO_HOURS, "--speed", "900"])
        watched.wait_for_time(300)
        first = watched.pid_of("monitor")
        os.kill(first, signal.SIGKILL)
        watched.wait_for_time(4000)
        second = watched.pid_of("monitor")
        self.assertNotEqual(first, second)
        os.kill(second, signal.SIGSTOP)
        self.assertEqual(watched.finish(), OK, watched.stderr())
        self.assertEqual(watched.left_over(), {})
        self.assert_identical(alone, watched)
        said = [(event["source"], event["event"]) for event in watched.events() if event["source"] == "monitor"]
        self.assertEqual([event for _, event in said][:2], ["exit", "started_again"])


if __name__ == "__main__":
    unittest.main()
