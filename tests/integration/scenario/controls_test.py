#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Agents steer the grid as `simulation.controls` allows: a battery by an agent in Python, whose refusals and whose loss are events."""
import json
import textwrap
import unittest

from harness import EXPECTATION, SOURCE, ScenarioTest

EXAMPLE = SOURCE / "examples/agents/python_battery_agent/self_consumption.yaml"
GOOSE = SOURCE / "configs/scenarios/goose_steers_a_battery.yaml"

# Asks for one thing after the other, a second each; what is wrong with it is in the events.
PROGRAM = """#!/usr/bin/env python3
import gridspace
from gridspace import Setting, Writes

class Asking(gridspace.Agent):
    latency_us = Setting("fraction", 1_000_000, min=0, latency=True, doc="in lockstep")
    set_points = Writes("set_points", "SetPoint")
    commands = Writes("commands", "ElementCommand")

    def begin(self):
        asks = [
            lambda: self.set_points(element="battery.BAT1", quantity="p_kw", value=3),
            lambda: self.set_points(element="battery.BAT1", quantity="p_kw", value=9, source="market"),
            lambda: self.set_points(element="battery.BAT1", quantity="p_kw", value=2, valid_for_s=-1),
            lambda: self.set_points(element="battery.BAT9", quantity="p_kw", value=1),
            lambda: self.set_points(element="pv.ROOF", quantity="p_limit_kw", value=1),
            lambda: self.set_points(element="load.HOME", quantity="demand_pu", value=2),
            lambda: self.commands(element="shunt_capacitor.BANK", command="COMMAND_CLOSE"),
            lambda: self.commands(element="breaker.CB", command="COMMAND_CLOSE"),
            lambda: self.commands(element="pv.ROOF", command="COMMAND_RESET"),
            lambda: self.commands(element="pv.ROOF", command="COMMAND_DISCONNECT"),
            lambda: self.commands(element="breaker.CB", command="COMMAND_OPEN"),
        ]
        for second, ask in enumerate(asks):
            self.at(second, ask)

if __name__ == "__main__":
    Asking.main()
"""
# Shows what it hears of its bus.
WATCHER = """#!/usr/bin/env python3
import gridspace
from gridspace import Reads, Setting, Signal, Writes

class Watching(gridspace.Agent):
    latency_us = Setting("fraction", 50_000, min=0, latency=True, doc="in lockstep")
    measurements = Reads("bus_measurements", "BusMeasurement", triggers=True)
    set_points = Writes("set_points", "SetPoint")
    heard_kw, heard_pu = Signal("agent.watching.heard_kw", "kW"), Signal("agent.watching.heard_pu", "p.u.")

    def begin(self):
        self.at(0.5, lambda: self.set_points(element="battery.BAT1", quantity="p_kw", value=3))

    def on_measurements(self, measured):
        if measured.bus == "HOUSE":
            self.heard_kw, self.heard_pu = measured.p_kw, measured.v_pu

if __name__ == "__main__":
    Watching.main()
"""
REFUSED = [
    (2, "set_point_refused", "battery.BAT1.p_kw = 9 of 'asking' for 'market': expected >= -8 and <= 8, ignored"),
    (3, "set_point_refused", "battery.BAT1.p_kw = 2 of 'asking': valid_for_s is -1, ignored"),
    (4, "set_point_refused", "battery.BAT9.p_kw = 1 of 'asking': there is no 'battery.BAT9', ignored"),
    (5, "set_point_refused", "pv.ROOF.p_limit_kw = 1 of 'asking': only 'ems' may, ignored"),
    (8, "command_refused", "close breaker.CB of 'asking': expected open, ignored"),
    (9, "command_refused", "reset pv.ROOF of 'asking': expected connect, disconnect, start, stop, ignored"),
]


