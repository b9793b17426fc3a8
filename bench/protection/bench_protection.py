#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case 2 in real time on this machine: the processor time of each process, and the headroom: with how many relays, each with two
merging units and two streams of 4800 Hz of its own, the first sample is lost, or simulated time cannot follow the clock any more.
Prints JSON; asserts nothing. Run it on a machine that does nothing else, after a release build (what others used of the processors is
in the result):

  bench/protection/bench_protection.py [--seconds 10] [--most 8] [--gridspace build/release/bin/gridspace]
"""
import argparse
import contextlib
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
TICKS = os.sysconf("SC_CLK_TCK")


def scenario(lines, seconds, folder):
    """`lines` relays on the currents of TL-2, each with merging units and streams of its own; nothing happens on the line."""
    text = [f"---\ngridspace: 1\nextends: {ROOT}/configs/scenarios/protection.yaml\nname: bench_{lines}",
            f"simulation: {{duration_s: {seconds}}}", "hosts:" if lines > 1 else ""]
    numbers = range(3, lines + 2)  # the first is the scenario's own
    text += [f"  {host}{n}: {{links: [{links}]}}" for n in numbers
             for host, links in (("mua", "data_bus, process_bus"), ("mub", "data_bus, process_bus"), ("ied", "process_bus"))]
    text += ["streams:" if lines > 1 else ""]
    for n in numbers:
        text += [f'  SMV{n}1: {{like: SMV21, mac: "01:0C:CD:04:01:{2 * n:02X}", app_id: {0x5000 + 2 * n}, sv_id: BENCH_{n}1}}',
                 f'  SMV{n}2: {{like: SMV21, mac: "01:0C:CD:04:01:{2 * n + 1:02X}", app_id: {0x5000 + 2 * n + 1}, sv_id: BENCH_{n}2}}',
                 f'  TRIP{n}: {{like: TRIP2, mac: "01:0C:CD:01:01:{n:02X}", app_id: {0x9000 + n}, control_block: IED{n}LD0/LLN0$GO$Trip}}']
    text += ["processes:", "  monitor: ~"]
    for n in numbers:
        text += [f"  mua{n}: {{program: gridspace-mu, host: mua{n}, qos: merging_unit, from: TL_21, to: SMV{n}1, buffer_ms: 1.5, latency_us: 120}}",
                 f"  mub{n}: {{program: gridspace-mu, host: mub{n}, qos: merging_unit, from: TL_22, to: SMV{n}2, buffer_ms: 1.5, latency_us: 120}}",
                 f"  relay{n}: {{program: gridspace-relay, host: ied{n}, currents: {{from: SMV{n}1, to: SMV{n}2}}, trip: TRIP{n}, "
                 "element: {kind: phasor, pickup_a: 30}, latency_us: 900}"]
    text += ["events: ~", "record: {comtrade: ~}", "expect: ~"]
    file = folder / f"bench_{lines}.yaml"
    file.write_text("\n".join(text) + "\n")
    return file


class Processors:
    """Processor time of the named processes of a run, and of the whole machine."""

    def __init__(self, session):
        self.session, self.names = session, {}

    def now(self):
        used = {}
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            with contextlib.suppress(OSError, ValueError, IndexError):
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                if int(fields[3]) != self.session:
                    continue
                if not self.names.get(entry.name):  # its name comes after the fork
                    environment = (entry / "environ").read_bytes().split(b"\0")
                    found = [e.partition(b"=")[2].decode() for e in environment if e.startswith(b"GRIDSPACE_PROCESS=")]
                    self.names[entry.name] = found[0] if found else ""
                name = self.names[entry.name] or "launcher and supervisor"
                used[name] = used.get(name, 0) + (int(fields[11]) + int(fields[12])) / TICKS
        busy = [int(word) for word in pathlib.Path("/proc/stat").read_text().split()[1:9]]
        return time.monotonic(), used, (sum(busy) - busy[3] - busy[4]) / TICKS


def run(gridspace, lines, seconds):
    """A run, measured between its first and its last report of progress: starting and ending is another matter."""
    with tempfile.TemporaryDirectory(prefix="gridspace-bench-") as name:
        folder = pathlib.Path(name)
        out = folder / "run"
        process = subprocess.Popen([gridspace, "run", str(scenario(lines, seconds, folder)), "--json", "--out", str(out)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
        processors, said, reports = Processors(process.pid), [], []
        for line in process.stderr:
            said.append(line)
            with contextlib.suppress(ValueError):
                progress = json.loads(line)
                if "speed" in progress and progress["time_s"] < seconds:
                    reports.append((progress["time_s"], processors.now()))
        code = process.wait()
        if not (out / "report/summary.json").exists() or len(reports) < 2:
            sys.exit(f"the run with {lines} relays ended with {code}:\n{''.join(said)}")
        summary = json.loads((out / "report/summary.json").read_text())
    (first_s, (began, before, busy_before)), (last_s, (ended, after, busy_after)) = reports[0], reports[-1]
    percent = {name: 100 * (after[name] - before.get(name, 0)) / (ended - began) for name in sorted(after)}
    together = sum(percent.values())
    streams = summary["wire_timing"]["smv"]
    return {"relays": lines, "streams": 2 * lines, "exit": code, "overruns": summary["overruns"], "scheduling": summary["scheduling"],
            "simulated_seconds_per_second": round((last_s - first_s) / (ended - began), 4),
            "received": sum(s["received"] for s in streams.values()), "lost": sum(s["lost"] for s in streams.values()),
            "late_or_twice": sum(s["late"] + s["duplicate"] for s in streams.values()),
            "cpu_percent": {name: round(value, 1) for name, value in percent.items()}, "cpu_percent_together": round(together, 1),
            "cpu_percent_of_others": round(100 * (busy_after - busy_before) / (ended - began) - together, 1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=10, help="simulated (and real) seconds of each run")
    parser.add_argument("--most", type=int, default=8, help="so many relays at most")
    parser.add_argument("--gridspace", default=str(ROOT / "build/release/bin/gridspace"))
    arguments = parser.parse_args()
    results = {"processors": os.cpu_count(), "machine": platform.processor() or platform.machine(), "load_before": os.getloadavg()[0], "runs": []}
    for lines in range(1, arguments.most + 1):
        done = run(arguments.gridspace, lines, arguments.seconds)
        results["runs"].append(done)
        print(f"{lines} relays, {2 * lines} streams: {done['lost']} lost of {done['received'] + done['lost']}, {done['overruns']} overruns, "
              f"{done['simulated_seconds_per_second']} simulated seconds a second, {done['cpu_percent_together']} % of a processor, "
              f"others {done['cpu_percent_of_others']} %", file=sys.stderr, flush=True)
        if done["lost"] or done["exit"] not in (0, 1):
            break
    whole = [r for r in results["runs"] if r["lost"] == 0 and r["exit"] in (0, 1)]
    results["relays_without_a_loss"] = max((r["relays"] for r in whole), default=0)
    results["relays_in_real_time"] = max((r["relays"] for r in whole if r["simulated_seconds_per_second"] > 0.99), default=0)
    print(json.dumps(results, indent=2))


if __name__ == "__main__":
    main()
