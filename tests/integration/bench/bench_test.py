#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""`./gridspace bench`: figures beside their baselines, kept by commit, compared with another commit. No figure is judged."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BIN, SOURCE  # noqa: E402


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def bench(self, *words):
        return subprocess.run([sys.executable, str(SOURCE / "bench/bench.py"), "--rounds", "1", "--build", str(BIN.parent), "--out", str(self.folder / "out"), *words],
                              capture_output=True, text=True, timeout=200, env={**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")})

    def test_each_figure_has_its_median_spread_and_baseline_and_can_be_compared(self):
        done = self.bench("codec", "wire")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "out/bench.json").read_text())
        rows = {row["key"]: row for row in result["rows"]}
        for key in ("decode_sv_frame/le92", "encode_goose/1"):
            self.assertGreater(rows[key]["value"], 0)
            self.assertIsNone(rows[key]["ratio"], "there is nothing beside it")
        beside = rows["one_way_p50"]
        self.assertEqual(beside["baseline_what"], "bare packet sockets")
        self.assertLessEqual(beside["least"], beside["ratio"])
        self.assertLessEqual(beside["ratio"], beside["most"])
        self.assertEqual({row["rounds"] for row in result["rows"]}, {1})
        self.assertIn("decode sv frame/le92", (self.folder / "out/bench.html").read_text())
        again = self.bench("codec", "--rounds", "2", "--compare", result["commit"][:7])
        self.assertEqual({row["rounds"] for row in json.loads((self.folder / "out/bench.json").read_text())["rows"]}, {2})
        self.assertRegex(again.stdout, r"decode sv frame/le92.*%, (same|better|worse)\)")

    def test_what_cannot_be_measured_is_said_and_is_a_failure(self):
        done = self.bench("codec", "--build", str(self.folder))
        self.assertEqual(done.returncode, 1)
        self.assertIn("not measured: codec: bench/bench_wire_codec: No such file", done.stdout)

    def test_bad_words_name_what_there_is(self):
        self.assertRegex(self.bench("codecs").stderr, "there is no measure 'codecs': expected codec, forecaster, wire")
        self.assertRegex(self.bench("codec", "--compare", "abc").stderr, "nothing was measured here at 'abc'; there is nothing yet")


if __name__ == "__main__":
    unittest.main(verbosity=2)
