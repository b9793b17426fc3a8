# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Kills, restarts and pauses of the timeline happen between two ticks: the run goes on, and is the same every time."""
import csv
import json
import unittest

from harness import CASE_1, USAGE, ScenarioTest

HOUR = ["--until", "1h", "--set", "expect=~"]


class ProcessEvents(ScenarioTest):
    def scenario(self, events):
        return self.write("scenario.yaml", f"extends: {CASE_1}\nprocesses: {{monitor: ~}}\nevents:\n{events}")

    def run_twice(self, events):
        scenario = self.scenario(events)
        first = self.run_to_end("first", HOUR, scenario)
        second = self.run_to_end("second", [*HOUR, "--speed", "1800"], scenario)
        self.assert_identical(first, second)
        return first

    def requests(self, run):
        """{ev: [time_s, ...]}"""
        self.assert_recording_readable(run)
        out = {}
        with (run.folder / "csv/requests.csv").open() as table:
            for row in csv.DictReader(table):
                out.setdefault(row["ev"], []).append(float(row[next(iter(row))]))
        return out

    def happened(self, run):
        lines = (run.folder / "events.ndjson").read_text().splitlines()
        return [(e["time_s"], e["text"]) for e in map(json.loads, lines) if e["source"] == "launcher"]

    def test_a_killed_agent_asks_no_more_and_the_others_go_on(self):
        run = self.run_twice("  loss: {at_s: 1000, kill: ev4}\n")
        self.assertEqual(self.happened(run), [(1000, "ev4 killed")])
        requests = self.requests(run)
        self.assertLess(max(requests["EV4"]), 1000)
        self.assertGreater(max(requests["EV1"]), 3000)
        waited = [e for e in (run.folder / "events.ndjson").read_text().splitlines() if "request_timeout" in e]
        self.assertGreaterEqual(len(waited), 5, "the MCCA decides without it, after its timeout")

    def test_a_restarted_agent_asks_again(self):
        run = self.run_twice("  again: {at_s: 1000, restart: ev4}\n")
        self.assertEqual(self.happened(run), [(1000, "ev4 restarted")])
        self.assertGreater(max(self.requests(run)["EV4"]), 3000)

    def test_a_killed_agent_can_be_restarted_later(self):
        run = self.run_twice("  loss: {at_s: 1000, kill: ev4}\n  back: {at_s: 2000, restart: ev4}\n")
        requests = self.requests(run)["EV4"]
        self.assertFalse([t for t in requests if 1000 < t < 2000])
        self.assertTrue([t for t in requests if t > 2000])

    def test_a_paused_agent_is_silent_until_it_is_resumed(self):
        """And who is still paused at the end does not hear of it, and does no harm."""
        run = self.run_twice("  sleep: {at_s: 1000, pause: ev2}\n  wake: {at_s: 2000, resume: ev2}\n  nap: {at_s: 3400, pause: ev3}\n")
        self.assertEqual(self.happened(run), [(1000, "ev2 paused"), (2000, "ev2 resumed"), (3400, "ev3 paused")])
        requests = self.requests(run)["EV2"]
        self.assertFalse([t for t in requests if 1000 < t < 2000])
        self.assertTrue([t for t in requests if t > 2000])

    def test_a_restarted_mcca_decides_again(self):
        run = self.run_twice("  again: {at_s: 1000, restart: mcca}\n")
        self.assert_recording_readable(run)
        with (run.folder / "csv/decisions.csv").open() as table:
            times = [float(row[next(iter(row))]) for row in csv.DictReader(table)]
        self.assertGreater(max(times), 3000)

    def test_the_simulator_and_the_recorder_cannot_be_killed_by_the_timeline(self):
        for process in ("sim", "recorder"):
            run = self.start(process, HOUR, self.scenario(f"  end: {{at_s: 1000, kill: {process}}}\n"))
            self.assertEqual(run.finish(), USAGE)
            self.assertRegex(run.stderr(), rf"scenario.yaml:4:\d+: error: event 'end' acts on '{process}'")

    def test_restarts_next_to_each_other_and_again_and_again(self):
        run = self.run_twice("  gone: {at_s: 300, kill: ev3}\n"
                             "  one: {at_s: 1000, restart: ev4}\n  two: {at_s: 1000, restart: mcca}\n  three: {at_s: 1000, restart: ev1}\n"
                             "  more: {at_s: 1003, restart: mcca}\n  again: {at_s: 1500, restart: mcca}\n  back: {at_s: 2000, restart: ev3}\n")
        requests = self.requests(run)
        for ev in ("EV1", "EV2", "EV3", "EV4"):
            self.assertGreater(max(requests[ev]), 3000, ev)
        with (run.folder / "csv/decisions.csv").open() as table:
            self.assertGreater(max(float(row[next(iter(row))]) for row in csv.DictReader(table)), 3000)


if __name__ == "__main__":
    unittest.main(verbosity=2)
