#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""An FMU as an agent: a lag whose analytic solution is known, by FMI 2.0 and 3.0; one that misbehaves; and files that are none."""
import json
import math
import pathlib
import platform
import sys
import unittest
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BIN, CHILD_DIED, EXPECTATION, OK, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

sys.path.insert(0, str(SOURCE / "python"))
import gridspace as package  # noqa: E402

EXAMPLE = SOURCE / "examples/fmu/lag_steers_a_battery.yaml"
FMUS = BIN.parent / "tests/fmus"
NO_FAULT, SEGFAULT, ABORT, ENDLESS, FATAL, ERROR, DISCARD, EARLY, EXIT, TERMINATE, NOT_A_NUMBER, WARNING, STACK = range(13)


def fmu(model, version):
    return str(FMUS / f"{model}_fmi{version}.fmu")


class FmuTest(ScenarioTest):
    def scenario(self, processes, duration_s=60, controls=None, **more):
        controls = {"battery.BAT1.p_kw": {"from": "lag", "low_kw": -8, "high_kw": 8}} if controls is None else controls
        return self.write("scenario.yaml", json.dumps({
            "gridspace": 1, "name": "fmu", "clock": {"mode": "lockstep", "speed": "max", "tick_s": 1, "member_timeout_s": 20},
            "simulation": {"network": str(SOURCE / "configs/networks/house.yaml"), "solver": "phasor", "step_s": 1, "duration_s": duration_s,
                           "epoch": "2019-12-01T20:00:00Z", "gateways": "per_bus", "controls": controls},
            "hosts": {"simulator": {"links": ["net"]}, "controller": {"links": ["net"]}},
            "links": {"net": {"kind": "switch", "ipv4": "10.40.0.0/24"}},
            "processes": {"sim": {"program": "gridspace-sim", "host": "simulator", "qos": "simulator"},
                          "recorder": {"program": "gridspace-recorder", "host": "simulator", "qos": "recorder"}, **processes},
            "record": {"samples": "all"}, **more}))

    def lag(self, version=3, **more):
        return {"program": "gridspace-fmu", "host": "controller", "fmu": fmu("lag", version), "period_s": 1, "latency_us": 1000000,
                "start": {"tau": 60, "u": 4}, "watch": ["y", "steps"],
                "outputs": {"battery": {"set_point": "battery.BAT1.p_kw", "from": "y", "valid_for_s": 3}}, **more}

    def misfit(self, version, fault, **more):
        return {"program": "gridspace-fmu", "host": "controller", "fmu": fmu("misfit", version), "period_s": 1, "latency_us": 1000000,
                "start": {"fault": fault, "at": 20, "largest": 0.4}, "watch": ["y"],
                "outputs": {"battery": {"set_point": "battery.BAT1.p_kw", "from": "y", "scale": 0.1}}, **more}

    def signal(self, run, name):
        signal = package.open(run.folder).signal(name)
        return dict(zip((round(t, 6) for t in signal.time_s), signal.values))


