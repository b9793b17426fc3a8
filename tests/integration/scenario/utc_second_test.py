# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`clock.start_at: utc_second`: smpCnt 0 of a real-time run falls on a second of the machine's clock, as other people's does."""
import csv
import unittest

import harness


class UtcSecond(harness.ScenarioTest):
    def start_ns(self, *changes):
        scenario = self.write("short.yaml", harness.short_case_2("protection", 0.2, "{}"))
        out = self.folder / f"run{len(changes)}"
        code, _, err = harness.gridspace("run", scenario, "--out", out, "--quiet", *changes)
        self.assertEqual(code, harness.OK, err)
        code, _, err = harness.gridspace("export", out, "--csv")
        self.assertEqual(code, harness.OK, err)
        with open(out / "csv/simulation_clock.csv", encoding="utf-8") as table:
            started = {int(row["start_unix_ns"]) for row in csv.DictReader(table)}
        self.assertEqual(len(started), 1)
        return started.pop()

    def test_a_real_time_run_begins_on_a_whole_second_when_it_is_asked_to(self):
        self.assertEqual(self.start_ns() % 1_000_000_000, 0)

    def test_and_at_once_when_it_is_not(self):
        self.assertNotEqual(self.start_ns("--set", "clock.start_at=~") % 1_000_000_000, 0)  # by chance once in a thousand million


if __name__ == "__main__":
    unittest.main()
