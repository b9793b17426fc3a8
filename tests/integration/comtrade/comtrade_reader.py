# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A reader of COMTRADE files written from IEEE C37.111-2013 alone; it shares nothing with the writer and refuses what the standard does."""
import datetime
import pathlib
import re
import struct


def stamp(text):
    """"dd/mm/yyyy,hh:mm:ss.ssssss" as nanoseconds since 1970."""
    date, clock = text.split(",")
    day, month, year = map(int, date.split("/"))
    hour, minute, second = clock.split(":")
    whole, _, fraction = second.partition(".")
    assert len(fraction) in (6, 9), f"{text}: microseconds or nanoseconds"
    base = datetime.datetime(year, month, day, int(hour), int(minute), int(whole), tzinfo=datetime.timezone.utc)
    return int(base.timestamp()) * 10**9 + int(fraction.ljust(9, "0"))


def parts(file):
    """CFG and DAT of a record, in two files or in one (.cff)."""
    raw = file.read_bytes()
    if file.suffix != ".cff":
        return raw, file.with_suffix(".dat").read_bytes()
    found = list(re.finditer(rb"^--- file type: (\w+)(?: (\w+)(?:: (\d+))?)? ---\r\n", raw, re.MULTILINE))
    assert [m[1] for m in found[:4]] == [b"CFG", b"INF", b"HDR", b"DAT"], found
    data = raw[found[3].end():]
    assert (found[3][2] == b"ASCII" and found[3][3] is None) or int(found[3][3]) == len(data), found[3]
    cfg = raw[found[0].end():found[1].start()]
    assert cfg.split(b"\r\n")[-5] == found[3][2], "both parts say the same of the data"
    return cfg, data


class Comtrade:
    def __init__(self, cfg):
        raw, data = parts(pathlib.Path(cfg))
        assert raw.endswith(b"\r\n") and raw.count(b"\n") == raw.count(b"\r\n"), "lines end with CR LF"
        lines = raw.decode("ascii").split("\r\n")[:-1]
        self.station, self.device, revision = lines.pop(0).split(",")
        assert revision == "2013", revision
        total, analog, digital = lines.pop(0).split(",")
        assert analog[-1] == "A" and digital[-1] == "D"
        self.analog_count, self.digital_count = int(analog[:-1]), int(digital[:-1])
        assert int(total) == self.analog_count + self.digital_count
        self.analog, self.digital = [], []
        for n in range(self.analog_count):
            number, name, phase, circuit, unit, a, b, skew, low, high, primary, secondary, ps = lines.pop(0).split(",")
            assert int(number) == n + 1 and ps in "PS" and float(skew) == 0
            self.analog.append({"name": name, "phase": phase, "circuit": circuit, "unit": unit, "a": float(a), "b": float(b), "low": float(low),
                                "high": float(high), "ratio": float(primary) / float(secondary), "ps": ps})
        for n in range(self.digital_count):
            number, name, phase, circuit, normal = lines.pop(0).split(",")
            assert int(number) == n + 1 and normal in "01"
            self.digital.append({"name": name, "phase": phase, "circuit": circuit, "normal": int(normal)})
        self.frequency = float(lines.pop(0))
        assert lines.pop(0) == "1", "one sampling rate"
        rate, last = lines.pop(0).split(",")
        self.rate, self.rows = float(rate), int(last)
        self.start_ns, self.trigger_ns = stamp(lines.pop(0)), stamp(lines.pop(0))
        self.format = lines.pop(0)
        self.time_multiplier = float(lines.pop(0))
        self.time_code, self.local_code = lines.pop(0).split(",")
        self.time_quality, self.leap_second = lines.pop(0).split(",")
        assert not lines, lines
        assert len({c["name"] for c in self.analog + self.digital}) == int(total), "names are unique"
        {"ASCII": self._read_ascii, "BINARY": self._read_binary, "FLOAT32": self._read_binary}[self.format](data)
        for c in self.analog:
            assert all(v is None or c["low"] <= v <= c["high"] for v in c["stored"]), f"{c['name']}: outside of min and max"
            c["values"] = [None if v is None else c["a"] * v + c["b"] for v in c["stored"]]

    def _take(self, n, stamp_us, stored, bits):
        assert n == len(self.stamps_us) + 1, "sample numbers count from 1"
        self.stamps_us.append(stamp_us)
        for channel, value in zip(self.analog, stored, strict=True):
            channel["stored"].append(value)
        for channel, bit in zip(self.digital, bits, strict=True):
            channel["values"].append(bit)

    def _begin(self):
        self.stamps_us = []
        for channel in self.analog:
            channel["stored"] = []
        for channel in self.digital:
            channel["values"] = []

    def _read_ascii(self, data):
        self._begin()
        assert data.endswith(b"\r\n\x1a"), "an ASCII file ends with an end-of-file mark"
        for line in data[:-1].decode("ascii").split("\r\n")[:-1]:
            fields = line.split(",")
            cut = 2 + self.analog_count
            self._take(int(fields[0]), int(fields[1]), [None if f in ("", "99999") else int(f) for f in fields[2:cut]], [int(f) for f in fields[cut:]])
        assert len(self.stamps_us) == self.rows

    def _read_binary(self, data):
        self._begin()
        words = (self.digital_count + 15) // 16
        row = struct.Struct(f"<II{self.analog_count}{'h' if self.format == 'BINARY' else 'f'}{words}H")
        assert len(data) == row.size * self.rows, f"{len(data)} octets are not {self.rows} rows of {row.size}"
        for fields in row.iter_unpack(data):
            stored = [None if v == -32768 else v for v in fields[2:2 + self.analog_count]]
            bits = [fields[2 + self.analog_count + n // 16] >> (n % 16) & 1 for n in range(self.digital_count)]
            self._take(fields[0], fields[1], stored, bits)

    def __getitem__(self, name):
        return next(c["values"] for c in self.analog + self.digital if c["name"] == name)

    def instant_ns(self, row):
        """Of a row, by the sampling rate: UTC."""
        return self.start_ns + round(row / self.rate * 1e9)
