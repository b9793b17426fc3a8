#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A program out of tree says what it is (`program: {path: FILE}`), and is then checked and run as strictly as ours."""
import json
import os
import pathlib
import shutil
import stat
import unittest

import harness

SCENARIO = harness.SOURCE / "configs/scenarios/ev_charging.yaml"
SHORT = ["--until", "1h", "--set", "expect=~"]


class OwnProgram(harness.ScenarioTest):
    def script(self, name, text):
        file = self.write(name, "#!/bin/sh\n" + text + "\n")
        pathlib.Path(file).chmod(0o755)
        return pathlib.Path(file)

    def scenario(self, **processes):
        return self.write("own.yaml", json.dumps({"extends": str(SCENARIO), "processes": processes}))

    def refused(self, expected, **processes):
        code, out, err = harness.gridspace("validate", self.scenario(**processes))
        self.assertEqual(code, harness.USAGE, out + err)
        self.assertIn(expected, out + err)

    def test_an_agent_outside_of_the_tree_gives_the_same_run_as_ours(self):
        agent = self.folder / "my_ev_agent"
        shutil.copy(harness.BIN / "gridspace-ev", agent)
        agent.chmod(agent.stat().st_mode | stat.S_IXUSR)
        ours = self.run_to_end("ours", SHORT)
        theirs = self.run_to_end("theirs", SHORT, scenario=self.scenario(ev1={"program": {"path": "./my_ev_agent"}}))
        self.assertNotIn("my_ev_agent", (ours.folder / "manifest.json").read_text())
        self.assertIn("agent.ev1.requested_a", harness.gridspace("signals", self.scenario(ev1={"program": {"path": "./my_ev_agent"}}))[1])
        code, out, err = harness.gridspace("compare", ours.folder, theirs.folder)
        self.assertEqual(code, harness.OK, out + err)
        self.assertIn("identical", out)

    def test_what_it_says_to_its_launcher_may_be_anything(self):
        """Members of another kind, a word that only the simulator may say, brackets without end, a line without end."""
        odd = self.script("odd_ev_agent", rf"""case "$*" in *--status-fd*)
            printf '%s\n' '{{"status":1}}' '{{"status":"event","time_s":null,"source":7,"text":[]}}' '{{"status":"hold","index":0}}' '{{"status":"progress","time_s":"x"}}' >&3
            printf '{{"status":"event","text":' >&3; head -c 60000 /dev/zero | tr '\0' '[' >&3; head -c 60000 /dev/zero | tr '\0' ']' >&3; printf '}}\n' >&3
            head -c 300000 /dev/zero | tr '\0' x >&3; echo >&3;;
        esac
        exec {harness.BIN}/gridspace-ev "$@" """)
        ours = self.run_to_end("ours", SHORT)
        theirs = self.run_to_end("theirs", SHORT, scenario=self.scenario(ev1={"program": {"path": str(odd)}}))
        code, out, err = harness.gridspace("compare", ours.folder, theirs.folder)
        self.assertEqual(code, harness.OK, out + err)

    def test_its_settings_are_checked_where_they_are_written(self):
        agent = {"path": str(harness.BIN / "gridspace-ev")}
        self.refused("unknown key 'perod_s'", ev1={"program": agent, "perod_s": 3})
        self.refused("which is out of range", ev1={"program": agent, "requested_h": -3})
        self.refused("did you mean 'EV1'?", ev1={"program": agent, "ev": "EV9"})
        self.refused("acts for the EV 'EV1', and 'ev1' does so already", ev2={"program": agent, "ev": "EV1"})

    def test_who_does_not_say_what_it_is_is_named(self):
        os.environ["GRIDSPACE_DESCRIBE_TIMEOUT_S"] = "1"
        self.addCleanup(os.environ.pop, "GRIDSPACE_DESCRIBE_TIMEOUT_S")
        for name, text, expected in (
            ("silent", "exit 0", "it printed nothing"),
            ("failing", "echo no licence >&2; exit 3", "it ended with code 3: no licence"),
            ("misspelt", """printf '  File "/x/agent.py", line 3\\n    def f()\\nSyntaxError: no colon\\n' >&2; exit 1""", "SyntaxError: no colon (agent.py:3)"),
            ("talking", "echo hello", "silent"),
            ("other", 'echo \'{"gridspace_program": 2, "name": "x"}\'', "gridspace_program"),
            ("doubled", 'echo \'{"gridspace_program": 1, "name": "x", "signals": [{"name": "a.b.c"}, {"name": "a.b.c"}]}\'', "`signals` has 'a.b.c' twice"),
            ("beyond", 'echo \'{"gridspace_program": 1, "name": "x", "settings": [{"key": "k_kw", "kind": "number", "default": "3", "max": 2}]}\'',
             "the setting 'k_kw' cannot have its own default, 3"),
            ("hanging", "sleep 60", "no answer within 1 s"),
            ("endless", "yes", "it printed more than 1048576 octets"),
            ("lingering", "exec >&- 2>&-; sleep 60", "no answer within 1 s"),
        ):
            with self.subTest(name):
                self.refused(expected if name != "talking" else "talking --describe:1:1", ev1={"program": {"path": str(self.script(name, text))}})
        self.refused("No such file", ev1={"program": {"path": "./nowhere"}})
        self.refused("lacks the key 'path'", ev1={"program": {"file": "x"}})

    def test_each_program_is_asked_once(self):
        text = json.dumps({"gridspace_program": 1, "name": "watcher", "member": False})
        agent = {"program": {"path": str(self.script("watcher", f"echo asked >>{self.folder}/count; echo '{text}'"))}, "host": "controller"}
        code, out, err = harness.gridspace("validate", self.scenario(one=agent, two=agent, three=agent))
        self.assertEqual(code, harness.OK, out + err)
        self.assertEqual((self.folder / "count").read_text(), "asked\n")

    def test_what_it_declares_is_part_of_the_dataflow(self):
        text = json.dumps({"gridspace_program": 1, "name": "ems", "member": False, "settings": [{"key": "from", "kind": "name", "doc": "topic", "required": True}],
                           "reads": [{"topic": "{from}", "type": "ChargingRequest"}]})
        agent = {"program": {"path": str(self.script("ems", f"echo '{text}'"))}, "host": "controller"}
        self.refused("reads the topic 'prices', which nobody writes", ems={**agent, "from": "prices"})
        code, out, err = harness.gridspace("validate", self.scenario(ems={**agent, "from": "requests"}))
        self.assertEqual(code, harness.OK, out + err)

    def test_a_file_that_it_needs_must_be_there(self):
        settings = [{"key": "prices", "kind": "file", "doc": "prices"},
                    {"key": "sites", "kind": "map", "doc": "sites", "keys": [{"key": "weather", "kind": "file", "doc": "its weather"}]}]
        text = json.dumps({"gridspace_program": 1, "name": "ems", "member": False, "settings": settings})
        agent = {"program": {"path": str(self.script("ems", f"echo '{text}'"))}, "host": "controller"}
        self.write("there.csv", "1\n")
        base = self.write("base.yaml", f"extends: {SCENARIO}\nprocesses:\n  ems: {json.dumps(agent)}\n")
        for written, expected in (("prices: gone.csv", f"base.yaml:4:11: error: 'prices' names '{self.folder}/gone.csv', which does not exist"),
                                  ("prices: .", f"'prices' names '{self.folder}/', which is a folder"),
                                  ("sites: {N: {weather: there.csv}, S: {weather: gone.csv}}", "base.yaml:4:49: error: 'weather' names ")):
            base.write_text(f"extends: {SCENARIO}\nprocesses:\n  ems: {json.dumps(agent)[:-1]},\n  {written}}}\n")
            code, out, err = harness.gridspace("validate", base)
            self.assertEqual(code, harness.USAGE, out + err)
            self.assertIn(expected, out + err)
        base.write_text(f"extends: {SCENARIO}\nprocesses:\n  ems: {json.dumps(agent)[:-1]},\n  prices: there.csv}}\n")
        (self.folder / "elsewhere").mkdir()  # of a file that another extends: where it is written counts
        other = self.write("elsewhere/other.yaml", "extends: ../base.yaml\nname: other\n")
        code, out, err = harness.gridspace("validate", other)
        self.assertEqual(code, harness.OK, out + err)


if __name__ == "__main__":
    unittest.main()
