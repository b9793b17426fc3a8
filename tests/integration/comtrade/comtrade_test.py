# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Disturbance records of a run, read back by a reader of their own and compared with the recording."""
import csv
import pathlib
import sys
import unittest

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parent), str(pathlib.Path(__file__).resolve().parents[1] / "scenario")]
from comtrade_reader import Comtrade  # noqa: E402
from harness import OK, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

LOCKSTEP = SOURCE / "configs/scenarios/protection_lockstep.yaml"
EPOCH_NS = 1575158400 * 10**9  # 2019-12-01T00:00:00Z
FAULT_S = 0.3
SHORT = ["--set", "processes.monitor=~", "--set", "expect=~", "--set", f"events.fault.at_s={FAULT_S}"]


def first(values, wanted):
    return next(i for i, v in enumerate(values) if v == wanted)


class DisturbanceRecords(ScenarioTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()

    def test_a_trip_leaves_a_record_in_ascii_and_one_in_binary_that_say_what_the_recording_says(self):
        ratio = ["--set", "simulation.network_changes.ct_types.ideal.ratio='400:5'"]
        run = self.run_to_end("run", [*SHORT, *ratio, "--until", "0.5s", "--set", "record.comtrade.after_ms=150"], scenario=LOCKSTEP)
        self.assertEqual(run.summary()["comtrade"], ["relay2_trip_1_ascii.cfg", "relay2_trip_1_binary.cfg"])
        ascii_record, binary = (Comtrade(run.folder / "comtrade" / name) for name in run.summary()["comtrade"])
        self.assertEqual((ascii_record.format, binary.format), ("ASCII", "BINARY"))
        for sut in (ascii_record, binary):
            self.assertEqual((sut.station, sut.device, sut.frequency, sut.rate), ("protection_lockstep", "relay2", 60, 4800))
            self.assertEqual((sut.time_code, sut.local_code, sut.time_quality), ("0", "0", "0"))
            names = [c["name"] for c in sut.analog]
            self.assertEqual(names[:6], [f"{ct} I{p}" for ct in ("CT21", "CT22") for p in "abc"])
            self.assertEqual(set(names[6:]), {f"{bus} V{p}" for bus in ("GRID", "B1", "B2", "B3", "B4") for p in "abc"})
            self.assertEqual([c["name"] for c in sut.digital], ["relay2 pickup", "relay2 trip"] + [f"{cb} 52a {p}" for cb in ("CB3", "CB4") for p in "ABC"])
            self.assertEqual([(c["ps"], c["ratio"]) for c in sut.analog], [("P", 80)] * 6 + [("P", 1)] * (len(names) - 6))
            self.assertEqual({c["unit"] for c in sut.analog[:6]}, {"A"})

            # The window: 200 ms before to 150 ms after the trip, whole samples, on the grid of the simulation.
            trigger_s = (sut.trigger_ns - EPOCH_NS) / 1e9
            self.assertAlmostEqual(trigger_s, FAULT_S + 0.00158, delta=0.0003)
            self.assertTrue(0 <= sut.start_ns - (sut.trigger_ns - 200_000_000) < 1e9 / 4800)
            self.assertTrue(0 <= sut.trigger_ns + 150_000_000 - sut.instant_ns(sut.rows - 1) < 1e9 / 4800 + 1000)
            self.assertEqual(sut.stamps_us[:4], [0, 208, 417, 625])

            # What happened, in its order: fault, pickup and trip, poles at their current zeros.
            trip = first(sut["relay2 trip"], 1)
            self.assertTrue(0 <= sut.instant_ns(trip) - sut.trigger_ns < 1e9 / 4800)
            self.assertLessEqual(first(sut["relay2 pickup"], 1), trip)
            for cb in ("CB3", "CB4"):
                for p in "ABC":
                    contact = sut[f"{cb} 52a {p}"]
                    opened = first(contact, 0)
                    self.assertGreater(opened, trip)
                    self.assertEqual(set(contact[opened:]), {0})
                    current = sut[f"CT2{1 if cb == 'CB3' else 2} I{p.lower()}"]
                    self.assertLess(max(map(abs, current[opened + 2:])), 0.05)
                    self.assertGreater(max(map(abs, current[:opened])), 40)

        # Both formats say the same, as exactly as they can.
        for one, other in zip(ascii_record.analog, binary.analog):
            peak = max(map(abs, one["values"]))
            for a, b in zip(one["values"], other["values"]):
                self.assertAlmostEqual(a, b, delta=peak / 30000)
        self.assertEqual([c["values"] for c in ascii_record.digital], [c["values"] for c in binary.digital])

        # And what the recording says: the simulator's own values, by the export of the samples that went over the bus.
        code, _, said = gridspace("export", run.folder, "--csv")
        self.assertEqual(code, OK, said)
        with (run.folder / "csv/TL_21.csv").open() as table:
            rows = list(csv.DictReader(table))
        sent = {}
        for row in rows:
            for k in range(4):
                if row.get(f"samples_{k}_ia"):
                    sent[int(row["first_index"]) + k] = float(row[f"samples_{k}_ia"])
        begin = round((ascii_record.start_ns - EPOCH_NS) / 1e9 * 4800)
        peak = max(map(abs, ascii_record["CT21 Ia"]))
        for n, value in enumerate(ascii_record["CT21 Ia"]):
            self.assertAlmostEqual(value, sent[begin + n], delta=peak / 99998)

        # The same again from the finished run, and around something else.
        code, out, said = gridspace("export", run.folder, "--comtrade", "--out", run.folder / "again")
        self.assertEqual((code, len(out.splitlines())), (OK, 2), said)
        self.assertEqual((run.folder / "again/relay2_trip_1_binary.dat").read_bytes(), (run.folder / "comtrade/relay2_trip_1_binary.dat").read_bytes())
        code, out, said = gridspace("export", run.folder, "--comtrade", "--cff", "--out", run.folder / "single")
        self.assertEqual((code, sorted(p.name for p in (run.folder / "single").iterdir())), (OK, ["relay2_trip_1_ascii.cff", "relay2_trip_1_binary.cff"]), said)
        for pair, single in zip((ascii_record, binary), map(Comtrade, out.splitlines())):
            self.assertEqual(vars(single), vars(pair))
        code, _, said = gridspace("export", run.folder, "--latency")
        self.assertEqual(code, USAGE)
        self.assertIn("no frame of this run has a time under way", said)
        code, out, said = gridspace("export", run.folder, "--comtrade", "--trigger", "fault", "--before-ms", "10", "--after-ms", "20", "--signals", "machine.G1.frequency_hz")
        self.assertEqual(code, OK, said)
        around = Comtrade(out.splitlines()[0])
        self.assertEqual((around.trigger_ns - EPOCH_NS, around.rows), (round(FAULT_S * 1e9), round(0.030 * 4800) + 1))
        self.assertAlmostEqual(around["machine.G1.frequency_hz"][0], 60, delta=0.001)
        code, _, said = gridspace("export", run.folder, "--comtrade", "--trigger", "relay2.reset")
        self.assertEqual(code, USAGE)
        self.assertIn("did not happen", said)

    def test_without_a_trip_there_is_no_record_and_the_report_says_so(self):
        run = self.run_to_end("run", [*SHORT, "--until", "0.2s", "--set", "events.fault=~"], scenario=LOCKSTEP)
        self.assertEqual(run.summary()["comtrade"], [])
        self.assertFalse((run.folder / "comtrade").exists())
        self.assertIn("'relay2.trip' did not happen: nothing to write", run.summary()["notes"])

    def test_a_trigger_that_does_not_exist_is_refused(self):
        code, _, said = gridspace("validate", LOCKSTEP, "--set", "record.comtrade.trigger=relay3.trip")
        self.assertEqual(code, USAGE)
        self.assertIn("record.comtrade waits for 'relay3.trip', and there is no such signal or event", said)
        self.assertIn("did you mean 'relay2.trip'?", said)
        code, _, said = gridspace("validate", LOCKSTEP)
        self.assertEqual((code, "warning" in said), (OK, False), said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
