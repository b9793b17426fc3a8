#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A run folder from somebody else is read, never obeyed: one evil folder per hole."""
import http.client
import http.server
import os
import pathlib
import shutil
import subprocess
import sys
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BASE, BIN, HANG_S, OK, USAGE, ScenarioTest, gridspace  # noqa: E402

SHORT = [*BASE, "--until", "600s", "--set", "expect=~", "--set", "processes.recorder.compress=false"]
SIGNAL, EVIL = b"bus.B1.v_pu\0", b"</script>\x1b[2"  # of one length, and so in the same places


class ForeignFolder(ScenarioTest):
    def setUp(self):
        super().setUp()
        self.run_folder = self.run_to_end("run", SHORT).folder
        self.outside = self.write("outside", "mine")

    def evil(self):
        """A copy of the run's folder, which a stranger may then fill."""
        out = self.folder / "evil"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(self.run_folder, out)
        return out

    def assert_refused(self, run, *verbs):
        for verb in verbs:
            code, _, err = gridspace(*verb)
            self.assertEqual(code, USAGE, (verb, err))
            self.assertIn("is a symbolic link to", err)
        self.assertEqual(self.outside.read_text(), "mine")

    def test_no_link_leads_a_verb_out_of_it(self):
        run = self.evil()
        verbs = (["report", run], ["info", run], ["export", run, "--csv"], ["compare", run, self.run_folder], ["compare", self.run_folder, run],
                 ["play", run], ["monitor", run], ["graph", run], ["topic", "list", "--run", run])
        (run / "report/index.html").unlink()
        (run / "report/index.html").symlink_to(self.outside)
        self.assert_refused(run, *verbs)
        run = self.evil()
        (run / "csv").symlink_to(self.folder, target_is_directory=True)
        self.assert_refused(run, ["export", run, "--csv"])
        run = self.evil()
        (run / "manifest.json").unlink()
        (run / "manifest.json").symlink_to(self.outside)
        self.assert_refused(run, ["report", run], ["info", run])

    def test_a_file_under_a_second_name_is_not_written_through(self):
        run = self.evil()
        (run / "report/index.html").unlink()
        os.link(self.outside, run / "report/index.html")
        code, _, err = gridspace("report", run)
        self.assertEqual(code, OK, err)
        self.assertIn("<!doctype html>", (run / "report/index.html").read_text())
        self.assertEqual(self.outside.read_text(), "mine")

    def test_its_monitor_file_joins_nothing_and_sets_nothing(self):
        """It asks for a bus with its own QoS, whose log file is somebody else's, for other hosts, and for a token file."""
        run = self.evil()
        qos = run / "evil.xml"
        qos.write_text(f"""<?xml version="1.0" encoding="UTF-8"?><dds><log><consumer><class>FileConsumer</class>
            <property><name>filename</name><value>{self.outside}</value></property></consumer></log></dds>""")
        (run / "monitor.yaml").write_text(f"""process: monitor
program: gridspace-monitor
bus: {{qos: ./evil.xml, management: {{domain: 77, addresses: [127.0.0.1]}}}}
settings: {{scenario: evil, listen: "0.0.0.0:0", allow_hosts: [evil.example], token_file: {self.outside}, run: {{graph: {self.outside}}}}}
""")
        process = subprocess.Popen([BIN / "gridspace", "monitor", run], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            url = process.stdout.readline().strip()
            self.assertTrue(url.startswith("http://127.0.0.1:"), url)
            connection = http.client.HTTPConnection(url.removeprefix("http://"), timeout=HANG_S)
            connection.request("GET", "/api/v1/run")
            answer = connection.getresponse()
            self.assertEqual(answer.status, 200, answer.read())  # it asks for no token
            connection.request("GET", "/api/v1/run", headers={"Host": "evil.example"})
            self.assertNotEqual(connection.getresponse().status, 200)
            ports = [line.split()[1] for line in pathlib.Path(f"/proc/{process.pid}/net/udp").read_text().splitlines()[1:]]
            self.assertFalse([p for p in ports if 7400 + 250 * 77 <= int(p.split(":")[1], 16) < 7400 + 250 * 78])
        finally:
            process.terminate()
            process.communicate(timeout=HANG_S)
        self.assertEqual(self.outside.read_text(), "mine")

    def test_no_address_of_it_is_contacted_and_no_file_that_it_names_is_sent(self):
        asked = []

        class Trap(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                asked.append(self.headers.get("Authorization"))
                self.send_response(200)
                self.end_headers()

            def log_message(self, *_):
                pass
        trap = http.server.HTTPServer(("127.0.0.1", 0), Trap)
        thread = threading.Thread(target=trap.serve_forever)
        thread.start()
        try:
            run = self.evil()
            for mode, text in ((0o600, f"http://127.0.0.1:{trap.server_port}\n\n{self.outside}\n"), (0o600, ""), (0o644, "http://x\n")):
                note = run / "monitor.address"
                note.write_text(text)
                note.chmod(mode)
                for verb in (["topic", "list", "--run", run], ["topic", "echo", "signals", "--run", run], ["control", "stop", "--run", run]):
                    code, out, err = gridspace(*verb)
                    self.assertEqual(code, USAGE, (verb, out, err))
                    self.assertNotIn("basic_string", err)
        finally:
            trap.shutdown()
            thread.join()
            trap.server_close()
        self.assertEqual(asked, [])

    def test_what_it_says_is_shown_as_text(self):
        run = self.evil()
        recording = run / "data.mcap"
        data = recording.read_bytes()
        self.assertEqual(len(SIGNAL), len(EVIL))
        self.assertIn(SIGNAL, data)
        recording.write_bytes(data.replace(SIGNAL, EVIL))
        manifest = run / "manifest.json"
        manifest.write_text(manifest.read_text().replace('"description": "', '"description": "<img src=x onerror=alert(1)>\\u001b[2J', 1)
                            .replace('"exit": 0', '"exit": "0"'))
        code, out, err = gridspace("report", run)
        self.assertNotIn("json.exception", err)
        page = (run / "report/index.html").read_text()
        self.assertEqual(page.count("</script>"), 1)
        self.assertNotIn("<img", page)
        for verb in ("report", "info"):
            _, out, err = gridspace(verb, run)
            self.assertNotIn("\x1b[2", out + err, verb)


if __name__ == "__main__":
    unittest.main()
