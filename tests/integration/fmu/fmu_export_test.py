#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A network exported as an FMU 3.0: its description by the rules of the standard, its functions as C calls them, its results against
`gridspace simulate` and against the simulator of a scenario in which it runs as an agent. What is expected is equal to the last bit."""
import csv
import hashlib
import json
import math
import pathlib
import re
import subprocess
import sys
import threading
import unittest
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from exported_fmu import ERROR, OK, Fmu, Instance  # noqa: E402
from harness import BIN, ENVIRONMENT, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

sys.path.insert(0, str(SOURCE / "python"))
import gridspace as package  # noqa: E402

NETWORKS = SOURCE / "configs/networks"
LAG = BIN.parent / "tests/fmus/lag_fmi3.fmu"


class ExportTest(ScenarioTest):
    def export(self, network, *arguments, name="grid.fmu"):
        file = self.folder / name
        code, out, err = gridspace("fmu", "export", network, "-o", file, *arguments)
        self.assertEqual(code, OK, out + err)
        return file

    def load(self, file):
        return Fmu(file, self.folder / f"unpacked_{file.stem}")

    def begun(self, fmu):
        instance = Instance(fmu)
        self.assertTrue(instance.handle, instance.said)
        self.addCleanup(instance.free)
        self.assertEqual(instance.begin(), OK, instance.said)
        return instance


class ItsDescription(ExportTest):
    """Rules of sections 2.4 and 4.4 of FMI 3.0.1 that an XML schema does not know, and those of a schema that matter."""

    USED = {("independent", "continuous"), ("input", "discrete"), ("output", "continuous")}  # of those that the standard allows

    def test_follows_the_rules_of_the_standard_in_both_engines(self):
        for network, solver in (("adn_set_b", "phasor"), ("adn_set_a", "emt"), ("renewable_site", "phasor"), ("energy_microgrid", "phasor"), ("islanding_microgrid", "emt")):
            with self.subTest(network):
                root = self.load(self.export(NETWORKS / f"{network}.yaml", "--solver", solver, name=f"{network}.fmu")).root
                self.assert_follows_the_rules(root)
                self.assertEqual(root.get("modelName"), network)

    def assert_follows_the_rules(self, root):
        self.assertEqual([child.tag for child in root if child.tag != "TypeDefinitions"], ["CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment", "ModelVariables", "ModelStructure"])
        self.assertEqual(root.get("fmiVersion"), "3.0")
        self.assertRegex(root.get("instantiationToken"), "^[0-9a-f]{64}$")
        self.assertRegex(root.find("CoSimulation").get("modelIdentifier"), "^[A-Za-z_][A-Za-z0-9_]*$")
        for state in ("canGetAndSetFMUState", "canSerializeFMUState"):
            self.assertEqual(root.find("CoSimulation").get(state), "false")
        variables = list(root.find("ModelVariables"))
        names, references = [v.get("name") for v in variables], [int(v.get("valueReference")) for v in variables]
        self.assertEqual((len(set(names)), len(set(references))), (len(names), len(names)))
        for name in names:
            self.assertRegex(name, r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_0-9][A-Za-z0-9_]*)*$")
        units = [u.get("name") for u in root.find("UnitDefinitions")]
        self.assertEqual(len(set(units)), len(units))
        self.assertEqual(set(units), {v.get("unit") for v in variables} - {None})
        self.assertEqual([v.get("name") for v in variables if v.get("causality") == "independent"], ["time"])
        for v in variables:
            kind = (v.get("causality"), v.get("variability"))
            self.assertIn(kind, self.USED, v.get("name"))
            self.assertEqual("start" in v.attrib, kind[0] == "input", "an input has a start value, a calculated output and the time have none")
            self.assertIsNone(v.get("initial"))
            if v.tag == "Boolean":
                self.assertEqual((kind, v.get("start") in ("true", "false"), v.get("unit")), (("input", "discrete"), True, None))
            elif v.tag == "Enumeration":
                kinds, = [t for t in root.find("TypeDefinitions") if t.get("name") == v.get("declaredType")]
                self.assertEqual([item.get("value") for item in kinds], [str(n + 1) for n in range(len(kinds))])
                self.assertGreater(len(kinds), 1)
                self.assertEqual((kind, v.get("start"), kinds.get("name") in names), (("input", "discrete"), "1", False))
            elif "start" in v.attrib:
                self.assertTrue(math.isfinite(float(v.get("start"))), v.attrib)
                self.assertLessEqual(float(v.get("min", "-inf")), float(v.get("start")))
                self.assertGreaterEqual(float(v.get("max", "inf")), float(v.get("start")))
        outputs = [v.get("valueReference") for v in variables if v.get("causality") == "output"]
        for element in ("Output", "InitialUnknown"):
            self.assertEqual([e.get("valueReference") for e in root.find("ModelStructure").findall(element)], outputs)

    def test_has_what_agents_may_do_as_inputs_and_what_was_asked_for_as_outputs(self):
        fmu = self.load(self.export(NETWORKS / "house.yaml", "--solver", "phasor", "--step", "1/10", "--until", "2h", "--signals", "bus.HOUSE.*,battery.*.soc_percent"))
        p = fmu.variables["set_point.battery.BAT1.p_kw"].attrib
        self.assertEqual((p["causality"], p["unit"], p["start"]), ("input", "kW", "0"))
        self.assertEqual(fmu.variables["command.line.L.connected"].get("start"), "true")
        self.assertEqual([n for n, v in fmu.variables.items() if v.get("causality") == "output"],
                         ["bus.HOUSE.v_pu", "bus.HOUSE.angle_deg", "bus.HOUSE.frequency_hz", "bus.HOUSE.p_kw", "bus.HOUSE.q_kvar", "battery.BAT1.soc_percent"])
        self.assertNotIn("set_point.battery.BAT1.droop_percent", fmu.variables)  # it follows the grid
        self.assertEqual(fmu.root.find("DefaultExperiment").attrib, {"startTime": "0", "stopTime": "7200", "stepSize": "0.1"})
        self.assertEqual(fmu.root.find("CoSimulation").get("fixedInternalStepSize"), "0.1")

    def test_is_one_that_our_own_reader_shows(self):
        code, out, err = gridspace("fmu", "info", self.export(NETWORKS / "house.yaml", "--solver", "phasor", "--inputs", "set_point.*.p_kw"), "--json")
        self.assertEqual(code, OK, err)
        said = json.loads(out)
        self.assertEqual((said["runs_here"], said["capabilities"]["variable_step"], said["capabilities"]["get_and_set_state"]), (True, True, False))
        self.assertEqual([v["name"] for v in said["variables"] if v["causality"] == "input"],
                         [f"set_point.{element}.p_kw" for element in ("load.HOME", "battery.BAT1")])


class ItsFile(ExportTest):
    def test_is_the_same_octets_each_time_and_another_for_another_choice(self):
        arguments = (NETWORKS / "house.yaml", "--solver", "phasor")
        files = [self.export(*arguments, name=f"{n}.fmu").read_bytes() for n in range(2)]
        self.assertEqual(hashlib.sha256(files[0]).hexdigest(), hashlib.sha256(files[1]).hexdigest())
        tokens = {self.load(self.export(*arguments, *more, name=f"m{n}.fmu")).token
                  for n, more in enumerate(((), ("--step", "1/100"), ("--fixed-step",), ("--signals", "bus.*"), ("--inputs", "*.p_kw"), ("--epoch", "2026-06-01T12:00:00Z")))}
        self.assertEqual(len(tokens), 6)

    def test_holds_profiles_and_what_the_network_extends(self):
        (self.folder / "data").mkdir()
        self.write("data/day.csv", "hours,home\n0,0.5\n1,1.5\n")
        self.write("base.yaml", (NETWORKS / "house.yaml").read_text())
        network = self.write("grid.yaml", "extends: base.yaml\nname: grid\nloads: {HOME: {scale: day}}\nprofiles: {day: {csv: data/day.csv, column: home}}\n")
        file = self.export(network, "--solver", "phasor", "--step", "60")
        fmu = self.load(file)
        with zipfile.ZipFile(file) as archive:
            self.assertIsNone(archive.testzip())
            self.assertEqual(archive.namelist(), ["modelDescription.xml", f"binaries/{fmu.binary.parent.name}/grid.so", "resources/grid.yaml",
                                                  "resources/network.yaml", "resources/profile_day.csv"])
        (self.folder / "base.yaml").unlink()
        (self.folder / "data/day.csv").unlink()
        instance = self.begun(fmu)
        self.assertEqual(instance.step(1800), OK)
        self.assertAlmostEqual(instance.get("load.HOME.p_kw"), 5.0, 6)  # half an hour on: once 5 kW

    def test_shows_only_functions_of_the_standard_and_needs_no_dds(self):
        fmu = self.load(self.export(NETWORKS / "house.yaml", "--solver", "phasor"))
        said = subprocess.run(["readelf", "-W", "--dyn-syms", "-d", fmu.binary], capture_output=True, text=True, check=True).stdout
        shown = {line.split()[7].partition("@")[0] for line in said.splitlines()
                 if re.match(r"\s*\d+:", line) and line.split()[4] in ("GLOBAL", "WEAK") and line.split()[6] != "UND"}
        self.assertTrue({"fmi3InstantiateCoSimulation", "fmi3DoStep", "fmi3GetFMUState", "fmi3ActivateModelPartition"} <= shown)
        self.assertEqual({name for name in shown if not name.startswith("fmi3")} - {"__bss_start", "_edata", "_end"}, set())
        needed = re.findall(r"\(NEEDED\).*\[(.*?)\]", said)
        self.assertIn("libc.so.6", needed)
        self.assertFalse([n for n in needed if re.search("fast|rtps|ssl|crypto|zip|gridspace", n)], needed)

    def test_cannot_be_made_of_what_is_no_network_or_does_not_start(self):
        target = self.folder / "no.fmu"
        house = NETWORKS / "house.yaml"
        unsolvable = self.write("unsolvable.yaml", house.read_text().replace("p_kw: 5, power_factor: 0.95", "p_kw: 5000"))
        for code, words, arguments in (
                (USAGE, ["this is a scenario file", ":"], [SOURCE / "configs/scenarios/ev_charging.yaml", "-o", target]),
                (USAGE, ["nowhere.yaml"], ["nowhere.yaml", "-o", target]),
                (USAGE, ["no signal matches 'bus.HUOSE.v_pu'", "did you mean 'bus.HOUSE.v_pu'?"], [house, "-o", target, "--solver", "phasor", "--signals", "bus.HUOSE.v_pu"]),
                (USAGE, ["no input matches 'set_point.battery.BAT2.p_kw'", "did you mean"], [house, "-o", target, "--solver", "phasor", "--inputs", "set_point.battery.BAT2.p_kw"]),
                (ENVIRONMENT, ["no_folder/no.fmu"], [house, "-o", self.folder / "no_folder/no.fmu", "--solver", "phasor"]),
                (USAGE, ["--step '0'"], [house, "-o", target, "--step", "0"]),
                (USAGE, ["--epoch 'noon'"], [house, "-o", target, "--epoch", "noon"]),
                (USAGE, ["--out"], [house]),
                (USAGE, ["does not converge", "HOUSE"], [unsolvable, "-o", target, "--solver", "phasor"])):
            with self.subTest(words):
                done, out, err = gridspace("fmu", "export", *arguments)
                self.assertEqual(done, code, out + err)
                for word in words:
                    self.assertIn(word, out + err)
                self.assertFalse(target.exists())


class ItsResults(ExportTest):
    """Against the same network by `gridspace simulate`, whose tables hold all digits."""

    def simulate(self, network, signals, events, *arguments):
        table = self.folder / "plain.csv"
        events = self.write("events.yaml", json.dumps({"events": events}))
        code, out, err = gridspace("simulate", network, "--events", events, "--signals", ",".join(signals), "--csv", table, "--quiet", *arguments)
        self.assertEqual(code, OK, out + err)
        rows = list(csv.reader(table.read_text().splitlines()))
        self.assertEqual(rows[0][1:], signals)
        return [[float(x) for x in row] for row in rows[1:]]

    def test_of_a_microgrid_in_phasors_with_set_points_coming_in_are_those_of_simulate(self):
        signals = ["bus.COLD.v_pu", "battery.STORE.p_kw", "battery.STORE.soc_percent", "generator.UTILITY.p_kw"]
        network, how = NETWORKS / "energy_microgrid.yaml", ("--solver", "phasor", "--step", "1", "--until", "600s")
        wanted = self.simulate(network, signals, {
            "store": {"at_s": 60, "set": {"batteries.STORE.p_kw": -30}}, "cold": {"at_s": 120, "set": {"loads.COMPRESSORS.p_kw": 20}},
            "off": {"at_s": 300, "disconnect": "TURBINE"}, "on": {"at_s": 420, "connect": "TURBINE"}}, *how)
        sut = self.begun(self.load(self.export(network, *how, "--signals", ",".join(signals))))
        for second in range(0, 600, 20):
            self.assertEqual(sut.get("time", *signals), wanted[second], second)
            sut.set("set_point.battery.STORE.p_kw", -30.0 if second >= 60 else 0.0)
            sut.set("set_point.load.COMPRESSORS.p_kw", 20.0 if second >= 120 else 5.0)
            sut.set("command.pv.TURBINE.connected", not 300 <= second < 420)
            self.assertEqual(sut.step(20), OK, sut.said)
        self.assertEqual(sut.get("time", *signals), wanted[600])
        self.assertNotEqual(wanted[600][2], wanted[0][2])

    def test_of_an_islanding_in_waveforms_are_those_of_simulate(self):
        signals = ["bus.SITE.v.a", "bus.SITE.frequency_hz", "battery.STORE.p_kw", "breaker.QP.position"]
        network, how = NETWORKS / "islanding_microgrid.yaml", ("--step", "1/24000", "--until", "1/5")
        wanted = self.simulate(network, signals, {"island": {"at_s": 0.05, "open": ["QP"]}, "shed": {"at_s": 0.1, "set": {"loads.HEATING.p_kw": 10}}}, *how)
        sut = self.begun(self.load(self.export(network, *how, "--signals", ",".join(signals))))
        for millisecond in range(200):
            self.assertEqual(sut.get(*signals), wanted[24 * millisecond][1:], millisecond)
            sut.set("command.breaker.QP.closed", millisecond < 50)
            sut.set("set_point.load.HEATING.p_kw", 10.0 if millisecond >= 100 else 40.0)
            self.assertEqual(sut.step(0.001), OK, sut.said)
        self.assertEqual((wanted[0][4], wanted[-1][4]), (2, 1))  # closed, open

    def test_of_a_governor_whose_mode_changes_are_those_of_simulate(self):
        signals = ["system.coi_hz", "machine.G1.p_kw"]
        network, how = NETWORKS / "adn_set_b_islanded.yaml", ("--solver", "phasor", "--step", "1/100", "--until", "2s")
        fmu = self.load(self.export(network, *how, "--signals", ",".join(signals)))
        modes = [i.get("name") for t in fmu.root.find("TypeDefinitions") if t.get("name") == "type.command.machine.G1.mode" for i in t]
        load = next(n for n in fmu.variables if re.fullmatch(r"set_point\.load\.\w+\.p_kw", n))
        more = 1.2 * float(fmu.variables[load].get("start"))
        wanted = self.simulate(network, signals, {"mode": {"at_s": 0.2, "mode": {"G1": "fixed_power"}},
                                                  "load": {"at_s": 0.4, "set": {f"loads.{load.split('.')[2]}.p_kw": more}}}, *how)
        sut = self.begun(fmu)
        for tenth in range(20):
            self.assertEqual(sut.get(*signals), wanted[10 * tenth][1:], tenth)
            sut.set("command.machine.G1.mode", modes.index("fixed_power") + 1 if tenth >= 2 else 1)
            if tenth >= 4:
                sut.set(load, more)
            self.assertEqual(sut.step(0.1), OK, sut.said)
        self.assertEqual(sut.get(*signals), wanted[-1][1:])
        self.assertEqual(sut.set("command.machine.G1.mode", len(modes) + 1), ERROR)
        self.assertIn(f"its modes are 1 to {len(modes)}: {', '.join(modes)}", sut.said[-1][2])

    def test_are_the_same_of_several_instances_in_threads_of_one_process_and_after_a_reset(self):
        fmu = self.load(self.export(NETWORKS / "islanding_microgrid.yaml", "--step", "1/24000", "--signals", "bus.SITE.v.*"))
        results = {}

        def run(instance, name, opens):
            values = []
            for _ in range(50):
                values.append(instance.get("bus.SITE.v.a", "bus.SITE.v.b"))
                instance.set("command.breaker.QP.closed", not opens)
                values.append(instance.step(0.001))
            results[name] = values

        instances = [self.begun(fmu) for _ in range(4)]
        threads = [threading.Thread(target=run, args=(sut, n, n % 2 == 1)) for n, sut in enumerate(instances)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results[0], results[2])
        self.assertEqual(results[1], results[3])
        self.assertNotEqual(results[0], results[1])
        self.assertEqual(instances[1].call("fmi3Reset"), OK)
        instances[1].time = 0.0
        self.assertEqual(instances[1].begin(), OK)
        run(instances[1], "again", False)
        self.assertEqual(results["again"], results[0])


class ItsFunctions(ExportTest):
    def setUp(self):
        super().setUp()
        self.fmu = self.load(self.export(NETWORKS / "house.yaml", "--solver", "phasor", "--step", "1"))

    def assert_said(self, instance, *words):
        status, category, message = instance.said[-1]
        self.assertEqual((status, category), (ERROR, "logStatusError"))
        for word in words:
            self.assertIn(word, message)

    def test_say_why_there_is_no_instance(self):
        for words, arguments in ((["instantiationToken is 'wrong'"], {"token": "wrong"}), (["nowhere/grid.yaml"], {"resources": "nowhere/"}),
                                 (["event mode"], {"event_mode": True})):
            refused = Instance(self.fmu, **arguments)
            self.assertIsNone(refused.handle)
            self.assert_said(refused, *words)
        self.assertEqual(self.fmu.c.fmi3GetVersion(), b"3.0")

    def test_refuse_a_communication_step_that_is_no_whole_number_of_steps(self):
        sut = self.begun(self.fmu)
        self.assertEqual(sut.step(2), OK)
        self.assertEqual(sut.step(0.5), ERROR)
        self.assert_said(sut, "the communication step of 0.5 s from 2 s on is no whole number of steps of 1 s")
        self.assertEqual(sut.step(1), ERROR)  # after an error only a reset helps
        self.assert_said(sut, "fmi3DoStep is called in the state of an error")
        self.assertEqual(sut.call("fmi3Reset"), OK)
        sut.time = 0.0
        self.assertEqual(sut.begin() or sut.step(1), OK)

    def test_refuse_another_time_than_the_present_and_a_start_that_is_not_0(self):
        sut = self.begun(self.fmu)
        self.assertEqual(sut.step(1, at=5.0), ERROR)
        self.assert_said(sut, "a step from 5 s was asked for, and it is 0 s")
        late = Instance(self.fmu)
        self.addCleanup(late.free)
        self.assertEqual(late.begin(start=3.0), ERROR)
        self.assert_said(late, "the start time is 3 s")

    def test_refuse_values_out_of_range_and_go_on(self):
        sut = self.begun(self.fmu)
        self.assertEqual(sut.set("set_point.pv.ROOF.irradiance_pu", -1.0), ERROR)
        self.assert_said(sut, "'set_point.pv.ROOF.irradiance_pu' cannot be -1", "expected >= 0")
        self.assertEqual(sut.set("set_point.battery.BAT1.p_kw", math.nan), ERROR)
        self.assertEqual(sut.set("bus.HOUSE.v_pu", 1.0), ERROR)
        self.assert_said(sut, "is no input")
        self.assertEqual(sut.set("set_point.battery.BAT1.p_kw", True), ERROR)
        self.assert_said(sut, "there is no Boolean with value reference")
        self.assertEqual(sut.step(1), OK)

    def test_say_what_the_solver_could_not_do_and_the_process_lives_on(self):
        sut, other = self.begun(self.fmu), self.begun(self.fmu)
        self.assertEqual(sut.set("set_point.load.HOME.p_kw", 5000.0), OK)  # more than the cable can carry
        self.assertEqual(sut.step(1), ERROR)
        self.assert_said(sut, "no consistent state at 0 s", "the last input that changed was set_point.load.HOME.p_kw = 5000 at 0 s")
        self.assertEqual(sut.get("bus.HOUSE.v_pu"), ERROR)
        self.assertEqual(sut.set("command.generator.GRID.connected", False), ERROR)
        self.assertEqual(other.set("command.generator.GRID.connected", False), OK)
        self.assertEqual(other.step(1), ERROR)  # the table of actions: with phasors one of role pq
        self.assert_said(other, "command.generator.GRID.connected: ")
        third = self.begun(self.fmu)
        self.assertEqual(third.step(1), OK)

    def test_that_are_not_there_say_so_and_those_in_the_wrong_order_too(self):
        sut = Instance(self.fmu)
        self.addCleanup(sut.free)
        self.assertEqual(sut.step(1), ERROR)
        self.assert_said(sut, "fmi3DoStep is called in the state of Instantiated")
        self.assertEqual(sut.get("bus.HOUSE.v_pu"), ERROR)
        self.assert_said(sut, "'bus.HOUSE.v_pu' is not known before the initialization")
        self.assertEqual(sut.begin(), OK)
        for function in ("fmi3GetFMUState", "fmi3EnterEventMode", "fmi3SetTime", "fmi3GetDirectionalDerivative"):
            self.assertEqual(sut.call(function, *[None] * 8), ERROR)
            self.assert_said(sut, f"{function} is not supported")
        self.assertEqual(sut.call("fmi3Terminate"), OK)
        self.assertEqual(sut.step(1), ERROR)
        self.assertIsNone(self.fmu.c.fmi3InstantiateModelExchange(b"", b"", b"", False, False, None, sut.log))
        self.assert_said(sut, "model exchange is not supported")
        self.assertEqual(self.fmu.c.fmi3Reset(None), ERROR)  # no instance


class AsAnAgent(ExportTest):
    """By our own importer, gridspace-fmu, in a process of its own beside the simulator of the same network."""

    def scenario(self, network, simulation, processes, **more):
        return self.write("scenario.yaml", json.dumps({
            "gridspace": 1, "name": "exported", "clock": {"mode": "lockstep", "speed": "max", "tick_s": more.pop("tick_s")},
            "simulation": {"network": str(network), **simulation},
            "hosts": {"simulator": {"links": ["net"]}, "controller": {"links": ["net"]}},
            "links": {"net": {"kind": "switch", "ipv4": "10.40.0.0/24"}},
            "processes": {"sim": {"program": "gridspace-sim", "host": "simulator", "qos": "simulator"},
                          "recorder": {"program": "gridspace-recorder", "host": "simulator", "qos": "recorder"}, **processes},
            "record": {"samples": "all"}, **more}))

    def assert_same_signals(self, run, names, at_least):
        opened = package.open(run.folder)
        for name in names:
            ours, theirs = ({round(t * 1e6): v for t, v in zip(s.time_s, s.values)} for s in (opened.signal(name), opened.signal(f"agent.grid.{name}")))
            common = sorted(set(ours) & set(theirs))
            self.assertGreaterEqual(len(common), at_least, name)
            self.assertEqual([ours[t] for t in common], [theirs[t] for t in common], name)
            self.assertGreater(len({ours[t] for t in common}), 1, f"{name} changes")

    def test_a_house_in_phasors_with_set_points_from_another_agent_has_the_bits_of_the_simulator(self):
        house, epoch = NETWORKS / "house.yaml", "2019-12-01T09:00:00Z"
        grid = self.export(house, "--solver", "phasor", "--step", "1", "--epoch", epoch)
        signals = ["bus.HOUSE.v_pu", "bus.HOUSE.frequency_hz", "battery.BAT1.p_kw", "battery.BAT1.soc_percent", "pv.ROOF.p_kw", "generator.GRID.p_kw"]
        run = self.run_to_end("run", [], self.scenario(house, {
            "solver": "phasor", "step_s": 1, "duration_s": 120, "epoch": epoch, "gateways": "per_bus", "controls": {"battery.BAT1.p_kw": {"from": "lag"}}}, {
            "lag": {"program": "gridspace-fmu", "host": "controller", "fmu": str(LAG), "period_s": 1, "latency_us": 1000000, "start": {"tau": 60, "u": 4, "y": 1},
                    "outputs": {"battery": {"set_point": "battery.BAT1.p_kw", "from": "y"}}},
            "grid": {"program": "gridspace-fmu", "host": "controller", "fmu": str(grid), "period_s": 1, "latency_us": 1000000, "watch": signals,
                     "inputs": {"battery": {"topic": "set_points", "type": "SetPoint", "where": {"element": "battery.BAT1", "quantity": "p_kw"},
                                            "fields": {"set_point.battery.BAT1.p_kw": "value"}}}}}, tick_s=1))
        self.assert_same_signals(run, signals[:1] + signals[2:], 119)

    def test_a_microgrid_in_waveforms_that_is_islanded_has_the_bits_of_the_simulator(self):
        network = NETWORKS / "islanding_microgrid.yaml"
        signals = ["bus.SITE.v.a", "bus.SITE.v_pu", "bus.SITE.frequency_hz", "battery.STORE.p_kw"]
        grid = self.export(network, "--step", "1/20000", "--signals", ",".join(signals), "--inputs", "command.breaker.*")
        run = self.run_to_end("run", [], self.scenario(network, {"solver": "emt", "step_s": 0.00005, "duration_s": 0.2}, {
            "grid": {"program": "gridspace-fmu", "host": "controller", "fmu": str(grid), "period_s": 0.001, "latency_us": 1000, "watch": signals,
                     "start": {"command.breaker.QP.closed": False}}}, tick_s=0.001, events={"island": {"at_s": 0, "open": ["QP"]}}))
        self.assert_same_signals(run, signals, 190)


if __name__ == "__main__":
    unittest.main()
