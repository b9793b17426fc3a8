# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Other people's grids, and what nobody should write: every run ends with numbers, or with exit code 2 and a message that names
the element (and the time, when it has begun). Never a NaN in a table, never a signal, never another exit code."""
import csv
import itertools
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).parents[3]))
SET_A = SOURCE / "configs/networks/adn_set_a.yaml"
FAULTS = ("3ph_g", "3ph", "1ph_g", "2ph", "2ph_g")

BASE = """gridspace_network: 1
name: t
base: {{frequency_hz: {hz}, power_kva: 1000}}
buses: {{A: {{voltage_v: 20000}}, B: {{voltage_v: 20000}}, C: {{voltage_v: 400}}}}
sources: {{S: {{bus: A, r_ohm: {rs}, l_mh: {ls}}}}}
breaker_types: {{cb: {{mechanism_ms: 2}}}}
lines: {{L: {{from: A, to: B, r_ohm: {r}, l_mh: {l}, c_nf: {c}}}}}
breakers: {{CB: {{line: L, end: from, type: cb}}}}
transformers: {{T: {{from: B, to: C, rating_kva: 400, r_percent: 1, x_percent: 4, from_winding: delta, phase_shift_deg: 30}}}}
loads: {{D: {{bus: C, p_kw: {p}, power_factor: 0.9, model: {model}}}}}
"""
USUAL = {"hz": 50, "rs": 0.1, "ls": 5, "r": 1, "l": 3, "c": 20, "p": 100, "model": "constant_impedance"}


class Hostile(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def run_network(self, text, *arguments, events=None, solver="emt", until="0.06s", signals=None):
        """Exit code, message, and the rows of the table."""
        network = text if isinstance(text, pathlib.Path) else self.folder / "n.yaml"
        if network is not text:
            network.write_text(text)
        usual = ["bus.*", "line.*", "load.*", "source.*", "breaker.*"] + (["machine.*"] if "machines:" in network.read_text() else [])
        table = self.folder / "out.csv"
        table.unlink(missing_ok=True)
        more = []
        if events:
            (self.folder / "e.yaml").write_text(events)
            more = ["--events", self.folder / "e.yaml"]
        command = [BIN, "simulate", network, "--solver", solver, "--until", until, "--quiet", "--every", "7", "--csv", table,
                   "--signals", signals or ",".join(usual), *more, *arguments]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=120, check=False)
        self.assertIn(done.returncode, (0, 2), f"{done.returncode}: {done.stderr}")
        rows = []
        if table.exists():
            for row in itertools.islice(csv.reader(table.open()), 1, None):
                for cell in row:
                    self.assertTrue(cell == "" or math.isfinite(float(cell)), f"'{cell}' in the table: {done.stderr}")
                rows.append(row)
        if done.returncode == 2:
            self.assertRegex(done.stderr, "error: ", text)
            said = [line for line in done.stderr.lower().splitlines() if line.startswith("error: ")]  # not what quotes the file
            self.assertNotRegex("\n".join(said), r"\bnan\b|\binf\b")
        else:
            self.assertGreater(len(rows), 3)
        return done.returncode, done.stderr, rows

    def refused(self, pattern, text, *arguments, **more):
        code, err, _ = self.run_network(text, *arguments, **more)
        self.assertEqual(code, 2, "accepted")
        self.assertRegex(err, pattern)

    def test_faults_of_every_type_at_every_place_and_resistance(self):
        for kind, place, ohm in itertools.chain(
                ((k, p, 0.01) for k in FAULTS for p in (0, 1, 50, 99, 100)),
                ((k, 37, r) for k in ("3ph_g", "1ph_g") for r in (0, 1e-9, 1, 100, 1e9)),
                (("1ph_g", p, 0) for p in (1e-9, 1e-3, 99.9999999))):
            with self.subTest(kind=kind, place=place, ohm=ohm):
                code, err, _ = self.run_network(SET_A, until="0.05s", events=(
                    f"events:\n  f: {{at_s: 0.01, apply_fault: {{line: TL2, position_percent: {place}, type: {kind}, "
                    f"resistance_ohm: {ohm}}}, clear_after_ms: 15}}\n  t: {{at_s: 0.015, open: [CB3, CB4]}}\n"))
                self.assertEqual(code, 0, err)

    def test_phasor_faults_of_every_type_at_every_place(self):
        for kind, place, ohm in itertools.product(FAULTS, (0, 1, 99, 100), (0, 100)):
            with self.subTest(kind=kind, place=place, ohm=ohm):
                code, err, _ = self.run_network(SOURCE / "configs/networks/adn_set_b.yaml", solver="phasor", until="0.1s", events=(
                    f"events:\n  f: {{at_s: 0.01, apply_fault: {{line: TL2, position_percent: {place}, type: {kind}, "
                    f"resistance_ohm: {ohm}}}, clear_after_ms: 15}}\n  t: {{at_s: 0.015, open: [CB3, CB4]}}\n"))
                self.assertEqual(code, 0, err)

    def test_two_faults_at_once_and_one_after_the_other(self):
        events = ("events:\n  f: {at_s: 0.01, apply_fault: {line: TL2, position_percent: 20, type: 1ph_g}, clear_after_ms: 20}\n"
                  "  g: {at_s: 0.012, apply_fault: {line: TL2, position_percent: 80, type: 2ph}, clear_after_ms: 3}\n"
                  "  h: {at_s: 0.012, apply_fault: {bus: B4, type: 3ph, resistance_ohm: 0.1}}\n"
                  "  i: {at_s: 0.03, apply_fault: {line: TL2, position_percent: 20, type: 2ph_g}}\n")
        self.assertEqual(self.run_network(SET_A, events=events, until="0.05s")[0], 0)
        self.refused(r"faults 'f' and 'g' .* one of them is unbalanced", SOURCE / "configs/networks/adn_set_b.yaml",
                     events=events, solver="phasor")

    def test_other_inertias_frequencies_and_sizes(self):
        text = SET_A.read_text()
        for old, new in (("inertia_h_s: 2.0", "inertia_h_s: 0.05"), ("inertia_h_s: 2.0", "inertia_h_s: 1000"),
                         ("frequency_hz: 60", "frequency_hz: 50"), ("frequency_hz: 60", "frequency_hz: 16.7"),
                         ("frequency_hz: 60", "frequency_hz: 400"), ("power_kva: 10}", "power_kva: 0.001}"),
                         ("power_kva: 10}", "power_kva: 1e9}")):
            with self.subTest(new=new):
                self.assertIn(old, text)
                code, err, _ = self.run_network(text.replace(old, new), until="0.05s", events=(
                    "events:\n  f: {at_s: 0.01, apply_fault: {line: TL2, type: 3ph_g, resistance_ohm: 0.01}, clear_after_ms: 20}\n"))
                self.assertEqual(code, 0, err)

    def test_tiny_and_huge_values_give_numbers_or_a_message(self):
        values = {"hz": (1, 1e-6, 1000, 1e7, 1e300), "rs": (0, 1e-12, 1e-300, 1e12), "ls": (0, 1e-12, 1e9, 1e300),
                  "r": (0, 1e-9, 1e-300, 1e9, 1e300), "l": (0, 1e-9, 1e9, 1e300), "c": (0, 1e-9, 1e9, 1e30, 1e300),
                  "p": (0, 1e-12, -100, 1e9, 1e300), "model": ("constant_power", "constant_current", "dc_constant_power")}
        for key, several in values.items():
            for value in several:
                for solver in ("emt", "phasor"):
                    with self.subTest(key=key, value=value, solver=solver):
                        text = BASE.format(**{**USUAL, key: value})
                        if value == "dc_constant_power":
                            text = text.replace("power_factor: 0.9, ", "")
                        self.run_network(text, solver=solver, until="0.03s", events="events: {t: {at_s: 0.01, open: [CB]}}\n")

    def test_values_that_are_no_numbers_are_refused_with_their_place(self):
        for word in (".nan", ".inf", "-.inf", "nan", "1e999", "''", "1,5"):
            with self.subTest(word=word):
                self.refused(r"n\.yaml:7:\d+: error: ", BASE.format(**{**USUAL, "r": word}))

    def test_what_has_no_solution_is_named(self):
        cases = [
            (r"line 'L' has 1e-09 ohm, too little", BASE.format(**{**USUAL, "r": "1e-9", "l": 0})),
            (r"line 'L' has no impedance", BASE.format(**{**USUAL, "r": 0, "l": 0})),
            (r"l_mh.* -3|-3.* l_mh|l_mh is -3", BASE.format(**{**USUAL, "l": -3})),
            (r"bus 'Z' is islanded", BASE.format(**USUAL).replace("buses: {", "buses: {Z: {voltage_v: 400}, ")),
            (r"source 'X' holds the voltage of bus 'A', which source 'S' already does",
             BASE.format(**USUAL).replace("sources: {S: {bus: A, r_ohm: 0.1, l_mh: 5}}", "sources: {S: {bus: A}, X: {bus: A}}")),
        ]
        for pattern, text in cases:
            for solver in ("emt", "phasor"):
                with self.subTest(pattern=pattern, solver=solver):
                    self.refused(pattern, text, solver=solver)

    def test_a_part_without_earth_is_refused_by_both_solvers(self):
        text = BASE.format(**USUAL).replace("from_winding: delta, phase_shift_deg: 30", "from_winding: delta, to_winding: delta")
        text = text.replace("loads: {D: {bus: C,", "loads: {D: {bus: B,")
        for solver in ("emt", "phasor"):
            self.refused(r"nothing connects bus 'C'.* to earth", text, solver=solver)

    def test_a_breaker_that_closes_between_ideal_sources_is_named_with_the_time(self):
        # A line cannot be without impedance, so an ideal source behind a breaker needs an open line's far end: its own bus.
        text = """gridspace_network: 1
