# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A process in the cable between a host and a switch (gridspace-link), in lockstep."""
import unittest

from harness import OK, SOURCE, ScenarioTest

BASE = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection_lockstep.yaml
name: short
simulation: {{duration_s: 0.1}}
processes: {{monitor: ~}}
events: {{fault: {{at_s: 0.04}}}}
record: {{comtrade: ~}}
expect: ~
"""

PASS_THROUGH = """---
gridspace: 1
extends: base.yaml
name: pass_through
hosts: {near_unit: {links: []}, near_relay: {links: []}, beside: {links: []}}
processes:
  near_unit: {program: gridspace-link, host: near_unit, place: {between: [mu21, process_bus]}}
  near_relay: {program: gridspace-link, host: near_relay, place: {between: [ied2, process_bus]}, direction: to_host}
  beside: {program: gridspace-link, host: beside, place: {between: [ied2, process_bus]}, direction: from_host}
"""


class Link(ScenarioTest):
    def test_a_cable_that_does_nothing_changes_no_frame_and_no_time(self):
        without = self.run_to_end("without", scenario=self.write("base.yaml", BASE))
        within = self.run_to_end("with", scenario=self.write("pass.yaml", PASS_THROUGH))
        frames = (without.folder / "bus.pcapng").read_bytes()
        self.assertGreater(len(frames), 100_000)
        self.assertEqual(frames, (within.folder / "bus.pcapng").read_bytes())
        code, said = self.compare(without, within, "--signals", "*")
        self.assertEqual(code, OK, said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