class AnFmuInLockstep(FmuTest):
    def test_it_steers_a_battery_as_theory_says_and_by_both_versions_to_the_last_bit(self):
        runs = [self.run_to_end(f"fmi{version}", ["--set", f"processes.lag.fmu={fmu('lag', version)}"], EXAMPLE) for version in (2, 3)]
        self.assert_identical(*runs)

    def test_with_another_gain_the_battery_does_something_else(self):
        self.run_to_end("run", ["--set", f"processes.lag.fmu={fmu('lag', 3)}", "--set", "processes.lag.start.k=2"], EXAMPLE, EXPECTATION)

    def test_its_outputs_are_those_of_the_analytic_solution_and_take_effect_a_latency_later(self):
        run = self.run_to_end("run", [], self.scenario({"lag": self.lag()}))
        y, steps, battery = (self.signal(run, name) for name in ("agent.lag.y", "agent.lag.steps", "battery.BAT1.p_kw"))
        self.assertEqual(len(y), 61)
        for t in range(61):
            self.assertAlmostEqual(y[t], 4 * (1 - math.exp(-t / 60)), 9, t)
            self.assertEqual(steps[t], t)
            if t >= 2:  # what is recorded of an instant was before the set-points of that instant
                self.assertAlmostEqual(battery[t], y[t - 2], 9, t)

    def test_two_in_a_row_exchange_a_topic_with_numbers_and_texts(self):
        first = self.lag(2, start={"tau": 10, "u": 4, "label": "FORECAST"}, watch=["y"],
                         outputs={"forecast": {"topic": "forecast", "type": "BusMeasurement", "fields": {"bus": "label", "p_kw": "y"}}})
        second = self.lag(3, start={"tau": 20}, watch=["y"], inputs={
            "first": {"topic": "forecast", "type": "BusMeasurement", "where": {"bus": "FORECAST"}, "fields": {"u": {"from": "p_kw", "scale": 2}}},
            "other": {"topic": "bus_measurements", "type": "BusMeasurement", "where": {"bus": "HOUSE"}, "fields": {}}})
        run = self.run_to_end("run", [], self.scenario({"first": first, "lag": second}))
        ours, theirs = self.signal(run, "agent.first.y"), self.signal(run, "agent.lag.y")
        wanted, u = 0.0, 0.0
        for t in range(1, 61):
            wanted = u + (wanted - u) * math.exp(-1 / 20)
            self.assertAlmostEqual(theirs[t], wanted, 9, t)
            u = 2 * ours[t - 1]  # it comes a latency later
        self.assertGreater(wanted, 1)

    def test_restarted_it_begins_anew_or_goes_on_with_the_state_that_it_had(self):
        for on_restart, began in (("start", 30), ("resume", 0)):
            run = self.run_to_end(on_restart, [], self.scenario({"lag": self.lag(on_restart=on_restart)}, events={"again": {"at_s": 30, "restart": "lag"}}))
            y = self.signal(run, "agent.lag.y")
            after = [t for t in y if t > 31]
            self.assertGreaterEqual(len(after), 25)
            for t in after:
                self.assertAlmostEqual(y[t], 4 * (1 - math.exp(-(t - y_began(y, began)) / 60)), 9, (on_restart, t))

    def test_paused_it_says_nothing_and_makes_up_for_it(self):
        run = self.run_to_end("run", [], self.scenario({"lag": self.lag()}, events={"rest": {"at_s": 20, "pause": "lag"}, "awake": {"at_s": 30, "resume": "lag"}}))
        y = self.signal(run, "agent.lag.y")
        self.assertFalse([t for t in y if 22 <= t <= 28], y)
        self.assertAlmostEqual(y[50], 4 * (1 - math.exp(-50 / 60)), 9)

    def test_in_real_time_it_steers_too(self):
        run = self.run_to_end("run", ["--speed", "30", "--set", "clock.mode=realtime"], self.scenario(
            {"lag": self.lag()}, expect={"follows": {"last_of": "agent.lag.y", "is": 4 * (1 - math.exp(-1)), "tolerance": 0.3}}))
        refused = [e for e in run.events() if e["event"].endswith("refused") and "it was valid until" not in e["text"]]  # a busy machine is late
        self.assertEqual(refused, [])


def y_began(y, began):
    """When it began anew: the last time that y was 0."""
    return max(t for t, value in y.items() if value == 0) if began else 0


