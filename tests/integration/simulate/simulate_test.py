# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""gridspace simulate: the files that it writes, read by somebody else; the same bits twice; mistakes said with their place."""
import csv
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).parents[3]))
SET_A = SOURCE / "configs/networks/adn_set_a.yaml"

FAULT = """events:
  fault: {at_s: 0.05, apply_fault: {line: TL2, position_percent: 37, type: 1ph_g, resistance_ohm: 0.1}, clear_after_ms: 30}
  trip: {at_s: 0.0613, open: [CB3, CB4]}
"""


def simulate(*arguments):
    done = subprocess.run([str(BIN), "simulate", *map(str, arguments)], capture_output=True, text=True, timeout=600, check=False)
    return done.returncode, done.stdout, done.stderr


def read_csv(path):
    rows = list(csv.reader(path.read_text().splitlines()))
    return rows[0], [[float(x) for x in row] for row in rows[1:]]


def read_comtrade(stem):
    """IEEE C37.111-2013 with FLOAT32 data, from the text of the standard: names, then (time in s, analog values, bits) by sample."""
    lines = stem.with_suffix(".cfg").read_bytes().decode().split("\r\n")
    assert lines[0].split(",")[2] == "2013", lines[0]
    total, analog, digital = lines[1].split(",")
    assert analog.endswith("A") and digital.endswith("D")
    analog, digital = int(analog[:-1]), int(digital[:-1])
    assert int(total) == analog + digital
    channels = [line.split(",") for line in lines[2:2 + analog + digital]]
    scale = [(float(c[5]), float(c[6])) for c in channels[:analog]]
    rest = lines[2 + analog + digital:]
    assert rest[1] == "1"  # one sampling rate
    rate, last = rest[2].split(",")
    assert rest[5] == "FLOAT32", rest
    data = stem.with_suffix(".dat").read_bytes()
    size = 8 + 4 * analog + 2 * ((digital + 15) // 16)
    assert len(data) == size * int(last)
    samples = []
    for n in range(int(last)):
        number, stamp = struct.unpack_from("<II", data, n * size)
        assert number == n + 1
        assert abs(stamp - n / float(rate) * 1e6) <= 0.5 + 1e-6
        values = [a * x + b for x, (a, b) in zip(struct.unpack_from(f"<{analog}f", data, n * size + 8), scale)]
        words = struct.unpack_from(f"<{(digital + 15) // 16}H", data, n * size + 8 + 4 * analog)
        samples.append((n / float(rate), values, [words[k // 16] >> (k % 16) & 1 for k in range(digital)]))
    return [c[1] for c in channels], samples


class Simulate(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def run_fault(self, name, *more, fault=FAULT):
        stem = self.folder / name
        code, _, err = simulate(SET_A, "--events", self.write("events.yaml", fault), "--until", "0.12s", "--quiet", "--signals",
                                "ct.CT2*.i.*,bus.B1.v_pu,machine.G1.frequency_hz,breaker.CB3.position,breaker.CB3.pole.*",
                                "--csv", stem.with_suffix(".csv"), "--comtrade", stem, *more)
        self.assertEqual(code, 0, err)
        return stem

    def test_two_runs_write_the_same_bits_and_another_fault_does_not(self):
        one, two = self.run_fault("one"), self.run_fault("two")
        for suffix in (".csv", ".cfg", ".dat"):
            self.assertEqual(one.with_suffix(suffix).read_bytes(), two.with_suffix(suffix).read_bytes(), suffix)
        other = self.run_fault("other", fault=FAULT.replace("37", "38"))
        self.assertNotEqual(one.with_suffix(".dat").read_bytes(), other.with_suffix(".dat").read_bytes())

    def test_a_reader_of_the_standard_finds_in_the_comtrade_files_what_the_table_says(self):
        stem = self.run_fault("run", "--every", "10")
        header, rows = read_csv(stem.with_suffix(".csv"))
        names, samples = read_comtrade(stem)
        self.assertEqual(header[0], "time_s")
        self.assertEqual(len(rows), len(samples))
        self.assertEqual(len(rows), 577)  # 0.12 s at 4800 Hz, and the start
        positions = [n for n in header[1:] if n.startswith("breaker.")]
        self.assertEqual(names, [n for n in header[1:] if n not in positions] + positions)
        self.assertIn("ct.CT21.i.a", names)
        analog = len(names) - len(positions)
        for row, (t, values, bits) in zip(rows, samples):
            table = dict(zip(header, row))
            self.assertAlmostEqual(row[0], t, places=9)
            for name, value in zip(names, values):
                self.assertAlmostEqual(table[name], value, delta=1e-6 * max(1, abs(table[name])))
            for name, bit in zip(names[analog:], bits):
                self.assertEqual(bit, table[name] == 2, name)
        self.assertEqual(samples[0][2], [1] * len(positions))
        self.assertEqual(samples[-1][2], [0] * len(positions))

    def test_a_pattern_that_matches_nothing_is_an_error_with_the_nearest_name(self):
        code, _, err = simulate(SET_A, "--until", "0.01s", "--signals", "bus.B1.v_pq", "--csv", self.folder / "x.csv")
        self.assertEqual(code, 2)
        self.assertIn("no signal matches 'bus.B1.v_pq'", err)
        self.assertIn("bus.B1.v_pu", err)

    def test_mistakes_in_the_events_are_said_with_their_line(self):
        for text, expected in (
                ("events:\n  f: {at_s: 1, apply_fault: {line: TL9, type: 3ph_g}}\n", r"events\.yaml:2:\d+: error: .*TL9"),
                ("events:\n  f: {at_s: 1, apply_fault: {line: TL2, typ: 3ph_g}}\n", r"events\.yaml:2:\d+: error: .*typ"),
                ("events:\n  f: {at_s: 1, open: [CB9]}\n", r"events\.yaml:2:\d+: error: .*CB9"),
                ("events:\n  f: {at_s: 1, kill: relay}\n", r"events\.yaml:2:\d+: error: .*no processes here"),
                ("events:\n  f: {at_s: 1, apply_fault: {line: TL2, position_percent: 101, type: 3ph}}\n", r"events\.yaml:2:\d+: error: .*101"),
                ("events: [\n", r"events\.yaml:\d+:\d+: error"),
        ):
            code, _, err = simulate(SET_A, "--until", "0.01s", "--events", self.write("events.yaml", text))
            self.assertEqual(code, 2, text)
            self.assertRegex(err, expected)

    def test_durations_and_steps_that_are_none_are_refused(self):
        for arguments in (["--until", "soon"], ["--until", "-1"], ["--step", "0"], ["--step", "fast"], ["--solver", "magic"],
                          ["--fixed-step"], ["--every", "0"]):
            code, out, err = simulate(SET_A, *arguments, "--csv", self.folder / "x.csv")
            self.assertEqual(code, 2, f"{arguments}: {out}{err}")
            self.assertTrue(err, arguments)

    def test_a_step_that_is_too_long_for_what_rings_is_warned_of_and_auto_takes_one_that_is_not(self):
        banks = self.write("banks.yaml", """gridspace_network: 1
name: banks
base: {frequency_hz: 60, power_kva: 10000}
buses: {A: {voltage_v: 13800}, B: {voltage_v: 13800}}
sources: {S: {bus: A, r_ohm: 0.05, l_mh: 2}}
lines: {L: {from: A, to: B, r_ohm: 0.005, l_mh: 0.02}}
shunt_capacitors: {C1: {bus: A, q_kvar: 3000, rated_kv: 13.8}, C2: {bus: B, q_kvar: 3000, rated_kv: 13.8, state: open}}
""")
        code, _, err = simulate(banks, "--until", "1ms")
        self.assertEqual(code, 0, err)
        for words in ("warning: steps of 20.8 us", "7796 Hz", "shunt capacitor 'C1', shunt capacitor 'C2'", "37 %", "steps of 1/235200 s"):
            self.assertIn(words, err)
        code, _, err = simulate(banks, "--until", "1ms", "--step", "auto")
        self.assertEqual(code, 0, err)
        self.assertIn("steps of 1/235200 s", err)
        self.assertNotIn("warning", err)
        code, _, err = simulate(banks, "--until", "1ms", "--step", "auto", "--solver", "phasor")
        self.assertEqual(code, 2)
        self.assertIn("--step auto is for waveforms", err)

    def test_any_number_of_threads_writes_the_same_table_of_a_large_network(self):
        case = SOURCE / "tests/golden/powerflow/case118.m"
        tables = []
        for threads in "1", "2", "5":
            table = self.folder / f"{threads}.csv"
            code, _, err = simulate(case, "--until", "0.01", "--threads", threads, "--signals", "bus.*.v.a", "--csv", table)
            self.assertEqual(code, 0, err)
            tables.append(table.read_bytes())
        self.assertGreater(len(tables[0]), 100000)
        self.assertEqual(tables, [tables[0]] * 3)

    def test_threads_that_cannot_be_are_refused(self):
        for arguments, words in ((["--threads", "0"], "not a number of threads"), (["--threads", "65"], "not a number of threads"),
                                 (["--threads", "2", "--solver", "phasor"], "--threads is for waveforms")):
            code, _, err = simulate(SET_A, "--until", "1ms", *arguments)
            self.assertEqual(code, 2, arguments)
            self.assertIn(words, err)

    def test_a_folder_that_is_not_there_is_an_environment_error(self):
        code, _, err = simulate(SET_A, "--until", "0.01s", "--csv", self.folder / "no/such/file.csv")
        self.assertEqual(code, 3)
        self.assertIn("file.csv", err)

    def test_divergence_ends_the_run_with_the_element_and_the_time(self):
        # A negative resistance behind an inductance: exp(t R/L).
        network = self.write("n.yaml", "gridspace_network: 1\nname: n\nbase: {frequency_hz: 50, power_kva: 1000}\n"
                             "buses: {A: {voltage_v: 20000}}\nsources: {S: {bus: A, r_ohm: 0.1, l_mh: 5}}\n"
                             "loads: {D: {bus: A, p_kw: -2000, model: constant_impedance}}\n")
        code, _, err = simulate(network, "--until", "0.2s", "--quiet", "--csv", self.folder / "x.csv")
        self.assertEqual(code, 2, err)
        self.assertRegex(err, r"diverge at 0\.0\d+ s: the voltage of .*A.* phase [abc] is")
        _, rows = read_csv(self.folder / "x.csv")
        self.assertTrue(all(x == x for row in rows for x in row), "a NaN was written")

    def test_timing_prints_percentiles_and_the_real_time_factor(self):
        code, _, err = simulate(SET_A, "--until", "0.1s", "--timing", "--quiet")
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"p50 [\d.]+ +p99 [\d.]+ +p99\.9 [\d.]+ +max [\d.]+")
        self.assertRegex(err, r"4800 steps, 0\.1 s simulated in .* times real time")

    def test_fixed_steps_of_phasors_agree_with_adaptive_ones(self):
        events = self.write("events.yaml", "events:\n  f: {at_s: 0.1, apply_fault: {line: TL2, position_percent: 50, type: 1ph_g, "
                            "resistance_ohm: 0.1}, clear_after_ms: 60}\n")
        got = []
        for more in ([], ["--fixed-step"]):
            table = self.folder / f"p{len(got)}.csv"
            code, _, err = simulate(SOURCE / "configs/networks/adn_set_b.yaml", "--solver", "phasor", "--step", "1/1000", "--events", events,
                                    "--until", "0.5s", "--quiet", "--signals", "machine.G1.frequency_hz", "--csv", table, *more)
            self.assertEqual(code, 0, err)
            got.append([row[1] for row in read_csv(table)[1]])
        self.assertLess(max(abs(a - b) for a, b in zip(*got)), 1e-4)
        self.assertGreater(max(got[0]) - min(got[0]), 0.01)  # the fault was felt


if __name__ == "__main__":
    unittest.main()
