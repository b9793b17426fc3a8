#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of a run in Python: what tshark reads in them is what the package reads, and damaged ones are refused with a reason."""
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import unittest
import warnings

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
sys.path[:0] = [str(SOURCE / "tests/integration/scenario"), str(SOURCE / "python"), str(SOURCE / "examples/agents/python_iec61850")]
import harness  # noqa: E402
import iec61850_frames as other  # noqa: E402 (the encoder of the examples, which shares nothing with the package)

import gridspace  # noqa: E402
from gridspace import frames, pcapng  # noqa: E402


class OfARun(harness.ScenarioTest):
    def tshark(self, file, filter_, *fields):
        if shutil.which("tshark") is None:
            if os.environ.get("GRIDSPACE_TEST_ALL"):
                self.fail("tshark is not there")
            self.skipTest("tshark is not there")
        command = ["tshark", "-r", file, "-Y", filter_, "-T", "fields", *[word for field in ("frame.time_epoch", *fields) for word in ("-e", field)]]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=harness.HANG_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [line.split("\t") for line in done.stdout.splitlines()]

    def test_they_say_what_tshark_says(self):
        folder = self.run_to_end("run", scenario=self.write("short.yaml", harness.SHORT_CASE_2)).folder
        run = gridspace.open(folder)
        self.assertGreater(len(list(run.frames())), 900)
        epoch_s = 1575158400  # 2019-12-01, the epoch of the scenario
        theirs = self.tshark(folder / "bus.pcapng.gz", "sv", "sv.svID", "sv.smpCnt", "sv.confRev", "sv.smpSynch", "sv.appid")
        ours = [[s.time_s, s.stream, s.count, s.conf_rev, s.synch, s.app_id] for s in run.sampled_values()]
        self.assertEqual(len(ours), len(theirs))
        for own, (time, name, *numbers) in zip(ours, theirs, strict=True):
            self.assertAlmostEqual(own[0], float(time) - epoch_s, places=6)
            self.assertEqual(own[1:], [name, *[int(n, 0) for n in numbers]])
        theirs = self.tshark(folder / "bus.pcapng.gz", "goose", "goose.gocbRef", "goose.stNum", "goose.sqNum", "goose.timeAllowedtoLive", "goose.boolean")
        ours = [[m.stream, m.st_num, m.sq_num, m.live_ms, m.values[0]] for m in run.goose()]
        self.assertEqual(ours, [[name, int(st), int(sq), int(live), value in ("1", "True", "true")] for _, name, st, sq, live, value in theirs])
        self.assertEqual({m.st_num for m in run.goose()}, {1, 2}, "it has tripped")
        self.assertEqual(list(run.goose("nobody's*")), [])
        self.assertEqual({f.port for f in run.frames("process_bus/mu2?")}, {"process_bus/mu21", "process_bus/mu22"})
        first = next(run.sampled_values("GS_TL2_MU21"))
        current = run.signal("ct.CT21.i.a")
        self.assertAlmostEqual(first.floats()[0], current.at(first.time_s), delta=0.01)
        self.assertEqual([s["status"] for s in run.samples("TL2_Trip")], [False, True])
        with self.assertRaisesRegex(KeyError, "no topic of .* is called 'TL9_Trip'; there are TL2_Trip"):
            run.samples("TL9_Trip")

    def test_a_run_without_a_capture_says_so(self):
        run = self.run_to_end("run", [*harness.BASE, "--until", "10min", "--set", "expect=~"])
        with self.assertRaisesRegex(gridspace.Error, "cannot read .*bus.pcapng.gz.*No such file"):
            list(gridspace.open(run.folder).frames())


def block(kind, body, order="<"):
    size = 12 + len(body)
    return struct.pack(order + "II", kind, size) + body + struct.pack(order + "I", size)


def capture(packets, order="<", units=b"\x09"):
    option = struct.pack(order + "HH", 9, 1) + units + b"\0\0\0" + struct.pack(order + "HH", 2, 4) + b"lan0" + struct.pack(order + "HH", 0, 0)
    out = block(pcapng.SECTION, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1), order) + block(1, struct.pack(order + "HHI", 1, 0, 0) + option, order)
    for stamp, octets in packets:
        body = struct.pack(order + "IIIII", 0, stamp >> 32, stamp & 0xFFFFFFFF, len(octets), len(octets)) + octets + bytes(-len(octets) % 4)
        out += block(6, body, order)
    return out


SV_FRAME = other.frame(other.mac("01:0C:CD:04:00:21"), other.mac("02:00:00:00:00:01"), other.SV, 0x4021, other.sv_apdu("MU", 4799, (1.5, -2.25, 1e6)))
GOOSE_FRAME = other.frame(other.mac("01:0C:CD:01:00:02"), other.mac("02:00:00:00:00:02"), other.GOOSE, 0x8002,
                          other.goose_apdu("LD/LLN0$GO$T", "LD/LLN0$D", True, 70000, 3, 1575158405.5, 40))