name: t
base: {frequency_hz: 50, power_kva: 1000}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}
sources: {S: {bus: A}, X: {bus: B, angle_deg: 10}}
lines: {L: {from: A, to: B, r_ohm: 0.5}}
breaker_types: {cb: {}}
breakers: {CB: {line: L, end: from, type: cb, state: open}}
loads: {D: {bus: A, p_kw: 1, model: constant_impedance}}
"""
        code, err, rows = self.run_network(text, events="events: {c: {at_s: 0.02, close: [CB]}}\n", signals="line.L.from.i_a")
        self.assertEqual(code, 0, err)  # 0.5 ohm between them: a current, and no mistake
        self.assertAlmostEqual(float(rows[-1][1]), 2 * math.sin(math.radians(5)) * 400 / math.sqrt(3) / 0.5, delta=0.1)

    def test_a_step_that_is_too_long_is_refused(self):
        text = BASE.format(**USUAL)
        self.refused(r"a step of 0\.005 s is too long for 50 Hz", text, "--step", "1/200")
        line = text.replace("c_nf: 20}", "c_nf: 20, model: bergeron}")
        self.refused(r"line 'L': a wave travels along it in .* us, less than a step", line)

    def test_a_machine_that_runs_away_ends_the_run_with_its_name_and_the_time(self):
        text = SET_A.read_text().replace("inertia_h_s: 2.0", "inertia_h_s: 0.002").replace(
            "governor: {droop_percent: 4, tg_s: 0.05, tt_s: 0.15, integral_ki: 0}", "governor: {droop_percent: 1000, tg_s: 5, tt_s: 5}")
        self.refused(r"(machine 'G\d' runs away|diverge) at \d.*s", text, until="3s", signals="machine.*", events=(
            "events:\n  d: {at_s: 0.01, open: [CB1, CB3, CB5]}\n  l: {at_s: 0.05, disconnect: AC4}\n"))

    def test_the_time_of_an_opening_is_an_empty_cell_before_it(self):
        _, _, rows = self.run_network(SET_A, until="0.03s", signals="breaker.CB3.opened_s",
                                      events="events: {t: {at_s: 0.01, open: [CB3]}}\n")
        self.assertEqual(rows[0][1], "")
        self.assertAlmostEqual(float(rows[-1][1]), 0.014, delta=0.007)

    def test_a_stuck_breaker_stays_closed_in_both_solvers(self):
        events = "events: {s: {at_s: 0.005, fail_to_open: [CB3]}, t: {at_s: 0.01, open: [CB3, CB4]}}\n"
        for solver in ("emt", "phasor"):
            _, _, rows = self.run_network(SET_A, solver=solver, signals="breaker.CB3.position,breaker.CB4.position", events=events)
            self.assertEqual([float(x) for x in rows[-1][1:]], [2, 1], solver)  # CB4 is not stuck

    def test_events_of_merging_units_have_nothing_to_act_on_here(self):
        self.refused("there are no merging units here", SET_A, events="events: {d: {at_s: 0.01, desynchronise: mu21}}\n")

    def test_an_event_after_the_end_is_pointed_out(self):
        code, err, _ = self.run_network(SET_A, until="0.01s", events="events: {late: {at_s: 9, open: [CB3]}}\n")
        self.assertEqual(code, 0)
        self.assertIn("event 'late' at 9 s comes after the end", err)


if __name__ == "__main__":
    unittest.main()
