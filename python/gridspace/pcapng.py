# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads capture files: pcapng, also compressed by gzip, as bus.pcapng.gz of a run is."""
from __future__ import annotations

import os
import pathlib
import struct
import warnings
import zlib
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from gridspace.launcher import Error

SECTION, INTERFACE, PACKET = 0x0A0D0D0A, 1, 6
LARGEST_BLOCK = 16 << 20


class Captured(NamedTuple):
    """A packet: the interface that saw it, nanoseconds since 1970, its octets, the direction ("in", "out" or ""), and a comment."""

    interface: str
    time_ns: int
    octets: bytes
    direction: str
    comment: str


def read(file: str | os.PathLike) -> Iterator[Captured]:
    """The packets of a capture, in the order of the file. One that was cut off gives its whole packets, and a warning.

    Raises Error for a file that is not there, is no pcapng or is damaged.
    """
    path = pathlib.Path(file)
    try:
        file = path.open("rb")
    except OSError as e:
        raise Error(f"cannot read '{path}': {e.strerror}", 2) from e
    with file:
        stream = _Octets(file, path)
        order, interfaces, end = "<", [], 0
        while head := stream.read(8):
            offset, end = end, end + len(head)
            if offset == 0 and head[:4] != SECTION.to_bytes(4, "little"):
                raise Error(f"'{path}' is no pcapng file", 2)
            magic = b""
            if len(head) == 8 and head[:4] == SECTION.to_bytes(4, "little"):  # the same in both orders
                magic = stream.read(4)
                order = ">" if magic == b"\x1a\x2b\x3c\x4d" else "<"
                interfaces = []
            kind, length = struct.unpack(order + "II", head) if len(head) == 8 else (0, 12)
            if length < 12 or length % 4 or length > LARGEST_BLOCK:
                raise Error(f"'{path}' is damaged at offset {offset}: a block of {length} octets", 2)
            body = magic + stream.read(length - 8 - len(magic))
            end += len(body)
            if len(head) + len(body) < length:
                warnings.warn(f"'{path}' ends in the middle of a block, at offset {offset}: the run did not end well", stacklevel=2)
                return
            try:
                if kind == INTERFACE:
                    options = _options(order, body, 8)
                    interfaces.append((options.get(2, b"").decode(errors="replace"), _units(options.get(9, b"\x06"))))
                elif kind == PACKET:
                    number, high, low, size = struct.unpack_from(order + "IIII", body)
                    if size > len(body) - 24:
                        raise ValueError(f"a packet of {size} octets in a block of {length}")
                    name, units = interfaces[number]
                    options = _options(order, body, 20 + size + -size % 4)
                    way = struct.unpack(order + "I", options[2])[0] & 3 if 2 in options else 0
                    yield Captured(name, (high << 32 | low) * 1_000_000_000 // units, body[20:20 + size], ("", "in", "out", "")[way],
                                   options.get(1, b"").decode(errors="replace"))
            except (struct.error, IndexError, ValueError) as e:
                raise Error(f"'{path}' is damaged at offset {offset}: {e}", 2) from e


class _Octets:
    """What a file holds, decompressed where it is compressed. One that was cut off ends where it was."""

    def __init__(self, file: BinaryIO, path: pathlib.Path) -> None:
        self._file, self._path, self._ready, self._at = file, path, file.read(2), 0
        self._inflate = zlib.decompressobj(31) if self._ready == b"\x1f\x8b" else None
        if self._inflate is not None:
            self._ready = self._inflate.decompress(self._ready)

    def read(self, size: int) -> bytes:
        while self._at + size > len(self._ready) and (raw := self._file.read(1 << 16)):
            try:
                more = raw if self._inflate is None else self._inflate.decompress(raw)
            except zlib.error as e:
                raise Error(f"'{self._path}' is damaged: it cannot be decompressed ({e})", 2) from e
            self._ready, self._at = self._ready[self._at:] + more, 0
        octets = self._ready[self._at:self._at + size]
        self._at += len(octets)
        return octets


def _options(order: str, body: bytes, at: int) -> dict[int, bytes]:
    out: dict[int, bytes] = {}
    while at + 4 <= len(body) - 4:  # behind them stands the length of the block once more
        code, size = struct.unpack_from(order + "HH", body, at)
        if code == 0:
            break
        out.setdefault(code, body[at + 4:at + 4 + size])
        at += 4 + size + -size % 4
    return out


def _units(resolution: bytes) -> int:
    """Units in a second: 10^n, or 2^n when the highest bit is set."""
    return 2 ** (resolution[0] & 0x7F) if resolution[0] & 0x80 else 10 ** resolution[0]
