#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""gridspace-relay alone on a cable, and its processor is taken away for more than a second: what came meanwhile was in time."""
import os
import signal
import time
import unittest

import counters
import own_namespace
import relay_alone_test
from relay_alone_test import frame

RATE = relay_alone_test.RATE = 960  # the kernel keeps 4096 frames
WORTH_TRYING = 8


class RelayStall(counters.Counters, unittest.TestCase):
    setUp, tearDown, start, wait_for = (getattr(relay_alone_test.RelayAlone, name) for name in ("setUp", "tearDown", "start", "wait_for"))
    said, heard, send = (getattr(relay_alone_test.RelayAlone, name) for name in ("said", "heard", "send"))

    def send_with_a_stall(self):
        """Of the relay, from 0.6 to 1.8 s; a fault from 2.4 s on. The longest time in which nothing was sent."""
        last, longest = time.monotonic(), 0.0

        def make(end, sample):
            nonlocal last, longest
            now = time.monotonic()
            last, longest = now, max(longest, now - last)
            if end == "left_end" and sample in (int(0.6 * RATE), int(1.8 * RATE)):
                os.kill(self.relay.pid, signal.SIGSTOP if sample < RATE else signal.SIGCONT)
            return [frame(end, sample, 0.0 if end == "right_end" and sample >= 2.4 * RATE else 100.0)]

        self.send(3, make)
        return longest

    def test_a_stall_of_its_own_is_no_gap_in_its_streams(self):
        for _ in range(WORTH_TRYING):
            self.start_monitor(78)
            if self.send_with_a_stall() < 0.2:  # otherwise there was a gap: half a wrap of the counter is ambiguous
                break
            self.tearDown()
            self.setUp()
        else:
            self.skipTest(f"the sender was held up in each of {WORTH_TRYING} runs")
        self.wait_for(lambda: "true" in self.heard(), "no trip", self.relay)
        self.assertNotIn("window_emptied", self.said())
        self.assertEqual(self.said().count("unblock"), 1, self.said())
        rows = self.rows_when(("FROM", "TO"), lambda r: all(int(r[s]["frames"]) + int(r[s]["lost"]) >= 3 * RATE for s in ("FROM", "TO")))
        for stream in ("FROM", "TO"):
            self.assert_zero(rows, stream, "lost", "restarts", "refused", "duplicate", "late", "dropped")
            self.assertEqual(int(rows[stream]["frames"]), 3 * RATE)


if __name__ == "__main__":
    own_namespace.main(own_namespace.DDS_CABLE)
