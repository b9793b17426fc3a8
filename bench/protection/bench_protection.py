#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case 2 in real time on this machine: the processor time of each process, and the headroom: with how many relays, each with two
merging units and two streams of 4800 Hz of its own, the first sample is lost. Prints JSON; asserts nothing. Run it on a machine that
does nothing else, after a release build:

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
import threading

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
    """Processor time of the named processes of a run, sampled until they end."""

    def __init__(self, session):
        self.session, self.seconds, self.stop = session, {}, threading.Event()
        self.thread = threading.Thread(target=self.sample)
        self.thread.start()

    def sample(self):
        names = {}
        while not self.stop.wait(0.2):
            for entry in pathlib.Path("/proc").iterdir():
                if not entry.name.isdigit():
                    continue
                with contextlib.suppress(OSError, ValueError, IndexError):
                    fields = (entry / "stat").read_text().rpartition(")")[2].split()
                    if int(fields[3]) != self.session:
                        continue
                    if entry.name not in names:
                        environment = (entry / "environ").read_bytes().split(b"\0")
                        found = [e.partition(b"=")[2].decode() for e in environment if e.startswith(b"GRIDSPACE_PROCESS=")]
                        names[entry.name] = found[0] if found else ""
                    if names[entry.name]:
                        self.seconds[names[entry.name]] = (int(fields[11]) + int(fields[12])) / TICKS

    def end(self):
        self.stop.set()
        self.thread.join()
        return self.seconds


def run(gridspace, lines, seconds):
    with tempfile.TemporaryDirectory(prefix="gridspace-bench-") as name:
        folder = pathlib.Path(name)
        out = folder / "run"
        process = subprocess.Popen([gridspace, "run", str(scenario(lines, seconds, folder)), "--quiet", "--out", str(out)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
        processors = Processors(process.pid)
        said = process.communicate()[1]
        used = processors.end()
        if not (out / "report/summary.json").exists():
            sys.exit(f"the run with {lines} relays ended with {process.returncode}:\n{said}")
        summary = json.loads((out / "report/summary.json").read_text())
    streams = summary["wire_timing"]["smv"]
    return {"relays": lines, "streams": 2 * lines, "exit": process.returncode, "overruns": summary["overruns"], "scheduling": summary["scheduling"],
            "received": sum(s["received"] for s in streams.values()), "lost": sum(s["lost"] for s in streams.values()),
            "late_or_twice": sum(s["late"] + s["duplicate"] for s in streams.values()),
            "cpu_percent": {k: round(100 * v / seconds, 1) for k, v in sorted(used.items())},
            "cpu_percent_together": round(100 * sum(used.values()) / seconds, 1)}


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
              f"{done['cpu_percent_together']} % of a processor", file=sys.stderr, flush=True)
        if done["lost"] or done["exit"] not in (0, 1):
            break
    whole = [r["relays"] for r in results["runs"] if r["lost"] == 0 and r["exit"] in (0, 1)]
    results["relays_without_a_loss"] = max(whole, default=0)
    print(json.dumps(results, indent=2))


if __name__ == "__main__":
    main()
