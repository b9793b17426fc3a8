# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams over UDP (R-GOOSE, R-SV): as tshark sees them, what receivers make of them, and what is refused."""
import subprocess
import unittest

from harness import HANG_S, SOURCE, USAGE, ScenarioTest, gridspace

ROUTED = SOURCE / "configs/scenarios/protection_routed.yaml"
ETHERNET = """---
gridspace: 1
extends: {routed}
name: ethernet
streams:
  SMV21: {{udp: ~, mac: "01:0C:CD:04:00:21"}}
  SMV22: {{udp: ~, mac: "01:0C:CD:04:00:22"}}
  TRIP2: {{udp: ~, mac: "01:0C:CD:01:00:02"}}
"""
LOSES_SAMPLES = """---
gridspace: 1
extends: {routed}
name: loses_samples
simulation: {{duration_s: 0.1}}
events: {{fault: {{at_s: 0.05}}}}
hosts: {{cable: {{links: []}}}}
processes:
  cable: {{program: gridspace-link, host: cable, place: {{between: [ied2, process_bus]}}, direction: to_host,
           samples: {{three: {{stream: SMV21, index: 100, count: 3, do: lose}}}}}}
expect:
  smv_lost: ~
  lost: {{last_of: stream.SMV21.lost, is: 3}}
  others: {{last_of: stream.SMV22.lost, is: 0}}
"""
REAL_TIME = """---
gridspace: 1
extends: {routed}
name: real_time
clock: {{mode: realtime, speed: 1, tick_samples: 4}}
simulation: {{duration_s: 1.2}}
expect: {{frequency_nadir_hz: ~, cb3_open_ms: ~, cb4_open_ms: ~, trip_decided_ms: ~, smv_rate_hz: ~}}
"""
REFUSED = """---
gridspace: 1
extends: {routed}
name: refused
{change}
"""


class Routed(ScenarioTest):
    def tshark(self, run, wanted, *fields):
        said = subprocess.run(["tshark", "-o", "udp.check_checksum:TRUE", "-o", "ip.check_checksum:TRUE", "-r", run.folder / "bus.pcapng.gz", "-Y", wanted, "-T", "fields",
                               *[word for field in fields for word in ("-e", field)]], capture_output=True, text=True, check=True, timeout=HANG_S)
        return [line.split("\t") for line in said.stdout.splitlines()]

    def results(self, run):
        return {one["name"]: one["value"] for one in run.summary()["expectations"]}

    def test_the_run_is_the_same_as_over_ethernet_and_tshark_reads_every_message(self):
        routed = self.run_to_end("routed", scenario=ROUTED)
        ethernet = self.run_to_end("ethernet", scenario=self.write("ethernet.yaml", ETHERNET.format(routed=ROUTED)))
        self.assertEqual(self.results(routed), self.results(ethernet))
        self.assertEqual(self.tshark(routed, "eth.type == 0x88b8 || eth.type == 0x88ba", "frame.number"), [])
        trips = self.tshark(routed, "rgoose.spdu_num", "eth.dst", "ip.dst", "ip.ttl", "ip.dsfield.dscp", "ip.checksum.status", "udp.checksum.status",
                            "rgoose.spdu_num", "rgoose.appid", "goose.gocbRef", "goose.stNum", "goose.sqNum", "goose.boolean")
        of_ethernet = self.tshark(ethernet, "goose", "goose.gocbRef", "goose.stNum", "goose.sqNum", "goose.boolean")
        self.assertGreater(len(trips), 20)
        for n, line in enumerate(trips):
            self.assertEqual(line[:8], ["01:00:5e:40:00:02", "239.192.0.2", "8", "46", "1", "1", str(n), "0x8002"])
        self.assertEqual([line[8:] for line in trips], of_ethernet)
        self.assertEqual({line[11] for line in trips}, {"0", "1"}, "the trip itself is there")
        samples = self.tshark(routed, "udp.port == 102 && !rgoose.spdu_num", "ip.dst", "vlan.priority", "udp.checksum.status")
        self.assertEqual(len(samples), 2 * 1440)
        self.assertEqual({tuple(line) for line in samples}, {("239.192.0.21", "4", "1"), ("239.192.0.22", "4", "1")})

    def test_samples_that_a_cable_loses_are_missed_as_over_ethernet(self):
        run = self.run_to_end("lossy", scenario=self.write("lossy.yaml", LOSES_SAMPLES.format(routed=ROUTED)))
        self.assertEqual(self.results(run)["lost"], 3)

    def test_in_real_time_the_line_is_isolated_and_no_sample_is_lost(self):
        run = self.run_to_end("real_time", scenario=self.write("real_time.yaml", REAL_TIME.format(routed=ROUTED)))
        self.assertEqual(self.results(run)["smv_lost"], 0)
        self.assertGreater(len(self.tshark(run, "rgoose.spdu_num && goose.boolean == 1", "frame.number")), 3)

    def test_what_goes_over_udp_is_no_target_of_attacks_and_not_for_programs_in_simulated_time(self):
        attack = ("hosts: {evil: {links: []}}\nprocesses: {attacker: {program: gridspace-attacker, host: evil}}\nattacks: {a: {by: attacker, "
                  "place: {between: [mu21, process_bus]}, target: {stream: SMV21}, window: {from_s: 0.1, until_s: 0.2}, value: {factor: 2}}}")
        for change, says in ((attack, "goes over UDP"),
                             ("processes: {x: {program: exec, command: [\"true\"], host: ied2, time: simulated, receives: [TRIP2]}}", "goes over UDP"),
                             ("streams: {TRIP2: {udp: {group: 10.0.0.1}}}", "routers forward nothing")):
            code, out, err = gridspace("validate", self.write("refused.yaml", REFUSED.format(routed=ROUTED, change=change)))
            self.assertEqual(code, USAGE, out + err)
            self.assertIn(says, out + err)


if __name__ == "__main__":
    unittest.main()
