#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Results as DataFrames and drawings, and the notebook that shows them. For a Python with pandas and matplotlib: that of the system, with Debian's."""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import types
import unittest
import unittest.mock

SYSTEM = "/usr/bin/python3"
if importlib.util.find_spec("pandas") is None and sys.executable != SYSTEM:
    os.execv(SYSTEM, [SYSTEM, *sys.argv])

SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).resolve().parents[3]))
sys.path[:0] = [str(SOURCE / "tests/integration/scenario"), str(SOURCE / "python")]
os.environ["MPLBACKEND"] = "Agg"
import harness  # noqa: E402
import pandas  # noqa: E402

import gridspace  # noqa: E402

NOTEBOOK = SOURCE / "docs/tutorials/results_in_python.ipynb"


class Tables(harness.ScenarioTest):
    def test_of_signals_events_and_expectations(self):
        arguments = [*harness.BASE, "--until", "2h", "--set", "expect=~", "--set", "expect={low: {min_of: bus.*.v_pu, above: 0.9}}", "--set", "events={x: {at_s: 3600, kill: ev4}}"]
        run = gridspace.open(self.run_to_end("run", arguments).folder)
        table = run.frame("bus.*.v_pu", "agent.ev1.requested_a")
        self.assertEqual((table.index.name, table.index[0], table.index[-1]), ("time_s", 0, 7200))
        for name in table:
            signal = run.signal(name)
            self.assertEqual(table[name].dropna().tolist(), list(signal.values), name)
            self.assertEqual(table[name].dropna().index.tolist(), list(signal.time_s), name)
        self.assertAlmostEqual(table.filter(like="v_pu").min().min(), run.expectations[0].value, places=12)
        even = run.frame("ev.EV1.soc_percent", "agent.ev1.requested_a", every_s=600)
        self.assertEqual(even.index.tolist(), [600.0 * i for i in range(13)])
        for time_s in (600, 4200, 7200):
            for name in even:
                self.assertEqual(even[name][time_s], run.signal(name).at(time_s))
        rows = {"s": types.SimpleNamespace(time_s=[0, 0.3, 0.6, 0.9], values=[0, 1, 2, 3]),
                "w": types.SimpleNamespace(time_s=[round(i / 4800, 9) for i in range(4800)], values=range(4800))}
        for name, every_s in (("s", 0.3), ("w", 1 / 4800)):  # multiples of every_s are binary fractions, a little beside the rows
            with unittest.mock.patch.object(type(run), "signals", lambda *_, name=name: {name: rows[name]}):
                self.assertEqual(run.frame(name, every_s=every_s)[name].tolist(), list(rows[name].values))
        events = pandas.DataFrame(run.events)
        self.assertEqual(events[events.text == "ev4 killed"].time_s.tolist(), [3600])
        self.assertEqual(pandas.DataFrame(run.expectations).passed.tolist(), [True])
        self.assertEqual(pandas.DataFrame(run.samples("decisions")).ev.unique().tolist(), ["EV1", "EV2", "EV3", "EV4"])

        axes = run.plot("bus.*.v_pu", events=True)
        self.assertEqual(sorted(line.get_label() for line in axes.lines if "bus" in str(line.get_label())), [f"bus.B{i}.v_pu" for i in (1, 2, 3, 4)])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("time, min", "v_pu"))
        self.assertEqual(axes.get_xlim(), (0, 120))
        part = run.plot("ev.EV1.soc_percent", from_s=60, until_s=120, axes=axes.figure.add_subplot())
        self.assertEqual((part.get_xlabel(), part.get_xlim(), list(part.lines[0].get_xdata())[:2]), ("time, s", (60, 120), [60, 61]))

    def test_without_pandas_it_says_what_to_install(self):
        run = self.run_to_end("run", [*harness.BASE, "--until", "10min", "--set", "expect=~"])
        code = f"import gridspace; run = gridspace.open({str(run.folder)!r}); print(len(run.signals('bus.*'))); run.{{}}('bus.*')"
        for function, package in (("frame", "pandas"), ("plot", "matplotlib")):
            done = subprocess.run([SYSTEM, "-S", "-c", code.format(function)], capture_output=True, text=True, check=False, timeout=harness.HANG_S,
                                  env={**os.environ, "PYTHONPATH": str(SOURCE / "python")})
            self.assertEqual(done.stdout, "20\n")
            self.assertIn(f"gridspace.launcher.Error: {package} is not installed: on Debian python3-{package}", done.stderr)


class Notebook(harness.ScenarioTest):
    def execute(self, notebook):
        folders = {"IPYTHONDIR": "ipython", "JUPYTER_RUNTIME_DIR": "runtime", "JUPYTER_CONFIG_DIR": "jupyter", "JUPYTER_DATA_DIR": "data", "TMPDIR": "runs"}
        for name in folders.values():
            (self.folder / name).mkdir(exist_ok=True)
        environment = {name: str(self.folder / folder) for name, folder in folders.items()}
        environment |= {"PYTHONPATH": str(SOURCE / "python"), "GRIDSPACE_BIN_DIR": str(harness.BIN)}
        environment |= {name: value for name, value in os.environ.items() if name not in (*environment, "MPLBACKEND")}
        done = subprocess.run([SYSTEM, SOURCE / "tests/integration/python/execute_notebook.py", notebook, self.folder / "out.ipynb"],
                              env=environment, capture_output=True, text=True, timeout=4 * harness.HANG_S, check=False)
        return done.returncode, done.stderr

    def test_the_tutorial_is_executed_to_its_end(self):
        code, said = self.execute(NOTEBOOK)
        self.assertEqual(code, 0, said)
        cells = [c for c in json.loads((self.folder / "out.ipynb").read_text())["cells"] if c["cell_type"] == "code"]
        self.assertTrue(all(c["execution_count"] for c in cells))
        outputs = [o for c in cells for o in c["outputs"]]
        self.assertEqual(sum("image/png" in o.get("data", {}) for o in outputs), 3, "drawings")
        self.assertEqual([o for o in outputs if o["output_type"] == "error"], [])
        self.assertEqual([c for c in json.loads(NOTEBOOK.read_text())["cells"] if c.get("outputs")], [], "it is kept without what came out")

    def test_a_cell_that_fails_is_a_failure(self):
        notebook = json.loads(NOTEBOOK.read_text())
        cell = next(c for c in notebook["cells"] if c["cell_type"] == "code")
        notebook["cells"] = [{**cell, "source": ["import gridspace\n", "gridspace.open('nowhere')"]}]
        code, said = self.execute(self.write("wrong.ipynb", json.dumps(notebook)))
        self.assertEqual(code, 1)
        self.assertIn("'nowhere' is not the folder of a run", said)


if __name__ == "__main__":
    unittest.main()
