# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Sampled values (IEC 61850-9-2) and GOOSE (IEC 61850-8-1) as Ethernet frames; standard library only.

Written from the standard's ASN.1 and shares nothing with Gridspace but the wire, so that each judges the other.
"""
import socket
import struct

SV, GOOSE = 0x88BA, 0x88B8


def mac(text):
    return bytes(int(part, 16) for part in text.split(":"))


def open_port(interface, ethertype):
    """Receives frames of one ethertype and sends any. Needs CAP_NET_RAW, which a host of a run has."""
    port = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ethertype))
    port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)  # Python may be late
    port.bind((interface, ethertype))
    return port


def own_mac(port):
    return port.getsockname()[4]


def tlv(tag, content):
    """Tag, length (BER, definite) and content."""
    size = len(content)
    length = bytes([size]) if size < 128 else bytes([0x81, size]) if size < 256 else b"\x82" + struct.pack(">H", size)
    return bytes([tag]) + length + content


def fields(data):
    """The elements of a constructed value, in order: (tag, content)."""
    at = 0
    while at + 2 <= len(data):
        tag, size = data[at], data[at + 1]
        at += 2
        if size >= 0x80:
            octets = size & 0x7F
            size = int.from_bytes(data[at:at + octets], "big")
            at += octets
        yield tag, data[at:at + size]
        at += size


def unsigned(value):
    """INTEGER of a number that is not negative, as short as it goes."""
    octets = value.to_bytes(max(1, (value.bit_length() + 8) // 8), "big")
    return octets


def frame(destination, source, ethertype, app_id, apdu):
    return destination + source + struct.pack(">HHHHH", ethertype, app_id, len(apdu) + 8, 0, 0) + apdu


def samples_of(octets):
    """Yields (svID, smpCnt, smpSynch, sample octets) of every ASDU of an SV frame."""
    if octets[12:14] == b"\x81\x00":  # a VLAN tag that the kernel has left in
        octets = octets[:12] + octets[16:]
    if octets[12:14] != struct.pack(">H", SV):
        return
    for tag, pdu in fields(octets[22:]):
        if tag != 0x60:
            continue
        for inner, asdus in fields(pdu):
            if inner != 0xA2:
                continue
            for _, asdu in fields(asdus):
                part = dict(fields(asdu))
                yield part[0x80].decode(), int.from_bytes(part[0x82], "big"), part[0x85][0], part[0x87]


def sv_apdu(sv_id, smp_cnt, currents, conf_rev=1, synch=2):
    """One sample of three FLOAT32 currents."""
    asdu = (tlv(0x80, sv_id.encode()) + tlv(0x82, struct.pack(">H", smp_cnt)) + tlv(0x83, struct.pack(">I", conf_rev))
            + tlv(0x85, bytes([synch])) + tlv(0x87, struct.pack(">fff", *currents)))
    return tlv(0x60, tlv(0x80, b"\x01") + tlv(0xA2, tlv(0x30, asdu)))


def goose_apdu(control_block, data_set, value, st_num, sq_num, time_s, live_ms, conf_rev=1):
    """A message with one Boolean. `time_s`: of the last change of state, since 1970."""
    whole = int(time_s)
    stamp = struct.pack(">I", whole) + int((time_s - whole) * (1 << 24)).to_bytes(3, "big") + b"\x0a"
    return tlv(0x61, tlv(0x80, control_block.encode()) + tlv(0x81, unsigned(live_ms)) + tlv(0x82, data_set.encode())
               + tlv(0x84, stamp) + tlv(0x85, unsigned(st_num)) + tlv(0x86, unsigned(sq_num)) + tlv(0x87, b"\x00")
               + tlv(0x88, unsigned(conf_rev)) + tlv(0x89, b"\x00") + tlv(0x8A, b"\x01") + tlv(0xAB, tlv(0x83, b"\xff" if value else b"\x00")))
