#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What `gridspace new` makes runs at once, and agents in C++ and C are built against nothing but an installation."""
import csv
import json
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
import harness  # noqa: E402

RELAY = """
#include <cmath>
#include <gridspace/agent.hpp>
struct Currents { std::int64_t time_ns; bool alive; std::uint16_t smp_cnt; std::uint8_t smp_synch; float a, b, c; };
struct Trip { std::int64_t time_ns; bool status; };
class Relay final : public gridspace::Agent {
  public:
    Relay() : Agent{"relay", "trips when a current is too high"} {}
    void begin() override { trip.write({}); }
  private:
    void look(Currents const& i) {
        above = i.alive && std::max({std::abs(i.a), std::abs(i.b), std::abs(i.c)}) > pickup_a ? above + 1 : 0;
        if (above == 3) { trip.write({0, true}); }
    }
    int above = 0;
    gridspace::Setting<std::string> currents{*this, "currents"}, trips{*this, "trip"};
    gridspace::Setting<double> pickup_a{*this, "pickup_a"};
    gridspace::Setting<double> latency_us{*this, "latency_us", "900", {.latency = true}};
    gridspace::Reads<Currents> in{*this, "{currents}", [this](Currents const& i) { look(i); }, {.stream = true}};
    gridspace::Writes<Trip> trip{*this, "{trip}", {.stream = true}};
};
int main(int argc, char** argv) { return gridspace::run<Relay>(argc, argv); }
"""
SEVERAL = """
#include <gridspace/agent.hpp>
struct Several : gridspace::Agent {
    Several() : Agent{"several", "a signal of several names"} {}
    void begin() override {
        v["x"] = 2;
        last = 9;
        try { v["y"] = 1; } catch (std::exception const& e) { log(e.what()); }
    }
    gridspace::Setting<std::string> part{*this, "part"};
    gridspace::Signal v{*this, "agent.{process}.{part}.v_pu"}, last{*this, "agent.{process}.last"};
};
int main(int argc, char** argv) { return gridspace::run<Several>(argc, argv); }
"""
LANGUAGES = {"python": "agent_a", "c++": "agent_b", "c": "agent_c"}


