# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Doubly attached nodes (PRP): trailers as tshark sees them, and what is refused."""
import collections
import re
import subprocess
import unittest

from harness import HANG_S, SOURCE, USAGE, ScenarioTest, gridspace

PRP = SOURCE / "configs/scenarios/protection_prp.yaml"
SHORT = """---
gridspace: 1
extends: {prp}
name: short
expect: ~
"""
REAL_TIME = """---
gridspace: 1
extends: {prp}
name: real_time
clock: {{mode: realtime, speed: 1, tick_samples: 4}}
expect: ~
"""
WRONG = """---
gridspace: 1
extends: {prp}
name: wrong
{change}
"""


class Prp(ScenarioTest):
    def trailers(self, run):
        """By source address and network: the sequence numbers, in the order of the capture."""
        fields = ["eth.src", "prp.trailer.prp_lan", "prp.trailer.prp_sequence_nr", "frame.len", "prp.trailer.prp_size", "vlan.id"]
        said = subprocess.run(["tshark", "--enable-protocol", "prp", "-r", run.folder / "bus.pcapng.gz", "-Y", "eth.type == 0x88ba || eth.type == 0x88b8 || vlan", "-T", "fields",
                               *[word for field in fields for word in ("-e", field)]], capture_output=True, text=True, check=True, timeout=HANG_S)
        out = collections.defaultdict(list)
        for line in said.stdout.splitlines():
            source, lan, sequence, length, size, vlan = line.split("\t")
            self.assertTrue(lan, f"a frame without a trailer: {line}")
            self.assertEqual(int(size), int(length) - (18 if vlan else 14), line)
            out[source, int(lan, 0)].append(int(sequence))
        # A frame is captured on both sides of who sits in its cable.
        return {who: list(dict.fromkeys(numbers)) for who, numbers in out.items()}

    def test_every_frame_is_on_both_networks_once_with_a_trailer_that_tshark_reads(self):
        run = self.run_to_end("run", ["--until", "0.06s"], scenario=self.write("short.yaml", SHORT.format(prp=PRP)))
        trailers = self.trailers(run)
        self.assertEqual(len({source for source, _ in trailers}), 3, "two merging units and the relay")
        for (source, lan), numbers in trailers.items():
            # The relay's cable to network A is cut, so what it sends after that is on B alone.
            whole = max(trailers[source, 0xA], trailers[source, 0xB], key=len)
            self.assertEqual(sorted(whole), list(range(len(whole))), (source, lan))
            self.assertGreater(len(numbers), 5)

    def test_in_real_time_a_cut_network_costs_no_sample(self):
        scenario = self.write("real_time.yaml", REAL_TIME.format(prp=PRP))
        run = self.run_to_end("run", ["--until", "0.3s"], scenario=scenario)
        lost = [e for e in run.events() if "lost" in e["event"] and "TRIP2" not in e["text"]]  # a message may expire on a busy machine
        self.assertEqual(lost, [])
        log = (run.folder / "logs/relay2.log").read_text()
        counted = {m[1]: tuple(map(int, m.groups()[1:])) for m in re.finditer(r"PRP, network (.): (\d+) frames received, (\d+) of them before", log)}
        # Each sample of two streams has come once, whichever network it came by; the last ones may still be on their way.
        self.assertGreaterEqual(counted["A"][1] + counted["B"][1], 2 * 4800 * 0.3 - 40, log)
        self.assertGreater(counted["A"][1], 100, log)
        self.assertGreater(counted["B"][1], 100, "while A was cut")

    def test_what_prp_cannot_be_is_refused_with_the_place(self):
        for change, says in (("processes: {relay2: {prp: [lan_a]}}", "is not on two networks"),
                             ("processes: {relay2: {prp: [lan_a, lan_a]}}", "is not on two networks"),
                             ("processes: {relay2: {link: lan_a}}", "has `prp` and `link`"),
                             ("processes: {sim: {prp: [lan_a, lan_b]}}", "exchanges no raw frames, and has `prp`"),
                             ("processes: {relay2: {prp: [lan_a, data_bus]}}", "is not plugged into it"),
                             ("processes: {relay2: {run_on: external}}", "runs on external")):
            code, out, err = gridspace("validate", self.write("wrong.yaml", WRONG.format(prp=PRP, change=change)))
            self.assertEqual(code, USAGE, out + err)
            self.assertIn(says, out + err)


if __name__ == "__main__":
    unittest.main(verbosity=2)
