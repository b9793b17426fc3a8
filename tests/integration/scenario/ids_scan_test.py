# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace ids scan` on the capture of a run with a man in the middle and a forged trip: the frames it names are those that tshark names."""
import bisect
import json
import pathlib
import subprocess
import sys
import unittest

from harness import EXPECTATION, HANG_S, OK, SOURCE, USAGE, ScenarioTest, gridspace

# Somebody adds a fault current to SMV21 in its cable, and somebody else forges trips beside the relay.
ATTACKED = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/attack_masquerade.yaml
name: attacked
simulation: {{duration_s: 0.6}}
hosts: {{evil2: {{links: [process_bus]}}}}
processes:
  monitor: ~
  breaker2: ~                                # nothing opens, so that the currents before the man in the middle stay calm
  attacker2: {{program: gridspace-attacker, host: evil2}}
attacks:
  masquerade: {{window: {{from_s: 0.3, until_s: 0.5}}}}
  trip:
    by: attacker2
    place: {{second_publisher: true}}
    target: {{stream: TRIP2, channels: [status]}}
    window: {{from_s: 0.4, until_s: 0.5}}
    message: {{kind: masquerade_trip, interval_ms: 2}}
record: {{comtrade: ~}}
expect: ~
"""
BEFORE = "process_bus/mu21:attacker"


def tshark(file, filter_, *fields):
    words = [word for field in fields for word in ("-e", field)]
    done = subprocess.run(["tshark", "-r", file, "-Y", filter_, "-T", "fields", *words], capture_output=True, text=True, check=True, timeout=HANG_S)
    return [line.split("\t") for line in done.stdout.splitlines()]


class Scan(ScenarioTest):
    def scan(self, *arguments):
        code, text, said = gridspace("ids", "scan", self.capture, "--streams", SOURCE / "configs/scenarios/protection.yaml", "--json", *arguments)
        self.assertIn(code, (OK, EXPECTATION), said)
        found = json.loads(text)
        self.assertEqual(code == EXPECTATION, found["alarms"])
        return found

    def test_it_names_the_frames_of_both_attacks_as_tshark_does_and_stays_calm_before_them(self):
        self.capture = self.run_to_end("run", scenario=self.write("attacked.yaml", ATTACKED)).folder / "bus.pcapng.gz"
        found = self.scan("--line", "SMV21,SMV22", "--nominal-peak-a", "18", "--out", self.folder / "scan")
        self.assertEqual(found["frames"], len(tshark(self.capture, "frame", "frame.number")))

        goose = next(s for s in found["streams"] if s["kind"] == "goose")
        sent = tshark(self.capture, "goose", "frame.number", "eth.src")
        self.assertEqual(goose["frames"], len(sent))
        foreign = [(int(number), source) for number, source in sent if source != goose["source"].lower()]
        self.assertEqual({k.lower(): v for k, v in goose["foreign_sources"].items()}, {foreign[0][1]: len(foreign)})
        wrong = next(a for a in goose["alarms"] if a["rule"] == "wrong_source")
        self.assertEqual((wrong["count"], wrong["first"]["frame"], wrong["last"]["frame"]), (len(foreign), foreign[0][0], foreign[-1][0]))

        line, = found["lines"]
        self.assertGreaterEqual(line["pickups"], 1)
        alarm = line["alarms"][0]
        self.assertLessEqual({"one_end", "unconfirmed"}, {a["rule"] for a in line["alarms"]})
        (time, name), = tshark(self.capture, f"frame.number == {alarm['first']['frame']}", "frame.time_relative", "sv.svID")
        self.assertAlmostEqual(float(time), alarm["first"]["time_s"], places=6)
        self.assertTrue(name.startswith("GS_TL2_MU2"), name)
        self.assertGreaterEqual(alarm["first"]["time_s"], 0.3)
        self.assertLess(alarm["first"]["time_s"], 0.305)

        # The same samples before the man in the middle: nothing.
        calm = self.scan("--only", BEFORE)
        stream, = calm["streams"]
        self.assertFalse(calm["alarms"])
        self.assertEqual(stream["place"], BEFORE)
        self.assertEqual(stream["frames"], 2880)
        self.assertGreater(stream["forecast"]["samples"], 2800)
        # Behind him, one stream alone: from the forged sample on.
        alone = self.scan("--only", "process_bus", "--stream", "SMV21", "--nominal-peak-a", "18")
        alarm, = alone["streams"][0]["alarms"]
        self.assertEqual(alarm["rule"], "off_forecast")
        self.assertLess(abs(alarm["first"]["time_s"] - 0.3), 0.002)
        self.assert_page(self.folder / "scan")
        self.assert_a_foreign_detector_is_judged(self.capture.parent)

        # Cut in the middle of a frame it says so, and judges what is there; a damaged one is refused.
        whole = self.capture.read_bytes()
        self.capture = pathlib.Path(self.folder / "cut.pcapng")
        self.capture.write_bytes(whole[: len(whole) // 4])
        self.assertTrue(self.scan("--stream", "SMV22")["truncated"])
        self.capture.write_bytes(whole[:1000] + b"\xff" * 64 + whole[1064:])
        code, _, said = gridspace("ids", "scan", self.capture)
        self.assertEqual(code, USAGE)
        self.assertIn("is damaged", said)

    def assert_a_foreign_detector_is_judged(self, run):
        """The example's own verdicts, scored here a second time by the definitions."""
        done = subprocess.run([sys.executable, SOURCE / "examples/detectors/kink_detector.py", run], capture_output=True, text=True, check=True, timeout=HANG_S)
        file = self.folder / "verdicts.csv"
        file.write_text(done.stdout)
        code, text, said = gridspace("ids", "score", run, file, "--json")
        self.assertEqual(code, OK, said)
        found = json.loads(text)
        forged = range(1441, 2400)  # 0.3 s to 0.5 s of SMV21, all phases; the added current begins at 0, so the first sample is as it was
        rows = [(name == "GS_TL2_MU21" and int(number) in forged, float(score), verdict == "1")
                for name, number, score, verdict in (line.split(",") for line in done.stdout.splitlines()[1:])]
        tp, fp = (sum(1 for altered, _, flagged in rows if flagged and altered == kind) for kind in (True, False))
        self.assertEqual((found["altered"], found["judged"], found["true_positives"], found["false_positives"]), (len(forged), len(rows), tp, fp))
        self.assertAlmostEqual(found["precision"]["value"], tp / (tp + fp), places=12)
        self.assertAlmostEqual(found["recall"]["value"], tp / len(forged), places=12)
        genuine = sorted(score for altered, score, _ in rows if not altered)
        wins = sum(bisect.bisect_left(genuine, s) + bisect.bisect_right(genuine, s) for altered, s, _ in rows if altered)
        self.assertAlmostEqual(found["auc"]["value"], wins / 2 / len(forged) / len(genuine), places=9)
        self.assertEqual([(a["attack"], a["seen"]) for a in found["attacks"]], [("masquerade", True)])
        self.assertLess(found["attacks"][0]["delay_ms"], 1)
        self.assertEqual(gridspace("ids", "score", run, file, "--json")[1], text, "the same seed, the same intervals")
        file.write_text(done.stdout.replace("GS_TL2_MU21,1500,", "GS_TL2_MU21,99999,"))
        code, _, said = gridspace("ids", "score", run, file)
        self.assertEqual(code, USAGE)
        self.assertRegex(said, r"verdicts.csv:\d+:13: error: '99999' is outside the run")

    def assert_page(self, folder):
        page = (folder / "index.html").read_text()
        self.assertIn("alarms were raised", page)
        self.assertIn("wrong_source", page)
        self.assertIn("one_end", [a["rule"] for a in json.loads((folder / "scan.json").read_text())["lines"][0]["alarms"]])


if __name__ == "__main__":
    unittest.main()
