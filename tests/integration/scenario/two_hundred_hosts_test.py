# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Two hundred processes, each on a host of its own, find each other and run."""
import unittest

from harness import ScenarioTest
from many_hosts import write_case

AGENTS = 198


class TwoHundredHosts(ScenarioTest):
    def test_they_start_and_run(self):
        run = self.start("run", ["--until", "3s"], write_case(self.folder, AGENTS))
        run.wait_for(lambda line: f"all {AGENTS + 3} processes are ready" in line.get("note", ""), "ready")
        self.assertEqual(run.finish(), 0, run.stderr())
        self.assertEqual(run.left_over(), {})


if __name__ == "__main__":
    unittest.main()
