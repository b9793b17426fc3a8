#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A gateway that does not run for two seconds (its processor was taken away) finds all frames of that time in the kernel: a stall of its
own is neither a loss of samples nor the end of a stream."""
import os
import pathlib
import signal
import socket
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "wire"))
import counters  # noqa: E402
import own_namespace  # noqa: E402
import gateway_test  # noqa: E402
from gateway_test import GOOSE_IN, SV_IN, keys_of  # noqa: E402

STALL_S = 2
RATE = SV_IN["rate_hz"]
GOOSE = dict(GOOSE_IN, live_min_ms=500)
SO_TIMESTAMPNS = 35
WORTH_TRYING = 8


class Ear:
    """What comes on an interface, by the kernel's stamps: how many frames, and the longest time without one of either kind."""

    def __init__(self, interface):
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
        self.socket.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.socket.bind((interface, 0))
        self.socket.settimeout(0.1)
        self.samples, self.longest_gap_s, self.last = 0, 0.0, {}
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        while not self.stop.is_set():
            try:
                frame, with_it, _, _ = self.socket.recvmsg(2048, 256)
            except socket.timeout:
                continue
            kind = next((k for k in (b"\x88\xba", b"\x88\xb8") if k in frame[12:18]), None)
            if kind is None:
                continue
            stamp = next(int.from_bytes(d[:8], sys.byteorder) + int.from_bytes(d[8:16], sys.byteorder) * 1e-9
                         for level, option, d in with_it if (level, option) == (socket.SOL_SOCKET, SO_TIMESTAMPNS))
            self.longest_gap_s = max(self.longest_gap_s, stamp - self.last.get(kind, stamp))
            self.last[kind] = stamp
            self.samples += kind == b"\x88\xba"

    def close(self):
        self.stop.set()
        self.thread.join()
        self.socket.close()


class Stall(counters.Counters, unittest.TestCase):
    setUp, tearDown = gateway_test.Gateway.setUp, gateway_test.Gateway.tearDown
    gateway, start, wire = gateway_test.Gateway.gateway, gateway_test.Gateway.start, gateway_test.Gateway.wire

    def stall(self):
        """The counters after a stall, and the longest time in which the publishers themselves were not heard."""
        mapping = {"to": {"topic": "feeders", "type": "example::FeederState"}}
        gateway = self.gateway("inward", "in1", {"IN": SV_IN, "STATE": GOOSE}, {
            "m": {**mapping, "from": {"stream": "IN"}, "every": 10, "fields": {"feeder": {"value": "A"}, "voltage_kv": "Ia"}},
            "s": {**mapping, "from": {"stream": "STATE"}, "fields": {"feeder": {"value": "B"}, "voltage_kv": "n"}}})
        self.start_monitor(77)
        ear = Ear("in1")
        try:
            return self.stall_of(gateway, ear), ear.longest_gap_s
        finally:
            ear.close()

    def stall_of(self, gateway, ear):
        self.start(self.wire("sv-pub", "in0", "--amplitude", "10", *keys_of(SV_IN)))
        self.start(self.wire("goose-pub", "in0", "--value", "n=1", *keys_of(GOOSE)))
        self.rows_when(("IN", "STATE"), lambda r: r["IN"]["state"] == r["STATE"]["state"] == "STREAM_ALIVE")
        os.kill(gateway.pid, signal.SIGSTOP)
        before = ear.samples
        self.until(lambda: ear.samples >= before + STALL_S * RATE, "the publisher does not go on")
        os.kill(gateway.pid, signal.SIGCONT)
        resumed = ear.samples
        return self.rows_when(("IN", "STATE"), lambda r: int(r["IN"]["frames"]) + int(r["IN"]["lost"]) >= resumed + RATE // 2)

    def test_a_stall_of_its_own_is_neither_lost_samples_nor_a_lost_stream(self):
        for _ in range(WORTH_TRYING):
            rows, gap_s = self.stall()
            if gap_s < 0.4:  # otherwise the publishers had a stall, too: half a wrap of the counter, the whole life of a message
                break
            self.tearDown()
            self.setUp()
        else:
            self.skipTest(f"the publishers were held up in each of {WORTH_TRYING} runs")
        self.assert_zero(rows, "IN", "lost", "restarts", "refused", "duplicate", "late", "dropped")
        self.assert_zero(rows, "STATE", "lost", "restarts", "refused", "silences", "dropped")
        self.assertLess(float(rows["IN"]["longest_gap_ms"]), 1000 * gap_s + 1, "by the kernel's stamps")


if __name__ == "__main__":
    own_namespace.main(own_namespace.DDS_CABLE)
