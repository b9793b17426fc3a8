#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A line differential relay that is not Gridspace's: two SV streams in, a GOOSE trip out, on a network interface.

    relay.py process_bus --from GS_TL2_MU21 --to GS_TL2_MU22 --trip 01:0C:CD:01:00:02 0x8002 'IED2LD0/LLN0$GO$Trip' 'IED2LD0/LLN0$TRIP2'

The difference of the RMS values of the two ends over one cycle, per phase, against a pickup. Real time only: it does not know the
simulation clock.
"""
import argparse
import select
import struct
import time

from iec61850_frames import GOOSE, SV, frame, goose_apdu, mac, open_port, own_mac, samples_of

WINDOW = 80  # samples of a cycle: 4800 Hz, 60 Hz


class End:
    """Running sums of squares of one end, by sample counter."""

    def __init__(self):
        self.ring = [(0.0, 0.0, 0.0)] * WINDOW
        self.sums = [0.0, 0.0, 0.0]
        self.last, self.filled = None, 0

    def add(self, count, sample):
        missing = 0 if self.last is None else (count - self.last - 1) % 4800
        if missing > 4:
            self.__init__()  # a hole: start again, nothing is decided meanwhile
        elif missing > 0:
            self.last = (count - 1) % 4800
            for _ in range(missing):  # a small one is bridged
                self.push(sample)
        self.last = count
        self.push(sample)

    def push(self, sample):
        squares = tuple(i * i for i in struct.unpack(">fff", sample[:12]))
        at = self.filled % WINDOW
        old = self.ring[at]
        self.ring[at] = squares
        self.sums = [s + n - o for s, n, o in zip(self.sums, squares, old)]
        self.filled += 1

    def rms(self):
        return [(max(s, 0.0) / WINDOW) ** 0.5 for s in self.sums] if self.filled >= WINDOW else None


class Trip:
    """Sends the trip message: at once when it changes, then after 1, 2, 4, 8 ms, then every 10 ms."""

    def __init__(self, port, head, control_block, data_set):
        self.port, self.head, self.control_block, self.data_set = port, head, control_block, data_set
        self.value, self.st_num, self.sq_num = False, 1, 0
        self.changed_s, self.interval_s, self.due = time.time(), 0.01, time.monotonic()

    def set(self, value):
        if value != self.value:
            self.value, self.st_num, self.sq_num = value, self.st_num + 1, 0
            self.changed_s, self.interval_s, self.due = time.time(), 0.001, time.monotonic()

    def work(self):
        if time.monotonic() < self.due:
            return
        apdu = goose_apdu(self.control_block, self.data_set, self.value, self.st_num, self.sq_num, self.changed_s, 200)
        self.port.send(frame(*self.head, apdu))
        self.sq_num += 1
        self.due = time.monotonic() + self.interval_s
        self.interval_s = min(self.interval_s * 2, 0.01)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("interface")
    parser.add_argument("--from", dest="ends", action="append", required=True, metavar="SVID")
    parser.add_argument("--to", dest="ends", action="append", required=True, metavar="SVID")
    parser.add_argument("--trip", nargs=4, required=True, metavar=("MAC", "APPID", "GOCBREF", "DATSET"))
    parser.add_argument("--pickup-a", type=float, default=30)
    options = parser.parse_args()

    port = open_port(options.interface, SV)
    address, app_id, control_block, data_set = options.trip
    trip = Trip(port, (mac(address), own_mac(port), GOOSE, int(app_id, 0)), control_block, data_set)
    ends = {name: End() for name in options.ends}
    first, second = (ends[name] for name in options.ends)
    while True:
        ready, _, _ = select.select([port], [], [], max(0.0, trip.due - time.monotonic()))
        trip.work()
        if not ready:
            continue
        for name, count, synch, sample in samples_of(port.recv(2048)):
            end = ends.get(name)
            if end is None or synch == 0:
                continue
            end.add(count, sample)
            here, there = first.rms(), second.rms()
            # Within a few samples of each other: an RMS over a cycle changes little in between.
            if here and there and not trip.value and max(abs(a - b) for a, b in zip(here, there)) > options.pickup_a:
                print(f"trip at sample {count}: {here} A and {there} A", flush=True)
                trip.set(True)
                trip.work()


if __name__ == "__main__":
    main()
