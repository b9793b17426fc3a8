# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A monitor beside somebody's own bus, whose types it was not compiled for and nobody describes."""
import contextlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

import client
import harness

INSIDE = "GRIDSPACE_FOREIGN_TYPES_TEST_INSIDE"
DOMAIN = 101  # its ports are below those that the kernel gives to others
IDL = """module station {
  // what stands on the roof
  @final struct Weather { @key string place; double celsius; long trend; };
};
"""
WRITER = harness.BIN.parent / "tests/foreign_writer"


class ForeignTypes(harness.ScenarioTest):
    def setUp(self):
        super().setUp()
        self.idl = self.write("weather.idl", IDL)

    @contextlib.contextmanager
    def monitor(self, topic="rt/weather", **settings):
        config = self.write("monitor.yaml", json.dumps({
            "process": "monitor", "program": "gridspace-monitor",
            "bus": {"qos": str(harness.SOURCE / "qos/monitor.xml"), "management": {"domain": DOMAIN, "addresses": ["127.0.0.1"]}},
            "settings": {"listen": "127.0.0.1:0", **settings}}))
        log = self.folder / "monitor.log"
        with open(log, "w") as out:
            process = subprocess.Popen([harness.BIN / "gridspace-monitor", "--config", config], stdout=out, stderr=out)
            try:
                deadline = time.monotonic() + client.PATIENCE_S
                while "http://" not in log.read_text():
                    self.assertIsNone(process.poll(), log.read_text())
                    self.assertLess(time.monotonic(), deadline)
                    time.sleep(0.02)
                monitor = client.Monitor(next(w for w in log.read_text().split() if w.startswith("http://")))
                monitor.until("/api/v1/topics", lambda t: any(x["name"] == topic and x["samples"] > 0 for x in t["topics"]), "a sample")
                yield monitor
            finally:
                process.terminate()
                process.wait(client.PATIENCE_S)

    @contextlib.contextmanager
    def station(self, *mode):
        process = subprocess.Popen([WRITER, harness.SOURCE / "qos/member.xml", str(DOMAIN), *mode], stdin=subprocess.PIPE)
        try:
            yield
        finally:
            process.stdin.close()
            process.wait(client.PATIENCE_S)

    def echo(self, monitor, *arguments):
        return harness.gridspace("topic", "echo", "rt/weather", "--run", f"http://{monitor.host}:{monitor.port}", *arguments)

    def test_a_writer_that_sends_best_effort_is_heard_beside_one_that_is_reliable(self):
        with self.station(), self.monitor() as monitor:
            with self.station("best_effort"):
                monitor.until("/api/v1/topics/rt%2Fweather/last", lambda t: any(s["process"] == "gust" for s in t["last"]), "a sample of the second")
                self.assertEqual([e["problems"] for e in monitor.json("/api/v1/graph")["edges"] if e["problems"]], [])
        with self.station("best_effort"), self.monitor() as monitor:
            self.assertEqual(monitor.json("/api/v1/topics/rt%2Fweather/last")["last"][0]["process"], "gust")

    def test_a_topic_is_read_with_the_type_of_the_first_writer_and_then_with_that_of_who_is_left(self):
        with contextlib.ExitStack() as first:
            first.enter_context(self.station())
            with self.monitor() as monitor, self.station("best_effort", "rt/weather", "station::Other"):
                monitor.until("/api/v1/graph", lambda g: "gust" in json.dumps(g), "the second writer")
                self.assertEqual(monitor.json("/api/v1/topics/rt%2Fweather")["type"], "station::Weather")
                first.close()
                monitor.until("/api/v1/topics/rt%2Fweather", lambda t: t["type"] == "station::Other", "the type of who is left")

    def test_its_samples_are_read_by_the_idl_that_the_user_gives(self):
        with self.station():
            with self.monitor() as monitor:
                last = monitor.json("/api/v1/topics/rt%2Fweather/last")["last"]
                self.assertIn("nobody has published the IDL of type station::Weather", last[0]["error"])
                code, out, _ = self.echo(monitor)
                self.assertEqual(code, harness.OK)
                self.assertIn("nobody has published the IDL", out)
                code, out, err = self.echo(monitor, "--idl", self.idl)
                self.assertEqual(code, harness.OK, err)
                for line in ("place: roof", "celsius: 21.5", "trend: -3"):
                    self.assertIn(line, out)
                self.assert_mistakes_are_told(monitor)
            with self.monitor(idl=str(self.idl)) as monitor:
                last = monitor.json("/api/v1/topics/rt%2Fweather/last")["last"]
                self.assertEqual((last[0]["key"], last[0]["fields"]), ("roof", {"place": "roof", "celsius": 21.5, "trend": -3}))
                self.assertEqual(monitor.json("/api/v1/topics/rt%2Fweather")["idl"], IDL)

    def test_one_command_shows_whoever_talks_in_a_domain(self):
        with self.station():
            process = subprocess.Popen([harness.BIN / "gridspace", "monitor", "--domain", str(DOMAIN), "--idl", self.idl], stdout=subprocess.PIPE, text=True)
            try:
                monitor = client.Monitor(process.stdout.readline().strip())
                monitor.until("/api/v1/topics", lambda t: any(x["name"] == "rt/weather" for x in t["topics"]), "the topic")
                monitor.until("/api/v1/topics/rt%2Fweather/last", lambda t: any(s.get("fields") for s in t["last"]), "a decoded sample")
                self.assertEqual(monitor.json("/api/v1/run")["scenario"], f"DDS domain {DOMAIN}")
            finally:
                process.terminate()
                process.wait(client.PATIENCE_S)
                process.stdout.close()
        for mistake, said in ((["--domain", 233], "0 to 232"), (["--domain", DOMAIN, "latest"], "excludes"), (["--address", "10.0.0.1"], "requires")):
            code, out, err = harness.gridspace("monitor", *mistake)
            self.assertEqual(code, harness.USAGE, out + err)
            self.assertIn(said, out + err)

    def test_a_mistake_in_the_idl_is_told_before_an_address_is(self):
        code, out, err = harness.gridspace("monitor", "--domain", DOMAIN, "--idl", self.write("weather.bad", "struct {"))
        self.assertEqual((code, out), (harness.USAGE, ""), err)
        self.assertIn("line 1: expected a name before '{'", err)

    def test_what_the_idl_says_of_other_types_does_not_hinder(self):
        idl = "#ifndef W\n#define W\nunion U switch (long) { case 1: long a; };\n#endif\nstruct Other { U u; };\n" + IDL
        with self.station(), self.monitor(idl=str(self.write("weather.idl", idl))) as monitor:
            self.assertEqual(monitor.json("/api/v1/topics/rt%2Fweather/last")["last"][0]["fields"]["celsius"], 21.5)
        idl = IDL.replace("long trend", "wstring trend")
        with self.station(), self.monitor(idl=str(self.write("weather.idl", idl))) as monitor:
            self.assertIn("its IDL, line 3: 'wstring' is not supported", monitor.json("/api/v1/topics/rt%2Fweather/last")["last"][0]["error"])

    def of_another_dds(self, name, **options):
        """Built of the IDL by the tools of another DDS."""
        self.write("weather.idl", IDL.replace("@key ", ""))  # the writer has no key
        source = pathlib.Path(__file__).parent / f"{name}.c"
        for command in (["idlc", "-l", "c", "-t", "-o", self.folder, self.folder / "weather.idl"],
                        ["gcc", "-Wall", "-Wextra", "-I", self.folder, "-o", self.folder / name, source, self.folder / "weather.c", "-lddsc"]):
            done = subprocess.run(command, capture_output=True, text=True, timeout=client.PATIENCE_S)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return subprocess.Popen([self.folder / name, str(DOMAIN)], stdin=subprocess.PIPE, **options)

    def test_writers_that_others_overhear_are_heard_and_of_the_rest_it_is_said_why(self):
        with self.of_another_dds("strange_writers", stdout=subprocess.PIPE, text=True) as writers:
            self.assertEqual(writers.stdout.readline(), "written\n")
            with self.monitor(topic="parted", idl=str(self.idl)) as monitor:
                wanted = {"parted", "owned", "patient", "kept", "xcdr2"}
                monitor.until("/api/v1/topics", lambda t: wanted <= {x["name"] for x in t["topics"]}, "the topics")
                for topic in ("parted", "owned", "patient", "kept"):
                    said = monitor.until(f"/api/v1/topics/{topic}/last", lambda t: t["last"], f"a sample of {topic}")
                    self.assertEqual((said["last"][0]["fields"]["celsius"], said["not_heard"]), (21.5, []))
                said = "stranger: data representation: written is XCDR2, read is XCDR1"
                self.assertEqual(monitor.json("/api/v1/topics/xcdr2/last")["not_heard"], [said])
                self.assertEqual(monitor.json("/api/v1/topics/xcdr2")["not_heard"], [said])
                event = monitor.until("/api/v1/events", lambda e: e["events"], "an event")["events"]
                self.assertEqual([(e["source"], e["event"], e["text"]) for e in event],
                                 [("monitor", "not_heard", f"the monitor hears nothing on 'xcdr2' from {said}")])
                for verb in (["echo", "xcdr2"], ["list"], ["info", "xcdr2"]):
                    code, out, err = harness.gridspace("topic", *verb, "--run", f"http://{monitor.host}:{monitor.port}")
                    self.assertEqual(code, harness.OK, err)
                    self.assertIn(f"hears nothing from {said}", out + err)
                _, out, err = harness.gridspace("topic", "echo", "kept", "--run", f"http://{monitor.host}:{monitor.port}")
                self.assertIn("# kept from an unnamed process", out, err)
            writers.stdin.close()

    def test_what_a_reader_of_another_dds_asks_for_in_vain_is_said(self):
        with self.station(), self.monitor() as monitor, self.of_another_dds("strict_reader") as reader:
            graph = monitor.until("/api/v1/graph", lambda g: any(e["problems"] for e in g["edges"]), "a broken edge")
            reader.stdin.close()
        problems = " ".join(p for e in graph["edges"] for p in e["problems"])
        for said in ("destination order: offered is by reception timestamp, requested is by source timestamp",
                     "presentation: offered is access by instance, requested is by topic", "ordered access is requested and not offered",
                     "data representation: written is XCDR1, read is XCDR2"):
            self.assertIn(said, problems)

    def assert_mistakes_are_told(self, monitor):
        for text, said in [("struct Other { long x; };", "does not define station::Weather"), ("struct {", "weather.bad"),
                           ("module station { struct Weather { long a; long b; long c[100]; }; };", "not of that type"), ("", "defines no struct")]:
            _, out, err = self.echo(monitor, "--idl", self.write("weather.bad", text))
            self.assertIn(said, out + err, text)


