# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Every key of a network file does something: each is changed alone, and some solver's results change with it. A key without an
entry here fails the test, so nothing can be added that is read and ignored."""
import copy
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
SOURCE = pathlib.Path(os.environ.get("GRIDSPACE_SOURCE_DIR", pathlib.Path(__file__).parents[3]))

# Keys that no solver reads, and why.
ELSEWHERE = {
    "gridspace_network", "name", "description", "extends",  # the file itself
    "*.label", "buses.diagram.x", "buses.diagram.y",         # displays
    "breaker_types.latched",                                 # what a falling trip signal does (line gateway)
    "profiles.time", "profiles.csv", "profiles.column",      # hours of the day start at 0 here; files: ProfileCsv tests
    "base.power_kva",                                        # p.u. of results only
}

# Times of seconds, and voltages that this network does not have: tests/unit/components, ride_through and tap_changer.
ELSEWHERE |= {f"{section}.ride_through.{key}" for section in ("pv", "batteries", "wind_turbines", "supercapacitors") for key in (
    "category", "restore_s", "anti_islanding.chopping_pu", "anti_islanding.gain_per_hz", "cease.below_pu", "cease.above_pu",
    *(f"enter_service.{k}" for k in ("delay_s", "ramp_s", "voltage_min_pu", "voltage_max_pu", "frequency_min_hz", "frequency_max_hz")),
    *(f"trip.{e}.{k}" for e in ("ov2", "ov1", "uv1", "uv2") for k in ("voltage_pu", "after_s")),
    *(f"trip.{e}.{k}" for e in ("of2", "of1", "uf1", "uf2") for k in ("frequency_hz", "after_s")))}
ELSEWHERE |= {f"{section}.governor.{key}" for section in ("machine_types", "machines") for key in (  # unit_components
    "gate_min_pu", "gate_max_pu", "lead_s", "damping_pu", "load_limit.power_pu", "load_limit.gain", "load_limit.t_s")}
ELSEWHERE |= {f"machine_types.avr.{key}" for key in (  # unit_components, exciter
    "tc_s", "tb_s", "kf", "tf_s", "ceiling.max_pu", "ceiling.min_pu", "ceiling.kc_pu",
    *(f"stabilizer.{k}" for k in ("gain", "washout_s", "t1_s", "t2_s", "t3_s", "t4_s", "min_pu", "max_pu")))}
ELSEWHERE |= {f"machines.governor.{key}" for key in (  # as in machine_types
    "type", "t1_s", "t2_s", "t3_s", "k", "t4_s", "t5_s", "t6_s", "td_s", "droop_control", "te_s")}
ELSEWHERE |= {f"machine_types.avr.{key}" for key in (  # unit_components, ac8b
    "pid_min_pu", "pid_max_pu", "vr_min_pu", "ve_min_pu", "vfe_max_pu")}
ELSEWHERE |= {f"transformers.tap_changer.{key}" for key in (
    "bus", "voltage_pu", "bandwidth_percent", "delay_s", "next_delay_s", "step_percent", "position", "lowest", "highest", "block_below_pu",
    *(f"compensation.{k}" for k in ("r_v", "x_v", "ct_a", "base_v")))}

BUS = {"voltage_v": 400}
NETWORK = {
    "gridspace_network": 1, "name": "n", "base": {"frequency_hz": 50, "power_kva": 100},
    "buses": {"A": BUS, "B": BUS, "C": BUS, "D": BUS, "E": BUS, "F": BUS, "J": BUS, "U": BUS, "Y": BUS, "H": {"voltage_v": 230}},
    "sources": {"S": {"bus": "A", "voltage_pu": 1.01, "angle_deg": 3, "r_ohm": 0.01, "l_mh": 0.1, "r0_ohm": 0.02, "l0_mh": 0.2,
                      "harmonics": [{"order": 5, "percent": 1, "angle_deg": 10}]}},
    "line_types": {"t": {"r_ohm_per_km": 0.2, "x_ohm_per_km": 0.1, "c_nf_per_km": 300, "r0_ohm_per_km": 0.4, "x0_ohm_per_km": 0.3,
                         "c0_nf_per_km": 200},
                   "u": {"r_ohm_per_km": 0.2, "l_mh_per_km": 0.3, "l0_mh_per_km": 0.9},
                   "w": {"earth_ohm_m": 90, "conductors": [
                       {"phase": p, "x_m": x, "height_m": 7, "radius_m": 0.004, "dc_ohm_per_km": 0.6}
                       for p, x in (("a", -0.5), ("b", 0), ("c", 0.5), ("earth", 1))]},
                   "x": {"c_nf_per_km": 10, "c0_nf_per_km": 5, "by_frequency": {
                       "hz": [1, 1e3, 1e5], "r_ohm_per_km": [0.1, 0.3, 3], "l_mh_per_km": [1, 0.95, 0.9],
                       "r0_ohm_per_km": [0.2, 1, 40], "l0_mh_per_km": [4, 3, 2]}}},
    "lines": {"L": {"from": "A", "to": "B", "r_ohm": 0.05, "l_mh": 0.2, "c_nf": 900, "r0_ohm": 0.1, "l0_mh": 0.6, "c0_nf": 500},
              "M": {"from": "B", "to": "C", "r_ohm": 0.05, "x_ohm": 0.06, "x0_ohm": 0.2},
              "N": {"from": "C", "to": "D", "type": "t", "length_km": 0.3},
              "O": {"from": "D", "to": "E", "type": "u", "length_km": 0.3},
              "P": {"from": "E", "to": "F", "r_ohm": 0.05, "l_mh": 9.0, "c_nf": 800, "model": "pi"},
              "X": {"from": "A", "to": "Y", "type": "w", "length_km": 16, "model": "frequency_dependent", "fault_places_percent": [50]},
              "X2": {"from": "A", "to": "Y", "type": "x", "length_km": 9, "model": "frequency_dependent"},
              "R": {"from": "A", "to": "J", "r_ohm": 0.05, "l_mh": 0.2}, "FL1": {"from": "A", "to": "U", "r_ohm": 0.05, "l_mh": 0.2},
              "FL2": {"from": "A", "to": "U", "r_ohm": 0.06, "l_mh": 0.2}},
    "fuse_types": {"f": {"rated_a": 3, "melting_a": [5, 30], "melting_s": [1, 0.02], "i2t_a2s": 8, "arcing_ms": 1},
                   "g": {"rated_a": 3, "melting_a": [5, 30], "melting_s": [1, 0.012]}},
    "fuses": {"F1": {"line": "FL1", "end": "from", "type": "f"}, "F2": {"line": "FL2", "end": "from", "type": "g"}},
    "breaker_types": {"b": {"mechanism_ms": 1, "opens": "each_pole_at_current_zero"}},
    "breakers": {"K": {"line": "M", "end": "from", "type": "b"}},
    "ct_types": {"c": {"ratio": "100:5", "error_percent": 0.2, "filter": "butterworth2", "cutoff_hz": 2000, "quantum_ma": 1,
                       "saturation": {"knee_v": 1, "magnetising_ma": 50, "winding_ohm": 0.3, "burden_ohm": 1, "air_core_mh": 5,
                                      "remanence_percent": 20}}},
    "cts": {"T1": {"line": "M", "end": "to", "type": "c", "positive": "from_to"}},
    "vt_types": {"v": {"ratio": "400:100", "error_percent": 0.2, "filter": "butterworth2", "cutoff_hz": 2000, "quantum_mv": 10,
                       "saturation": {"knee_pu": 0.9, "magnetising_ma": 5, "winding_ohm": 50, "air_core_mh": 900}}},
    "vts": {"T2": {"bus": "B", "type": "v"}},
    "transformers": {"T": {"from": "E", "to": "H", "rating_kva": 50, "r_percent": 1, "x_percent": 4, "tap_ratio": 1.02,
                           "phase_shift_deg": 30, "from_winding": "delta", "to_winding": "wye_grounded", "magnetising_percent": 2,
                           "charging_percent": 0.5, "saturation": {"knee_pu": 0.8, "air_core_percent": 30}}},
    "machine_types": {"m": {"model": "full", "constants_pu": {"xd": 1.3, "xq": 0.5, "xd1": 0.3, "xd2": 0.25, "xq2": 0.24, "xl": 0.18,
                                                              "x0": 0.1, "ra": 0.006},
                            "times_s": {"td01": 4.5, "td02": 0.06, "tq02": 0.1}, "inertia_h_s": 2, "damping_pu": 1,
                            "avr": {"ka": 50, "ta_s": 0.02, "tr_s": 0.02, "efd_min_pu": 0.15, "efd_max_pu": 2},
                            "governor": {"droop_percent": 4, "tg_s": 0.05, "tt_s": 0.15, "integral_ki": 1}}},
    "machines": {"G": {"bus": "B", "type": "m", "rating_kva": 30, "p_kw": 10, "voltage_setpoint_pu": 1.0},
                 "G2": {"bus": "A", "type": "m", "rating_kva": 20, "p_kw": 8, "voltage_setpoint_pu": 1.005, "inertia_h_s": 3,
                        "governor": {"droop_percent": 5, "tg_s": 0.06, "tt_s": 0.2, "integral_ki": 0.5}},
                 "G3": {"bus": "H", "type": "genset", "rating_kva": 15, "p_kw": 6, "voltage_setpoint_pu": 0.98}},  # of the reference
    "generators": {"Q": {"bus": "C", "role": "pq", "rating_kva": 6, "p_kw": 5, "q_kvar": 1},
                   "V": {"bus": "D", "role": "pv", "rating_kva": 20, "p_kw": 5, "voltage_setpoint_pu": 1.1, "q_min_kvar": -1,
                         "q_max_kvar": 1},
                   "W": {"bus": "F", "role": "pv", "rating_kva": 20, "p_kw": 1, "voltage_setpoint_pu": 0.8, "q_min_kvar": -1,
                         "q_max_kvar": 1}},
    "loads": {"D1": {"bus": "C", "p_kw": 5, "power_factor": 0.9, "model": "constant_impedance"},
              "D2": {"bus": "D", "p_kw": 5, "q_kvar": 2, "model": "exponential", "exponent_p": 1.3, "exponent_q": 2.1, "lag_s": 0.01,
                     "scale": "p"},
              "D3": {"bus": "E", "p_kw": 3, "power_factor": 0.9, "model": "zip", "zip_p": [0.2, 0.3, 0.5], "zip_q": [0.5, 0.3, 0.2]},
              "D4": {"bus": "H", "p_kw": 3, "model": "dc_constant_power"}, "D5": {"bus": "F", "p_kw": 1},
              "D6": {"bus": "U", "p_kw": 40, "model": "constant_impedance"}},
    "shunts": {"C1": {"bus": "C", "p_kw": 0.5, "q_kvar": 2}},
    "induction_machines": {"I1": {"bus": "C", "rating_kva": 3, "load_kw": 1.5, "load_exponent": 1, "inertia_h_s": 0.3, "state": "running",
                                  "constants_pu": {"rs": 0.02, "xs": 0.09, "xm": 2.6, "rr": 0.02, "xr": 0.15, "rr2": 0.1, "xr2": 0.06}}},
    "pv": {"P1": {"bus": "D", "p_kw": 5, "rating_kva": 5, "power_factor": 0.95, "scale": "s"},
           "P2": {"bus": "B", "scale": "p", "ambient_c": 30, "ambient": "s",
                  "array": {"series": 2, "strings": 1, "il_a": 8.214, "i0_a": 9.825e-8, "rs_ohm": 0.221, "rsh_ohm": 415.4, "a_v": 1.8036,
                            "alpha_a_k": 0.00318, "noct_c": 46, "efficiency": 0.97, "mppt_s": 0.02}}},
    "wind_turbines": {"W1": {"bus": "B", "rated_kw": 0.5, "rating_kva": 0.54, "wind_m_s": 14, "scale": "p", "q_kvar": 0.03,
                             "generator": "doubly_fed", "rated_wind_m_s": 12, "cut_out_m_s": 25, "restart_m_s": 22, "speed_min_pu": 0.4,
                             "inertia_h_s": 0.4, "power_lag_s": 0.01, "cp": [0.5176, 116, 0.4, 5, 21, 0.0068],
                             "pitch": {"kp": 150, "ki": 25, "t_s": 0.3, "rate_deg_s": 10, "max_deg": 27},
                             "shaft": {"turbine_share": 0.9, "frequency_hz": 1.8, "damping_pu": 1.5}}},
    "evs": {"E1": {"bus": "C", "capacity_kwh": 0.0001, "battery_v": 360, "max_current_a": 15, "efficiency": 0.9,
                   "soc_start_percent": 20, "soc_stop_percent": 60, "current_lag_s": 0.002}},
    "batteries": {"B1": {"bus": "C", "capacity_kwh": 0.0002, "rating_kva": 7, "p_kw": 6, "q_kvar": 1, "efficiency": 0.9,
                         "soc_start_percent": 60, "soc_min_percent": 55, "scale": "p", "soc_max_percent": 90},
                  "B2": {"bus": "B", "capacity_kwh": 0.0002, "rating_kva": 7, "p_kw": -6, "soc_start_percent": 60,
                         "soc_max_percent": 65},
                  "B3": {"bus": "J", "capacity_kwh": 1, "rating_kva": 9, "p_kw": 2, "control": "grid_forming",
                         "grid_forming": {"voltage_setpoint_pu": 1.003, "droop_percent": 2, "voltage_droop_percent": 5, "inertia_h_s": 0.5,
                                          "integral_ki": 5, "voltage_ki": 30, "power_filter_s": 0.02, "r_pu": 0.01, "x_pu": 0.15,
                                          "current_limit_pu": 1.3, "ramp_s": 0.5}}},
    "profiles": {"p": {"hours": [0, 1e-5], "values": [0.9, 1.1], "clouds": [{"at_h": 1e-6, "depth_percent": 5, "width_h": 1e-5}]},
                 "s": {"half_sine": {"rise_h": -5, "set_h": 9, "exponent": 1.2}}},
}
# The same network without what needs balance: phase impedances and loads by phase; slack generator.
UNBALANCED = {
    "gridspace_network": 1, "name": "n", "base": {"frequency_hz": 50, "power_kva": 100}, "buses": {"A": BUS, "B": BUS},
    "generators": {"Z": {"bus": "A", "role": "slack", "voltage_setpoint_pu": 1, "angle_deg": 2}},
    "line_types": {"t": {"phase_r_ohm_per_km": [0.2, 0.05, 0.21, 0.05, 0.05, 0.2], "phase_x_ohm_per_km": [0.3, 0.1, 0.31, 0.1, 0.1, 0.3]}},
    "lines": {"L": {"from": "A", "to": "B", "type": "t", "length_km": 0.3}},
    "loads": {"D": {"bus": "B", "phase_p_kw": [1, 2, 3], "phase_q_kvar": [0.5, 0.5, 1], "model": "constant_power"}},
}
EVENTS = """events:
  e: {at_s: 0.001, set: {evs.E1.current_a: 100}}
  v: {at_s: 0.019, set: {machines.G.voltage_setpoint_pu: 0.9}}
  f: {at_s: 0.003, apply_fault: {line: M, position_percent: 60, type: 2ph_g, resistance_ohm: 0.005}, clear_after_ms: 8}
  o: {at_s: 0.006, open: [K]}
  h: {at_s: 0.0205, stop: [B3]}
  i: {at_s: 0.0225, start: [B3]}
  y: {at_s: 0.024, set: {electrolysers.Y1.p_kw: 0.5}}
  g: {at_s: 0.015, apply_fault: {bus: I, type: 1ph_g, resistance_ohm: 0.05}, clear_after_ms: 4}
