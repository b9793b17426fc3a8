# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads the pcapng files of runs: little-endian, compressed or not, stamps in nanoseconds. Written from the specification, not from our writer."""
import collections
import gzip
import struct

Packet = collections.namedtuple("Packet", "point time_ns octets direction comment")
Statistics = collections.namedtuple("Statistics", "received dropped")
INBOUND, OUTBOUND = 1, 2


def _options(block, at):
    out = {}
    while at + 4 <= len(block):
        code, size = struct.unpack_from("<HH", block, at)
        if code == 0:
            break
        out[code] = block[at + 4: at + 4 + size]
        at += 4 + (size + 3) // 4 * 4
    return out


def octets_of(file):
    """What a capture holds, decompressed."""
    octets = file.read_bytes()
    return gzip.decompress(octets) if octets[:2] == b"\x1f\x8b" else octets


class Capture:
    """points: names in order; packets: in order of the file; statistics: by name."""

    def __init__(self, file):
        data, at = octets_of(file), 0
        self.points, self.descriptions, self.packets, self.statistics = [], {}, [], {}
        while at + 12 <= len(data):
            kind, size = struct.unpack_from("<II", data, at)
            block = data[at + 8: at + size - 4]
            if kind == 1:
                options = _options(block, 8)
                self.points.append(options[2].decode())
                self.descriptions[self.points[-1]] = options.get(3, b"").decode()
                assert options[9] == b"\x09", "stamps in nanoseconds"
            elif kind == 6:
                interface, high, low, length = struct.unpack_from("<IIII", block, 0)
                options = _options(block, 20 + (length + 3) // 4 * 4)
                flags = struct.unpack("<I", options[2])[0] if 2 in options else 0
                self.packets.append(Packet(self.points[interface], high << 32 | low, block[20: 20 + length], flags & 3, options.get(1, b"").decode()))
            elif kind == 5:
                interface = struct.unpack_from("<I", block, 0)[0]
                options = _options(block, 12)
                self.statistics[self.points[interface]] = Statistics(struct.unpack("<Q", options[4])[0], struct.unpack("<Q", options[5])[0])
            at += size

    def at(self, point, direction=None):
        """(time, octets) of the frames at a point, in the order of the file."""
        return [(p.time_ns, p.octets) for p in self.packets if p.point == point and direction in (None, p.direction)]


def ethertype(octets):
    """Behind a VLAN tag, if there is one."""
    return octets[16:18] if octets[12:14] == b"\x81\x00" else octets[12:14]
