# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""bus.pcapng.gz holds every frame of every link: at the switches, on both sides of who sits in a cable, and on real interfaces."""
import collections
import json
import sys
import unittest

from harness import SHORT_CASE_2, SOURCE, ScenarioTest, gridspace
from pcapng_file import INBOUND, OUTBOUND, Capture, ethertype

SMV, GOOSE = b"\x88\xba", b"\x88\xb8"
EPOCH_NS = 1575158400 * 10**9  # 2019-12-01T00:00:00Z

# One cable loses and repeats what its host sends; the other delays what its host receives.
CUT = """---
gridspace: 1
extends: base.yaml
name: cut
impairments:
  lossy: {place: {between: [mu21, process_bus]}, direction: from_host, loss_percent: 20, duplicate_percent: 10, duplicate_after_us: 300}
  slow: {place: {between: [bay2, process_bus]}, direction: to_host, delay_us: 500}
"""
BEFORE, AFTER, SLOW = "process_bus/mu21:lossy", "process_bus/mu21", "process_bus/bay2:slow"

ON_REAL_INTERFACES = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/protection.yaml
name: real_interfaces
simulation: {{duration_s: 4}}
hosts: {{guest: {{links: [process_bus], plugs: {{process_bus: {{interface: plugged}}}}}}}}
processes: {{monitor: ~, relay2: ~, breaker2: ~, mu21: {{interface: outside}}, recorder: {{capture: ~}}}}
events: ~
record: {{comtrade: ~}}
expect: ~
"""

# Stands for the machine with two interfaces and for what is at the other ends of their cables. It answers the first sampled
# values by a frame of its own into each, so the run is under way then.
MACHINE = """
import socket, subprocess, sys
for a, b in (("outside", "beyond"), ("plugged", "visitor")):
    subprocess.run(f"ip link add {a} type veth peer name {b} && ip link set {b} up", shell=True, check=True)
hear = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x88ba))
hear.bind(("beyond", 0x88ba))
hear.settimeout(120)
say = {}
for name in ("beyond", "visitor"):
    say[name] = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)
    say[name].bind((name, 0))
run = subprocess.Popen(sys.argv[1:])
try:
    hear.recv(2048)
    for name, port in say.items():
        port.send(bytes.fromhex("010ccd010077 020000000099 88b8".replace(" ", "")) + name.encode().ljust(60, b"."))
finally:
    code = run.wait()
sys.exit(code)
"""


def differences(first, second):
    """What is in the one more often than in the other."""
    a, b = collections.Counter(first), collections.Counter(second)
    return a - b, b - a


# Six units behind one cable, in ticks of 2400 frames: more than may wait for a recorder that collects them.
LONG_TICKS = f"""---
gridspace: 1
name: long_ticks
simulation:
  network: {SOURCE}/configs/networks/adn_set_a.yaml
  solver: emt
  step_s: 1/48000
  duration_s: 1
  sampling: {{rate_hz: 4800, samples_per_message: 8}}
  gateways: {{TL1: {{publish: {{TL_11: CT11, TL_12: CT12}}}}, TL2: {{publish: {{TL_21: CT21, TL_22: CT22}}}}, TL3: {{publish: {{TL_31: CT31, TL_32: CT32}}}}}}
