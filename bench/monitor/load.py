#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a crowd costs the monitor: 100 participants with 500 topics (or as many as are asked for) in a domain of their own.

  cmake --preset bench && ninja -C build/bench bench_crowd gridspace-monitor
  python3 bench/monitor/load.py --build build/bench [--participants 100] [--topics 5] [--rate 500] [--seconds 10]

Prints a table: time until everything is known, answers of the REST interface, processor time and memory of the monitor, what a client is
pushed. Figures, not judgements: they depend on the machine."""
import json
import subprocess
import sys
import time

import shared
from shared import ROOT, memory_mb, processor_s

DOMAIN = 173
MONITORS_PORT = 7400 + 250 * DOMAIN + 10  # DDSI-RTPS 9.6.1.1: discovery by unicast, of the first participant of a machine


def crowd_qos(folder):
    """The crowd's profiles: everybody finds the monitor and nobody else. Between a hundred participants of one process ten thousand
    discoveries would have to be made, which is the crowd's work and not the monitor's."""
    qos = (ROOT / "qos/member.xml").read_text()
    alone = (f"<metatrafficUnicastLocatorList><locator/></metatrafficUnicastLocatorList><initialPeersList><locator><udpv4>"
             f"<address>127.0.0.1</address><port>{MONITORS_PORT}</port></udpv4></locator></initialPeersList></builtin>")
    assert "</builtin>" in qos
    file = folder / "crowd.xml"
    file.write_text(qos.replace("</builtin>", alone))
    return file


def main():
    # topics: of each participant; rate: samples a second, of all topics together; wait: keep everything there for so many seconds, to look at the page
    arguments = shared.begin(__doc__, participants=100, topics=5, rate=500.0, seconds=10.0, patience=240.0, wait=0.0)
    import client
    folder = shared.folder("load")
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
        crowd = subprocess.Popen([arguments.build / "bench/bench_crowd", crowd_qos(folder), str(DOMAIN), str(arguments.participants),
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
            rows.append((f"GET {path}", f"{client.percentiles(times)}, {size / 1000:.0f} kB"))
        width = max(len(r[0]) for r in rows)
        for name, value in rows:
            print(f"{name:<{width}}  {value}")
        if arguments.wait:
            time.sleep(arguments.wait)
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
