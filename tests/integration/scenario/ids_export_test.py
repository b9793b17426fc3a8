# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`gridspace ids export`: labels are counted here from the schedule of the attacks, features from the frames by the Python decoder, and frames by tshark."""
import csv
import hashlib
import json
import math
import shutil
import subprocess
import sys
import unittest

from harness import HANG_S, OK, SOURCE, USAGE, ScenarioTest, gridspace

sys.path.insert(0, str(SOURCE / "python"))
from gridspace import frames, pcapng  # noqa: E402

# A man in the middle adds a fault current to SMV21 from 0.2 s to 0.3 s; beside the relay somebody forges trips from 0.3 s to 0.35 s.
ATTACKED = f"""---
gridspace: 1
extends: {SOURCE}/configs/scenarios/attack_masquerade.yaml
name: attacked
simulation: {{duration_s: 0.4}}
hosts: {{evil2: {{links: [process_bus]}}}}
processes:
  monitor: ~
  breaker2: ~
  attacker2: {{program: gridspace-attacker, host: evil2, labels: attack_labels}}
attacks:
  masquerade: {{window: {{from_s: 0.2, until_s: 0.3}}}}
  trip:
    by: attacker2
    place: {{second_publisher: true}}
    target: {{stream: TRIP2, channels: [status]}}
    window: {{from_s: 0.3, until_s: 0.35}}
    message: {{kind: masquerade_trip, interval_ms: 2}}
record: {{comtrade: ~, samples: all, frames: all}}
expect: ~
"""
RATE, FROM, UNTIL = 4800, 0.2, 0.3
INSIDE = "process_bus.mu21.attacker"


def rows(file):
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


