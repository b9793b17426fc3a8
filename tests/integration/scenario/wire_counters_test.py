# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What the devices of case 2 say about their streams: on the topic stream_statistics, and in a recording of real time."""
import csv
import json
import os
import signal
import time
import unittest

from harness import HANG_S, INTERRUPTED, SOURCE, ScenarioTest, gridspace, short_case_2

PROTECTION = SOURCE / "configs/scenarios/protection_lockstep.yaml"


class WireCounters(ScenarioTest):
    def statistics(self, run, wanted):
        """{(process, stream): newest sample} of the topic, as the command line shows it, when there is one of each that is `wanted`
        of a second or later: the monitor may be behind."""
        deadline = time.monotonic() + HANG_S
        while True:
            code, out, said = gridspace("topic", "echo", "stream_statistics", "--run", run.folder, "--json")
            self.assertEqual(code, 0, said + run.stderr())
            samples = [entry["fields"] for entry in json.loads(out)["last"]]
            found = {(s["process"], s["stream"]): s for s in samples}
            if wanted <= {key for key, s in found.items() if int(s["time_ns"]) >= 1e9}:
                return found
            self.assertLess(time.monotonic(), deadline, found)

    def test_every_device_counts_its_streams_on_a_topic(self):
        run = self.start("run", ["--speed", "0.5", "--set", "expect=~", "--set", "events=~", "--set", "record.comtrade=~"], scenario=PROTECTION)
        run.wait_for_time(2.2)
        wanted = {("mu21", "SMV21"), ("mu22", "SMV22"), ("relay2", "SMV21"), ("relay2", "SMV22"), ("relay2", "TRIP2"), ("breaker2", "TRIP2")}
        found = self.statistics(run, wanted)
        self.assertEqual(set(found), wanted)
        for (process, stream), row in found.items():
            frames = int(row["frames"])
            self.assertEqual(row["state"], "STREAM_ALIVE", (process, row))
            self.assertEqual(row["direction"], "STREAM_SENT" if (process, stream) in (("mu21", "SMV21"), ("mu22", "SMV22"), ("relay2", "TRIP2"))
                             else "STREAM_RECEIVED")
            # Once per simulated second: so many as there are then, of 4800 a second, or of a message every 10 ms.
            seconds = int(row["time_ns"]) / 1e9
            self.assertGreaterEqual(seconds, 1, (process, row))
            self.assertAlmostEqual(frames, (4800 if stream != "TRIP2" else 100) * seconds, delta=12, msg=(process, row))
            for counter in ("lost", "duplicate", "late", "restarts", "refused", "silences", "underruns", "dropped"):
                self.assertEqual(int(row[counter]), 0, (process, counter, row))
            if row["direction"] == "STREAM_RECEIVED":
                rate = 4800 if stream != "TRIP2" else 100
                self.assertAlmostEqual(float(row["rate_hz"]), rate, delta=0.05 * rate, msg=(process, row))
        os.kill(run.pid, signal.SIGINT)
        self.assertEqual(run.finish(), INTERRUPTED, run.stderr())

    def test_the_last_counters_of_a_real_time_run_are_in_its_recording(self):
        """The relay says them when it hears of the end, and so does the recorder: neither waits for the other."""
        run = self.start("run", scenario=self.write("short.yaml", short_case_2("protection", 1.4, events="~")))
        run.finish()  # on a busy machine samples may be late; that is not what is looked at
        self.assert_recording_readable(run)
        tables = [t for t in (run.folder / "csv").glob("*.csv") if "stream.SMV21.received" in t.read_text().split("\n", 1)[0]]
        self.assertEqual(len(tables), 1)
        with tables[0].open() as table:
            rows = list(csv.DictReader(table))
        self.assertGreater(float(rows[-1]["time_s"]), 1.35, rows[-1])
        received = next(value for name, value in rows[-1].items() if name.startswith("stream.SMV21.received"))
        self.assertGreater(float(received), 1.2 * 4800 / 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