class Controls(ScenarioTest):
    def scenario(self, **changes):
        return self.write("own.yaml", json.dumps({"extends": str(EXAMPLE), **changes}))

    def said(self, run):
        kinds = ("set_point_refused", "command_refused", "control_lost", "control_fallback")
        return [(e["time_s"], e["event"], e["text"]) for e in run.events() if e["event"] in kinds]

    def test_an_agent_balances_a_house_and_its_loss_is_a_fallback(self):
        runs = [self.run_to_end(name, [], EXAMPLE) for name in ("first", "second")]
        self.assert_identical(*runs)
        self.assertEqual([(t, event) for t, event, _ in self.said(runs[0])], [(1831, "control_lost"), (1891, "control_fallback")])

    def test_what_it_may_not_do_is_not_done_and_the_house_is_not_balanced(self):
        control = {"battery.BAT1.p_kw": {"low_kw": -0.1, "high_kw": 0.1}}
        run = self.run_to_end("run", ["--until", "5min", "--set", "events=~"],
                              self.scenario(simulation={"controls": control}, expect={name: None for name in ("at_rest",)}
                                            | {"little_is_taken": {"until": None}, "little_is_given": {"until": None}, "balanced": {"until": None}}),
                              EXPECTATION)
        (time_s, event, text), *more = self.said(run)
        self.assertEqual(event, "set_point_refused")
        self.assertRegex(text, r"battery.BAT1.p_kw = .* of 'ems': expected >= -0.1 and <= 0.1, ignored")
        self.assertEqual(more, [], "once")

    def test_each_refusal_says_who_what_and_why_and_the_rest_is_done(self):
        self.write("asking.py", textwrap.dedent(PROGRAM)).chmod(0o755)
        elements = {
            "breaker_types": {"quick": {"mechanism_ms": 0}},
            "breakers": {"CB": {"line": "L", "end": "from", "type": "quick"}},
            "shunt_capacitors": {"BANK": {"bus": "HOUSE", "q_kvar": 5, "rated_kv": 0.4, "state": "open"}},
        }
        controls = {
            "battery.BAT1.p_kw": {"from": "asking", "ramp_kw_per_s": None, "hold_s": None, "then": None},
            "battery.*.q_kvar": {"from": "asking"},
            "pv.ROOF.p_limit_kw": {"from": "ems"},
            "load.*.demand_pu": {"from": ["ems", "asking"]},
            "shunt_capacitor.*": {"from": "asking"},
            "breaker.CB": {"from": "asking", "commands": ["open"]},
            "pv.*": {"from": "asking"},
        }
        expect = {name: None for name in ("little_is_taken", "little_is_given", "balanced", "allowed", "at_rest")}
        expect |= {
            "set": {"min_of": "battery.BAT1.p_kw", "from": "3 s", "until": "8 s", "is": 3, "tolerance": 1e-6},
            "doubled": {"max_of": "load.HOME.p_kw", "from": "8 s", "is": 10, "tolerance": 0.01},
            "closed": {"eventually": "shunt_capacitor.BANK.position == closed"},
            "disconnected": {"last_of": "pv.ROOF.p_kw", "is": 0},
            "opened": {"last_of": "bus.HOUSE.v_pu", "is": 0, "tolerance": 0.001},
        }
        run = self.run_to_end("run", ["--until", "20s", "--set", "events=~"], self.scenario(
            simulation={"network_changes": elements, "controls": controls}, expect=expect,
            processes={"asking": {"program": {"path": "./asking.py"}, "host": "controller"}}))
        self.assertEqual([said for said in self.said(run) if " of 'asking'" in said[2]], REFUSED)

    def test_a_value_in_goose_steers_within_its_range_only(self):
        allowed = self.run_to_end("allowed", [], GOOSE)
        self.assertEqual(self.said(allowed), [])
        scenario = self.write("refused.yaml", json.dumps({"extends": str(GOOSE), "simulation": {"controls": {"battery.*.q_kvar": {"high_kvar": 1}}}}))
        refused = self.run_to_end("refused", [], scenario, EXPECTATION)
        self.assertRegex(self.said(refused)[0][2], r"^battery.BAT1.q_kvar = .* of 'inward' for 'voltage_controller': expected >= -8 and <= 1, ignored$")

    def test_a_bus_is_measured_with_waveforms_as_with_phasors(self):
        self.write("watching.py", WATCHER).chmod(0o755)
        expect = {name: None for name in ("little_is_taken", "little_is_given", "balanced", "allowed", "at_rest")}
        expect |= {"before": {"mean_of": "agent.watching.heard_kw", "from": "0.3 s", "until": "0.5 s", "is": -2.071, "tolerance": 0.1},
                   "after": {"mean_of": "agent.watching.heard_kw", "from": "0.8 s", "is": -5.071, "tolerance": 0.1},
                   "voltage": {"last_of": "agent.watching.heard_pu", "above": 0.98, "below": 1.02}}
        for solver, step_s in (("phasor", 0.05), ("emt", 0.0005)):
            self.run_to_end(solver, ["--set", "events=~"], self.scenario(
                simulation={"solver": solver, "step_s": step_s, "duration_s": 1, "controls": {
                    "battery.BAT1.p_kw": {"from": "watching", "ramp_kw_per_s": None, "hold_s": None, "then": None}}},
                clock={"tick_s": 0.05}, expect=expect,
                hosts={"simulator": {"links": ["l"]}, "controller": {"links": ["l"]}},  # a name that `ip` takes for a word of its own
                links={"net": None, "l": {"kind": "switch", "ipv4": "10.40.0.0/24"}},
                processes={"ems": None, "watching": {"program": {"path": "./watching.py"}, "host": "controller"}}))

    def test_it_steers_in_real_time_too(self):
        run = self.run_to_end("run", ["--until", "1min", "--speed", "10", "--set", "clock.mode=realtime", "--set", "events=~"], self.scenario(
            expect={name: None for name in ("little_is_taken", "little_is_given", "balanced", "at_rest")} | {"charges": {"min_of": "battery.BAT1.p_kw", "at_most": -1}}))
        self.assertEqual([event for _, event, _ in self.said(run) if event.endswith("refused")], [])


if __name__ == "__main__":
    unittest.main()
