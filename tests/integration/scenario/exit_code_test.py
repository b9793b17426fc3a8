# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Every kind of failure has its exit code, and says what to do."""
import json
import os
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from harness import (BASE, BIN, CASE_1, CHILD_DIED, ENVIRONMENT, EXPECTATION, OK, SHORT_CASE_2, SOURCE, STALL, USAGE, ScenarioTest,
                     gridspace)

SHORT = [*BASE, "--until", "600s", "--set", "expect=~"]


class ExitCodes(ScenarioTest):
    def test_a_stream_that_two_publish_and_one_that_nobody_does_are_told(self):
        scenario = self.write("wrong.yaml", SHORT_CASE_2)
        code, out, err = gridspace("validate", scenario)
        self.assertEqual((code, "warning" in out + err), (OK, False), out + err)  # the control
        code, out, err = gridspace("validate", scenario, "--set", "processes.mu22.to=SMV21")
        self.assertEqual(code, OK, out + err)
        self.assertIn("'mu22' publishes the stream 'SMV21', as 'mu21' does", out + err)
        self.assertIn("'relay2' waits for the stream 'SMV22', and nobody publishes it", out + err)

    def test_0_when_everything_holds(self):
        run = self.run_to_end("run", SHORT)
        self.assertEqual(run.manifest()["exit"], OK)

    def test_1_when_an_expectation_fails_and_the_table_says_which(self):
        junit = self.folder / "junit.xml"
        run = self.run_to_end("run", [*SHORT, "--set", "expect={too_high: {min_of: bus.*.v_pu, above: 2}, fine: {max_of: bus.*.v_pu, below: 2}}",
                                      "--junit", junit], code=EXPECTATION)
        results = {e["name"]: e["pass"] for e in run.summary()["expectations"]}
        self.assertEqual(results, {"too_high": False, "fine": True})
        self.assertEqual(run.summary()["exit"], EXPECTATION)
        suite = xml.etree.ElementTree.parse(junit).getroot()
        self.assertEqual(suite.get("failures"), "1")
        code, out, _ = gridspace("report", run.folder)
        self.assertEqual(code, EXPECTATION)
        self.assertRegex(out, r"too_high .*FAIL")
        self.assertRegex(out, r"fine .*pass")

    def test_1_for_a_report_on_a_recording_that_was_cut_of_what_asks_about_the_rest(self):
        held = "{all: {always: bus.B1.v_pu > 0.5}, least: {min_of: bus.B1.v_pu, above: 0.5}, soon: {always: bus.B1.v_pu > 0.5, until: 1 s}, once: {eventually: bus.B1.v_pu > 0.5}}"
        run = self.run_to_end("run", [*BASE, "--until", "4h", "--set", "expect=~", "--set", f"expect={held}"])
        recording = run.folder / "data.mcap"
        recording.write_bytes(recording.read_bytes()[:recording.stat().st_size * 6 // 10])
        code, out, err = gridspace("report", run.folder)
        self.assertEqual(code, EXPECTATION, out + err)
        self.assertRegex(out, r"all .*FAIL +cannot be judged: the recording is whole until \d")
        self.assertRegex(out, r"least .*FAIL +cannot be judged: the recording is whole until \d")
        self.assertRegex(out, r"soon .*pass")
        self.assertRegex(out, r"once .*pass")

    def test_2_for_a_report_on_a_run_that_cannot_be_judged(self):
        run = self.run_to_end("run", SHORT)
        manifest = run.folder / "manifest.json"
        good = manifest.read_text()
        manifest.write_text("{")
        code, _, err = gridspace("report", run.folder)
        self.assertEqual(code, USAGE, err)
        self.assertIn("is no JSON object", err)
        manifest.write_text(good)
        (run.folder / "scenario.resolved.yaml").unlink()
        code, out, err = gridspace("report", run.folder)
        self.assertEqual(code, USAGE, out + err)
        self.assertIn("cannot be judged", out + err)
        self.assertIn("✗ the expectations cannot be judged", (run.folder / "report/index.html").read_text())

    def test_2_for_a_mistake_on_the_command_line(self):
        for arguments in (["run"], ["run", "--nonsense", CASE_1], ["nonsense"], [], ["run", CASE_1, "--speed", "fast"],
                          ["run", CASE_1, "--until", "later"], ["run", CASE_1, "--seed", "99999999999999999999"], ["run", CASE_1, "--set", "nonsense"], ["completion", "tcsh"]):
            code, out, err = gridspace(*arguments)
            self.assertEqual(code, USAGE, f"{arguments}: {out}{err}")
            self.assertTrue(out + err, arguments)

    def test_2_for_a_scenario_that_does_not_exist(self):
        code, _, err = gridspace("run", self.folder / "none.yaml")
        self.assertEqual(code, USAGE)
        self.assertIn("none.yaml", err)

    def test_2_for_a_run_folder_that_is_not_one(self):
        for verb in (["report"], ["export"]):
            code, _, err = gridspace(*verb, self.folder)
            self.assertEqual(code, USAGE, err)
            self.assertIn(str(self.folder), err)

    def test_2_when_the_folder_of_out_is_in_use(self):
        (self.folder / "mine").write_text("keep me")
        code, _, err = gridspace("run", CASE_1, *SHORT, "--out", self.folder)
        self.assertEqual(code, USAGE, err)
        self.assertEqual((self.folder / "mine").read_text(), "keep me")

    def test_3_when_a_program_is_missing(self):
        self.copy_programs()
        (self.folder / "bin/gridspace-mcca").unlink()
        code, _, err = gridspace_of(self.folder / "bin", "run", CASE_1, *SHORT, "--out", self.folder / "run")
        self.assertEqual(code, ENVIRONMENT, err)
        self.assertIn("mcca", err)

    @unittest.skipIf(os.geteuid() != 0, "a switch of user needs root")
    def test_3_when_the_run_folder_cannot_be_written(self):
        sealed = self.folder / "sealed"
        sealed.mkdir(mode=0o555)
        code, _, err = gridspace("run", CASE_1, *SHORT, "--out", sealed / "run", user=65534, group=65534)
        self.assertEqual(code, ENVIRONMENT, err)
        self.assertIn("sealed", err)

    def test_3_before_anything_starts_when_the_junit_file_cannot_be_written(self):
        code, _, err = gridspace("run", CASE_1, *SHORT, "--out", self.folder / "run", "--junit", self.folder / "nowhere/junit.xml")
        self.assertEqual(code, ENVIRONMENT, err)
        self.assertIn("nowhere/junit.xml': No such file", err)
        self.assertFalse((self.folder / "run").exists())

    def test_the_junit_file_may_lie_in_the_run_folder(self):
        run = self.run_to_end("run", [*SHORT, "--junit", self.folder / "run/junit.xml"])
        self.assertIn("testsuite", (run.folder / "junit.xml").read_text())

    def test_3_when_the_report_cannot_be_written_and_the_results_are_printed_all_the_same(self):
        junit = self.folder / "junit.xml"
        run = self.run_to_end("run", [*BASE, "--until", "1200s", "--speed", "300", "--set", "expect=~", "--set", "expect={fine: {max_of: bus.*.v_pu, below: 2}}", "--junit", junit,
                                      "--set", "processes.own={program: exec, host: board1, "
                                               "command: [/bin/sh, -c, 'rm -r ../report && touch ../report; exec sleep 1000']}"], code=ENVIRONMENT)
        self.assertRegex(run.stderr(), "cannot write '.*summary.json': Not a directory")
        self.assertEqual([e["pass"] for e in json.loads(run.printed[0])["expectations"]], [True])
        self.assertIn('failures="0"', junit.read_text())

    def test_nobody_needs_to_read_what_a_run_says(self):
        for number, redirection in enumerate(["2>&-", "2>/dev/full", "2>&1 | head -n 1 >/dev/null"]):
            folder = self.folder / str(number)
            shell = f'"$@" {redirection}; exit ${{PIPESTATUS[0]}}'
            done = subprocess.run(["bash", "-c", shell, "bash", BIN / "gridspace", "run", CASE_1, *SHORT, "--out", folder], capture_output=True, text=True,
                                  timeout=90)
            self.assertIn(done.returncode, [OK, ENVIRONMENT] if "head" in redirection else [OK], redirection)
            self.assertEqual(json.loads((folder / "report/summary.json").read_text())["exit"], OK, redirection)

    def test_3_when_the_results_cannot_be_printed(self):
        for arguments in (["run", CASE_1, *SHORT, "--json", "--out", self.folder / "run"], ["info", "--json", self.folder / "run"],
                          ["compare", self.folder / "run", self.folder / "run"], ["--version"]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([BIN / "gridspace", *map(str, arguments)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=90)
            self.assertEqual(done.returncode, ENVIRONMENT, arguments)
            self.assertIn("No space left on device", done.stderr)

    def test_4_when_an_exec_process_ends_early(self):
        run = self.run_to_end("run", [*SHORT, "--speed", "60", "--set",
                                      "processes.own={program: exec, host: board1, command: [/bin/sh, -c, 'echo my last words; exit 7']}"],
                              code=CHILD_DIED)
        self.assertIn("'own'", run.summary()["cause"])
        self.assertIn("exit code 7", run.summary()["cause"])
        self.assertIn("my last words", run.stderr())

    def test_4_when_the_solver_comes_to_no_end_and_2_when_an_event_cannot_be(self):
        text = (SOURCE / "configs/networks/adn_set_a.yaml").read_text()
        for old, new in (("inertia_h_s: 2.0", "inertia_h_s: 0.002"),
                         ("governor: {droop_percent: 4, tg_s: 0.05, tt_s: 0.15, integral_ki: 0}", "governor: {droop_percent: 1000, tg_s: 5, tt_s: 5}")):
            self.assertIn(old, text)
            text = text.replace(old, new)
        self.write("grid.yaml", text)
        usual = ("gridspace: 1\nname: away\nclock: {mode: lockstep, tick_s: 0.01}\nhosts: {h: {}}\n"
                 "processes: {sim: {program: gridspace-sim, host: h}, recorder: {program: gridspace-recorder, host: h}}\n")
        away = self.write("away.yaml", usual + "simulation: {network: grid.yaml, solver: emt, step_s: 0.0001, duration_s: 3}\n"
                          "events: {d: {at_s: 0.01, open: [CB1, CB3, CB5]}, l: {at_s: 0.05, disconnect: AC4}}\n")
        run = self.run_to_end("away", scenario=away, code=CHILD_DIED)
        self.assertRegex(run.summary()["cause"], r"^sim: (machine 'G\d' runs away|the waveforms diverge) at \d")
        fault = "apply_fault: {line: TL2, type: 1ph_g}"
        twice = self.write("twice.yaml", usual + f"simulation: {{network: {SOURCE}/configs/networks/adn_set_b.yaml, solver: phasor, "
                           f"step_s: 0.01, duration_s: 1}}\nevents: {{a: {{at_s: 0.1, {fault}}}, b: {{at_s: 0.2, {fault}}}}}\n")
        run = self.run_to_end("twice", scenario=twice, code=USAGE)
        self.assertRegex(run.summary()["cause"], r"^sim: event 'b': ")

    def test_3_when_an_exec_process_does_not_exist(self):
        run = self.run_to_end("run", [*SHORT, "--set", "processes.own={program: exec, host: board1, command: [/no/such/program]}"],
                              code=ENVIRONMENT)
        self.assertIn("own", run.stderr())
        self.assertIn("/no/such/program", run.stderr())

    def test_5_when_a_member_never_appears(self):
        run = self.run_to_end("run", [*SHORT, "--set", "clock.start_timeout_s=4", "--set",
                                      "processes.own={program: exec, host: board1, member: true, command: [sleep, '1000'], "
                                      "writes: {x: {type: ChargingRequest}}}"], code=STALL)
        self.assertIn("own", run.summary()["cause"])
        said = "".join(log.read_text() for log in (run.folder / "logs").glob("*.log"))
        self.assertRegex(said, r"waits for 1 of 1 writer\(s\) of '\w+' in own \(its participant is not discovered\)")

    @unittest.skipIf(os.geteuid() != 0, "a switch of user needs root")
    def test_an_ordinary_user_runs_in_namespaces_of_its_own(self):
        self.folder.chmod(0o777)
        run = self.run_to_end("run", SHORT, prefix=["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"])
        reference = self.run_to_end("root", SHORT)
        self.assert_identical(reference, run)
        self.assertIn("namespaces", run.manifest()["isolation"])
        self.assertFalse(run.manifest()["host"]["root"])

    def copy_programs(self):
        shutil.copytree(BIN, self.folder / "bin")
        shutil.copytree(SOURCE / "qos", self.folder / "qos")


def gridspace_of(folder, *arguments):
    environment = dict(os.environ, GRIDSPACE_QOS_DIR=str(SOURCE / "qos"))
    done = subprocess.run([folder / "gridspace", *map(str, arguments)], capture_output=True, text=True, env=environment, timeout=90)
    return done.returncode, done.stdout, done.stderr


if __name__ == "__main__":
    unittest.main(verbosity=2)