class Parsing(harness.ScenarioTest):
    def read(self, octets):
        file = self.folder / "x.pcapng"
        file.write_bytes(octets)
        return list(pcapng.read(file))

    def test_what_somebody_else_encodes_is_read(self):
        sample, = frames.sampled_values(frames.parse(SV_FRAME, 2.5))
        self.assertEqual((sample.time_s, sample.stream, sample.app_id, sample.count, sample.synch, sample.conf_rev), (2.5, "MU", 0x4021, 4799, 2, 1))
        self.assertEqual(sample.floats(), (1.5, -2.25, 1e6))
        self.assertEqual(sample.integers()[0], 0x3FC00000)
        message = frames.goose(frames.parse(GOOSE_FRAME))
        self.assertEqual((message.stream, message.st_num, message.sq_num, message.live_ms, message.t_s, message.values),
                         ("LD/LLN0$GO$T", 70000, 3, 40, 1575158405.5, (True,)))
        self.assertIsNone(frames.goose(frames.parse(SV_FRAME)))
        self.assertEqual(list(frames.sampled_values(frames.parse(GOOSE_FRAME))), [])
        tagged = frames.parse(SV_FRAME[:12] + b"\x81\x00\x80\x05" + SV_FRAME[12:])
        self.assertEqual((tagged.vlan, tagged.ethertype, tagged.destination), (5, frames.SV, "01:0c:cd:04:00:21"))
        self.assertEqual(len(list(frames.sampled_values(tagged))), 1)

    def test_every_kind_of_value_in_a_message(self):
        data = (other.tlv(0x85, b"\xfe") + other.tlv(0x86, b"\x01\x00") + other.tlv(0x87, b"\x08" + struct.pack(">f", 0.5)) + other.tlv(0x84, b"\x06\x80")
                + other.tlv(0x8A, b"text") + other.tlv(0xA2, other.tlv(0x83, b"\x00") + other.tlv(0xA1, other.tlv(0x89, b"\x07"))))
        self.assertEqual(list(frames._values(data, 0)), [-2, 256, 0.5, "10", "text", [False, [b"\x07"]]])
        deep = b""
        for _ in range(40):
            deep = other.tlv(0xA2, deep)
        with self.assertRaisesRegex(ValueError, "structures more than 16 deep"):
            list(frames._values(other.tlv(0xA2, deep), 0))

    def test_a_damaged_frame_is_refused_and_never_anything_else(self):
        random_ = random.Random(7)
        refused = 0
        for frame in [SV_FRAME, GOOSE_FRAME] * 2000:
            octets = bytearray(frame[:random_.randrange(10, len(frame) + 1)] if random_.random() < 0.3 else frame)
            for _ in range(random_.randrange(4)):
                octets[random_.randrange(len(octets))] = random_.randrange(256)
            try:
                parsed = frames.parse(bytes(octets))
                list(frames.sampled_values(parsed))
                frames.goose(parsed)
            except ValueError as e:
                refused += 1
                self.assertTrue(str(e))
        self.assertGreater(refused, 500)

    def test_either_order_of_octets_and_any_resolution(self):
        for order, units, stamp, ns in (("<", b"\x09", 1_500_000_001, 1_500_000_001), (">", b"\x06", 1_500_000, 1_500_000_000), ("<", b"\x8a", 1536, 1_500_000_000)):
            packet, = self.read(capture([(stamp, SV_FRAME)], order, units))
            self.assertEqual((packet.interface, packet.time_ns, packet.octets, packet.direction), ("lan0", ns, SV_FRAME, ""))

    def test_a_capture_that_was_cut_off_gives_what_is_whole(self):
        whole = capture([(1, SV_FRAME), (2, SV_FRAME)])
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            packets = self.read(whole)
            self.assertEqual((len(packets), said), (2, []))
            for cut in range(len(capture([])) + 1, len(whole)):
                found = self.read(whole[:cut])
                self.assertEqual(found, packets[:len(found)])
            self.assertEqual(len(found), 1)
        self.assertIn("ends in the middle of a block", str(said[-1].message))

    def test_what_is_no_capture_is_refused(self):
        for octets, expected in ((b"hello, world", "is no pcapng file"), (capture([]) + struct.pack("<II", 6, 7) + b"\0" * 8, "is damaged at offset .*: a block of 7 octets"),
                                 (capture([]) + block(6, struct.pack("<IIIII", 0, 0, 0, 99, 99)), "a packet of 99 octets in a block of 32"),
                                 (capture([]) + block(6, struct.pack("<IIIII", 5, 0, 0, 0, 0)), "is damaged at offset")):
            with self.assertRaisesRegex(gridspace.Error, expected):
                self.read(octets)

    def test_the_simulated_time_of_a_run_in_real_time_is_in_the_comment(self):
        from gridspace import recording
        self.assertEqual(recording._simulated("simulated time 1.250000 s"), 1.25)
        self.assertNotEqual(recording._simulated(""), recording._simulated(""), "not a number")


if __name__ == "__main__":
    unittest.main()
