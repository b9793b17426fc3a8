# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Ethernet frames of a run, and what sampled values (IEC 61850-9-2) and GOOSE (IEC 61850-8-1) say in them."""
from __future__ import annotations

import dataclasses
import struct
from collections.abc import Iterator
from typing import Any

SV, GOOSE, VLAN = 0x88BA, 0x88B8, 0x8100
DEEPEST = 16  # structures in structures


@dataclasses.dataclass(frozen=True, slots=True)
class Frame:
    """A frame as it was captured. time_s: simulated seconds. port: where it was seen (docs/design/protection.md, "What is captured").

    direction: "in" or "out", as seen from the port; "" where the capture does not say.
    """

    time_s: float
    unix_ns: int
    port: str
    direction: str
    destination: str
    source: str
    vlan: int | None
    ethertype: int
    payload: bytes
    octets: bytes


@dataclasses.dataclass(frozen=True, slots=True)
class SampledValue:
    """One ASDU of a frame of sampled values. data: the octets of its data set; floats() and integers() read them."""

    time_s: float
    port: str
    stream: str
    app_id: int
    count: int
    synch: int
    conf_rev: int
    simulated: bool
    data: bytes

    def floats(self) -> tuple[float, ...]:
        """The data set as FLOAT32 members."""
        return struct.unpack(f">{len(self.data) // 4}f", self.data[:len(self.data) // 4 * 4])

    def integers(self) -> tuple[int, ...]:
        """The data set as INT32 members, qualities included (9-2LE: value, quality, value, quality …)."""
        return struct.unpack(f">{len(self.data) // 4}i", self.data[:len(self.data) // 4 * 4])


@dataclasses.dataclass(frozen=True, slots=True)
class Goose:
    """A GOOSE message. t_s: the time of its newest state, in seconds since 1970. values: bool, int, float, str, bytes, or a list of those."""

    time_s: float
    port: str
    stream: str
    app_id: int
    st_num: int
    sq_num: int
    t_s: float
    live_ms: int
    conf_rev: int
    simulated: bool
    values: tuple[Any, ...]


def parse(octets: bytes, time_s: float = 0.0, unix_ns: int = 0, port: str = "", direction: str = "") -> Frame:
    """A frame of its octets. Raises ValueError when it is shorter than its header."""
    if len(octets) < 14:
        raise ValueError(f"a frame of {len(octets)} octets, and its header has 14")
    vlan, at = None, 12
    if octets[12:14] == VLAN.to_bytes(2, "big"):
        if len(octets) < 18:
            raise ValueError(f"a frame of {len(octets)} octets, and its header with a VLAN tag has 18")
        vlan, at = int.from_bytes(octets[14:16], "big") & 0xFFF, 16
    address = [":".join(f"{octet:02x}" for octet in octets[i:i + 6]) for i in (0, 6)]
    return Frame(time_s, unix_ns, port, direction, address[0], address[1], vlan, int.from_bytes(octets[at:at + 2], "big"), octets[at + 2:], octets)


def sampled_values(frame: Frame) -> Iterator[SampledValue]:
    """The ASDUs of a frame; none of another frame. Raises ValueError for one that cannot be read."""
    if frame.ethertype != SV:
        return
    app_id, simulated, pdu = _header(frame)
    part = _only(pdu, 0x60)
    for tag, asdu in _elements(_only(part, 0xA2)):
        if tag != 0x30:
            raise ValueError(f"tag 0x{tag:02x} among the ASDUs")
        fields = dict(_elements(asdu))
        try:
            yield SampledValue(frame.time_s, frame.port, _text(fields[0x80]), app_id, _unsigned(fields[0x82]), _unsigned(fields[0x85]),
                               _unsigned(fields[0x83]), simulated, fields[0x87])
        except KeyError as e:
            raise ValueError(f"an ASDU without the element 0x{e.args[0]:02x}") from None


def goose(frame: Frame) -> Goose | None:
    """The message in a frame; None of another frame. Raises ValueError for one that cannot be read."""
    if frame.ethertype != GOOSE:
        return None
    app_id, simulated, pdu = _header(frame)
    fields = dict(_elements(_only(pdu, 0x61)))
    try:
        stamp = fields[0x84]
        if len(stamp) != 8:
            raise ValueError(f"a time of {len(stamp)} octets")
        return Goose(frame.time_s, frame.port, _text(fields[0x80]), app_id, _unsigned(fields[0x85]), _unsigned(fields[0x86]), _time(stamp),
                     _unsigned(fields[0x81]), _unsigned(fields[0x88]), simulated or fields.get(0x87, b"\0") != b"\0", tuple(_values(fields[0xAB], 0)))
    except KeyError as e:
        raise ValueError(f"a GOOSE message without the element 0x{e.args[0]:02x}") from None


def _header(frame: Frame) -> tuple[int, bool, bytes]:
    """APPID, S bit, and the PDU."""
    if len(frame.payload) < 8:
        raise ValueError("a frame without APPID and length")
    app_id, length, reserved = struct.unpack_from(">HHH", frame.payload)
    if not 8 <= length <= len(frame.payload):
        raise ValueError(f"its length is {length}, and {len(frame.payload)} octets follow")
    return app_id, bool(reserved & 0x8000), frame.payload[8:length]


def _elements(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The elements of a constructed value (BER, definite lengths): tag and content."""
    at = 0
    while at < len(data):
        if at + 2 > len(data):
            raise ValueError("an element is cut off")
        tag, size = data[at], data[at + 1]
        at += 2
        if size >= 0x80:
            octets = size & 0x7F
            if not 1 <= octets <= 4 or at + octets > len(data):
                raise ValueError(f"the length of the element 0x{tag:02x} is none")
            size, at = int.from_bytes(data[at:at + octets], "big"), at + octets
        if at + size > len(data):
            raise ValueError(f"the element 0x{tag:02x} has {size} octets, and {len(data) - at} are left")
        yield tag, data[at:at + size]
        at += size


def _only(data: bytes, tag: int) -> bytes:
    for found, content in _elements(data):
        if found == tag:
            return content
    raise ValueError(f"there is no element 0x{tag:02x}")


def _unsigned(content: bytes) -> int:
    return int.from_bytes(content, "big")


def _text(content: bytes) -> str:
    return content.decode("ascii", errors="replace")


def _time(stamp: bytes) -> float:
    """UtcTime: seconds, a fraction in 2^-24, and its quality."""
    return int.from_bytes(stamp[:4], "big") + int.from_bytes(stamp[4:7], "big") / (1 << 24)


def _values(data: bytes, depth: int) -> Iterator[Any]:
    """Data of MMS (ISO 9506-2)."""
    if depth > DEEPEST:
        raise ValueError(f"structures more than {DEEPEST} deep")
    for tag, content in _elements(data):
        if tag in (0xA1, 0xA2):
            yield list(_values(content, depth + 1))
        elif tag == 0x83:
            yield content != b"\0"
        elif tag == 0x84:
            if not content or content[0] > 7:
                raise ValueError("a bit string without its count of unused bits")
            yield "".join(f"{octet:08b}" for octet in content[1:])[:8 * (len(content) - 1) - content[0]]
        elif tag in (0x85, 0x86):
            yield int.from_bytes(content, "big", signed=tag == 0x85)
        elif tag == 0x87 and len(content) in (5, 9):
            yield struct.unpack(">f" if len(content) == 5 else ">d", content[1:])[0]
        elif tag in (0x8A, 0x90):
            yield content.decode(errors="replace")
        elif tag == 0x91 and len(content) == 8:
            yield _time(content)
        else:
            yield content