class TypesOfAScenario(harness.ScenarioTest):
    def test_a_type_that_an_exec_process_names_is_recorded_and_shown(self):
        idl = IDL.replace("@key ", "")  # the writer has no key either
        self.write("weather.idl", idl)
        command = f"sleep 1000 | exec {WRITER} {harness.SOURCE}/qos/member.xml $GRIDSPACE_DATA_DOMAIN reliable weather"
        run = self.start("run", ["--no-namespaces"], self.write("weather.yaml", json.dumps({
            "extends": str(harness.CASE_1), "name": "weather", "expect": None, "clock": {"mode": "realtime", "speed": 100},
            "processes": {"station": {"program": "exec", "host": "board1", "command": ["/bin/sh", "-c", command],
                                      "writes": {"weather": {"type": "station::Weather", "idl": "weather.idl"}}}}})))
        url = run.wait_for(lambda line: line.get("note", "").startswith("monitor: http://"), "the monitor")["note"].split()[-1]
        run.wait_for_time(10)
        monitor = client.Monitor(url)
        seen = monitor.until("/api/v1/topics/weather/last", lambda t: t["last"], "a sample")["last"][0]
        self.assertEqual(seen["fields"], {"place": "roof", "celsius": 21.5, "trend": -3})
        self.assertEqual(monitor.json("/api/v1/topics/weather")["idl"], idl)
        os.kill(run.pid, signal.SIGINT)
        self.assertEqual(run.finish(), harness.INTERRUPTED, run.stderr())
        code, out, err = harness.gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, harness.OK, out + err)
        self.assertTrue((run.folder / "csv/weather.csv").read_text().splitlines()[-1].endswith(",roof,21.5,-3"))


if __name__ == "__main__":
    if os.environ.get(INSIDE) is None:  # its domain is on a loopback interface of its own
        kind = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
        script = f'ip link set lo up multicast on && exec "{sys.executable}" "$@"'
        os.execvpe("unshare", [*kind, "sh", "-c", script, "sh", *sys.argv], {**os.environ, INSIDE: "1"})
    unittest.main()
