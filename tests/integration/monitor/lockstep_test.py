# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run is the same with the monitor and without it, whoever looks, however slowly."""
import unittest

import client
import harness
from slow_clients import dropped_for_slow_clients, slow_clients_of

CASE_2 = harness.SOURCE / "configs/scenarios/protection_lockstep.yaml"
SHORT = ["--set", "simulation.duration_s=0.4", "--set", "events.fault.at_s=0.2", "--set", "expect=~"]


class Lockstep(harness.ScenarioTest):
    def test_ten_slow_clients_change_nothing(self):
        alone = self.run_to_end("alone", [*SHORT, "--set", "processes.monitor=~"], scenario=CASE_2)
        watched = self.start("watched", [*SHORT, "--speed", "0.02"], scenario=CASE_2)  # slow enough for all of them to come, and to lose something
        address = client.monitor_of(watched)
        slow = slow_clients_of(address)
        while dropped_for_slow_clients(address) == 0:  # they are slow indeed
            self.assertIsNone(watched.process.poll(), "the run ended before a client was too slow")
        self.assertEqual(watched.finish(), harness.OK, watched.stderr())
        for one in slow:
            one.close()
        self.assert_identical(alone, watched)

        # The negative control: another run is another one.
        other = self.run_to_end("other", [*SHORT, "--set", "processes.monitor=~", "--set", "events.fault.at_s=0.21"], scenario=CASE_2)
        code, _ = self.compare(alone, other)
        self.assertEqual(code, harness.EXPECTATION)


if __name__ == "__main__":
    unittest.main()
