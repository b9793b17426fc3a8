#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""An agent in Python is a member like ours: the same run, the same times, and its mistakes end the run with its own words."""
import json
import pathlib
import sys
import tempfile
import textwrap
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scenario"))
from harness import BASE, BIN, CHILD_DIED, ENVIRONMENT, INTERRUPTED, OK, SOURCE, USAGE, ScenarioTest, gridspace  # noqa: E402

EXAMPLE = SOURCE / "examples/agents/python_ev_agent"
NO_EXPECTATIONS = [*BASE, "--set", "expect=~"]
SHORT = [*NO_EXPECTATIONS, "--until", "2h"]

WEATHER = """
module station {
    enum Sky { CLEAR, CLOUDY };
    @final struct Layer { double height_m; float speed; octet quality; };
    @final struct Weather { @key string<8> place; long long time_ns; Sky sky; sequence<double> curve; sequence<Layer, 8> layers; double pair[2]; };
};
"""


class Agents(ScenarioTest):
    def script(self, name, body):
        text = "#!/usr/bin/env python3\nimport gridspace\nfrom gridspace import Reads, Setting, Signal, Writes\n" + textwrap.dedent(body)
        file = self.write(name, text + f"\nif __name__ == '__main__':\n    {text.rpartition('class ')[2].partition('(')[0]}.main()\n")
        file.chmod(0o755)
        return file

    def scenario(self, **processes):
        return self.write("own.yaml", json.dumps({"extends": str(SOURCE / "configs/scenarios/ev_charging.yaml"), "processes": processes}))

    def message_of(self, body, expected_code=CHILD_DIED, **settings):
        """Runs an agent that makes a mistake beside case 1; what the run says."""
        agent = {"program": {"path": str(self.script("wrong.py", body))}, "host": "controller", **settings}
        self.tried = getattr(self, "tried", 0) + 1
        run = self.run_to_end(f"wrong_{self.tried}", [*NO_EXPECTATIONS, "--until", "20min"], self.scenario(wrong=agent), expected_code)
        self.log = (run.folder / "logs/wrong.log").read_text()
        self.others = {p["exit"] for p in run.summary()["processes"] if p["name"] != "wrong"}
        return run.summary().get("cause")

    def test_its_run_is_the_same_as_ours_octet_for_octet(self):
        ours = self.run_to_end("ours", SHORT)
        python = self.run_to_end("python", SHORT, EXAMPLE / "ev_charging_python.yaml")
        self.assert_identical(ours, python)
        other = self.run_to_end("other", [*SHORT, "--set", "processes.ev4.requested_h=6"], EXAMPLE / "ev_charging_python.yaml")
        self.assertNotEqual(self.compare(ours, other)[0], OK, "another wish is another result")

    def test_it_survives_its_own_restart_and_that_of_its_reader(self):
        arguments = [*SHORT, "--set", "events={x: {at_s: 1800, restart: ev4}, y: {at_s: 3000, restart: mcca}, z: {at_s: 4000, kill: ev2}}"]
        self.assert_identical(self.run_to_end("ours", arguments), self.run_to_end("python", arguments, EXAMPLE / "ev_charging_python.yaml"))

    def test_a_sample_of_the_simulator_that_triggers_is_answered_in_its_tick(self):
        agent = {"program": {"path": str(self.script("watch.py", '''
            class Watch(gridspace.Agent):
                measured = Reads("bus_measurements", "BusMeasurement", triggers=True)
                seen_s = Signal("agent.{process}.seen_s", "s", rate_hz=1)
                def on_measured(self, sample):
                    self.seen_s = sample.time_ns / 1e9
        '''))}, "host": "controller"}
        run = self.run_to_end("watch", [*NO_EXPECTATIONS, "--until", "20s"], self.scenario(watch=agent))
        code, out, err = gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, OK, err)
        header, *rows = next(p.read_text() for p in map(pathlib.Path, out.split()) if "agent.watch.seen_s" in p.read_text()).splitlines()
        column = header.split(",").index("agent.watch.seen_s")
        told = [(float(row.split(",")[0]), float(row.split(",")[column])) for row in rows if row.split(",")[column]]
        self.assertEqual(sorted(set(told)), [(float(s), float(s)) for s in range(21)])

    def test_samples_that_it_does_not_want_do_not_come(self):
        agent = """
            class Wrong(gridspace.Agent):
                buses = Setting("names")
                measured = Reads("bus_measurements", "BusMeasurement", only={"bus": "{buses}"})
                def begin(self):
                    self.seen = set()
                def on_measured(self, sample):
                    self.seen.add(sample.bus)
                def end(self):
                    raise ValueError(f"came: {sorted(self.seen)}")
        """
        self.assertEqual(self.message_of(agent, buses=["B1", "B3"]), "wrong: ValueError: came: ['B1', 'B3'] (wrong.py:13 in end)")
        self.assertEqual(self.message_of(agent.replace('"bus":', '"place":'), buses=["B1"], expected_code=USAGE),
                         "wrong: topic 'bus_measurements': `only` names 'place', and BusMeasurement has no text of that name")

    def test_it_takes_part_in_real_time(self):
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--set", "clock.mode=realtime", "--speed", "900", "--until", "1h"],
                              EXAMPLE / "ev_charging_python.yaml")
        code, out, err = gridspace("export", run.folder, "--csv", "--out", run.folder / "csv")
        self.assertEqual(code, OK, err)
        header, *rows = next(p.read_text() for p in map(pathlib.Path, out.split()) if "agent.ev4.requested_a" in p.read_text()).splitlines()
        column = header.split(",").index("agent.ev4.requested_a")
        self.assertGreaterEqual(sum(bool(row.split(",")[column]) for row in rows), 9, "an hour has ten periods; the last may be beyond the end")

    def test_an_exception_in_a_tick_ends_the_run_with_its_words(self):
        said = self.message_of("""
            class Wrong(gridspace.Agent):
                def begin(self):
                    self.every(60, self.work)
                def work(self):
                    if self.now_s == 600:
                        raise LookupError("no price for 00:10")
        """)
        self.assertEqual(said, "wrong: LookupError: no price for 00:10 (wrong.py:10 in work)")
        self.assertIn("Traceback (most recent call last)", self.log)
        self.assertIn('raise LookupError("no price for 00:10")', self.log)
        self.assertLessEqual(self.others, {OK, INTERRUPTED}, "all ended of themselves, none had to be killed")

    def test_an_exception_at_the_end_is_the_end_of_the_run_too(self):
        said = self.message_of("""
            class Wrong(gridspace.Agent):
                def end(self):
                    raise OSError("the results cannot be written")
        """)
        self.assertEqual(said, "wrong: OSError: the results cannot be written (wrong.py:7 in end)")

    def test_a_name_that_means_something_of_every_agent_is_refused(self):
        agent = self.script("wrong.py", """
            class Wrong(gridspace.Agent):
                settings = Setting("text", "a")
        """)
        code, out, err = gridspace("validate", self.scenario(wrong={"program": {"path": str(agent)}, "host": "controller"}))
        self.assertEqual(code, USAGE)
        self.assertIn("TypeError: Wrong.settings: an agent has that attribute already; give it another name", out + err)

    def test_what_a_sample_cannot_hold_is_said_by_its_member(self):
        mistakes = {
            "self.extra(ev='E', current_a='12 A')": "TypeError: ChargingRequest.current_a is a number (double), and not a str, '12 A'",
            "self.extra(ev='E', current_a=float('nan'))": "ValueError: ChargingRequest.current_a is nan, which is not finite",
            "self.extra(ev='E' * 33)": "ValueError: ChargingRequest.ev has 33 characters, and at most 32 fit",
            "self.extra(ev='E', curent_a=1)": "AttributeError: ChargingRequest has no member 'curent_a'; did you mean 'current_a'?",
            "self.extra(ev=7)": "TypeError: ChargingRequest.ev is a text, and not an int, 7",
            "self.extra.write(gridspace.sample_type('BusMeasurement')())": "TypeError: a BusMeasurement was written, and the topic has ChargingRequest",
            "__import__('concurrent.futures').futures.ThreadPoolExecutor(1).submit(self.extra, ev='E').result()":
                "ValueError: called on another thread than the one that calls the agent; hand it over, and call it in a callback, of a timer for example",
            "self.level = float('inf')": "ValueError: the signal 'agent.{process}.level' is inf, which is not finite",
            "self.every(0, self.begin)": "ValueError: a timer every '0' s: expected a number of seconds, at least the 1 s that time is counted in; "
                                         '"60", "0.25" or "1/4800"',
            "gridspace.sample_type('Whether')": "Error: 'Whether' is no type of Gridspace; name the file that defines it: `idl` beside the topic",
        }
        self.message_of(f"""
            class Wrong(gridspace.Agent):
                extra = Writes("extra", "ChargingRequest", optional=True)
                level = Signal("agent.{{process}}.level")
                def begin(self):
                    for code in {list(mistakes)!r}:
                        try:
                            eval(code) if " = " not in code.partition("(")[0] else exec(code)
                        except Exception as e:
                            print(f"{{code}} -> {{type(e).__name__}}: {{e}}")
        """, OK)
        self.assertEqual([line for line in self.log.splitlines() if " -> " in line], [f"{code} -> {said}" for code, said in mistakes.items()])

    def test_another_idl_for_a_type_of_ours_is_refused_before_anything_starts(self):
        self.write("other.idl", "@final struct BusMeasurement { string<2> bus; long long time_ns; };")
        agent = self.script("wrong.py", """
            class Wrong(gridspace.Agent):
                measurements = Reads("bus_measurements", "BusMeasurement", idl="other.idl")
        """)
        code, out, err = gridspace("validate", self.scenario(wrong={"program": {"path": str(agent)}, "host": "controller"}))
        self.assertEqual(code, USAGE)
        self.assertIn("'BusMeasurement' is a type of Gridspace, and '", out + err)

    def test_a_mistake_in_what_it_says_of_itself_is_shown_by_line_and_column(self):
        agent = self.script("wrong.py", """
            class Wrong(gridspace.Agent):
                level = Setting("numbr", 3)
        """)
        code, out, err = gridspace("validate", self.scenario(wrong={"program": {"path": str(agent)}, "host": "controller"}))
        self.assertEqual(code, USAGE)
        self.assertRegex(out + err, r"wrong\.py --describe:\d+:\d+: error: 'numbr' is no kind of setting")

    def test_types_of_its_own_and_views_of_their_sequences(self):
        self.write("weather.idl", WEATHER)
        source = self.script("station.py", """
            class Station(gridspace.Agent):
                weather = Writes("weather", "station::Weather", idl="weather.idl")
                def begin(self):
                    self.every(60, self.work)
                def work(self):
                    self.weather(place="N", sky="CLOUDY", curve=[self.now_s, 1, 2], pair=(3, 4), layers=[{"height_m": 10, "speed": 2.5, "quality": 7}] * 2)
        """)
        reader = self.script("reader.py", """
            class Reader(gridspace.Agent):
                weather = Reads("weather", "station::Weather", idl="weather.idl", triggers=True)
                def begin(self):
                    self.kept = []
                def on_weather(self, w):
                    self.kept.append(w)
                def end(self):
                    first, second = self.kept[:2]     # views of memory that is still theirs
                    assert (first.place, first.sky.name, list(first.curve), second.curve[0]) == ("N", "CLOUDY", [0, 1, 2], 60), first
                    assert [*first.pair] == [3, 4] and first.layers[1].speed == 2.5 and first.layers[-1].to_dict()["quality"] == 7, first
                    assert first.time_ns == 0 and second.time_ns == 60_000_000_000
                    try:
                        import numpy
                    except ImportError:
                        return print("no numpy here")
                    curve, layers = numpy.asarray(first.curve), numpy.asarray(second.layers)
                    assert curve.dtype == float and not curve.flags.owndata and curve.sum() == 3
                    assert layers["height_m"].tolist() == [10, 10] and layers["speed"].dtype == "f4"
                    del self.kept, first, second
                    assert curve[2] == 2
        """)
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--until", "3min"], self.scenario(
            station={"program": {"path": str(source)}, "host": "controller"}, reader={"program": {"path": str(reader)}, "host": "controller"}))
        self.assertNotIn("Traceback", (run.folder / "logs/reader.log").read_text())
        self.assertEqual({t["name"]: t["samples"] for t in run.summary()["topics"]}["weather"], 4)

    def test_two_processes_of_one_class_have_their_own_settings_and_signals(self):
        program = {"path": str(self.script("twin.py", """
            class Twin(gridspace.Agent):
                period_s = Setting("fraction", above=0, doc="period")
                measured = Reads("bus_measurements", "BusMeasurement")
                seen = Signal("agent.{process}.seen")
                def begin(self):
                    self.count = 0
                    self.every(self.period_s, self.show)
                def on_measured(self, sample):
                    self.count += 1
                def show(self):
                    self.seen = self.count
                def end(self):
                    print(f"{self.process} every {self.period_s} s: {self.count}")
        """))}
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--until", "3min"], self.scenario(
            first={"program": program, "host": "controller", "period_s": 60}, second={"program": program, "host": "board1", "period_s": 45}))
        self.assertEqual([(run.folder / f"logs/{name}.log").read_text().strip() for name in ("first", "second")],
                         ["first every 60 s: 724", "second every 45 s: 724"], "four buses, each second, the first and the last as well")

    def test_a_signal_of_several_names_has_a_value_for_each_and_the_next_one_its_own(self):
        source = self.script("several.py", """
            class Several(gridspace.Agent):
                cars = Setting("names", doc="cars")
                spare = Setting("name", required=False, doc="not given")
                v = Signal("agent.{process}[.{cars}].v_pu")
                other = Signal("agent.{process}.{spare}.x")
                last = Signal("agent.{process}.last")
                def begin(self):
                    for number, car in enumerate(self.cars):
                        self.v[car] = 1 + number
                    self.last = 9
                    assert self.v == {"EV1": 1, "EV2": 2} and self.last == 9
                    for wrong in ("self.v = 1", "self.v['EV7'] = 1", "self.other = 1"):
                        try:
                            exec(wrong)
                            raise AssertionError(wrong)
                        except (ValueError, KeyError) as e:
                            print(e)
        """)
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--until", "2min"], self.scenario(
            several={"program": {"path": str(source)}, "host": "controller", "cars": ["EV1", "EV2"]}))
        sys.path.insert(0, str(SOURCE / "python"))
        import gridspace as package
        signals = {name: signal.values[-1] for name, signal in package.open(run.folder).signals("agent.several.*").items()}
        self.assertEqual(signals, {"agent.several.EV1.v_pu": 1, "agent.several.EV2.v_pu": 2, "agent.several.last": 9})
        said = (run.folder / "logs/several.log").read_text()
        for words in ("is several signals, set one of them: self.v['EV1'], self.v['EV2']", "no signal for 'EV7'", "no signal here"):
            self.assertIn(words, said)

    def test_a_sample_of_another_idl_than_was_said_ends_the_run(self):
        self.write("weather.idl", WEATHER)
        self.write("other.idl", "module station { @final struct Weather { @key string<8> place; long long time_ns; octet sky; }; };")
        source = self.script("station.py", """
            import sys
            class Station(gridspace.Agent):
                weather = Writes("weather", "station::Weather", idl="weather.idl" if "--describe" in sys.argv else "other.idl")
                def begin(self):
                    self.at(60, lambda: self.weather(place="N"))
        """)
        reader = self.script("reader.py", """
            class Reader(gridspace.Agent):
                weather = Reads("weather", "station::Weather", idl="weather.idl", triggers=True)
        """)
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--until", "3min"], self.scenario(
            station={"program": {"path": str(source)}, "host": "controller"}, reader={"program": {"path": str(reader)}, "host": "controller"}), ENVIRONMENT)
        self.assertEqual(run.summary()["cause"], "reader: a sample of 'weather' from station cannot be decoded")

    def test_a_file_is_found_from_the_file_that_names_it(self):
        self.script("reader.py", """
            class Reader(gridspace.Agent):
                prices = Setting("file", doc="prices")
                def begin(self):
                    print("read:", open(self.prices).read())
        """)
        (self.folder / "data").mkdir()
        self.write("data/prices.csv", "0.30")
        scenario = self.write("data/own.yaml", json.dumps({"extends": str(SOURCE / "configs/scenarios/ev_charging.yaml"), "processes": {
            "reader": {"program": {"path": "../reader.py"}, "host": "controller", "prices": "prices.csv"}}}))
        run = self.run_to_end("run", [*NO_EXPECTATIONS, "--until", "1min"], scenario)
        self.assertIn("read: 0.30", (run.folder / "logs/reader.log").read_text())


