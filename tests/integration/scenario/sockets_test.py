#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Who is not asked for many ticks of lockstep takes what comes all the same: its sockets must not fill up."""
import pathlib
import time
import unittest

from harness import BASE, ScenarioTest


def waiting_octets(pid):
    """In the receive buffers of the process's host: nobody else of this scenario is there but the simulator."""
    lines = pathlib.Path(f"/proc/{pid}/net/udp").read_text().splitlines()[1:]
    return sum(int(line.split()[4].split(":")[1], 16) for line in lines)


class Sockets(ScenarioTest):
    def test_those_of_a_recorder_are_empty_most_of_the_time_between_the_ticks_in_which_it_works(self):
        """Five ticks a second of the wall clock, and it works in every sixteenth: without a look they are empty 6 % of the time."""
        run = self.start("run", [*BASE, "--speed", "5", "--until", "60s", "--set", "expect=~"])
        run.wait_for_time(2)
        recorder = run.pid_of("recorder")
        looks = []
        while len(looks) < 400:
            looks.append(waiting_octets(recorder))
            time.sleep(0.01)
        run.end_by_force()
        self.assertGreater(looks.count(0), len(looks) // 2, looks)


if __name__ == "__main__":
    unittest.main()
