#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What an agent in Python costs more than the same one in C++: case 1, in which one EV asks every two seconds, side by side.

    python3 bench/python/bench_python.py [ROUNDS]

Prints the microseconds that a tick of its work takes longer, of each round and the median; in such a tick it takes eight
measurements, sends a request and a row of signals. Starting is not counted. Processor time of the whole run beside wall time: what
else the machine does lengthens the second alone.
"""
import pathlib
import resource
import statistics
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "python"))
import gridspace  # noqa: E402

SECONDS, SHORT, PERIOD_S = 4 * 3600, 60, 2
SETTINGS = [("expect", "~"), ("processes.monitor", "~"), ("processes.mcca.request_timeout_s", 1), ("processes.mcca.evs", "[EV1]"), *[(f"processes.ev{n}", "~") for n in (2, 3, 4)]]
COMMON = f"host: board1, qos: ev_agent, ev: EV1, requested_h: 4, period_s: {PERIOD_S}"
AGENTS = {"C++": f"{{program: gridspace-ev, {COMMON}}}",
          "Python": f"{{program: {{path: {SOURCE}/examples/agents/python_ev_agent/ev_agent.py}}, {COMMON}}}"}


def seconds(agent, until_s):
    """(processor time, wall time) of a run."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    with tempfile.TemporaryDirectory() as folder:
        before = used()
        run = gridspace.run(SOURCE / "configs/scenarios/ev_charging.yaml", out=f"{folder}/run", until=str(until_s),
                            set=[*SETTINGS, ("processes.ev1", "~"), ("processes.ev1", agent)])
        return used() - before, run.summary["wall_s"]


def tick_us(agent):
    """Of a tick: processor time and wall time, without what a short run takes as well."""
    long, short = seconds(agent, SECONDS + SHORT), seconds(agent, SHORT)
    return [1e6 * (a - b) / (SECONDS / PERIOD_S) for a, b in zip(long, short)]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    ticks, differences = [], []
    for number in range(rounds):
        ours, python = tick_us(AGENTS["C++"]), tick_us(AGENTS["Python"])
        ticks.append([*ours, *python])
        differences.append([p - o for o, p in zip(ours, python)])
        print(f"round {number + 1}: a tick of C++ {ours[0]:.0f} us of processor time ({ours[1]:.0f} us of wall time), of Python {python[0]:.0f} ({python[1]:.0f})")
    ours_cpu, ours_wall, python_cpu, python_wall = (statistics.median(column) for column in zip(*ticks))
    print(f"median: C++ {ours_cpu:.0f} us of processor time ({ours_wall:.0f} us of wall time), Python {python_cpu:.0f} ({python_wall:.0f}); "
          f"ratio {python_cpu / ours_cpu:.2f} ({python_wall / ours_wall:.2f})")
    processor, wall = (statistics.median(column) for column in zip(*differences))
    print(f"Python takes {processor:.0f} us of processor time ({wall:.0f} us of wall time) more in a tick")


if __name__ == "__main__":
    main()