class WithoutARun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        sys.path[:0] = [str(SOURCE / "python"), str(EXAMPLE)]
        import ev_agent
        cls.agent_type = ev_agent.EvAgent

    def test_an_agent_is_tried_without_a_run(self):
        from gridspace.types import BusMeasurement
        sut = self.agent_type(ev="EV1", bus="B1")
        sut.begin()
        sut.on_measurements(BusMeasurement(bus="B1", v_pu=0.97, evs=[{"ev": "EV1", "soc_percent": 79}]))
        sut.now_s = 3600
        sut.ask()
        self.assertAlmostEqual(sut.requests.sent[0].current_a, 0.01 * 24e3 / (3 * 360))
        self.assertEqual(sut.v_pu, 0.97)
        with self.assertRaisesRegex(TypeError, "EvAgent has no setting 'colour'"):
            self.agent_type(colour="red")

    def test_a_list_of_the_wrong_length_or_shape_is_said_by_its_member(self):
        import gridspace
        with tempfile.TemporaryDirectory() as folder:
            idl = pathlib.Path(folder) / "weather.idl"
            idl.write_text(WEATHER)
            weather = gridspace.sample_type("station::Weather", idl)

        class Table:  # as numpy's arrays of two dimensions are: their items have __float__
            ndim = 1

            def __float__(self):
                return 1.0

        for given, expected in (({"pair": (1, 2, 3)}, "Weather.pair holds 2 items, and not 3"), ({"pair": []}, "Weather.pair holds 2 items, and not 0"),
                                ({"pair": 5}, "Weather.pair is a list, and not an int, 5"), ({"layers": [{}] * 9}, "Weather.layers holds at most 8 items, and not 9"),
                                ({"layers": [5]}, "Weather.layers.* is a Layer, and not an int, 5"), ({"curve": [Table()]}, "Weather.curve.* is a number"),
                                ({"curve": [1, "a"]}, "Weather.curve.* is a number .*, and not a str, 'a'")):
            with self.subTest(given), self.assertRaisesRegex((TypeError, ValueError), expected):
                weather(**given)

    def test_an_unknown_type_is_named(self):
        import gridspace
        with self.assertRaisesRegex(gridspace.Error, "'Whether' is no type of Gridspace"):
            gridspace.sample_type("Whether")

    def test_the_library_that_is_loaded_is_that_of_the_programs(self):
        from gridspace import library
        self.assertEqual(pathlib.Path(library.load()._name).parent, BIN.resolve().parent / "lib")


if __name__ == "__main__":
    unittest.main()
