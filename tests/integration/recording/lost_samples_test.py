#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""In real time nothing waits for the recorder. What is not in the recording is said, and the numbers are right."""
import json
import os
import pathlib
import re
import shutil
import signal
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mcap_file  # noqa: E402
from harness import OK, SOURCE, ScenarioTest  # noqa: E402

CASE_2 = SOURCE / "configs/scenarios/protection.yaml"
MESSAGES_HZ = 1200
SETTINGS = ["--set", "expect=~", "--set", "processes.monitor=~",
            "--set", "record={samples: all, frames: none}", "--set", "processes.recorder.compress=false"]
MISSING = re.compile(r"(\d+) of (\d+) samples of '(\w+)' from sim")


class LostSamples(ScenarioTest):
    def check_accounts(self, run, until_s):
        """Every waveform sample is in the recording or said to be missing. The number that is missing."""
        self.assertEqual(run.finish(), OK, run.stderr())
        events = [json.loads(line) for line in (run.folder / "events.ndjson").read_text().splitlines()]
        said = {topic: (int(missing), int(sent)) for event in events if event["event"] == "samples_dropped"
                for missing, sent, topic in MISSING.findall(event["text"])}
        recorded = mcap_file.by_topic(run.folder / "data.mcap")
        sent = until_s * MESSAGES_HZ + 1
        waveforms = [f"TL_{line}{end}" for line in (1, 2, 3) for end in (1, 2)]
        for topic in waveforms:
            missing = said.get(topic, (0, sent))
            self.assertEqual(missing[1], sent, topic)
            self.assertEqual(len(recorded.get((topic, "sim"), [])) + missing[0], sent, topic)
        return sum(said[topic][0] for topic in waveforms if topic in said)

    def test_every_sample_is_in_the_recording_or_said_to_be_missing(self):
        self.check_accounts(self.start("all", [*SETTINGS, "--until", "3s"], CASE_2), 3)

    def test_a_recorder_that_was_not_scheduled_says_what_it_missed(self):
        qos = self.folder / "qos"
        shutil.copytree(SOURCE / "qos", qos)
        file = qos / "simulator.xml"
        text = file.read_text()
        self.assertIn(">4096<", text)
        file.write_text(text.replace(">4096<", ">2<"))  # nothing is kept for who is late
        until_s = 8  # so that it is still under way when this test is not scheduled for some seconds either
        run = self.start("paused", [*SETTINGS, "--until", f"{until_s}s"], CASE_2, prefix=("env", f"GRIDSPACE_QOS_DIR={qos}"))
        run.wait_for_time(0.5)
        recorder = run.pid_of("recorder")
        os.kill(recorder, signal.SIGSTOP)
        run.wait_for_time(run.latest_time(0.5) + 1.5)
        os.kill(recorder, signal.SIGCONT)
        self.assertGreater(self.check_accounts(run, until_s), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
