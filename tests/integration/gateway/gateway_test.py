#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""gridspace-gateway in real time, without a simulator, over virtual cables in a namespace of its own: what `gridspace wire`
publishes on one cable goes through two gateways and DDS to the other."""
import contextlib
import json
import os
import pathlib
import queue
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "wire"))
import own_namespace  # noqa: E402
from foreign_frames import TRUE, asdu, floats, goose, integer, sv, tlv  # noqa: E402

BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", "build/release/bin")).resolve()
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
HANG_S = 240  # nothing that works takes that long

GOOSE_IN = {"kind": "goose", "mac": "01:0C:CD:01:00:07", "app_id": 7, "control_block": "INLD0/LLN0$GO$a", "data_set_name": "INLD0/LLN0$a",
            "data_set": {"n": "int32", "pos": "position", "ok": "boolean"}, "min_time_ms": 2, "max_time_ms": 20}
GOOSE_OUT = {"kind": "goose", "mac": "01:0C:CD:01:00:08", "app_id": 8, "control_block": "OUTLD0/LLN0$GO$b", "data_set_name": "OUTLD0/LLN0$b",
             "data_set": {"mv": "int32", "pos": "position", "there": "boolean"}, "min_time_ms": 2, "max_time_ms": 20}
SV_IN = {"kind": "smv", "mac": "01:0C:CD:04:00:07", "app_id": 0x4007, "sv_id": "IN", "rate_hz": 400,
         "data_set": {"Ia": "float32", "Ib": "float32", "Ic": "float32"}}
SV_OUT = {"kind": "smv", "mac": "01:0C:CD:04:00:08", "app_id": 0x4008, "sv_id": "OUT", "rate_hz": 400, "send_refr_tm": True,
          "data_set": {"Ia": "int32", "q": "quality"}}


def keys_of(stream):
    return [f"{k}={json.dumps(v) if isinstance(v, (dict, bool)) else v}" for k, v in stream.items() if k != "kind"]


class Gateway(unittest.TestCase):
    def setUp(self):
        for a, b in (("in0", "in1"), ("out0", "out1")):
            own_namespace.cable(a, b)
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.running = []
        self.lines = {}  # of subscribers

    def tearDown(self):
        for process in self.running:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            if process in self.lines:
                process.wait(timeout=HANG_S)
            else:
                process.communicate(timeout=HANG_S)
        for link in ("in0", "out0"):
            subprocess.run(["ip", "link", "del", link], check=False)
        shutil.rmtree(self.folder)

    def gateway(self, name, interface, streams, mappings):
        file = self.folder / f"{name}.yaml"
        file.write_text(json.dumps({
            "process": name, "program": "gridspace-gateway",
            "bus": {"qos": str(SOURCE / "qos/gateway.xml"), "management": {"domain": 77, "addresses": ["10.99.0.1"]},
                    "clock": {"mode": "realtime", "simulator": ""}},
            "settings": {"wire": {"interface": interface}, "streams": streams, "mappings": mappings}}))
        return self.start([str(BIN / "gridspace-gateway"), "--config", str(file)])

    def start(self, command):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.running.append(process)
        watchdog = threading.Timer(HANG_S, process.kill)  # a line that never comes ends the wait for it
        watchdog.daemon = True
        watchdog.start()
        return process

    def wire(self, *arguments):
        return [str(BIN / "gridspace"), "wire", *arguments]

    def subscribe(self, *arguments):
        """A subscriber whose lines are always taken: behind a full pipe it would stop, and lose frames."""
        process = self.start(self.wire(*arguments))
        lines = self.lines[process] = queue.SimpleQueue()

        def take():
            for line in process.stdout:
                lines.put(line)
            lines.put(None)

        threading.Thread(target=take, daemon=True).start()
        return process

    def first_line(self, process, wanted):
        """The first JSON line of a subscriber that `wanted` accepts."""
        deadline = time.monotonic() + HANG_S
        while (line := self.lines[process].get()) is not None:
            message = json.loads(line)
            if wanted(message):
                return message
            self.assertLess(time.monotonic(), deadline, f"the last was {line}")
        self.fail(f"the subscriber ended: {process.stderr.read()}")

    def stop(self, process, in_its_start=False):
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=HANG_S)
        self.assertIn(process.returncode, (0, 130, *([-signal.SIGTERM] if in_its_start else [])), err)
        return out

    def test_goose_becomes_a_topic_and_goose_again_and_its_loss_too(self):
        self.gateway("inward", "in1", {"IN": GOOSE_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "feeders", "type": "example::FeederState"},
            "fields": {"feeder": {"value": "A"}, "voltage_kv": {"from": "n", "scale": 0.5}, "position": "pos",
                       "energised": {"from": "ok", "on_loss": False}}}})
        self.gateway("outward", "out0", {"OUT": GOOSE_OUT}, {"m": {
            "from": {"topic": "feeders", "type": "example::FeederState", "where": {"feeder": "A"}}, "to": {"stream": "OUT"},
            "fields": {"mv": {"from": "voltage_kv", "scale": 1000}, "there": "energised", "pos": {"value": "closed"}}}})
        subscriber = self.subscribe("goose-sub", "out1", *keys_of(GOOSE_OUT))
        # A topic has no memory: a change that comes before the two gateways have found each other is gone. So another value is
        # published, again and again, until one has come through.
        arrived = threading.Event()
        publishers = []

        def publish():
            number = 20
            while not arrived.is_set():
                number += 1
                if publishers:
                    self.stop(publishers.pop(), in_its_start=True)  # or already at work, if the machine gave it the time
                publishers.append(self.start(self.wire("goose-pub", "in0", "--value", f"n={number}", "--value", "ok=true", "--value", "pos=open",
                                                       *keys_of(GOOSE_IN))))
                arrived.wait(number - 20)  # each time longer: on a busy machine it takes a while to start

        publishing = threading.Thread(target=publish)
        publishing.start()
        try:
            first = self.first_line(subscriber, lambda m: m.get("values", "").endswith("true"))
        finally:
            arrived.set()
            publishing.join()
        self.stop(publishers.pop(), in_its_start=True)
        ever = range(21 * 500, 1000 * 500, 500)
        self.assertIn(first["values"], [f"{millivolts}, closed, true" for millivolts in ever])
        lost = self.first_line(subscriber, lambda m: m.get("values", "").endswith("false"))
        self.assertIn(lost["values"], [f"{millivolts}, closed, false" for millivolts in ever], "what has no on_loss is held")

    def test_sampled_values_become_a_topic_and_sampled_values_at_their_own_rate(self):
        self.gateway("inward", "in1", {"IN": SV_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "feeders", "type": "example::FeederState"}, "every": 10,
            "fields": {"feeder": {"value": "A"}, "voltage_kv": "Ia", "energised": "$alive"}}})
        self.gateway("outward", "out0", {"OUT": SV_OUT}, {"m": {
            "from": {"topic": "feeders", "type": "example::FeederState"}, "to": {"stream": "OUT"}, "lost_after_ms": 2000,
            "fields": {"Ia": {"from": "voltage_kv", "from_unit": "A", "to_unit": "mA"}, "q": {"value": "good", "on_loss": "invalid"}}}})
        subscriber = self.subscribe("sv-sub", "out1", "--frames", *keys_of(SV_OUT))
        publisher = self.start(self.wire("sv-pub", "in0", "--amplitude", "10", *keys_of(SV_IN)))
        first = self.first_line(subscriber, lambda m: m.get("values", {}).get("Ia", 0) != 0)
        self.assertLessEqual(abs(first["values"]["Ia"]), 10000)
        samples = [first] + [self.first_line(subscriber, lambda m: True) for _ in range(100)]
        for a, b in zip(samples, samples[1:]):
            self.assertEqual(b["smp_cnt"], (a["smp_cnt"] + 1) % 400)
            self.assertAlmostEqual(b["refr_tm_ns"] - a["refr_tm_ns"], 2_500_000, delta=120, msg="the time of the sample, in 2^-24 s")
        self.assertAlmostEqual(first["refr_tm_ns"] % 1_000_000_000, first["smp_cnt"] * 2_500_000, delta=120, msg="sample 0 is on the second")
        self.assertLess(abs(first["refr_tm_ns"] / 1e9 - time.time()), HANG_S)
        self.stop(publisher)
        self.first_line(subscriber, lambda m: m["values"]["q"] not in ("0x0000", 0))

    def test_consecutive_samples_are_gathered_and_sent_again_one_by_one(self):
        self.gateway("inward", "in1", {"IN": SV_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "lines", "type": "LineCurrents"}, "each": "samples", "index": "first_index", "per_message": 4,
            "fields": {"transformer": {"value": "CT1"}, "rate_num": {"value": 400}, "rate_den": {"value": 1},
                       "samples.ia": "Ia", "samples.ib": "Ib", "samples.ic": "Ic"}}})
        out = dict(SV_IN, mac="01:0C:CD:04:00:09", app_id=0x4009, sv_id="AGAIN")
        self.gateway("outward", "out0", {"OUT": out}, {"m": {
            "from": {"topic": "lines", "type": "LineCurrents"}, "to": {"stream": "OUT"}, "each": "samples", "index": "first_index",
            "buffer_ms": 40, "fields": {"Ia": "samples.ia", "Ib": "samples.ib", "Ic": "samples.ic"}}})
        original = self.subscribe("sv-sub", "in1", "--frames", *keys_of(SV_IN))
        again = self.subscribe("sv-sub", "out1", "--frames", *keys_of(out))
        self.start(self.wire("sv-pub", "in0", "--amplitude", "10", *keys_of(SV_IN)))
        first = self.first_line(again, lambda m: True)
        wanted = {first["smp_cnt"]: first["values"]}
        for _ in range(60):
            sample = self.first_line(again, lambda m: True)
            wanted[sample["smp_cnt"]] = sample["values"]
        self.assertEqual(len(wanted), 61, "each once")

        def is_wanted(m):  # a subscriber that began late finds the same count in another second, rounded otherwise
            values = wanted.get(m["smp_cnt"])
            return values is not None and all(abs(values[phase] - m["values"][phase]) < 1e-5 for phase in ("Ia", "Ib", "Ic"))

        while wanted:
            del wanted[self.first_line(original, is_wanted)["smp_cnt"]]

    def test_a_frame_of_two_samples_holds_consecutive_ones_whatever_is_missing(self):
        self.gateway("inward", "in1", {"IN": SV_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "lines", "type": "LineCurrents"}, "each": "samples", "index": "first_index", "per_message": 4,
            "fields": {"samples.ia": "Ia", "samples.ib": "Ib", "samples.ic": "Ic"}}})
        out = dict(SV_IN, mac="01:0C:CD:04:00:09", app_id=0x4009, sv_id="AGAIN", samples_per_frame=2)
        self.gateway("outward", "out0", {"OUT": out}, {"m": {
            "from": {"topic": "lines", "type": "LineCurrents"}, "to": {"stream": "OUT"}, "each": "samples", "index": "first_index",
            "buffer_ms": 40, "fields": {"Ia": "samples.ia", "Ib": "samples.ib", "Ic": "samples.ic"}}})
        again = self.subscribe("sv-sub", "out1", "--frames", *keys_of(out))
        port, enough = self.raw_port("in0"), threading.Event()

        def send():  # at the stream's rate; of every twenty samples three are missing, so that frames begin at odd ones too
            for number in range(HANG_S * 400):
                if number % 20 >= 3:
                    port.send(sv([asdu(SV_IN["sv_id"], number % 400, floats(number, 0, 0))], app_id=SV_IN["app_id"], destination=SV_IN["mac"]))
                if enough.wait(1 / 400):
                    return

        sending = threading.Thread(target=send)
        sending.start()
        try:
            samples = [self.first_line(again, lambda m: True) for _ in range(200)]
        finally:
            enough.set()
            sending.join()
        for a, b in zip(samples[::2], samples[1::2]):
            self.assertEqual(a["time_ns"], b["time_ns"], "of one frame")
            self.assertEqual((a["smp_cnt"] % 2, b["smp_cnt"]), (0, a["smp_cnt"] + 1))
            self.assertEqual(b["values"]["Ia"], a["values"]["Ia"] + 1, "none is an old one")
        self.assertEqual(len({s["values"]["Ia"] for s in samples}), len(samples), "each once")

    def test_two_streams_of_one_sv_id_are_told_apart_by_their_addresses(self):
        other = dict(SV_IN, mac="01:0C:CD:04:00:0A", app_id=0x400A)
        inward = self.gateway("inward", "in1", {"IN": SV_IN, "OTHER": other}, {name: {
            "from": {"stream": stream}, "to": {"topic": "feeders", "type": "example::FeederState"}, "every": 10,
            "fields": {"feeder": {"value": name}, "voltage_kv": "Ia"}} for name, stream in (("A", "IN"), ("B", "OTHER"))})
        self.gateway("outward", "out0", {"OUT": SV_OUT}, {"m": {
            "from": {"topic": "feeders", "type": "example::FeederState", "where": {"feeder": "B"}}, "to": {"stream": "OUT"},
            "fields": {"Ia": {"from": "voltage_kv", "scale": 1000}}}})
        subscriber = self.subscribe("sv-sub", "out1", "--frames", *keys_of(SV_OUT))
        for amplitude, stream in (("1000", SV_IN), ("10", other)):
            self.start(self.wire("sv-pub", "in0", "--amplitude", amplitude, *keys_of(stream)))
        self.first_line(subscriber, lambda m: m.get("values", {}).get("Ia", 0) != 0)
        for _ in range(100):
            self.assertLessEqual(abs(self.first_line(subscriber, lambda m: True)["values"]["Ia"]), 10000, "of the other stream")
        inward.send_signal(signal.SIGTERM)
        _, said = inward.communicate(timeout=HANG_S)
        self.assertNotIn("wrong_", said)

    # For every message: a change that comes before the two gateways have found each other would be gone.
    INWARD_GOOSE = {"m": {"from": {"stream": "IN"}, "to": {"topic": "feeders", "type": "example::FeederState"}, "write_on": "message",
                          "fields": {"feeder": {"value": "A"}, "voltage_kv": {"from": "n", "scale": 0.5}, "energised": "ok"}}}
    OUTWARD_GOOSE = {"m": {"from": {"topic": "feeders", "type": "example::FeederState"}, "to": {"stream": "OUT"},
                           "fields": {"mv": {"from": "voltage_kv", "scale": 1000}, "there": "energised"}}}

    def until_heard(self, subscriber, values, send):
        """Sends again and again, each time with a new state, until the far end of the chain says `values`."""
        heard = threading.Event()

        def keep_sending():
            while not heard.is_set():
                send()
                heard.wait(0.2)

        sending = threading.Thread(target=keep_sending)
        sending.start()
        try:
            return self.first_line(subscriber, lambda m: m.get("values", "") == values)
        finally:
            heard.set()
            sending.join()

    def foreign_goose(self, number, state):
        data = [tlv(0x85, integer(number)), tlv(0x84, b"\x06\x40"), tlv(0x83, b"\x01")]
        return goose(data, gocb=GOOSE_IN["control_block"], dat_set=GOOSE_IN["data_set_name"], go_id=GOOSE_IN["control_block"], st=state,
                     app_id=GOOSE_IN["app_id"], destination=GOOSE_IN["mac"], live=4000)

    def raw_port(self, interface):
        port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)
        port.bind((interface, 0))
        self.addCleanup(port.close)
        return port

    def test_damaged_and_foreign_frames_do_not_stop_it(self):
        """Frames of an independent encoder, whole ones between damaged ones and a storm of somebody else's."""
        self.gateway("inward", "in1", {"IN": GOOSE_IN}, self.INWARD_GOOSE)
        self.gateway("outward", "out0", {"OUT": GOOSE_OUT}, self.OUTWARD_GOOSE)
        subscriber = self.subscribe("goose-sub", "out1", *keys_of(GOOSE_OUT))
        port, dice, state = self.raw_port("in0"), random.Random(11), 0

        def send(number):
            nonlocal state
            state += 1
            whole = self.foreign_goose(number, state)
            for _ in range(100):
                at = dice.randrange(14, len(whole))
                port.send(whole[:at] + bytes([dice.randrange(256)]) + whole[at + 1:dice.randrange(at + 1, len(whole) + 1)])
                port.send(goose([TRUE], gocb=f"FOREIGN/LLN0$GO${dice.randrange(1000)}", app_id=GOOSE_IN["app_id"], destination=GOOSE_IN["mac"]))
            port.send(whole)

        self.until_heard(subscriber, "21000, intermediate, true", lambda: send(42))
        self.until_heard(subscriber, "5000, intermediate, true", lambda: send(10))
        for process in self.running[:2]:
            self.assertIsNone(process.poll(), "a gateway ended")

    def test_an_interface_that_vanishes_and_comes_back_is_used_again(self):
        self.gateway("inward", "in1", {"IN": GOOSE_IN}, self.INWARD_GOOSE)
        self.gateway("outward", "out0", {"OUT": GOOSE_OUT}, self.OUTWARD_GOOSE)
        subscriber = self.subscribe("goose-sub", "out1", *keys_of(GOOSE_OUT))
        state = 0

        def send(number):
            nonlocal state
            state += 1
            with contextlib.suppress(OSError):  # the interface may be on its way
                port.send(self.foreign_goose(number, state))

        port = self.raw_port("in0")
        self.until_heard(subscriber, "21000, intermediate, true", lambda: send(42))
        for command in ("ip link set in1 down && sleep 0.5 && ip link set in1 up", "ip link set in1 down && ip link set in1 name other && sleep 0.5 && ip link set other name in1 && "
                        "ip link set in1 up", "ip link del in0 && sleep 0.5 && ip link add in0 type veth peer name in1 && ip link set in0 up && ip link set in1 up"):
            subprocess.run(command, shell=True, check=True)
            port = self.raw_port("in0")
            number = 100 + state
            self.until_heard(subscriber, f"{500 * number}, intermediate, true", lambda n=number: send(n))
        for process in self.running[:2]:
            self.assertIsNone(process.poll(), "a gateway ended")

    def test_a_table_with_a_mistake_is_refused_before_anything_starts(self):
        process = self.gateway("wrong", "in1", {"IN": GOOSE_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "feeders", "type": "example::FeederState"}, "fields": {"voltage": "n"}}})
        _, err = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 2, err)
        self.assertIn("there is no field 'voltage'", err)
        self.assertIn("did you mean 'voltage_kv'?", err)

    def test_an_interface_that_is_missing_is_named(self):
        process = self.gateway("wrong", "nowhere0", {"IN": GOOSE_IN}, {"m": {
            "from": {"stream": "IN"}, "to": {"topic": "feeders", "type": "example::FeederState"}, "fields": {"voltage_kv": "n"}}})
        _, err = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 3, err)
        self.assertIn("nowhere0", err)


if __name__ == "__main__":
    own_namespace.main(own_namespace.DDS_CABLE)
