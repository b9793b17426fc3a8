# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of an MCAP recording that is not compressed, read after the format's specification alone. Standard library only."""
import struct


def _text(body, at):
    size = struct.unpack_from("<I", body, at)[0]
    return body[at + 4: at + 4 + size].decode(), at + 4 + size


def messages(file):
    """[(topic, process, time_ns, octets)] in the order of the file."""
    data = file.read_bytes()
    assert data[:8] == b"\x89MCAP0\r\n", file
    channels, out = {}, []

    def records(block, at):
        while at + 9 <= len(block):
            op, size = struct.unpack_from("<BQ", block, at)
            body = block[at + 9: at + 9 + size]
            at += 9 + size
            if op == 0x04:
                number, _ = struct.unpack_from("<HH", body)
                topic, next_ = _text(body, 4)
                _, next_ = _text(body, next_)
                end = next_ + 4 + struct.unpack_from("<I", body, next_)[0]
                next_, metadata = next_ + 4, {}
                while next_ < end:
                    key, next_ = _text(body, next_)
                    metadata[key], next_ = _text(body, next_)
                channels[number] = (topic, metadata.get("process", ""))
            elif op == 0x05:
                number, _, time_ns = struct.unpack_from("<HIQ", body)
                out.append((*channels[number], time_ns, body[22:]))
            elif op == 0x06:
                compression, next_ = _text(body, 28)
                assert compression == "", "a compressed recording: record.compress"
                records(body, next_ + 8)
            elif op == 0x0F:
                return

    records(data, 8)
    return out


def by_topic(file):
    """{(topic, process): [octets]}"""
    out = {}
    for topic, process, _, octets in messages(file):
        out.setdefault((topic, process), []).append(octets)
    return out