class AnFmuThatMisbehaves(FmuTest):
    def ends(self, fault, version, *words, **more):
        run = self.run_to_end(f"{fault}_{version}", [], self.scenario(
            {"fmu": self.misfit(version, fault, **more)}, controls={"battery.BAT1.p_kw": {"from": "fmu"}}), CHILD_DIED)
        cause = run.summary()["cause"]
        for word in (f"misfit_fmi{version}.fmu", *words):
            self.assertIn(word, cause)
        self.assert_recording_readable(run, 15)
        return run

    def test_that_crashes_is_named_with_function_and_time_and_the_recording_stays(self):
        self.ends(SEGFAULT, 3, "fmi3DoStep crashed (SIGSEGV", "at 21.000 s of simulated time")

    def test_that_uses_up_its_stack_is_named(self):
        self.ends(STACK, 2, "fmi2DoStep crashed (SIGSEGV")

    def test_that_aborts_or_ends_the_process_is_named(self):
        self.ends(ABORT, 2, "fmi2DoStep aborted (SIGABRT)")
        self.ends(EXIT, 3, "fmi3DoStep ended the process")

    def test_that_does_not_come_back_is_named_before_anybody_else_gives_up(self):
        scenario = self.scenario({"fmu": self.misfit(3, ENDLESS)}, controls={"battery.BAT1.p_kw": {"from": "fmu"}})
        run = self.run_to_end("run", ["--set", "clock.member_timeout_s=4"], scenario, CHILD_DIED)
        self.assertIn("misfit_fmi3.fmu: fmi3DoStep did not come back in time", run.summary()["cause"])

    def test_that_fails_says_why_in_its_own_words(self):
        self.ends(FATAL, 2, "fmi2DoStep from 20 s returned fatal", "the solver is beyond repair")
        self.ends(ERROR, 3, "fmi3DoStep from 20 s returned error: the solver found no solution")
        self.ends(NOT_A_NUMBER, 3, "its variable 'y' is nan at 21 s")

    def test_that_discards_steps_or_returns_early_or_warns_gives_the_results_of_one_that_does_not(self):
        controls = {"battery.BAT1.p_kw": {"from": "fmu"}}
        for version in (2, 3):
            for fault in (DISCARD, EARLY, WARNING):
                run = self.run_to_end(f"{fault}_{version}", [], self.scenario({"fmu": self.misfit(version, fault)}, controls=controls))
                y = self.signal(run, "agent.fmu.y")
                for t in range(61):
                    self.assertAlmostEqual(y[t], t, 6, (fault, version, t))

    def test_that_ends_itself_is_an_event_and_the_run_goes_on(self):
        run = self.run_to_end("run", [], self.scenario({"fmu": self.misfit(3, TERMINATE)}, controls={"battery.BAT1.p_kw": {"from": "fmu"}}))
        self.assertEqual([(e["time_s"], e["text"]) for e in run.events() if e["event"] == "fmu_ended"],
                         [(21, "misfit_fmi3.fmu has ended itself: nothing more comes of it")])
        self.assertEqual(max(self.signal(run, "agent.fmu.y")), 20)


