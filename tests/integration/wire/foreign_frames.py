# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of sampled values and GOOSE as other people's devices write them, from the ASN.1 of IEC 61850-9-2 and 8-1 alone: it shares
nothing with Gridspace. Every liberty that BER leaves to a writer is an argument."""
import struct

SV, GOOSE = 0x88BA, 0x88B8
SOURCE = bytes.fromhex("02ab00000001")


def length(size, form=0):
    """Length octets; `form` octets in the long form, 0: the shortest there is."""
    if form == 0:
        if size < 0x80:
            return bytes([size])
        form = 1 if size < 0x100 else 2 if size < 0x10000 else 3
    return bytes([0x80 | form]) + size.to_bytes(form, "big")


def tlv(tag, content, form=0):
    head = bytes([tag]) if tag < 0x100 else tag.to_bytes((tag.bit_length() + 7) // 8, "big")
    return head + length(len(content), form) + content


def integer(value, octets=0):
    """BER INTEGER: `octets` long, or as short as it goes (two's complement)."""
    if octets == 0:
        octets = 1
        while not -(1 << (8 * octets - 1)) <= value < 1 << (8 * octets - 1):
            octets += 1
    return value.to_bytes(octets, "big", signed=True)


def ethernet(payload_type, app_id, apdu, destination, vlan=None, source=SOURCE, simulated=False, length_field=None, reserved2=0, pad=True):
    """`vlan`: list of (TPID, TCI)."""
    out = bytes.fromhex(destination.replace(":", "")) + source
    for tpid, tci in vlan or []:
        out += struct.pack(">HH", tpid, tci)
    size = len(apdu) + 8 if length_field is None else length_field
    out += struct.pack(">HHHHH", payload_type, app_id, size, 0x8000 if simulated else 0, reserved2) + apdu
    return out + bytes(max(0, 60 - len(out))) if pad else out


def asdu(sv_id, smp_cnt, sample, conf_rev=1, smp_synch=2, *, form=0, cnt_octets=2, rev_octets=4, extra=b"", first=b"", **optional):
    """One ASDU. Optional: dat_set, refr_tm (8 octets), smp_rate, smp_mod, gm_identity (8 octets)."""
    name = sv_id if isinstance(sv_id, bytes) else sv_id.encode()
    out = first + tlv(0x80, name, form)
    if "dat_set" in optional:
        out += tlv(0x81, optional["dat_set"].encode(), form)
    out += tlv(0x82, smp_cnt.to_bytes(cnt_octets, "big"), form) + tlv(0x83, conf_rev.to_bytes(rev_octets, "big"), form)
    if "refr_tm" in optional:
        out += tlv(0x84, optional["refr_tm"], form)
    out += tlv(0x85, bytes([smp_synch]), form)
    if "smp_rate" in optional:
        out += tlv(0x86, struct.pack(">H", optional["smp_rate"]), form)
    out += tlv(0x87, sample, form)
    if "smp_mod" in optional:
        out += tlv(0x88, struct.pack(">H", optional["smp_mod"]), form)
    if "gm_identity" in optional:
        out += tlv(0x89, optional["gm_identity"], form)
    return tlv(0x30, out + extra, form)


def sv(asdus, *, form=0, declared=None, number_octets=1, before=b"", behind=b"", app_id=0x4000, destination="01:0C:CD:04:00:01", **frame):
    number = (len(asdus) if declared is None else declared).to_bytes(number_octets, "big")
    pdu = tlv(0x60, tlv(0x80, number, form) + before + tlv(0xA2, b"".join(asdus), form) + behind, form)
    return ethernet(SV, app_id, pdu, destination, **frame)


def floats(*values):
    return struct.pack(f">{len(values)}f", *values)


def le92(pairs):
    """9-2LE: (INT32, quality) of four currents and four voltages."""
    return b"".join(struct.pack(">iI", value, quality) for value, quality in pairs)


def goose(data, *, gocb="IED/LLN0$GO$g", dat_set="IED/LLN0$d", go_id="g", live=2000, st=1, sq=0, conf_rev=1, t=bytes(8), entries=None, form=0,
          octets=0, leave_out=(), simulation=False, nds_com=False, behind=b"", app_id=0x0001, destination="01:0C:CD:01:00:01", **frame):
    """`data`: encoded members. `octets`: length of the header's integers, 0: the shortest. `leave_out`: tags that are not sent."""
    parts = [(0x80, gocb.encode()), (0x81, integer(live, octets)), (0x82, dat_set.encode()), (0x83, go_id.encode()), (0x84, t),
             (0x85, integer(st, octets)), (0x86, integer(sq, octets)), (0x87, bytes([simulation])), (0x88, integer(conf_rev, octets)),
             (0x89, bytes([nds_com])), (0x8A, integer(len(data) if entries is None else entries, octets)), (0xAB, b"".join(data))]
    content = b"".join(tlv(tag, value, form) for tag, value in parts if tag not in leave_out) + behind
    return ethernet(GOOSE, app_id, tlv(0x61, content, form), destination, **frame)


TRUE, FALSE = tlv(0x83, b"\x01"), tlv(0x83, b"\x00")
