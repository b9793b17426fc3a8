# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A process in the cable between a host and a switch (gridspace-link), in lockstep."""
import unittest

from harness import OK, SHORT_CASE_2, SOURCE, ScenarioTest, busy_loops
from pcapng_file import Capture, octets_of

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


# One network for everything: DDS and the frames of the process bus share the cables.
ONE_BUS = """---
gridspace: 1
extends: base.yaml
name: one_bus
hosts: {simulator: {links: [process_bus]}, mu21: {links: [process_bus]}, mu22: {links: [process_bus]}, ied2: {links: [process_bus]}, bay2: {links: [process_bus]}}
links: {data_bus: ~, process_bus: {ipv4: 10.20.0.0/24}}
"""

ONE_BUS_WITH_SOMEBODY_IN_IT = """---
gridspace: 1
extends: one_bus.yaml
name: one_bus_cut
hosts: {near_unit: {links: []}}
processes:
  near_unit: {program: gridspace-link, host: near_unit, place: {between: [mu21, process_bus]}, direction: from_host%s}
"""


def at_the_switch(run):
    """Frames where they enter a switch: (point, time, octets). Who sits in a cable is a point of its own in the file."""
    return [p[:3] for p in Capture(run.folder / "bus.pcapng.gz").packets if ":" not in p.point]


class Link(ScenarioTest):
    def test_a_cable_that_carries_ip_too_hands_everything_on(self):
        self.write("base.yaml", SHORT_CASE_2)
        without = self.run_to_end("without", scenario=self.write("one_bus.yaml", ONE_BUS))
        within = self.run_to_end("with", scenario=self.write("cut.yaml", ONE_BUS_WITH_SOMEBODY_IN_IT % ""))
        frames = at_the_switch(without)
        self.assertGreater(len(frames), 900)
        self.assertEqual(frames, at_the_switch(within))
        # And it can do harm there: every tenth sample of one end is missing, while DDS passes.
        lossy = self.run_to_end("lossy", scenario=self.write("lossy.yaml", ONE_BUS_WITH_SOMEBODY_IN_IT % ", loss_percent: 10"))
        self.assertLess(len(at_the_switch(lossy)), len(frames))

    def test_a_cable_that_does_nothing_changes_no_frame_and_no_time(self):
        without = self.run_to_end("without", scenario=self.write("base.yaml", SHORT_CASE_2))
        within = self.run_to_end("with", scenario=self.write("pass.yaml", PASS_THROUGH))
        frames = at_the_switch(without)
        self.assertGreater(len(frames), 900)
        self.assertEqual(frames, at_the_switch(within))
        code, said = self.compare(without, within, "--signals", "breaker.*,relay.*,ct.*,stream.*,machine.*")
        self.assertEqual(code, OK, said)

    def test_bad_cables_repeat_bit_by_bit_with_1_2_and_4_samples_per_tick_and_beside_anything(self):
        bad = SOURCE / "tests/scenarios/misbehaviour/samples_twice_and_out_of_order.yaml"
        short = ["--until", "130ms", "--set", "expect=~"]
        four = self.run_to_end("four", short, scenario=bad)
        frames = octets_of(four.folder / "bus.pcapng.gz")
        self.assertGreater(len(frames), 100_000)
        for samples in (1, 2):
            other = self.run_to_end(f"ticks_of_{samples}", [*short, "--set", f"clock.tick_samples={samples}"], scenario=bad)
            self.assertEqual(frames, octets_of(other.folder / "bus.pcapng.gz"))
            code, said = self.compare(four, other, "--signals", "breaker.*,relay.*,ct.*")
            self.assertEqual(code, OK, said)
        with busy_loops():
            loaded = self.run_to_end("loaded", short, scenario=bad)
        self.assert_identical(four, loaded)
        self.assertEqual(frames, octets_of(loaded.folder / "bus.pcapng.gz"))
        seed = self.run_to_end("other_seed", [*short, "--seed", "2"], scenario=bad)
        self.assertNotEqual(frames, octets_of(seed.folder / "bus.pcapng.gz"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
