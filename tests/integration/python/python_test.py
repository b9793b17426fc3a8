#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The Python package runs a scenario and reads what it recorded; the launcher's own judgement is what it is compared with."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(os.environ["GRIDSPACE_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "python"))
import gridspace  # noqa: E402

SCENARIO = SOURCE / "configs/scenarios/ev_charging.yaml"


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="gridspace-python-")
        cls.run_ = gridspace.run(SCENARIO, out=pathlib.Path(cls.folder.name) / "run", until="1h", set=[("expect", None), ("processes.monitor", None), (
            "expect", {"lowest": {"min_of": "bus.*.v_pu", "above": 0.9}, "charged": {"last_of": "ev.EV1.soc_percent", "above": 1},
                       "impossible": {"always": "bus.B1.v_pu > 2"}})])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def expectation(self, name):
        return next(e for e in self.run_.expectations if e.name == name)

    def test_a_run_whose_expectations_fail_is_a_run(self):
        self.assertFalse(self.run_.passed)
        self.assertEqual([e.name for e in self.run_.expectations if not e.passed], ["impossible"])

    def test_signals_have_the_values_that_the_launcher_judged(self):
        voltages = self.run_.signals("bus.*.v_pu")
        self.assertGreaterEqual(len(voltages), 4)
        self.assertAlmostEqual(min(min(s.values) for s in voltages.values()), self.expectation("lowest").value, places=12)
        soc = self.run_.signal("ev.EV1.soc_percent")
        self.assertAlmostEqual(soc.values[-1], self.expectation("charged").value, places=12)
        self.assertEqual((soc.time_s[0], soc.time_s[-1]), (0, 3600))
        self.assertEqual(soc.at(1e9), soc.values[-1])
        self.assertEqual(len(soc), len(soc.time_s))
        self.assertIn("agent.mcca.curtailed", self.run_.signal_names)

    def test_it_can_be_opened_again(self):
        again = gridspace.open(self.run_.folder)
        self.assertEqual(again.summary, self.run_.summary)
        self.assertEqual(again.events, self.run_.events)

    def test_what_is_not_there_is_named(self):
        with self.assertRaisesRegex(KeyError, "no signal of .* fits 'bus.X.*'"):
            self.run_.signals("bus.X.*")
        with self.assertRaisesRegex(KeyError, "is called 'bus'"):
            self.run_.signal("bus")
        with self.assertRaisesRegex(ValueError, "is before that"):
            self.run_.signal("bus.B1.v_pu").at(-1)
        with self.assertRaisesRegex(gridspace.Error, "is not the folder of a run") as caught:
            gridspace.open(self.folder.name)
        self.assertEqual(caught.exception.code, 2)

    def test_tables_of_before_the_run_ended_are_not_mixed_with_new_ones(self):
        folder = pathlib.Path(self.folder.name) / "grown"
        shutil.copytree(self.run_.folder, folder, ignore=shutil.ignore_patterns("csv"))
        (folder / "csv").mkdir()
        (folder / "csv/signals_99.csv").write_text("time_s,bus.B1.v_pu\n0,7\n")  # of a time when it had more tables
        os.utime(folder / "csv", (0, 0))
        self.assertEqual(gridspace.open(folder).signal("bus.B1.v_pu").values, self.run_.signal("bus.B1.v_pu").values)
        self.assertEqual(list(folder.glob("csv.*")), [])

    def test_a_run_that_has_not_ended_is_called_that(self):
        under_way = pathlib.Path(self.folder.name) / "under_way"
        shutil.copytree(self.run_.folder, under_way, ignore=shutil.ignore_patterns("report"))
        run = gridspace.open(under_way)
        with self.assertRaisesRegex(gridspace.Error, "has not ended: report/summary.json comes with its end"):
            _ = run.passed
        with self.assertRaisesRegex(KeyError, "fits 'bus.X.\\*'; the run has not ended, open it again later"):
            run.signals("bus.X.*")
        self.assertTrue(run.signals("bus.*.v_pu"), "what there is can be read")

    def test_pip_installs_it_without_a_network(self):
        target = pathlib.Path(self.folder.name) / "site"
        pip = [sys.executable, "-m", "pip"]
        if subprocess.run([*pip, "--version"], capture_output=True, check=False).returncode != 0:
            sys.path.insert(0, str(SOURCE / "python"))  # pip is not everywhere: what it calls is tried
            import wheel_of_tree

            target.mkdir()
            zipfile.ZipFile(target / wheel_of_tree.build_wheel(target)).extractall(target)
        else:
            subprocess.run([*pip, "install", "--quiet", "--no-index", "--target", target, SOURCE / "python"], check=True)
        code = f"import gridspace; print(gridspace.open({str(self.run_.folder)!r}).passed, gridspace.__file__)"
        done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(target)}, capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.split(), ["False", str(target / "gridspace/__init__.py")])

    def test_pip_can_lead_to_the_tree_instead_of_copying_it(self):
        sys.path.insert(0, str(SOURCE / "python"))
        import wheel_of_tree

        with tempfile.TemporaryDirectory() as folder:
            wheel = zipfile.ZipFile(pathlib.Path(folder) / wheel_of_tree.build_editable(folder))
            self.assertEqual(wheel.read("gridspace.pth").decode().strip(), str(SOURCE / "python"))
            self.assertFalse([name for name in wheel.namelist() if name.endswith(".py")])

    def test_the_launchers_errors_are_exceptions_with_its_text(self):
        with self.assertRaisesRegex(gridspace.Error, "unknown key 'clok'") as caught:
            gridspace.run(SCENARIO, set={"clok.tick_s": 1})
        self.assertEqual(caught.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
