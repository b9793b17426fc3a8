#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case study 2 in real time without the monitor, with it, and with ten clients that ask it for everything and read nothing: what was lost, and
how late frames were. Figures of this machine.

  python3 bench/monitor/real_time.py [--build build/release] [--seconds 4]"""
import argparse
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--seconds", type=float, default=4)
    arguments = parser.parse_args()
    os.environ["GRIDSPACE_BIN_DIR"] = str(arguments.build.resolve() / "bin")
    sys.path.insert(0, str(ROOT / "tests/integration/monitor"))
    import client
    import harness
    from lockstep_test import CLIENTS, SlowClient, SlowMonitor

    scenario = ROOT / "configs/scenarios/protection.yaml"
    short = ["--set", f"simulation.duration_s={arguments.seconds}", "--set", f"events.fault.at_s={arguments.seconds / 2}"]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace-rt-"))
    for name, more, clients in (("no monitor", ["--set", "processes.monitor=~"], 0), ("monitor", [], 0), ("monitor, ten slow clients", [], CLIENTS)):
        run = harness.Run(folder / name.replace(" ", "_").replace(",", ""), scenario, [*short, *more])
        slow = []
        if clients:
            address = client.monitor_of(run)
            found = address.until("/api/v1/signals", lambda s: sum("value" in e for e in s["signals"]) > 20, "signals")
            reader = SlowMonitor(f"http://{address.host}:{address.port}")
            slow = [SlowClient.dashboard(reader, [s["name"] for s in found["signals"]]) for _ in range(clients - 2)]
            slow += [SlowClient.foxglove(reader) for _ in range(2)]
        code = run.finish()
        print(f"{name}: exit code {code}")
        for e in run.summary()["expectations"]:
            if e["name"] in ("smv_lost", "smv_rate_hz", "smv_delay_p99_ms", "goose_delay_p99_ms", "cb3_open_ms", "cb4_open_ms"):
                print(f"    {e['name']:<20} {e.get('value')} {e.get('unit', '')}")
        print(f"    overruns             {run.summary().get('overruns', '?')}")
        del slow


if __name__ == "__main__":
    main()
