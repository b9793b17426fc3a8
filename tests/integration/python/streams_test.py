#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""An agent in Python on the process bus: it hears sampled values and GOOSE, and sends them, without a gateway between."""
import json
import pathlib
import sys
import textwrap
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import CHILD_DIED, OK, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

EXAMPLE = SOURCE / "examples/agents/python_overcurrent_relay"
SENDER = """
    class Sender(gridspace.Agent):
        latency_us = Setting("fraction", 1000, latency=True)
        wave, state = WritesStream("WAVE"), WritesStream("STATE")
        def begin(self):
            self.count = 0
            self.every("1/100", self.step)
        def step(self):
            if self.count < 6:
                self.count += 1
                self.wave(V=100 * self.count, q=0)
                self.state(n=self.count, mag_f=self.count / 4, pos=2, closed=self.count % 2 == 0)
"""
HEARER = """
    class Hearer(gridspace.Agent):
        wave, state = ReadsStream("WAVE"), ReadsStream("STATE")
        def on_wave(self, s):
            if s.smp_cnt % 40 == 39 or not s.alive:
                self.log(f"WAVE {s.time_ns} {s.alive} {s.smp_cnt} {s.smp_synch} {s.V} {s.q}")
        def on_state(self, m):
            if m.sq_num == 0 or not m.alive:
                self.log(f"STATE {m.time_ns} {m.alive} {m.st_num} {m.n} {m.mag_f} {m.pos} {m.closed}")
"""


class Streams(ScenarioTest):
    def script(self, name, body):
        text = ("#!/usr/bin/env python3\nimport gridspace\nfrom gridspace import ReadsStream, Setting, WritesStream\n" + textwrap.dedent(body))
        file = self.write(name, text + f"\nif __name__ == '__main__':\n    {text.rpartition('class ')[2].partition('(')[0]}.main()\n")
        file.chmod(0o755)
        return file

    def echo_scenario(self, **changes):
        return self.write("echo.yaml", json.dumps({
            "gridspace": 1, "name": "echo",
            "simulation": {"network": str(SOURCE / "configs/networks/house.yaml"), "solver": "phasor", "step_s": 0.00025, "duration_s": 0.12,
                           "gateways": "per_bus", "epoch": "2019-12-01T00:00:00Z"},
            "clock": {"mode": "lockstep", "speed": "max", "tick_s": 0.001},
            "hosts": {"a": {"links": ["net", "process_bus"]}, "b": {"links": ["net", "process_bus"]}},
            "links": {"net": {"kind": "switch", "ipv4": "10.50.0.0/24"}, "process_bus": {"kind": "switch", "delay_us": 0}},
            "streams": {
                "WAVE": {"kind": "smv", "mac": "01:0C:CD:04:00:01", "app_id": 0x4001, "sv_id": "W", "rate_hz": 4000,
                         "data_set": {"V": "int32", "q": "quality"}},
                "STATE": {"kind": "goose", "mac": "01:0C:CD:01:00:01", "app_id": 1, "control_block": "LD0/LLN0$GO$S", "max_time_ms": 20,
                          "data_set": {"n": "int32", "mag": {"f": "float32"}, "pos": "position", "closed": "boolean"}}},
            "processes": {"sim": {"program": "gridspace-sim", "host": "a", "qos": "simulator"},
                          "recorder": {"program": "gridspace-recorder", "host": "a", "qos": "recorder", "capture": ["process_bus"]},
                          "sender": {"program": {"path": str(self.script("sender.py", SENDER))}, "host": "a"},
                          "hearer": {"program": {"path": str(self.script("hearer.py", HEARER))}, "host": "b"},
                          **changes},
            "record": {"samples": "all"}}))

    def test_a_relay_in_python_trips_by_what_it_hears_and_repeats_to_the_octet(self):
        first, second = (self.run_to_end(name, [], EXAMPLE / "overcurrent.yaml") for name in ("first", "second"))
        self.assert_identical(first, second)
        self.run_to_end("deaf", ["--set", "processes.relay.pickup_a=6000"], EXAMPLE / "overcurrent.yaml", 1)  # the negative control

    def test_what_it_sends_is_heard_at_the_time_and_with_the_values_that_arithmetic_says(self):
        run = self.run_to_end("echo", [], self.echo_scenario())
        heard = [line.split() for line in (run.folder / "logs/hearer.log").read_text().splitlines()]
        words = {kind: [w[w.index(kind) + 1:] for w in heard if kind in w] for kind in ("WAVE", "STATE")}
        # Step k is at k/100 s; a sample leaves a latency of 1 ms after its instant, with the values of the step before it; the sixth stay.
        wave = [(int(t), alive, int(n), int(v)) for t, alive, n, _, v, _ in words["WAVE"] if alive == "True"]
        self.assertEqual(wave[:12], [(10_000_000 * k + 10_750_000, "True", 40 * k + 39, 100 * min(k + 1, 6)) for k in range(12)][:len(wave[:12])])
        self.assertGreaterEqual(len(wave), 11)
        state = [(int(t), int(st), int(n), float(f), int(pos), closed) for t, _, st, n, f, pos, closed in words["STATE"]]
        self.assertEqual(state, [(10_000_000 * k + 1_000_000, k + 1, k + 1, (k + 1) / 4, 2, str((k + 1) % 2 == 0)) for k in range(6)])
        self.assertEqual(run.manifest()["processes"]["hearer"]["end"], "exit code 0")

    def test_a_stream_that_falls_silent_says_so_once(self):
        scenario = self.echo_scenario()
        run = self.run_to_end("silent", ["--set", "events={gone: {at_s: 0.04, kill: sender}}"], scenario)
        heard = [line.split() for line in (run.folder / "logs/hearer.log").read_text().splitlines()]
        self.assertEqual(sorted(w[3] for w in heard if w[3:4] in (["WAVE"], ["STATE"]) and w[5] == "False"), ["STATE", "WAVE"])

    def test_what_cannot_be_is_said_before_anything_runs(self):
        for change, said in (({"currents": "SMV23"}, "process 'relay' reads the stream 'SMV23', which does not exist"),
                             ({"link": "data_bus"}, "and host 'ied2' is not plugged into it")):
            settings = [word for key, value in change.items() for word in ("--set", f"processes.relay.{key}={value}")]
            code, out, err = gridspace("validate", EXAMPLE / "overcurrent.yaml", *settings)
            self.assertEqual(code, USAGE)
            self.assertIn(said, out + err)

    def test_a_member_that_the_data_set_does_not_have_ends_the_run_with_its_name(self):
        wrong = str(self.script("wrong.py", SENDER.replace("mag_f=", "mag_g=")))
        run = self.run_to_end("wrong", [], self.echo_scenario(sender={"program": {"path": wrong}, "host": "a"}), CHILD_DIED)
        self.assertIn("mag_g", run.summary()["cause"])


if __name__ == "__main__":
    unittest.main()