"""
# What each key becomes: path (section.element.key...), new value.
CHANGES = {
    "base.frequency_hz": 60, "buses.H.voltage_v": 240,
    "sources.S.bus": "B", "sources.S.voltage_pu": 1.02, "sources.S.angle_deg": 4, "sources.S.r_ohm": 0.02, "sources.S.l_mh": 0.2,
    "sources.S.r0_ohm": 0.03, "sources.S.l0_mh": 0.3, "sources.S.harmonics": [{"order": 7, "percent": 1, "angle_deg": 10}],
    "sources.S.harmonics.0.order": 7, "sources.S.harmonics.0.percent": 2, "sources.S.harmonics.0.angle_deg": 20,
    "line_types.t.r_ohm_per_km": 0.3, "line_types.t.x_ohm_per_km": 0.2, "line_types.t.c_nf_per_km": 400,
    "line_types.t.r0_ohm_per_km": 0.5, "line_types.t.x0_ohm_per_km": 0.4, "line_types.t.c0_nf_per_km": 250,
    "line_types.u.l_mh_per_km": 0.4, "line_types.u.l0_mh_per_km": 1.0,
    "lines.L.from": "C", "lines.L.to": "C", "lines.L.r_ohm": 0.06, "lines.L.l_mh": 0.3, "lines.L.c_nf": 1000, "lines.L.r0_ohm": 0.2,
    "lines.L.l0_mh": 0.7, "lines.L.c0_nf": 600, "lines.M.x_ohm": 0.07, "lines.M.x0_ohm": 0.3, "lines.N.type": "u",
    "lines.N.length_km": 0.4, "lines.P.model": "bergeron", "lines.X.fault_places_percent": [45],
    **{f"line_types.w.{key}": value for key, value in
       {"earth_ohm_m": 200, "conductors.0.x_m": -0.7, "conductors.1.height_m": 8, "conductors.2.radius_m": 0.005,
        "conductors.3.dc_ohm_per_km": 0.7, "conductors.3.phase": "c"}.items()},
    **{f"line_types.x.by_frequency.{key}": value for key, value in
       {"hz": [2, 2e3, 2e5], "r_ohm_per_km": [0.2, 0.4, 4], "l_mh_per_km": [1.1, 1, 0.95], "r0_ohm_per_km": [0.3, 1.1, 44],
        "l0_mh_per_km": [4.1, 3.1, 2.1]}.items()},
    "breaker_types.b.mechanism_ms": 3, "breaker_types.b.opens": "at_once", "breaker_types.b.chop_a": 20,
    "breakers.K.line": "N", "breakers.K.end": "to", "breakers.K.type": "b2", "breakers.K.state": "open",
    "fuse_types.f.rated_a": 6, "fuse_types.f.i2t_a2s": 4, "fuse_types.f.arcing_ms": 3, "fuse_types.f.opens": "at_once",
    "fuse_types.g.melting_a": [5, 20], "fuse_types.g.melting_s": [1, 0.006],
    "fuses.F1.line": "P", "fuses.F1.end": "to", "fuses.F1.type": "g",
    "ct_types.c.ratio": "200:5", "ct_types.c.error_percent": 0.3, "ct_types.c.filter": None, "ct_types.c.cutoff_hz": 1000,
    "ct_types.c.quantum_ma": 2, "ct_types.c.saturation.knee_v": 0.8, "ct_types.c.saturation.magnetising_ma": 70,
    "ct_types.c.saturation.winding_ohm": 0.5, "ct_types.c.saturation.burden_ohm": 2, "ct_types.c.saturation.air_core_mh": 9,
    "ct_types.c.saturation.remanence_percent": 50,
    "cts.T1.line": "N", "cts.T1.end": "from", "cts.T1.type": "c2", "cts.T1.positive": "into_line",
    "vt_types.v.ratio": "500:100", "vt_types.v.error_percent": 0.3, "vt_types.v.filter": None, "vt_types.v.cutoff_hz": 1000,
    "vt_types.v.quantum_mv": 20, "vt_types.v.saturation.knee_pu": 0.8, "vt_types.v.saturation.magnetising_ma": 8,
    "vt_types.v.saturation.winding_ohm": 80, "vt_types.v.saturation.air_core_mh": 500, "vts.T2.bus": "C", "vts.T2.type": "v2",
    "transformers.T.from": "D", "transformers.T.to": "I", "transformers.T.rating_kva": 60, "transformers.T.r_percent": 2,
    "transformers.T.x_percent": 5, "transformers.T.tap_ratio": 1.03, "transformers.T.phase_shift_deg": -30,
    "transformers.T.from_winding": "wye", "transformers.T.to_winding": "wye", "transformers.T.magnetising_percent": 3,
    "transformers.T.charging_percent": 1, "transformers.T.saturation.knee_pu": 0.7, "transformers.T.saturation.air_core_percent": 40,
    "machine_types.m.model": "classical",
    **{f"machine_types.m.constants_pu.{k}": v for k, v in
       {"xd": 1.4, "xq": 0.6, "xd1": 0.31, "xd2": 0.26, "xq2": 0.25, "xl": 0.17, "x0": 0.12, "ra": 0.01}.items()},
    **{f"machine_types.m.times_s.{k}": v for k, v in {"td01": 5, "td02": 0.07, "tq02": 0.12}.items()},
    "machine_types.m.inertia_h_s": 2.5, "machine_types.m.damping_pu": 2,
    **{f"machine_types.m.avr.{k}": v for k, v in
       {"ka": 60, "ta_s": 0.03, "tr_s": 0.03, "efd_min_pu": 0.2, "efd_max_pu": 1.8}.items()},
    **{f"machine_types.m.governor.{k}": v for k, v in {"droop_percent": 5, "tg_s": 0.06, "tt_s": 0.2, "integral_ki": 2}.items()},
    "machines.G.bus": "C", "machines.G.type": "m2", "machines.G.rating_kva": 40, "machines.G.p_kw": 11,
    "machines.G.voltage_setpoint_pu": 1.01, "machines.G2.inertia_h_s": 4,
    **{f"machines.G2.governor.{k}": v for k, v in {"droop_percent": 6, "tg_s": 0.07, "tt_s": 0.3, "integral_ki": 2}.items()},
    "generators.Q.bus": "D", "generators.Q.role": "pv", "generators.Q.rating_kva": 8, "generators.Q.p_kw": 6, "generators.Q.q_kvar": 2,
    "generators.V.voltage_setpoint_pu": 0.7, "generators.W.q_min_kvar": -0.9, "generators.V.q_max_kvar": 0.9,
    "loads.D1.bus": "D", "loads.D1.p_kw": 6, "loads.D1.power_factor": 0.8, "loads.D1.model": "constant_current", "loads.D2.q_kvar": 3,
    "loads.D2.exponent_p": 1.5, "loads.D2.exponent_q": 2.5, "loads.D2.lag_s": 0.02, "loads.D2.scale": "s",
    "loads.D3.zip_p": [0.5, 0.3, 0.2], "loads.D3.zip_q": [0.2, 0.3, 0.5],
    "shunts.C1.bus": "D", "shunts.C1.p_kw": 1, "shunts.C1.q_kvar": 3,
    "induction_machines.I1.bus": "B", "induction_machines.I1.rating_kva": 4, "induction_machines.I1.load_kw": 2,
    "induction_machines.I1.load_exponent": 2, "induction_machines.I1.inertia_h_s": 0.5, "induction_machines.I1.state": "stopped",
    **{f"induction_machines.I1.constants_pu.{k}": v for k, v in
       {"rs": 0.03, "xs": 0.1, "xm": 3, "rr": 0.03, "xr": 0.2, "rr2": 0.2, "xr2": 0.08}.items()},
    "pv.P1.bus": "C", "pv.P1.p_kw": 4, "pv.P1.rating_kva": 4, "pv.P1.power_factor": 0.9, "pv.P1.scale": "p",
    "pv.P2.ambient_c": 35, "pv.P2.ambient": None,
    **{f"pv.P2.array.{k}": v for k, v in
       {"series": 3, "strings": 2, "il_a": 8, "i0_a": 1e-7, "rs_ohm": 0.3, "rsh_ohm": 300, "a_v": 1.9, "alpha_a_k": 0.004, "noct_c": 48,
        "efficiency": 0.9, "mppt_s": 0.03}.items()},
    **{f"wind_turbines.W1.{k}": v for k, v in
       {"bus": "C", "rated_kw": 0.4, "rating_kva": 0.6, "wind_m_s": 13, "scale": None, "q_kvar": 0.04, "generator": "full_converter",
        "rated_wind_m_s": 11, "cut_out_m_s": 13, "restart_m_s": 26, "speed_min_pu": 1, "inertia_h_s": 0.5, "power_lag_s": 0.02,
        "cp": [0.5, 116, 0.4, 5, 21, 0.0068], "pitch.kp": 100, "pitch.ki": 50, "pitch.t_s": 0.5, "pitch.rate_deg_s": 1, "pitch.max_deg": 2,
        "shaft.turbine_share": 0.8, "shaft.frequency_hz": 2, "shaft.damping_pu": 1}.items()},
    "evs.E1.bus": "D", "evs.E1.capacity_kwh": 0.0002, "evs.E1.battery_v": 300, "evs.E1.max_current_a": 12, "evs.E1.efficiency": 0.8,
    "evs.E1.soc_start_percent": 30, "evs.E1.soc_stop_percent": 25, "evs.E1.current_lag_s": 0.004,
    "batteries.B1.bus": "D", "batteries.B1.capacity_kwh": 0.0003, "batteries.B1.rating_kva": 6.1, "batteries.B1.p_kw": 5,
    "batteries.B1.q_kvar": 2, "batteries.B1.efficiency": 0.8, "batteries.B1.soc_start_percent": 70, "batteries.B1.soc_min_percent": 59,
    "batteries.B1.scale": "s", "batteries.B2.soc_max_percent": 62,
    "batteries.B3.control": "grid_following",
    **{f"batteries.B3.grid_forming.{k}": v for k, v in
       {"voltage_setpoint_pu": 1.005, "droop_percent": 3, "voltage_droop_percent": 6, "inertia_h_s": 0.6, "integral_ki": 9, "voltage_ki": 20,
        "power_filter_s": 0.03, "r_pu": 0.02, "x_pu": 0.16, "current_limit_pu": 1.0, "ramp_s": 0.2}.items()},
    "profiles.p.hours": [0, 2e-5], "profiles.p.values": [0.8, 1.1], "profiles.p.clouds": [],
    "profiles.p.clouds.0.at_h": 2e-6, "profiles.p.clouds.0.depth_percent": 9, "profiles.p.clouds.0.width_h": 2e-5,
    "profiles.s.half_sine.rise_h": -6, "profiles.s.half_sine.set_h": 8, "profiles.s.half_sine.exponent": 1,
}
UNBALANCED_CHANGES = {
    "line_types.t.phase_r_ohm_per_km": [0.2, 0.05, 0.22, 0.05, 0.05, 0.2], "line_types.t.phase_x_ohm_per_km": [0.3, 0.1, 0.32, 0.1, 0.1, 0.3],
    "generators.Z.angle_deg": 3, "loads.D.phase_p_kw": [2, 2, 3], "loads.D.phase_q_kvar": [0.6, 0.5, 1],
}


# Elements whose example stands in the reference: they are part of the network. Where a key stands first,
# a number becomes nine tenths and a word is left out.
def leaves(element, prefix=""):
    for key, value in element.items():
        yield from leaves(value, f"{prefix}{key}.") if isinstance(value, dict) else [(prefix + key, value)]


REFERENCE = (SOURCE / "docs/reference/components.md").read_text()
for section, elements in re.findall(r"```yaml\n(\w+):(.*?)```", REFERENCE, re.S):
    examples, seen = json.loads(re.sub(r"\b[A-Za-z_]\w*", r'"\g<0>"', elements)), set()
    NETWORK.setdefault(section, {}).update(examples)
    for name, example in examples.items():
        for key, value in leaves(example):
            if key not in seen and f"{section}.{key}" not in ELSEWHERE:
                seen.add(key)
                CHANGES[f"{section}.{name}.{key}"] = None if isinstance(value, str) else 0.9 * value
CHANGES["electrolysers.Y1.cells"] = 9


def changed(network, path, value):
    out = copy.deepcopy(network)
    # Twins to point at: another type of breaker, CT, VT and machine; a bus for the transformer.
    parts = path.split(".")
    at = out
    for part in parts[:-1]:
        at = at[int(part)] if isinstance(at, list) else at[part]
    if value is None:
        at.pop(parts[-1])
        if parts[-1] == "filter":
            at.pop("cutoff_hz")
    else:
        at[parts[-1]] = value
    return out


def keys_of(schema, prefix="", definitions=None):
    """Paths of all keys without the names of elements."""
    definitions = schema["$defs"] if definitions is None else definitions
    if "$ref" in schema:
        schema = definitions[schema["$ref"].rpartition("/")[2]]
    for option in schema.get("anyOf", []):
        yield from keys_of(option, prefix, definitions)
    extra = schema.get("additionalProperties")
    if isinstance(extra, dict):
        yield from keys_of(extra, prefix, definitions)
    if isinstance(schema.get("items"), dict):
        yield from keys_of(schema["items"], prefix, definitions)
    for key, value in schema.get("properties", {}).items():
        inner = list(keys_of(value, f"{prefix}{key}.", definitions))
        yield from inner if inner else [prefix + key]


class EveryKey(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.holder.name)
        twins = copy.deepcopy(NETWORK)
        for section, name, key, value in (("breaker_types", "b", "mechanism_ms", 4), ("ct_types", "c", "error_percent", 5),
                                          ("vt_types", "v", "error_percent", 5), ("machine_types", "m", "inertia_h_s", 9)):
            twins[section][name + "2"] = {**copy.deepcopy(twins[section][name]), key: value}
        twins["buses"]["I"] = {"voltage_v": 230}
        twins["lines"]["Z"] = {"from": "H", "to": "I", "r_ohm": 0.05}
        cls.network = twins
        cls.results = {}

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def table(self, network, solver, events):
        key = (json.dumps(network), solver)
        if key not in self.results:
            (self.folder / "n.yaml").write_text(json.dumps(network))
            (self.folder / "e.yaml").write_text(EVENTS)
            out = self.folder / "o.csv"
            out.unlink(missing_ok=True)
            command = [BIN, "simulate", self.folder / "n.yaml", "--solver", solver, "--until", "0.03s", "--quiet", "--signals",
                       "bus.*.v_pu,bus.*.angle_deg,ct.*,vt.*,line.*.from.*,machine.*,generator.*,battery.*,ev.*,pv.*,wind_turbine.*,load.*,breaker.*.position"
                       if solver == "emt" and "cts" in network else "*", "--csv", out]
            command += ["--events", self.folder / "e.yaml"] if events else []
            command += ["--every", "8", "--comtrade", self.folder / "o"] if solver == "emt" else []
            done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=60, check=False)
            self.results[key] = f"{done.returncode}: {done.stderr}"
            if done.returncode == 0:
                self.results[key] = out.read_bytes() + ((self.folder / "o.cfg").read_bytes() if solver == "emt" else b"")
        return self.results[key]

    def check(self, network, changes, events):
        for solver in ("emt", "phasor"):
            self.assertIsInstance(self.table(network, solver, events), bytes, self.table(network, solver, events))
        for path, value in changes.items():
            with self.subTest(key=path):
                other = changed(network, path, value)
                seen = False
                for solver in ("emt", "phasor"):
                    got = self.table(other, solver, events)
                    if isinstance(got, str):
                        # A change may be a mistake that is named: that is an effect too.
                        self.assertRegex(got, r"^2: (.|\n)*error: ")
                        seen = True
                    seen = seen or got != self.table(network, solver, events)
                    if seen:
                        break
                self.assertTrue(seen, f"{path} has no effect")

    def test_each_key_changes_some_result(self):
        self.check(self.network, CHANGES, True)

    def test_each_key_of_unbalanced_networks_changes_some_result(self):
        self.check(UNBALANCED, UNBALANCED_CHANGES, False)

    def test_no_key_is_forgotten(self):
        schema = json.loads((SOURCE / "configs/schema/network.schema.json").read_text())

        def plain(path):
            parts = [p for p in path.split(".") if not p.isdigit()]
            return parts[0] + "." + ".".join(parts[2:]) if parts[0] != "base" and len(parts) > 2 else ".".join(parts)

        known = {plain(p) for p in (*CHANGES, *UNBALANCED_CHANGES)} | ELSEWHERE
        missing = [key for key in keys_of(schema) if key not in known and "*." + key.split(".", 1)[-1] not in known]
        self.assertEqual(missing, [])
        self.assertGreater(len(known), 130)


if __name__ == "__main__":
    unittest.main()