clock: {{mode: lockstep, speed: max, tick_samples: 400}}
hosts: {{simulator: {{links: [data_bus]}}, bay: {{links: [data_bus, process_bus]}}, ied: {{links: [process_bus]}}}}
links: {{data_bus: {{kind: switch, ipv4: 10.20.0.0/24}}, process_bus: {{kind: switch, delay_us: 0}}}}
streams:
  S1: {{kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: A1, conf_rev: 1, vlan_priority: 4, rate_hz: 4800, samples_per_frame: 1, synch: global, data_set: {{Ia: float32, Ib: float32, Ic: float32}}}}
{"".join(f'  S{i}: {{like: S1, mac: "01:0C:CD:04:00:2{i}", app_id: 0x402{i}, sv_id: A{i}}}' + chr(10) for i in range(2, 7))}processes:
  sim: {{program: gridspace-sim, host: simulator, qos: simulator}}
{"".join(f"  m{i}: {{program: gridspace-mu, host: bay, qos: merging_unit, from: {topic}, to: S{i}, buffer_ms: 1.5, latency_us: 120}}" + chr(10) for i, topic in enumerate(("TL_11", "TL_12", "TL_21", "TL_22", "TL_31", "TL_32"), 1))}  recorder: {{program: gridspace-recorder, host: simulator, qos: recorder, capture: [process_bus]}}
record: {{samples: all, frames: all, signals: ["bus.*"]}}
"""


class LongTicks(ScenarioTest):
    def test_ticks_with_more_frames_than_may_wait_for_a_recorder_are_captured_whole(self):
        run = self.run_to_end("run", scenario=self.write("long_ticks.yaml", LONG_TICKS))
        self.assertEqual(sum(ethertype(octets) == SMV for _, octets in Capture(run.folder / "bus.pcapng.gz").at("process_bus/bay")), 6 * 4800)


class CutCable(ScenarioTest):
    def test_both_sides_of_a_bump_are_captured_under_names(self):
        self.write("base.yaml", SHORT_CASE_2)
        sound = Capture(self.run_to_end("sound", scenario=self.folder / "base.yaml").folder / "bus.pcapng.gz")
        run = self.run_to_end("cut", scenario=self.write("cut.yaml", CUT))
        cut = Capture(run.folder / "bus.pcapng.gz")
        self.assertEqual(cut.points, [*sound.points, BEFORE, SLOW])
        self.assertIn("inbound is what mu21 sent", cut.descriptions[BEFORE])

        # Before the lossy cable: what the unit sends in a sound run, at the same simulated times.
        sent = sound.at(AFTER)
        self.assertGreater(len(sent), 450)
        self.assertEqual(cut.at(BEFORE, INBOUND), sent)
        self.assertEqual(cut.at(BEFORE, OUTBOUND), [], "this way is nobody's, and seen at the switch")
        # Behind it: some of them are missing, some come twice, 300 us later (rounded up to the grid of 1/48000 s).
        lost, again = differences(sent, cut.at(AFTER))
        self.assertGreater(sum(lost.values()), 60)
        self.assertGreater(sum(again.values()), 20)
        times = {octets: time for time, octets in sent}
        for time, octets in again:
            self.assertAlmostEqual(time - times[octets], 312_500, delta=2)
        # Behind the slow cable: everything that others put onto the bus, half a millisecond later.
        onto_the_bus = sorted((time, octets) for point in sound.points if point != "process_bus/bay2" for time, octets in cut.at(point) if ethertype(octets) == GOOSE)
        got = sorted((time, octets) for time, octets in cut.at(SLOW, OUTBOUND))
        self.assertGreater(len(got), 10)
        self.assertEqual([o for _, o in got], [o for _, o in onto_the_bus][:len(got)])
        for (before, _), (after, _) in zip(onto_the_bus, got):
            self.assertAlmostEqual(after - before, 500_000, delta=2)

        self.assert_repeats(run)
        self.assert_statistics_speak_of_the_switch(run, cut)

    def assert_repeats(self, run):
        again = self.run_to_end("again", scenario=self.folder / "cut.yaml")
        self.assertEqual((run.folder / "bus.pcapng.gz").read_bytes(), (again.folder / "bus.pcapng.gz").read_bytes())
        ticks = self.run_to_end("ticks_of_1", ["--set", "clock.tick_samples=1"], scenario=self.folder / "cut.yaml")
        self.assertEqual((run.folder / "bus.pcapng.gz").read_bytes(), (ticks.folder / "bus.pcapng.gz").read_bytes())

    def assert_statistics_speak_of_the_switch(self, run, cut):
        """A frame in the middle of a cable is not counted: it may never come out of it."""
        code, text, said = gridspace("wire", "stats", run.folder / "bus.pcapng.gz", "--json")
        self.assertEqual(code, 0, said)
        stream = next(s for s in json.loads(text)["streams"] if s["id"] == "GS_TL2_MU21")
        self.assertEqual(stream["frames"], len(cut.at(AFTER)))
        self.assertGreater(stream["lost"], 60)
        self.assertGreater(stream["duplicates"] + stream["out_of_order"], 20, "repeated behind the next sample")


class RealInterface(ScenarioTest):
    def test_frames_of_real_interfaces_are_captured_both_ways_and_every_link_is_when_nothing_is_said(self):
        """Root of a user namespace of its own, where cables stand for the machine's interfaces."""
        prefix = ["unshare", "-rn", sys.executable, "-c", MACHINE]
        run = self.run_to_end("run", scenario=self.write("real.yaml", ON_REAL_INTERFACES), prefix=prefix)
        capture = Capture(run.folder / "bus.pcapng.gz")
        # A process's own interface: its samples go out, and the answer comes in.
        out, into = capture.at("mu21/outside", OUTBOUND), capture.at("mu21/outside", INBOUND)
        samples = [o for _, o in out if ethertype(o) == SMV]
        self.assertGreater(len(samples), 4000)
        self.assertEqual({o[18:20] if o[12:14] == b"\x81\x00" else o[14:16] for o in samples}, {b"\x40\x21"})
        self.assertEqual([o[14:20] for _, o in into if ethertype(o) == GOOSE], [b"beyond"])
        # One in the place of a host's cable: what comes in, at the switch.
        self.assertEqual([o[14:21] for _, o in capture.at("process_bus/guest") if ethertype(o) == GOOSE], [b"visitor"])
        self.assertGreater(len([o for _, o in capture.at("process_bus/mu22") if ethertype(o) == SMV]), 4000)
        # DDS on the data bus, because `capture:` does not choose.
        self.assertTrue(any(b"RTPS" in o for _, o in capture.at("data_bus/simulator")))
        # Stamps are the kernel's, with the simulated time beside them; nothing was lost without being counted.
        stamps = [time for time, _ in out]
        self.assertGreater(stamps[0], EPOCH_NS + 10**15)
        self.assertEqual(stamps, sorted(stamps))
        self.assertRegex(capture.packets[-1].comment, r"^simulated time \d+\.\d{6} s$")
        statistics = capture.statistics["mu21/outside"]
        self.assertGreaterEqual(statistics.received, len(out) + len(into))
        dropped = sum(s.dropped for s in capture.statistics.values())
        self.assertEqual(dropped > 0, "frames_dropped" in (run.folder / "events.ndjson").read_text())

    def test_what_lockstep_cannot_capture_is_said(self):
        self.write("base.yaml", SHORT_CASE_2)
        code, out, err = gridspace("validate", self.write("data.yaml", "---\ngridspace: 1\nextends: base.yaml\nname: data\nprocesses: {recorder: {capture: [data_bus]}}\n"))
        self.assertEqual(code, 0, err)
        self.assertIn("nothing of 'data_bus' will be captured", out + err)


if __name__ == "__main__":
    unittest.main(verbosity=2)
