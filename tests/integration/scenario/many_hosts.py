# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes a case of so many EV agents, each on a host of its own: many_hosts.py FOLDER HOSTS. Prints the scenario."""
import pathlib
import sys

PER_BUS = 8  # below a bus's rating whatever the agents ask for


def write_case(folder, hosts, duration_s=30, extra=""):
    """A scenario of `hosts` + 2 hosts and processes: the simulator, the controller, and an agent each."""
    folder = pathlib.Path(folder)
    evs = [f"EV{i}" for i in range(1, hosts + 1)]
    buses = (hosts + PER_BUS - 1) // PER_BUS
    network = ["gridspace_network: 1", "name: many", "base: {frequency_hz: 60, power_kva: 1000}", "buses:"]
    network += [f"  B{b}: {{voltage_v: 480}}" for b in range(buses + 1)]
    network += ["line_types:", "  cable: {r_ohm_per_km: 0.32, x_ohm_per_km: 0.11, c_nf_per_km: 0}", "lines:"]
    network += [f"  F{b}: {{from: B0, to: B{b}, type: cable, length_km: 0.05}}" for b in range(1, buses + 1)]
    network += ["generators:", f"  G: {{bus: B0, rating_kva: {20 * hosts + 100}, role: slack, voltage_setpoint_pu: 1.0, angle_deg: 0}}", "evs:"]
    network += [f"  {ev}: {{bus: B{1 + i // PER_BUS}, capacity_kwh: 24, battery_v: 360, max_current_a: 15, efficiency: 0.95, "
                f"soc_start_percent: 20, soc_stop_percent: 80}}" for i, ev in enumerate(evs)]
    (folder / "network.yaml").write_text("\n".join(network) + "\n")
    scenario = folder / "many.yaml"
    agents = "\n".join(f"  {ev.lower()}: {{program: gridspace-ev, host: h{i}, ev: {ev}, requested_h: 4}}" for i, ev in enumerate(evs))
    places = "\n".join(f"  h{i}: {{links: [lan]}}" for i in range(hosts))
    scenario.write_text(f"""gridspace: 1
name: many
simulation: {{network: network.yaml, solver: phasor, step_s: 1, duration_s: {duration_s}, gateways: per_bus}}
clock: {{mode: lockstep, tick_s: 1}}
hosts:
  simulator: {{links: [lan]}}
  controller: {{links: [lan]}}
{places}
links:
  lan: {{kind: switch, ipv4: 10.10.0.0/23}}
defaults:
  gridspace-ev: {{qos: ev_agent, period_s: 10, soc_target_percent: 80, rated_current_a: 15, battery_v: 360}}
processes:
  sim: {{program: gridspace-sim, host: simulator, qos: simulator}}
{agents}
  mcca: {{program: gridspace-mcca, host: controller, qos: mcca, evs: [{", ".join(evs)}], request_timeout_s: 30, latency_us: 1000000}}
  recorder: {{program: gridspace-recorder, host: simulator, qos: recorder}}
record: {{samples: all, frames: none, signals: ["ev.*"]}}
{extra}""")
    return scenario


if __name__ == "__main__":
    print(write_case(sys.argv[1], int(sys.argv[2])))