class AFileThatIsNoFmu(FmuTest):
    """`validate` and `fmu info` say what is wrong, and start nothing."""

    DESCRIPTION = (SOURCE / "examples/fmu/lag_fmi3.xml").read_text()
    BINARY = f"binaries/{platform.machine()}-linux/lag.so"

    def make(self, name, files):
        with zipfile.ZipFile(self.folder / name, "w", zipfile.ZIP_DEFLATED) as out:
            for file, content in files.items():
                out.writestr(file, content)
        return str(self.folder / name)

    def refused(self, settings, *words):
        code, out, err = gridspace("validate", self.scenario({"lag": settings}))
        self.assertEqual(code, USAGE, out + err)
        for word in ("scenario.yaml:1:", *words):
            self.assertIn(word, out + err)

    def test_as_a_file_is_refused_at_its_place(self):
        whole = {"modelDescription.xml": self.DESCRIPTION, self.BINARY: ""}
        for name, files, word in (
                ("traversal", {**whole, "../../evil": ""}, "leaves the folder"),
                ("no_description", {self.BINARY: ""}, "'modelDescription.xml' is missing"),
                ("no_binary", {**{"modelDescription.xml": self.DESCRIPTION}, "binaries/win64/lag.dll": ""}, "it has some for win64"),
                ("old", {**whole, "modelDescription.xml": self.DESCRIPTION.replace('"3.0"', '"1.0"')}, "fmiVersion is '1.0'"),
                ("exchange", {**whole, "modelDescription.xml": self.DESCRIPTION.replace("<CoSimulation", "<ModelExchange")}, "for model exchange only"),
                ("broken", {**whole, "modelDescription.xml": self.DESCRIPTION.replace("</ModelVariables>", "")}, "it is not XML")):
            with self.subTest(name):
                self.refused(self.lag(fmu=self.make(f"{name}.fmu", files)), f"{name}.fmu: ", word)
        self.refused(self.lag(fmu=str(self.write("text.fmu", "no zip"))), "it is no zip file")
        self.refused(self.lag(fmu="nowhere.fmu"), "nowhere.fmu", "there is no such file")

    def test_with_settings_that_do_not_fit_it_is_refused_with_the_nearest_spelling(self):
        source = {"topic": "bus_measurements", "type": "BusMeasurement"}
        for settings, *words in (
                ({"start": {"tua": 1}}, "the FMU has no variable 'tua'", "did you mean 'tau'?"),
                ({"start": {"tau": "long"}}, "'long' is no value of 'tau', which is float64"),
                ({"start": {"time": 3}}, "'time' takes no start value"),
                ({"watch": ["label"]}, "'label' is string: a signal is a number"),
                ({"inputs": {"a": {**source, "fields": {"y": "p_kw"}}}}, "'y' cannot be set while it runs: it is a continuous output"),
                ({"inputs": {"a": {**source, "fields": {"u": "p_kwh"}}}}, "no field 'p_kwh' to read", "did you mean 'p_kw'?"),
                ({"inputs": {"a": {**source, "fields": {"u": "v_pu"}}}}, "kW"),
                ({"inputs": {"a": {**source, "fields": {"u": "p_kw"}}, "b": {**source, "fields": {"u": "q_kvar"}}}}, "'u' has its value from 'bus_measurements' already"),
                ({"outputs": {"a": {"set_point": "battery.BAT1", "from": "y"}}}, "'battery.BAT1' is no quantity of an element"),
                ({"outputs": {"a": {"set_point": "battery.BAT1.p_kw"}}}, "has no `from`"),
                ({"outputs": {"a": {"topic": "t", "type": "SetPoint", "fields": {"value": "z"}}}}, "the FMU has no variable 'z'"),
                ({"period_s": 0.3}, "'period_s' of 3/10 s is not a whole number of steps of 1 s"),
                ({"outputs": {}}, "process 'lag' does not write the topic 'set_points'")):
            with self.subTest(settings):
                self.refused(self.lag(**settings), *words)

    def test_that_cannot_keep_its_state_is_refused_where_it_should_resume(self):
        xml = self.DESCRIPTION.replace('canSerializeFMUState="true"', "")
        file = self.make("forgetful.fmu", {"modelDescription.xml": xml, self.BINARY: ""})
        self.refused(self.lag(fmu=file, on_restart="resume"), "the FMU cannot keep its state in a file")
        code, out, err = gridspace("validate", self.scenario({"lag": self.lag(fmu=file)}))
        self.assertEqual(code, OK, out + err)

    def test_whose_binary_is_none_ends_with_3_and_says_so(self):
        file = self.make("empty.fmu", {"modelDescription.xml": self.DESCRIPTION, self.BINARY: "no ELF"})
        run = self.run_to_end("run", [], self.scenario({"lag": self.lag(fmu=file)}), 3)
        self.assertIn("empty.fmu: its binary cannot be loaded", run.summary()["cause"] if (run.folder / "report").exists() else run.stderr())

    def test_fmu_info_shows_what_it_is_or_why_it_is_none(self):
        for version in (2, 3):
            code, out, err = gridspace("fmu", "info", fmu("lag", version), "--json")
            self.assertEqual(code, OK, err)
            said = json.loads(out)
            self.assertEqual((said["fmi_version"], said["name"], said["runs_here"]), (f"{version}.0", "lag", True))
            self.assertEqual(said["kinds"], {"co_simulation": True, "model_exchange": False, "scheduled_execution": False})
            self.assertIn({"name": "tau", "type": "float64", "causality": "parameter", "variability": "fixed", "unit": "s", "start": "10"}, said["variables"])
            code, out, err = gridspace("fmu", "info", fmu("lag", version))
            self.assertEqual(code, OK, err)
            self.assertRegex(out, r"\ntau +float64 +parameter +fixed +s +10\n")
        code, out, err = gridspace("fmu", "info", self.make("none.fmu", {"a": ""}))
        self.assertEqual((code, out), (USAGE, ""))
        self.assertIn("'modelDescription.xml' is missing", err)
        windows = self.make("windows.fmu", {"modelDescription.xml": self.DESCRIPTION, "binaries/win64/lag.dll": ""})
        code, out, err = gridspace("fmu", "info", windows)
        self.assertEqual(code, OK, err)  # what it is can be shown
        self.assertIn("runs here      no: it has no binary for this machine", out)


if __name__ == "__main__":
    unittest.main()