class Export(ScenarioTest):
    def export(self, *runs, to, code=OK):
        out = self.folder / to
        ended, text, said = gridspace("ids", "export", *runs, "--out", out, "--json")
        self.assertEqual(ended, code, said)
        return (out, json.loads(text)) if code == OK else (out, said)

    def test_labels_are_those_of_the_schedule_and_features_those_of_the_frames(self):
        runs = self.folder / "runs"
        runs.mkdir()
        attacked = self.start("attacked", scenario=self.write("attacked.yaml", ATTACKED), folder=runs / "attacked")
        self.assertEqual(attacked.finish(), OK, attacked.stderr())
        healthy = ATTACKED.replace("name: attacked", "name: healthy").replace("duration_s: 0.4", "duration_s: 0.1")
        healthy = healthy[:healthy.index("attacks:")] + "attacks: ~\nrecord: {comtrade: ~, samples: all, frames: all}\nexpect: ~\n"
        calm = self.start("healthy", scenario=self.write("healthy.yaml", healthy), folder=runs / "healthy")
        self.assertEqual(calm.finish(), OK, calm.stderr())

        out, found = self.export(runs, to="data")
        self.assertEqual([(r["run"], r["attack_kinds"]) for r in found["runs"]], [("attacked", ["masquerade", "masquerade_trip"]), ("healthy", [])])
        self.assert_manifest(out)
        self.assert_samples(out / "runs/attacked")
        self.assert_messages(out / "runs/attacked")
        # Negative controls: in front of the man in the middle, and where nobody attacks, nothing is altered.
        for calm in (out / "runs/attacked" / INSIDE, out / "runs/healthy/process_bus"):
            table = rows(calm.with_name(calm.name + ".frames.csv"))
            self.assertGreater(len(table), 400)
            self.assertEqual({(r["altered"], r["attack"]) for r in table}, {("0", "")})
        if shutil.which("tshark"):
            self.assert_as_tshark_sees_it(out / "runs/attacked")
        self.assert_foreign_detectors_read_it(runs / "attacked", out)
        again, _ = self.export(runs / "healthy", runs / "attacked", to="again")
        for file in sorted(p.relative_to(out) for p in out.rglob("*") if p.is_file()):
            if file.name not in ("README.md", "manifest.json"):  # which name what was asked for
                self.assertEqual((out / file).read_bytes(), (again / file).read_bytes(), file)
        third, _ = self.export(runs, to="third")
        self.assertEqual((out / "manifest.json").read_bytes(), (third / "manifest.json").read_bytes(), "the same inputs, the same octets")
        self.assert_refusals(runs, out)

    def assert_manifest(self, out):
        listed = {f["path"]: f for f in json.loads((out / "manifest.json").read_text())["files"]}
        there = {str(p.relative_to(out)): p.read_bytes() for p in out.rglob("*") if p.is_file() and p.name != "manifest.json"}
        self.assertEqual(set(listed), set(there))
        for name, octets in there.items():
            self.assertEqual((listed[name]["octets"], listed[name]["sha256"]), (len(octets), hashlib.sha256(octets).hexdigest()), name)
        card = (out / "README.md").read_text()
        for table in out.rglob("*.csv"):
            for column in table.read_text().partition("\n")[0].split(","):
                if table.parent.name == "attacked":
                    self.assertIn(column, card, f"a column of {table.name} that the data card does not explain")

    def assert_samples(self, run):
        table = rows(run / "process_bus.samples.csv")
        # The added current is zero at its first instant, so that sample is as it was.
        altered = {(r["stream"], int(r["sample"])) for r in table if r["altered"] == "1"}
        self.assertEqual(altered, {("SMV21", n) for n in range(round(FROM * RATE) + 1, round(UNTIL * RATE))})
        self.assertEqual({r["attack"] for r in table if r["altered"] == "1"}, {"masquerade"})
        # What the frames say, read by the other decoder.
        seen = [(s.stream, s.count, s.floats()[:3]) for c in pcapng.read(run / "process_bus.pcapng")
                for s in frames.sampled_values(frames.parse(c.octets))]
        self.assertEqual(len(seen), len(table))
        history = {}
        turn = 2 * math.cos(2 * math.pi * 60 / RATE)
        for (sv_id, count, currents), row in zip(seen, table):
            self.assertEqual((sv_id[-2:], count), (row["stream"][-2:], int(row["smp_cnt"])))
            before = history.setdefault(row["stream"], [])
            for phase, current in zip("abc", currents):
                self.assertAlmostEqual(float(row[f"i{phase}_a"]), current, delta=1e-6 * max(1, abs(current)))
            if len(before) >= 2:
                for phase, current in enumerate(currents):
                    kink = current - turn * before[-1][phase] + before[-2][phase]
                    self.assertAlmostEqual(float(row[f"kink_{'abc'[phase]}_a"]), kink, delta=1e-5)
            peak = max((abs(i) for old in before[-80:] for i in old), default=0)
            self.assertAlmostEqual(float(row["peak_a"]), peak, delta=1e-6 * max(1, peak))
            before.append(currents)
        # The truth in front of him, and what he said it was.
        truth = {(r["stream"], int(r["sample"])): r for r in rows(run / f"{INSIDE}.samples.csv")}
        labels = [r for r in rows(run / "labels.csv") if r["target"] == "SMV21"]
        self.assertEqual(len(labels), 3 * len(altered))
        for label in labels:
            row = truth["SMV21", int(label["index"])]
            self.assertAlmostEqual(float(label["true_value"]), float(row[f"i{label['phase']}_a"]), delta=1e-5)

    def assert_messages(self, run):
        table = rows(run / "process_bus.messages.csv")
        forged = [r for r in table if r["altered"] == "1"]
        self.assertEqual(len(forged), 25, "one in 2 ms from 0.3 s to 0.35 s")
        self.assertEqual({(r["port"], r["attack"]) for r in forged}, {("process_bus/evil2", "trip")})
        self.assertEqual({r["port"] for r in table if r["altered"] == "0"}, {"process_bus/ied2"})
        self.assertEqual(forged[0]["st_step"], "1")
        self.assertGreaterEqual(float(forged[0]["time_s"]), 0.3)
        attacks = {r["attack"]: r for r in rows(run.parents[1] / "attacks.csv") if r["run"] == "attacked"}
        self.assertEqual((attacks["trip"]["labels"], attacks["trip"]["altered_frames"]), ("25", "25"))

    def assert_as_tshark_sees_it(self, run):
        def count(file, what):
            return len(subprocess.run(["tshark", "-r", file, "-Y", what], capture_output=True, text=True, check=True, timeout=HANG_S).stdout.splitlines())

        for vantage in ("process_bus", INSIDE):
            table = rows(run / f"{vantage}.frames.csv")
            file = run / f"{vantage}.pcapng"
            self.assertEqual(count(file, "frame"), len(table))
            for protocol, what in (("smv", "sv"), ("goose", "goose")):
                self.assertEqual(count(file, what), sum(r["protocol"] == protocol for r in table))
            self.assertEqual(count(file, 'frame.comment contains "attack "'), sum(r["altered"] == "1" for r in table))

    def assert_foreign_detectors_read_it(self, run, data):
        def verdicts(python, *arguments):
            done = subprocess.run([python, *map(str, arguments)], capture_output=True, text=True, timeout=HANG_S)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done

        def scored(text=None):
            file = self.folder / "verdicts.csv"
            if text is not None:
                file.write_text(text)
            code, found, said = gridspace("ids", "score", run, *([] if text is None else [file]), "--json")
            self.assertEqual(code, OK, said)
            return json.loads(found)

        def first_alarms(found):
            return {a["attack"]: a["by"] if a["alarmed"] else None for a in found["alarms"]["attacks"]}

        rules = SOURCE / "examples/detectors/rule_checker.py"
        said = verdicts(sys.executable, rules, data, "attacked", "--messages").stderr
        self.assertRegex(said, r"forged 25 found, 0 missed; genuine 0 flagged, \d+ not")
        # The man in the middle keeps all headers as they are: no rule sees him.
        by_rules = scored(verdicts(sys.executable, rules, data, "attacked").stdout)
        self.assertEqual((by_rules["true_positives"], by_rules["false_positives"]), (0, 0))
        self.assertEqual(first_alarms(by_rules), {"masquerade": None}, "verdicts on samples do not judge a forged message")
        # Alarms judge both: of the checker, and of those that were in the loop (without breaker2 nobody checks its messages).
        listed = scored(verdicts(sys.executable, rules, data, "attacked", "--alarms").stdout)["alarms"]
        self.assertEqual([(a["attack"], a["alarmed"]) for a in listed["attacks"]], [("masquerade", False), ("trip", True)])
        self.assertEqual((listed["count"], listed["false"]), (1, 0))
        in_the_loop = scored()
        self.assertEqual(first_alarms(in_the_loop)["masquerade"], "ids.relay2")
        python = next((p for p in (sys.executable, "/usr/bin/python3")
                       if subprocess.run([p, "-c", "import sklearn"], capture_output=True).returncode == 0), None)
        if python:
            forest = SOURCE / "examples/detectors/isolation_forest.py"
            by_forest = scored(verdicts(python, forest, data, "attacked", "--train", "other-kinds", "--trees", "20").stdout)
            self.assertGreater(by_forest["judged"], 3000)
            self.assertTrue(by_forest["attacks"][0]["seen"])

    def assert_refusals(self, runs, there):
        self.assertIn("is there already", self.export(runs, to="data", code=USAGE)[1])
        self.assertIn("there is no folder", self.export(self.folder / "nothing", to="x", code=USAGE)[1])
        empty = self.folder / "empty"
        empty.mkdir()
        self.assertIn("there is no run in", self.export(empty, to="x", code=USAGE)[1])
        self.assertIn("two runs have the name", self.export(runs, runs / "healthy", to="x", code=USAGE)[1])
        for file, what in (("data.mcap", "is damaged"), ("bus.pcapng.gz", "is damaged")):
            damaged = self.folder / f"damaged_{file}"
            shutil.copytree(runs / "attacked", damaged)
            octets = (damaged / file).read_bytes()
            (damaged / file).write_bytes(octets[:len(octets) // 2])
            self.assertIn(what, self.export(damaged, to=f"of_damaged_{file}", code=USAGE)[1])
            self.assertFalse((self.folder / f"of_damaged_{file}/manifest.json").exists(), "looks like a whole data set")
        (damaged / "bus.pcapng.gz").unlink()
        self.assertIn("it has no capture bus.pcapng.gz", self.export(damaged, to="x", code=USAGE)[1])
        manifest = json.loads((damaged / "manifest.json").read_text())
        (damaged / "manifest.json").write_text(json.dumps({**manifest, "exit": 4}))
        self.assertIn("it ended early, with code 4", self.export(damaged, to="x", code=USAGE)[1])
        study = self.folder / "study"
        (study / "runs/0123").mkdir(parents=True)
        for file in ("study.lock", "runs/0123/record.json"):
            (study / file).touch()
        self.assertIn("has not kept its run 0123", self.export(study, to="x", code=USAGE)[1])
        shutil.copytree(runs / "healthy", study / "runs/0123/run")
        self.assertEqual([r["run"] for r in self.export(study, to="of_study")[1]["runs"]], ["0123"])
        unlabelled = self.start("unlabelled", scenario=self.write("unlabelled.yaml", ATTACKED.replace("host: evil2, labels: attack_labels", "host: evil2")))
        self.assertEqual(unlabelled.finish(), OK, unlabelled.stderr())
        out, said = self.export(unlabelled.folder, to="of_unlabelled", code=USAGE)
        self.assertIn("the attack 'trip' has no labels", said)
        self.assertFalse(out.exists(), "nothing is written before all runs were read")


if __name__ == "__main__":
    unittest.main()
