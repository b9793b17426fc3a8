#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""gridspace-relay alone on a cable, without a simulator: two merging units of an independent encoder (foreign_frames.py) and whoever
else sends there."""
import json
import math
import os
import pathlib
import random
import shutil
import socket
import subprocess
import tempfile
import time
import unittest

import own_namespace
from foreign_frames import asdu, floats, sv

BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", "build/release/bin")).resolve()
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
HANG_S = 60
RATE = 4800
ENDS = {"left_end": 0x21, "right_end": 0x22}


def stream(end):
    return {"kind": "smv", "mac": f"01:0C:CD:04:00:{ENDS[end]:02X}", "app_id": 0x4000 + ENDS[end], "sv_id": end, "rate_hz": RATE,
            "data_set": {"Ia": "float32", "Ib": "float32", "Ic": "float32"}}


TRIP = {"kind": "goose", "mac": "01:0C:CD:01:00:02", "app_id": 0x8002, "control_block": "IEDLD0/LLN0$GO$Trip", "data_set": {"status": "boolean"},
        "min_time_ms": 2, "max_time_ms": 20, "live_min_ms": 5000}


def frame(end, sample, amplitude, counter=None, **optional):
    """One sample of a balanced current. `tag`: VLAN tags."""
    around = {"app_id": 0x4000 + ENDS[end], "destination": f"01:0C:CD:04:00:{ENDS[end]:02X}", "vlan": optional.pop("tag", [(0x8100, 0x8000)]),
              "simulated": optional.pop("simulated", False)}
    phases = [amplitude * math.cos(2 * math.pi * (60 * sample / RATE - k / 3)) for k in range(3)]
    return sv([asdu(end, sample % RATE if counter is None else counter, floats(*phases), **optional)], **around)


class RelayAlone(unittest.TestCase):
    def setUp(self):
        own_namespace.cable("bay", "ied")
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)
        self.port.bind(("bay", 0))
        self.running = []
        file = self.folder / "relay.yaml"
        file.write_text(json.dumps({
            "process": "relay", "program": "gridspace-relay",
            "bus": {"qos": str(SOURCE / "qos/relay.xml"), "management": {"domain": 78, "addresses": ["10.99.0.1"]},
                    "clock": {"mode": "realtime", "simulator": ""}},
            "settings": {"currents": {"from": "FROM", "to": "TO", "partner_timeout_ms": 1000},
                         "trip": "TRIP", "trip_field": "status",
                         "element": {"kind": "phasor", "window_cycles": 1, "pickup_a": 30}, "latency_us": 0, "wire": {"interface": "ied"},
                         "streams": {"FROM": stream("left_end"), "TO": stream("right_end"), "TRIP": TRIP}, "frequency_hz": 60,
                         "positive": {"from": "from_to", "to": "from_to"}}}))
        self.relay = self.start(BIN / "gridspace-relay", "--config", file)
        self.listener = self.start(BIN / "gridspace", "wire", "goose-sub", "bay")

    def tearDown(self):
        for process in self.running:
            process.kill()
            process.wait(timeout=HANG_S)
        self.port.close()
        subprocess.run(["ip", "link", "del", "bay"], check=True)
        shutil.rmtree(self.folder)

    def start(self, *command):
        """Until it listens. What it says goes into files: nobody reads a pipe meanwhile."""
        def listening():
            with open("/proc/net/packet", encoding="ascii") as table:
                return sum(line.split()[3] != "0000" for line in table.readlines()[1:])
        before = listening()
        name = f"process{len(self.running)}"
        with open(self.folder / f"{name}.out", "wb") as out, open(self.folder / f"{name}.err", "wb") as err:
            process = subprocess.Popen(list(map(str, command)), stdout=out, stderr=err)
        self.running.append(process)
        self.wait_for(lambda: listening() != before, "it does not listen", process)
        return process

    def wait_for(self, condition, what, process):
        deadline = time.monotonic() + HANG_S
        while not condition():
            self.assertIsNone(process.poll(), "it ended")
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.002)

    def said(self):
        return (self.folder / "process0.err").read_text()

    def heard(self):
        """The values of its messages so far; a line that is being written does not count."""
        text = (self.folder / "process1.out").read_text()
        return [json.loads(line).get("values") for line in text[:text.rfind("\n") + 1].splitlines()]

    def send(self, seconds, make):
        """`make(end, sample)`: the frames of one end at that sample, in real time."""
        start = time.monotonic()
        for sample in range(int(seconds * RATE)):
            for end in ENDS:
                for one in make(end, sample):
                    self.port.send(one)
            if sample % 8 == 7:
                time.sleep(max(0, start + sample / RATE - time.monotonic()))

    def expect_trip(self, sample):
        """The fault stays, from this sample on, until it has tripped: what comes while it is not scheduled may be lost to it."""
        deadline = time.monotonic() + HANG_S
        while "true" not in self.heard():
            self.assertIsNone(self.relay.poll(), "it ended")
            self.assertLess(time.monotonic(), deadline, "no trip: " + self.said())
            self.send(0.1, lambda end, k: [frame(end, k + sample, self.fault(end, k, 0))])
            sample += int(0.1 * RATE)
        self.end()

    def tell(self, story, as_expected):
        """Judges what it says of a story that ends in a trip. When it was not scheduled for longer than frames are kept for it, it
        has something else to say: then the story is told once more, to another relay, at most three times."""
        for attempt in range(3):
            if attempt > 0:
                self.tearDown()
                self.setUp()
            story()
            if as_expected(self.said()):
                return
        self.fail(self.said())

    def expect_no_trip(self):
        messages = len(self.heard())  # five more: by then it has looked at all that was sent
        self.wait_for(lambda: len(self.heard()) >= messages + 5, "it says nothing", self.relay)
        self.assertNotIn("true", self.heard(), self.said())
        self.end()

    def end(self):
        self.relay.terminate()
        self.assertEqual(self.relay.wait(timeout=HANG_S), 0, self.said())

    @staticmethod
    def fault(end, sample, after=0.3):
        """What flows in at the left end: nothing comes out at the right one any more."""
        return 0.0 if end == "right_end" and sample >= after * RATE else 100.0

    def test_it_trips_for_a_fault_and_not_without_one(self):
        self.send(0.3, lambda end, k: [frame(end, k, 100.0)])
        self.send(0.3, lambda end, k: [frame(end, k + int(0.3 * RATE), self.fault(end, k, 0))])
        self.expect_trip(int(0.6 * RATE))

    def test_every_way_to_write_a_sample_is_read(self):
        ways = [{}, {"tag": []}, {"tag": [(0x8100, 0x6007)]}, {"refr_tm": bytes(8), "smp_rate": RATE, "smp_mod": 1, "dat_set": "A/B$C", "gm_identity": bytes(8)},
                {"form": 2}, {"cnt_octets": 4, "rev_octets": 1}]

        def story():
            self.send(0.6, lambda end, k: [frame(end, k, self.fault(end, k), **ways[k % len(ways)])])
            self.expect_trip(int(0.6 * RATE))

        self.tell(story, lambda said: said.count("unblock") == 1)

    def test_what_is_not_its_stream_does_nothing(self):
        """Simulated, of another revision, not synchronised: a fault in those is none."""
        for odd in ({"simulated": True}, {"conf_rev": 2}, {"smp_synch": 0}):
            self.send(0.2, lambda end, k, odd=odd: [frame(end, k, self.fault(end, k, 0), **odd)])
        self.expect_no_trip()

    def test_forged_counters_neither_block_it_nor_make_it_trip(self):
        """One wrong counter now and then, within the second and beyond it."""
        def disturbed(amplitude):
            return lambda end, k: [frame(end, k, amplitude(end, k)),
                                   *([frame(end, k, 100.0, counter=counter)] if (counter := {250: 60000, 750: (k + 2000) % RATE, 999: 65535}.get(k % 1000)) else [])]

        def story():
            self.send(0.8, disturbed(lambda end, k: 100.0))
            self.assertNotIn("true", self.heard(), self.said())
            self.send(0.3, lambda end, k: disturbed(lambda e, s: self.fault(e, s, 0))(end, k + int(0.8 * RATE)))
            self.expect_trip(int(1.1 * RATE))

        self.tell(story, lambda said: "window_emptied" not in said and said.count("unblock") == 1)

    def test_damaged_frames_beside_good_ones_change_nothing(self):
        dice = random.Random(3)

        def damaged(whole):
            """Its head is broken: damage in the values alone is what the checksum of Ethernet is for."""
            at = dice.randrange(12, 40)
            return whole[:at] + bytes([whole[at] ^ dice.randrange(1, 256)]) + whole[at + 1:dice.randrange(max(at + 1, 22), len(whole) - 13)]

        self.send(0.4, lambda end, k: [damaged(frame(end, k, 100.0)), frame(end, k, 100.0), damaged(frame(end, k, 1e9))])
        self.expect_no_trip()

    def test_merging_units_that_begin_anew_are_followed(self):
        self.send(0.3, lambda end, k: [frame(end, k + 1234, 100.0)])
        self.send(0.3, lambda end, k: [frame(end, k, 100.0)])
        self.send(0.3, lambda end, k: [frame(end, k + int(0.3 * RATE), self.fault(end, k, 0))])
        self.expect_trip(int(0.6 * RATE))
        self.assertIn("window_emptied", self.said())


if __name__ == "__main__":
    own_namespace.main(own_namespace.DDS_CABLE)
