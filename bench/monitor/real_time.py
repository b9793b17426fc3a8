#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Case study 2 in real time without the monitor, with it, and with ten clients that ask it for everything and read nothing: what was lost, and
how late frames were. Delays are figures of this machine; a sample that was lost is an error (exit code 1).

  python3 bench/monitor/real_time.py [--build build/release] [--seconds 4]"""
import json
import sys

import shared

SHOWN = ("smv_lost", "smv_rate_hz", "smv_delay_p99_ms", "goose_delay_p99_ms", "cb3_open_ms", "cb4_open_ms")


def main():
    arguments = shared.begin(__doc__, seconds=4.0)
    import client
    import harness
    from slow_clients import dropped_for_slow_clients, slow_clients_of

    scenario = shared.ROOT / "configs/scenarios/protection.yaml"
    short = ["--set", f"simulation.duration_s={arguments.seconds}", "--set", f"events.fault.at_s={arguments.seconds / 2}"]
    folder, lost = shared.folder("real-time"), 0
    for name, more, is_slow in (("alone", ["--set", "processes.monitor=~"], False), ("monitored", [], False), ("ten_slow_clients", [], True)):
        run = harness.Run(folder / name, scenario, [*short, *more])
        slow = dropped = None
        if is_slow:
            address = client.monitor_of(run)
            slow = slow_clients_of(address)
            run.wait_for_time(0.75 * arguments.seconds)
            dropped = dropped_for_slow_clients(address)
        code = run.finish()
        if code not in (harness.OK, harness.EXPECTATION):
            sys.exit(f"{name}: exit code {code}\n{run.stderr()}")
        summary = run.summary()
        print(f"{name}: {summary.get('overruns', '?')} overruns" + (f", {dropped} messages not sent to slow clients" if slow else ""))
        for e in summary["expectations"]:
            if e["name"] in SHOWN or not e["pass"]:
                print(f"    {e['name']:<22} {e.get('value')} {e.get('unit', '')}{'' if e['pass'] else '  FAILED'}")
            lost += e.get("value") or 0 if e["name"] == "smv_lost" else 0
        recording = json.loads(harness.gridspace("info", run.folder, "--json")[1])["recording"]
        currents = {t["name"]: t["samples"] for t in recording["topics"] if t["type"] == "LineCurrents"}
        due = round(1200 * arguments.seconds)  # four samples of 4800 Hz each
        print(f"    recorded of each line's currents: {min(currents.values())} to {max(currents.values())} messages of {due}")
        lost += sum(max(due - n, 0) for n in currents.values())
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
