#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Merging units that are not Gridspace's: the two ends of a line as a relay test set plays them, on a network interface.

    merging_units.py process_bus --stream 01:0C:CD:04:00:21 0x4021 GS_TL2_MU21 --stream 01:0C:CD:04:00:22 0x4022 GS_TL2_MU22

Both ends carry the same current; from --fault-after-s on the first one carries --fault-a. Paced by the clock of the machine.
"""
import argparse
import math
import time

from iec61850_frames import SV, frame, mac, open_port, own_mac, sv_apdu

RATE_HZ, FREQUENCY_HZ, BATCH = 4800, 60, 8


def currents(index, peak_a):
    angle = 2 * math.pi * FREQUENCY_HZ * index / RATE_HZ
    return tuple(peak_a * math.cos(angle - phase * 2 * math.pi / 3) for phase in range(3))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("interface")
    parser.add_argument("--stream", nargs=3, action="append", required=True, metavar=("MAC", "APPID", "SVID"))
    parser.add_argument("--load-a", type=float, default=15, help="peak value")
    parser.add_argument("--fault-a", type=float, default=150, help="peak value")
    parser.add_argument("--fault-after-s", type=float, help="no fault when left out")
    options = parser.parse_args()

    port = open_port(options.interface, SV)
    source = own_mac(port)
    heads = [((mac(address), source, SV, int(app_id, 0)), sv_id) for address, app_id, sv_id in options.stream]
    began, index = time.monotonic(), 0
    while True:
        time.sleep(max(0.0, began + (index + BATCH) / RATE_HZ - time.monotonic()))
        for index in range(index, index + BATCH):
            faulted = options.fault_after_s is not None and index / RATE_HZ >= options.fault_after_s
            for number, (head, sv_id) in enumerate(heads):
                peak_a = options.fault_a if faulted and number == 0 else options.load_a
                port.send(frame(*head, sv_apdu(sv_id, index % RATE_HZ, currents(index, peak_a))))
        index += 1


if __name__ == "__main__":
    main()
