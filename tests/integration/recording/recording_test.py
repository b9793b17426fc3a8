# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A real recording, judged by other people's readers: @mcap/core and Foxglove's IDL reader (tests/js), and by our own export."""
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BASE, BIN, OK, SOURCE, ScenarioTest, gridspace  # noqa: E402

JS = SOURCE / "tests/js"
MODULES = BIN.parent / "js"  # in the build tree; filled once
EPOCH_NS = 1575190800 * 10**9  # 2019-12-01T09:00:00Z, of case 1


def prepare_modules():
    """The packages of package-lock.json beside the judge, in the build tree."""
    MODULES.mkdir(parents=True, exist_ok=True)
    subprocess.run([SOURCE / "scripts/npm_packages.sh", JS, MODULES], check=True, capture_output=True, timeout=240)


class Recording(ScenarioTest):
    @classmethod
    def setUpClass(cls):
        prepare_modules()
        for name in ("judge_recording.mjs", "package.json"):
            shutil.copy(JS / name, MODULES)

    def judge(self, file):
        """(exit code, what it found, what it says)"""
        done = subprocess.run(["node", MODULES / "judge_recording.mjs", file], capture_output=True, text=True, timeout=120)
        return done.returncode, json.loads(done.stdout) if done.stdout else None, done.stderr

    def test_every_message_decodes_with_foreign_readers_and_equals_our_export(self):
        run = self.run_to_end("run", [*BASE, "--until", "1h", "--set", "expect=~"])
        code, found, said = self.judge(run.folder / "data.mcap")
        self.assertEqual(code, 0, said)
        topics = found["topics"]
        self.assertEqual(set(found["processes"]), {"sim", "ev1", "ev2", "ev3", "ev4", "mcca"} | set(found["processes"]) & {"recorder"})
        self.assertEqual(topics["bus_measurements"]["messages"], 4 * 3601)
        self.assertEqual(topics["requests"]["type"], "ChargingRequest")
        self.assertGreaterEqual(topics["requests"]["messages"], 40)
        self.assertEqual({t["name"]: t["samples"] for t in run.summary()["topics"]}, {n: t["messages"] for n, t in topics.items()})
        low, high = topics["bus_measurements"]["low"], topics["bus_measurements"]["high"]
        self.assertGreater(low["v_pu"], 0.95)
        self.assertAlmostEqual(high["v_pu"], 1.005, places=9)

        # Our own reader and CSV writer see the same numbers, to the last bit.
        self.assert_recording_readable(run)
        with (run.folder / "csv/bus_measurements.csv").open() as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(len(rows), topics["bus_measurements"]["messages"])
        voltage = next(name for name in rows[0] if name.startswith("v_pu"))
        values = [float(row[voltage]) for row in rows]
        self.assertEqual((min(values), max(values)), (low["v_pu"], high["v_pu"]))
        last = topics["bus_measurements"]["last"]
        self.assertEqual(float(rows[-1][voltage]), last["v_pu"])
        self.assertEqual(rows[-1]["bus"], last["bus"])

    def test_the_recorder_is_asked_for_a_tick_now_and_then_although_it_captures_every_frame(self):
        scenario = SOURCE / "configs/scenarios/protection_lockstep.yaml"
        run = self.run_to_end("frames", ["--until", "0.2s", "--set", "expect=~", "--set", "processes.monitor=~"], scenario=scenario)
        self.assert_recording_readable(run)
        with (run.folder / "csv/simulation_clock.csv").open() as table:
            awaited = [int(row["awaited_0"]) for row in csv.DictReader(table)]
        members = ["breaker2", "mu21", "mu22", "recorder", "relay2"]  # bits are in the order of names
        asked = {name: sum(bits >> i & 1 for bits in awaited) for i, name in enumerate(members)}
        self.assertEqual(asked["mu21"], len(awaited))
        self.assertLessEqual(asked["recorder"], len(awaited) // 16 + 2)

    def test_the_judge_finds_damage(self):
        """The negative control: what is cut or changed does not pass."""
        run = self.run_to_end("run", [*BASE, "--until", "1h", "--set", "expect=~"])
        whole = (run.folder / "data.mcap").read_bytes()
        for name, damaged in {"cut": whole[: len(whole) // 2], "changed": whole[: len(whole) // 2] + b"\xff" * 64 + whole[len(whole) // 2 + 64:]}.items():
            file = self.folder / f"{name}.mcap"
            file.write_bytes(damaged)
            self.assertNotEqual(self.judge(file)[0], 0, name)
        # Ours reads the beginning of the cut one and says that it is one.
        cut = self.folder / "cut_run"
        cut.mkdir()
        shutil.copy(run.folder / "manifest.json", cut)
        (cut / "data.mcap").write_bytes(whole[: len(whole) * 2 // 3])
        code, out, err = gridspace("export", cut, "--csv")
        self.assertEqual(code, OK, err)
        self.assertTrue(out.splitlines())


if __name__ == "__main__":
    unittest.main(verbosity=2)
