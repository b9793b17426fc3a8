#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of an independent encoder (foreign_frames.py), good ones, odd ones and damaged ones, against the tools of `gridspace wire`."""
import contextlib
import functools
import json
import os
import random
import socket
import struct
import subprocess
import time
import unittest

import foreign_frames
import own_namespace
from foreign_frames import FALSE, GOOSE, SV, TRUE, asdu, floats, goose, integer, le92, sv, tlv

GRIDSPACE = os.environ.get("GRIDSPACE_BIN_DIR", "build/release/bin") + "/gridspace"
HANG_S = 60
ONE = floats(1.0, -0.5, -0.5)


class ForeignFrames(unittest.TestCase):
    def setUp(self):
        own_namespace.cable("left", "right")
        self.port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)
        self.port.bind(("left", 0))

    def tearDown(self):
        self.port.close()
        subprocess.run(["ip", "link", "del", "left"], check=True)

    @staticmethod
    def listeners():
        with open("/proc/net/packet", encoding="ascii") as table:
            return sum(line.split()[3] != "0000" for line in table.readlines()[1:])

    def subscriber(self, *arguments):
        """A subscriber that listens already."""
        before = self.listeners()
        process = subprocess.Popen([GRIDSPACE, "wire", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + HANG_S
        while self.listeners() == before:
            self.assertIsNone(process.poll(), "the subscriber ended")
            self.assertLess(time.monotonic(), deadline, "the subscriber does not listen")
            time.sleep(0.001)
        return process

    def heard(self, verb, frames, *arguments):
        """What the subscriber says of these frames, one line each."""
        process = self.subscriber(verb, "right", *arguments, "--count", str(len(frames)), "--duration", str(HANG_S))
        for frame in frames:
            self.port.send(frame)
        out, err = process.communicate(timeout=2 * HANG_S)
        self.assertEqual(process.returncode, 0, err)
        return [json.loads(line) for line in out.splitlines()]

    def samples(self, frames, *keys):
        return self.heard("sv-sub", frames, "--frames", *keys)

    def messages(self, frames, *keys):
        return self.heard("goose-sub", frames, *keys)

    def test_every_way_to_write_a_sample_is_read_the_same(self):
        ways = {
            "plain": sv([asdu("MU", 4799, ONE)]),
            "priority tag": sv([asdu("MU", 4799, ONE)], vlan=[(0x8100, 0x8000)]),
            "VLAN 100": sv([asdu("MU", 4799, ONE)], vlan=[(0x8100, 0x8064)]),
            "two tags": sv([asdu("MU", 4799, ONE)], vlan=[(0x88A8, 0x0005), (0x8100, 0x8064)]),
            "long lengths, 1 octet": sv([asdu("MU", 4799, ONE, form=1)], form=1),
            "long lengths, 2 octets": sv([asdu("MU", 4799, ONE, form=2)], form=2),
            "long lengths, 4 octets": sv([asdu("MU", 4799, ONE, form=4)], form=4),
            "number of ASDUs in 2 octets": sv([asdu("MU", 4799, ONE)], number_octets=2),
            "counter in 4 octets": sv([asdu("MU", 4799, ONE, cnt_octets=4)]),
            "revision in 1 octet": sv([asdu("MU", 4799, ONE, rev_octets=1)]),
            "revision in 5 octets": sv([asdu("MU", 4799, ONE, rev_octets=5)]),
            "all optional fields": sv([asdu("MU", 4799, ONE, dat_set="MU/LLN0$d", refr_tm=bytes(8), smp_rate=4800, smp_mod=1, gm_identity=bytes(8))]),
            "a field of a later edition": sv([asdu("MU", 4799, ONE, extra=tlv(0x8A, b"later") + tlv(0x9F45, b"longer tag"))]),
            "a field of a later edition first": sv([asdu("MU", 4799, ONE, first=tlv(0xBF8145, b"longest tag"))]),
            "security": sv([asdu("MU", 4799, ONE)], before=tlv(0x81, bytes(20)), reserved2=32),
            "an unknown element behind": sv([asdu("MU", 4799, ONE)], behind=tlv(0x9A, b"?")),
            "an authentication value behind the APDU": sv([asdu("MU", 4799, ONE)]) + bytes(40),
            "no padding": sv([asdu("MU", 4799, ONE)], pad=False),
        }
        lines = self.samples(list(ways.values()), "data_set={Ia: float32, Ib: float32, Ic: float32}")
        self.assertEqual(len(lines), len(ways))
        for way, line in zip(ways, lines):
            self.assertEqual((line.get("sv_id"), line.get("smp_cnt"), line.get("conf_rev"), line.get("smp_synch")), ("MU", 4799, 1, 2), way)
            self.assertEqual(line["values"], {"Ia": 1.0, "Ib": -0.5, "Ic": -0.5}, way)
        optional = lines[list(ways).index("all optional fields")]
        self.assertEqual((optional["smp_rate"], optional["smp_mod"], optional["dat_set"], optional["gm_identity"]), (4800, 1, "MU/LLN0$d", "0" * 16))
        self.assertEqual(lines[2]["vlan"], {"id": 100, "priority": 4})

    def test_sixteen_samples_and_sixteen_streams_in_a_frame(self):
        one = sv([asdu("MU", (4790 + i) % 4800, floats(i)) for i in range(16)])
        other = sv([asdu(f"MU{i}", 7, floats(i)) for i in range(16)])
        lines = self.samples([one, other], "data_set={Ia: float32}")
        self.assertEqual([line["smp_cnt"] for line in lines[:16]], [(4790 + i) % 4800 for i in range(16)])
        self.assertEqual([line["sv_id"] for line in lines[16:]], [f"MU{i}" for i in range(16)])
        self.assertEqual([line["values"]["Ia"] for line in lines], [*range(16), *range(16)])

    def test_9_2le_with_negative_values_and_bad_quality(self):
        values = [(-1_000_000, 0), (2_147_483_647, 0x2), (-2_147_483_648, 0x3), (0, 0x2000), (11_000_00, 0), (-1, 0x800), (5, 0), (-1_100_004, 0x2000)]
        line, = self.samples([sv([asdu("xxxxMUnn01", 0, le92(values))])], "data_set=9-2LE")
        self.assertEqual([v for v in line["values"].values()], [part for pair in values for part in pair])

    def test_names_and_counters_at_their_ends(self):
        frames = [sv([asdu("Übung Süd", 65535, ONE)]), sv([asdu("", 0, ONE)]), sv([asdu("x" * 129, 1, ONE)]), sv([asdu(b"a\x00\x1b[2J\xff", 2, ONE)]),
                  sv([asdu("MU", 65535, ONE, cnt_octets=3)]), sv([asdu("MU", 3, b"")])]
        lines = self.samples(frames)
        self.assertEqual(lines[0]["sv_id"], "\\xc3\\x9cbung S\\xc3\\xbcd")
        self.assertEqual([line["smp_cnt"] for line in lines], [65535, 0, 1, 2, 65535, 3])
        self.assertNotIn("\x1b", lines[3]["sv_id"])

    def test_what_contradicts_itself_is_an_error_with_its_place(self):
        good = asdu("MU", 1, ONE)
        frames = {
            "declares two, holds one": (sv([good], declared=2), "noASDU"),
            "declares one, holds two": (sv([good, good], declared=1), "noASDU"),
            "holds none": (sv([]), "noASDU"),
            "counter beyond 16 bits": (sv([asdu("MU", 65536, ONE, cnt_octets=3)]), "0x82"),
            "the same field twice": (sv([asdu("MU", 1, ONE, extra=tlv(0x82, b"\0\2"))]), "twice"),
            "an indefinite length": (sv([good]).replace(b"\x30\x2a", b"\x30\x80") if b"\x30\x2a" in sv([good]) else sv([tlv(0x30, b"\x80\x80")]), ""),
            "a length beyond the frame": (sv([good], length_field=2000), ""),
            "a length of seven": (sv([good], length_field=7), ""),
            "no svID": (sv([tlv(0x30, tlv(0x82, b"\0\1") + tlv(0x83, b"\0\0\0\1") + tlv(0x85, b"\2") + tlv(0x87, ONE))]), "0x80"),
        }
        lines = self.samples([frame for frame, _ in frames.values()])
        for (what, (_, text)), line in zip(frames.items(), lines):
            self.assertIn("error", line, what)
            self.assertIn(text, line["error"], what)

    def test_damaged_frames_of_every_kind_end_nothing(self):
        """Each prefix, each octet changed in several ways, and noise; the tool goes on and says something of each frame."""
        dice = random.Random(7)
        whole = {SV: sv([asdu("MU", 4799, ONE, smp_rate=4800), asdu("MU", 0, ONE)], vlan=[(0x8100, 0x8000)], pad=False),
                 GOOSE: goose([TRUE, tlv(0xA2, TRUE + tlv(0x84, b"\x06\x40")), tlv(0x87, b"\x08" + floats(1))], vlan=[(0x8100, 0x8000)], pad=False)}
        for protocol, verb in ((SV, "sv-sub"), (GOOSE, "goose-sub")):
            frame = whole[protocol]
            damaged = [frame[:n] for n in range(20, len(frame))]  # less holds no header: the kernel drops it
            for at in range(18, len(frame)):
                for octet in (0x00, 0x7F, 0x80, 0x81, 0x84, 0xFF, dice.randrange(256)):
                    damaged.append(frame[:at] + bytes([octet]) + frame[at + 1:])
            for _ in range(500):
                damaged.append(frame[:18] + dice.randbytes(dice.randrange(2, 1400)))
            options = ["--frames"] if protocol == SV else []
            process = self.subscriber(verb, "right", *options, "--count", str(len(damaged) + 1), "--duration", str(HANG_S))
            for k, one in enumerate(damaged):
                self.port.send(one)
                if k % 50 == 49:
                    time.sleep(0.001)  # not a test of how fast it is
            self.port.send(frame)
            out, err = process.communicate(timeout=2 * HANG_S)
            self.assertEqual(process.returncode, 0, err)
            lines = [json.loads(line) for line in out.splitlines()]
            self.assertGreaterEqual(len(lines), len(damaged) + 1)
            self.assertGreater(sum("error" in line for line in lines), len(damaged) / 4)
            self.assertNotIn("error", lines[-1])

    def test_every_way_to_write_a_message_is_read_the_same(self):
        data = [TRUE]
        ways = {
            "plain": goose(data, st=300, sq=70000),
            "fixed-length integers": goose(data, st=300, sq=70000, octets=5),
            "integers of 4 octets": goose(data, st=300, sq=70000, octets=4),
            "integers of 9 octets": goose(data, st=300, sq=70000, octets=9),
            "long lengths": goose(data, st=300, sq=70000, form=2),
            "longest lengths": goose(data, st=300, sq=70000, form=4),
            "VLAN": goose(data, st=300, sq=70000, vlan=[(0x8100, 0xE001)]),
            "defaults left out": goose(data, st=300, sq=70000, leave_out=(0x83, 0x87, 0x89)),
            "security behind": goose(data, st=300, sq=70000, behind=tlv(0xAC, tlv(0x04, bytes(16)))),
            "an unknown field": goose(data, st=300, sq=70000, behind=tlv(0x9F55, b"later")),
            "TRUE as FF": goose([tlv(0x83, b"\xff")], st=300, sq=70000),
        }
        lines = self.messages(list(ways.values()))
        for way, line in zip(ways, lines):
            self.assertEqual((line.get("st_num"), line.get("sq_num"), line.get("time_allowed_to_live_ms"), line.get("conf_rev"), line.get("values")),
                             (300, 70000, 2000, 1, "true"), way)
            self.assertEqual((line["simulation"], line["nds_com"]), (False, False), way)

    def test_all_types_of_data_are_shown(self):
        structure = tlv(0xA2, tlv(0x84, b"\x06\x80") + tlv(0x84, b"\x03\x00\x00") + tlv(0x91, bytes(8)))
        data = [tlv(0x85, integer(-129)), tlv(0x85, integer(-(1 << 63))), tlv(0x86, b"\x00\xff\xff\xff\xff"), tlv(0x87, b"\x08" + floats(-1.5)),
                tlv(0x87, b"\x0b" + struct.pack(">d", 1e300)), tlv(0x89, b"\x01\xfe"), tlv(0x8A, "größer".encode()), tlv(0x8C, bytes(6)),
                tlv(0xA1, structure * 2), tlv(0x84, b"\x00"), tlv(0x8F, b"unknown kind")]
        line, = self.messages([goose(data)])
        shown = line["values"]
        for part in ("-129", "-9223372036854775808", "4294967295", "-1.5", "1e+300", "01fe", "gr\\xc3\\xb6\\xc3\\x9fer", "<tag 0x8F>"):
            self.assertIn(part, shown)
        self.assertEqual(line["entries"], len(data))

    def test_a_subscriber_follows_restarts_and_refuses_replays_when_asked_to(self):
        keys = ["control_block=IED/LLN0$GO$g"]
        goose = functools.partial(foreign_frames.goose, live=60_000)  # none expires meanwhile
        story = [goose([FALSE], st=5, sq=9), goose([FALSE], st=5, sq=9), goose([TRUE], st=6, sq=0), goose([TRUE], st=6, sq=3), goose([FALSE], st=5, sq=10),
                 goose([TRUE], st=6, sq=4), goose([FALSE], st=1, sq=0), goose([FALSE], st=1, sq=1), goose([TRUE, TRUE], st=2, sq=0),
                 goose([TRUE], st=2, sq=0, conf_rev=2), goose([TRUE], st=2, sq=0, nds_com=True), goose([TRUE], st=2, sq=0, live=0),
                 goose([TRUE], st=2, sq=0, simulation=True), goose([TRUE], st=2, sq=0, simulated=True), goose([tlv(0x85, b"\x01")], st=2, sq=0)]
        tolerant = [line["event"] for line in self.messages(story, *keys)]
        self.assertEqual(tolerant, ["first", "duplicate", "state_change", "repetition", "restart", "state_change", "restart", "repetition",
                                    "data_set_mismatch", "conf_rev_mismatch", "needs_commissioning", "no_time_to_live", "simulation_refused",
                                    "simulation_refused", "data_set_mismatch"])
        strict = [line["event"] for line in self.messages(story[:7], *keys, "--strict")]
        self.assertEqual(strict, ["first", "duplicate", "state_change", "repetition", "stale", "repetition", "stale"])

    def test_a_counter_that_turns_over_loses_nothing(self):
        top = 0xFFFFFFFF
        # An INTEGER that is unsigned needs five octets up there.
        goose = functools.partial(foreign_frames.goose, live=60_000)
        story = [goose([TRUE], st=top, sq=top - 1, octets=5), goose([TRUE], st=top, sq=top, octets=5), goose([TRUE], st=top, sq=1, octets=5),
                 goose([FALSE], st=1, sq=0, octets=5)]
        lines = self.messages(story, "control_block=IED/LLN0$GO$g")
        self.assertEqual([line["event"] for line in lines], ["first", "repetition", "repetition", "state_change"])
        self.assertEqual([line["lost"] for line in lines], [0, 0, 0, 0])

    def test_the_table_survives_a_storm_of_made_up_names(self):
        process = self.subscriber("list", "right", "--json", "--duration", str(HANG_S))
        for i in range(3000):
            self.port.send(sv([asdu(f"made up {i}", i, ONE)]))
        for i in range(100):
            self.port.send(goose([TRUE], gocb=f"made up {i}"))
        for line in process.stdout:
            if json.loads(line)["frames"] >= 3100:
                break
        process.terminate()
        out, err = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 0, err)
        table = json.loads(out.splitlines()[-1])
        self.assertEqual(len(table["streams"]), 1024)
        self.assertEqual(table["frames"], 3100)
        self.assertEqual(table["beyond_table"], 3100 - 1024)

    def test_publishers_of_other_rates_are_followed(self):
        """80 and 256 samples per cycle of 50 and 60 Hz, one and eight in a frame: none lost, whatever the wrap."""
        for rate, asdus in ((4000, 1), (4800, 2), (12800, 8), (15360, 8), (14400, 6)):
            for _ in range(60):
                process = self.subscriber("sv-sub", "right", "--count", str(rate // asdus * 3 // 2), "--duration", str(HANG_S))
                publisher = subprocess.Popen([GRIDSPACE, "wire", "sv-pub", "left", f"rate_hz={rate}", f"samples_per_frame={asdus}", "sv_id=MU"],
                                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                with contextlib.suppress(OSError):  # where it may, it sends in time whatever else the machine does
                    os.sched_setscheduler(publisher.pid, os.SCHED_RR, os.sched_param(1))
                out, err = process.communicate(timeout=2 * HANG_S)
                publisher.terminate()
                sent = json.loads(publisher.communicate(timeout=HANG_S)[0])
                self.assertEqual(process.returncode, 0, err)
                last = json.loads(out.splitlines()[-1])
                stream, = last["streams"]
                counted = (stream["lost"], stream["duplicates"], stream["late"], stream["restarts"])
                # Of a subscriber whom the kernel had to drop frames for, and of a publisher that sent in heaps, it says nothing.
                disturbed = last["dropped"] > 0 or sent["worst_late_us"] > 16e6 / rate
                if counted == (0, 0, 0, 0) or not disturbed:
                    break
            self.assertEqual(counted, (0, 0, 0, 0), (rate, last, sent))


if __name__ == "__main__":
    own_namespace.main()