class Sdk(harness.ScenarioTest):
    def do(self, *command, code=0, **environment):
        done = subprocess.run(list(map(str, command)), cwd=self.folder, capture_output=True, text=True, timeout=harness.HANG_S,
                              env={**os.environ, **environment}, check=False)
        self.assertEqual(done.returncode, code, f"{command}:\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def test_agents_of_three_languages_are_built_against_an_installation_and_do_the_same(self):
        prefix = self.folder / "prefix"
        self.do("cmake", "--install", harness.BIN.parent, "--prefix", prefix)
        installed = prefix / "bin/gridspace"
        for header in (prefix / "include/gridspace").iterdir():
            for word in ("fastdds", "fastrtps", "yaml-cpp", "Eigen", str(harness.SOURCE)):
                self.assertNotIn(word, header.read_text(), header)
        runs = {}
        for language, name in LANGUAGES.items():
            *building, _run, testing = self.do(installed, "new", "agent", name, "--language", language).splitlines() if language != "python" else [
                *self.do(installed, "new", "agent", name).splitlines()]
            for command in building:
                self.do("sh", "-c", command)
            self.do(installed, "validate", f"{name}/scenario.yaml")
            self.do(installed, "run", f"{name}/scenario.yaml", "--quiet", "--out", f"{name}/run")
            runs[language] = self.folder / name / "run"
            if language != "c":  # its test is the one of C++
                self.do("sh", "-c", testing, PATH=f"{installed.parent}:{os.environ['PATH']}", GRIDSPACE_BIN_DIR=str(installed.parent))
        for language in ("c++", "c"):
            said = self.do(harness.BIN / "gridspace", "compare", runs["python"], runs[language], "--signals", "battery.*,bus.*")
            self.assertIn("identical", said)

        # Streams: the relay of the Python example, in C++; its messages open the breakers at the same instants.
        self.write("relay.cpp", RELAY)
        self.write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.20)\nproject(relay CXX)\nset(CMAKE_CXX_STANDARD 20)\n"
                                     "find_package(Gridspace REQUIRED)\nadd_executable(relay relay.cpp)\ntarget_link_libraries(relay PRIVATE gridspace::agent)\n")
        self.do("cmake", "-S", ".", "-B", "relay_build", f"-DCMAKE_PREFIX_PATH={prefix}")
        self.do("cmake", "--build", "relay_build")
        example = harness.SOURCE / "examples/agents/python_overcurrent_relay/overcurrent.yaml"
        self.do(installed, "run", example, "--quiet", "--out", "python_relay")
        self.do(installed, "run", example, "--quiet", "--out", "relay", "--set", f"processes.relay.program.path={self.folder}/relay_build/relay",
                "--set", "expect.trip_decided_ms=~", "--set", "expect.no_trip_before_fault=~")
        self.assertIn("identical", self.do(harness.BIN / "gridspace", "compare", "python_relay", "relay", "--signals", "breaker.*,breaker_ied.*,ct.*"))

        # From the declaration in C++: its settings are checked where they are written.
        scenario = self.folder / "agent_b/scenario.yaml"
        scenario.write_text(scenario.read_text().replace("most_kw: 8", "most_kw: -8, fast: true"))
        said = self.do(installed, "validate", scenario, code=harness.USAGE)
        self.assertRegex(said, r"scenario\.yaml:\d+:\d+: error: unknown key 'fast'")
        self.assertRegex(said, r"scenario\.yaml:\d+:\d+: error: .*most_kw.*-8.*out of range")

        # What goes wrong in a callback is what the run says: a struct of another IDL, a text too long for the type, an exception.
        for number, (name, file, before, after, expected) in enumerate((
            ("agent_c", "agent_c.c", "&set_point, sizeof set_point)", "&set_point, 8)", "agent_c: a sample of 8 octets for 'set_points', whose type SetPoint has 48"),
            ("agent_c", "agent_c.c", "&set_point, 8)", f'&(SetPoint){{.element = "{"x" * 65}"}}, sizeof set_point)', "agent_c: SetPoint.element"),
            ("agent_b", "agent_b.cpp", "if (v_pu_) {", 'if (now_s() == 600) throw std::runtime_error{"no price"}; else {', "agent_b: no price"),
        )):
            source = self.folder / name / file
            source.write_text(source.read_text().replace(before, after))
            scenario = self.folder / name / "scenario.yaml"
            scenario.write_text(scenario.read_text().replace("most_kw: -8, fast: true", "most_kw: 8"))
            self.do("cmake", "--build", f"{name}/build")
            self.assertIn(expected, self.do(installed, "run", scenario, "--quiet", "--out", f"{name}/wrong_{number}", code=harness.CHILD_DIED))

    def test_a_signal_of_several_names_has_a_value_for_each_and_the_next_one_its_own(self):
        library = harness.BIN.resolve().parent / "lib"
        self.write("several.cpp", SEVERAL)
        self.do("g++", "-std=c++20", "-I", harness.SOURCE / "sdk", "several.cpp", "-o", "several", f"-L{library}", "-lgridspace", f"-Wl,-rpath,{library}")
        scenario = self.write("own.yaml", json.dumps({"extends": str(harness.CASE_1), "processes": {
            "several": {"program": {"path": "./several"}, "host": "controller", "part": "x"}}}))
        run = self.run_to_end("run", ["--until", "2min", "--set", "expect=~"], scenario)
        code, out, err = harness.gridspace("export", run.folder, "--csv", "--out", self.folder / "csv")
        self.assertEqual(code, harness.OK, out + err)
        tables = [list(csv.DictReader(file.open(newline=""))) for file in (self.folder / "csv").glob("signals*.csv")]
        last = {name: float(value) for rows in tables for name, value in rows[-1].items() if name.startswith("agent.several.")}
        self.assertEqual(last, {"agent.several.x.v_pu": 2, "agent.several.last": 9})
        self.assertIn("'agent.{process}.{part}.v_pu' is no signal for 'y'", (run.folder / "logs/several.log").read_text())

    def test_an_installation_has_the_agents_that_its_scenarios_name(self):
        prefix = self.folder / "prefix"
        self.do("cmake", "--install", harness.BIN.parent, "--prefix", prefix)
        scenarios = prefix / "share/gridspace/configs/scenarios"
        for name in ("energy_management", "energy_management_agent_lost", "energy_management_predictive"):
            self.do(prefix / "bin/gridspace", "validate", scenarios / f"{name}.yaml")
        run = self.folder / "run"
        self.do(prefix / "bin/gridspace", "run", scenarios / "energy_management.yaml", "--quiet", "--out", run, "--until", "1h", "--set", "expect=~")
        (prefix / "share/gridspace/examples/agents/energy_management/meter.py").unlink()
        self.assertIn("meter.py", self.do(prefix / "bin/gridspace", "validate", scenarios / "energy_management.yaml", code=harness.USAGE))

    def test_the_library_shows_the_functions_of_its_header_and_nothing_else(self):
        library = harness.BIN.resolve().parent / "lib/libgridspace.so.1"
        shown = {line.split()[-1] for line in self.do("nm", "-D", "--defined-only", library).splitlines() if " T " in line}
        header = (harness.SOURCE / "sdk/gridspace/agent.h").read_text()
        self.assertEqual(shown, {f"{name}@@GRIDSPACE_1" for name in re.findall(r"^GRIDSPACE_API .*?(gridspace_\w+)\(", header, re.M)})

    def test_who_builds_only_the_programs_has_the_headers_of_agents_too(self):
        self.assertIn("sdk/agent_types", self.do("ninja", "-C", harness.BIN.resolve().parent, "-t", "query", "programs"))

    def test_new_scenarios_and_networks_pass_their_tests(self):
        for kind in ("scenario", "network"):
            *_, testing = self.do(harness.BIN / "gridspace", "new", kind, f"my_{kind}").splitlines()
            self.do("sh", "-c", testing)  # as it was printed, though PATH does not lead to gridspace

    def test_the_tutorial_does_what_it_says(self):
        tutorial = (harness.SOURCE / "docs/tutorials/first_agent_in_python.md").read_text()
        diff = tutorial.partition("```diff\n")[2].partition("```")[0]
        self.assertLessEqual(sum(line[0] in "+-" and line[:3] not in ("+++", "---") for line in diff.splitlines() if line), 4, "four lines, it says")
        first, second, third = [line for line in tutorial.splitlines() if line.startswith("gridspace ")]
        charged = []
        for command in (first, second, third):
            if command == third:
                (self.folder / "change.diff").write_text(diff)
                self.do("git", "apply", "--unsafe-paths", "-p1", "--directory", self.folder / "my_agent", self.folder / "change.diff")
            self.do("sh", "-c", command, PATH=f"{harness.BIN}:{os.environ['PATH']}")
            if command != first:
                results = json.loads((self.folder / "runs/latest/report/summary.json").read_text())["expectations"]
                charged.append(next(e["value"] for e in results if e["name"] == "charge_percent"))
        self.assertLess(charged[1], charged[0] - 1, "it gives more where electricity is dear")

    def test_a_name_that_cannot_be_is_refused_and_nothing_is_overwritten(self):
        new = [harness.BIN / "gridspace", "new", "agent"]
        for name, expected in (("My-Agent", "'My-Agent' cannot be the name"), ("a" * 33, "at most 32"), ("lambda", "it means something already"),
                               ("json", "it means something already"), ("install", "it means something already"),
                               ("../up", "cannot be the name"), ("", "cannot be the name")):
            self.assertIn(expected, self.do(*new, name, code=harness.USAGE))
        self.assertIn("--language", self.do(*new, "x", "--language", "fortran", code=harness.USAGE))
        self.write("taken", "mine")
        self.assertIn("'taken' is there already", self.do(*new, "taken", code=harness.USAGE))
        self.assertEqual((self.folder / "taken").read_text(), "mine")
        self.assertIn("cannot make", self.do(*new, "x", "--out", "taken/x", code=harness.ENVIRONMENT))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["taken"])

    def test_structs_of_c_for_types_of_the_users(self):
        idl = self.write("weather.idl", "module station { enum Sky { CLEAR, CLOUDY }; struct Weather { string<8> place; Sky sky; sequence<double> t[2]; }; };")
        self.write("use.c", '#include "weather.h"\nint main(void) { station_Weather w = {.place = "N", .sky = station_Sky_CLOUDY}; return w.t[1].length; }\n')
        (self.folder / "weather.h").write_text(self.do(harness.BIN / "gridspace", "types", idl))
        self.do("cc", "-std=c11", "-Wall", "-Werror", "-x", "c", "use.c", "-o", "use")
        self.do(self.folder / "use")
        self.write("bad.idl", "struct {")
        self.assertIn("bad.idl", self.do(harness.BIN / "gridspace", "types", "bad.idl", code=harness.USAGE))


if __name__ == "__main__":
    import unittest

    unittest.main()
