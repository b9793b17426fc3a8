#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a crowd costs the monitor: 100 participants with 500 topics (or as many as are asked for) in a domain of their own.

  python3 bench/monitor/load.py [--build build/release] [--participants 100] [--topics 5] [--rate 500] [--seconds 10]

Prints a table: time until everything is known, answers of the REST interface, processor time and memory of the monitor, what a client is
pushed. Figures, not judgements: they depend on the machine."""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/integration/monitor"))
import client  # noqa: E402

DOMAIN = 173


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100


def memory_mb(pid):
    line = next(x for x in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines() if x.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


def percentiles(times):
    times = sorted(1e3 * t for t in times)
    return f"p50 {statistics.median(times):.1f} ms, p99 {times[int(0.99 * (len(times) - 1))]:.1f} ms, most {times[-1]:.1f} ms"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--participants", type=int, default=100)
    parser.add_argument("--topics", type=int, default=5, help="of each participant")
    parser.add_argument("--rate", type=float, default=500, help="samples a second, of all topics together")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--patience", type=float, default=240)
    parser.add_argument("--wait", action="store_true", help="keep everything there, to look at the page, until Enter")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace-load-"))
    (folder / "monitor.yaml").write_text(json.dumps({
        "process": "monitor", "program": "gridspace-monitor",
        "bus": {"qos": str(ROOT / "qos/monitor.xml"), "management": {"domain": DOMAIN, "addresses": ["127.0.0.1"]}},
        "settings": {"listen": "127.0.0.1:0", "scenario": "a crowd"}}))
    log = open(folder / "monitor.log", "w+")
    monitor_process = subprocess.Popen([arguments.build / "bin/gridspace-monitor", "--config", folder / "monitor.yaml"], stderr=log, stdout=log)
    crowd = None
    try:
        url = None
        while url is None:
            if monitor_process.poll() is not None:
                sys.exit((folder / "monitor.log").read_text())
            url = next((w for w in (folder / "monitor.log").read_text().split() if w.startswith("http://")), None)
            time.sleep(0.02)
        monitor = client.Monitor(url)
        print(f"monitor: {url}")
        idle_mb = memory_mb(monitor_process.pid)
        began = time.monotonic()
        crowd = subprocess.Popen([arguments.build / "bench/bench_crowd", ROOT / "qos/member.xml", str(DOMAIN), str(arguments.participants),
                                  str(arguments.topics), str(arguments.rate)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if crowd.stdout.readline() != "there\n":
            sys.exit("the crowd was not made")
        made_s = time.monotonic() - began
        topics = arguments.participants * arguments.topics
        while True:
            run, graph = monitor.json("/api/v1/run"), monitor.json("/api/v1/graph")
            here = sum(p["name"].startswith("crowd") and p["state"] == "alive" for p in run["processes"])
            known = sum(t["name"].startswith("crowd_") and t["readers"] >= 2 and t["writers"] == 1 for t in graph["topics"])  # the next one, and us
            if here == arguments.participants and known == topics:
                break
            if time.monotonic() - began > arguments.patience:
                sys.exit(f"after {arguments.patience} s: {here} participants, {known} topics")
            time.sleep(0.2)
        known_s = time.monotonic() - began
        push = monitor.web_socket()
        pushed, ends = 0, time.monotonic() + 2
        while time.monotonic() < ends:
            pushed += len(push.receive())
        push.close()
        pushed, ends = 0, time.monotonic() + arguments.seconds
        push = monitor.web_socket()
        push.receive()
        used, began_load = processor_s(monitor_process.pid), time.monotonic()
        while time.monotonic() < ends:
            message = push.receive()
            pushed += len(message)
        cpu = (processor_s(monitor_process.pid) - used) / (time.monotonic() - began_load)
        push.close()
        rows = [("participants, topics", f"{here}, {known}"), ("made after", f"{made_s:.1f} s"), ("all of them known after", f"{known_s:.1f} s"),
                ("processor with one client", f"{100 * cpu:.1f} % of one"), ("memory", f"{memory_mb(monitor_process.pid):.0f} MB ({idle_mb:.0f} MB alone)"),
                ("pushed to one client", f"{pushed / arguments.seconds / 1000:.0f} kB/s")]
        for path in ("/api/v1/health", "/api/v1/run", "/api/v1/graph", "/api/v1/topics", "/api/v1/graph.svg", "/metrics"):
            times, size = [], 0
            for _ in range(30):
                at = time.monotonic()
                size = len(monitor.get(path).body)
                times.append(time.monotonic() - at)
            rows.append((f"GET {path}", f"{percentiles(times)}, {size / 1000:.0f} kB"))
        width = max(len(r[0]) for r in rows)
        for name, value in rows:
            print(f"{name:<{width}}  {value}")
        if arguments.wait:
            input("Enter ends it")
        if crowd.poll() is not None:
            sys.exit("the crowd has died")
    finally:
        if crowd is not None:
            crowd.stdin.close()
            crowd.wait(30)
        monitor_process.terminate()
        monitor_process.wait(30)


if __name__ == "__main__":
    main()
