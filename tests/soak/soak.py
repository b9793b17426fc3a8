#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What only shows after a long time, or now and then.

  1. A scenario in real time for an hour: its processes hold no more memory and descriptors at the end than after a tenth of it, the run
     ends as it should, and the recording holds what was sent, or the report says what was lost.
  2. Each scenario is started a hundred times, two at a time, and ended after a few ticks, beside four busy loops.

  ./gridspace test --only long_soak                                       an hour, and a hundred starts each
  python3 tests/soak/soak.py --seconds 60 --starts 2 --only ev_charging   a short one
"""
import argparse
import concurrent.futures
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "configs/scenarios"
LET = 1.2  # memory may grow by a fifth from a tenth of the time to the end ...
LET_KB = 4096  # ... or by this: an allocator takes what it takes
FILLS_KB = {"monitor": 256 * 1024}  # its past of signals is in rings that are full after some hours (docs/design/monitor.md)


def processes_of(session):
    """{process of the scenario: pid} of what a run has started, found by the session of its launcher."""
    out = {}
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            if entry.name.isdigit() and int((entry / "stat").read_text().rpartition(")")[2].split()[3]) == session:
                for word in (entry / "environ").read_bytes().split(b"\0"):
                    if word.startswith(b"GRIDSPACE_PROCESS="):
                        out[word[18:].decode()] = int(entry.name)
    return out


def use_of(pid):
    """(resident kB, descriptors) of a process."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    resident = int(status.partition("VmRSS:")[2].split()[0])
    return resident, len(os.listdir(f"/proc/{pid}/fd"))


def start(gridspace, scenario, out, *options):
    command = [gridspace, "run", scenario, "--out", out, "--quiet", *options]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)


def long_run(gridspace, scenario, seconds, folder):
    """Mistakes of one long run. Its table of processes is printed."""
    out = folder / "long"
    began = time.monotonic()
    run = start(gridspace, scenario, out, "--until", f"{seconds}s", "--set", f"simulation.duration_s={seconds}", "--set", "expect={}")
    samples = {}  # process: [(seconds, resident kB, descriptors)]
    while run.poll() is None:
        for name, pid in processes_of(run.pid).items():
            with contextlib.suppress(OSError, IndexError):
                samples.setdefault(name, []).append((time.monotonic() - began, *use_of(pid)))
        with contextlib.suppress(subprocess.TimeoutExpired):
            run.wait(max(0.5, seconds / 400))
        if time.monotonic() - began > 2 * seconds + 300:
            run.terminate()
    said = run.stdout.read()
    mistakes = [] if run.returncode == 0 else [f"{scenario.stem}: exit code {run.returncode}\n{said}"]
    if not samples:
        mistakes.append(f"{scenario.stem}: no process of it was ever seen")
    print(f"{scenario.stem}, {seconds} s in real time\n{'process':12} {'kB early':>10} {'kB late':>10} {'fd early':>9} {'fd late':>8}")
    for name, seen in sorted(samples.items()):
        early = max((s for s in seen if s[0] <= seen[-1][0] * 0.2), key=lambda s: s[1])
        late = max(seen[len(seen) * 4 // 5:], key=lambda s: s[1])
        print(f"{name:12} {early[1]:>10} {late[1]:>10} {early[2]:>9} {late[2]:>8}")
        if late[1] > max(early[1] * LET, early[1] + FILLS_KB.get(name, LET_KB)):
            mistakes.append(f"{scenario.stem}: memory of {name} grew from {early[1]} to {late[1]} kB")
        if late[2] > early[2] + 2:
            mistakes.append(f"{scenario.stem}: descriptors of {name} grew from {early[2]} to {late[2]}")
    summary = out / "report/summary.json"
    lost = [f"{name} = {value}" for name, value in results(summary) if "lost" in name or "overrun" in name]
    print("  what it says of its time: " + (", ".join(lost) or "nothing was lost"))
    shutil.rmtree(out, ignore_errors=True)
    return mistakes


def results(summary):
    """(name, value) of each number in a summary, by its path."""
    def walk(prefix, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from walk(f"{prefix}.{key}" if prefix else key, inner)
        elif isinstance(value, (int, float)) and not isinstance(value, bool) and value:
            yield prefix, value
    return walk("", json.loads(summary.read_text())) if summary.exists() else []


def a_little_of(gridspace, scenario):
    """The shortest of some times that is a whole number of the scenario's ticks."""
    times = ("0.02s", "0.05s", "1s", "10s")[0 if "goose" in scenario.read_text() or "smv" in scenario.read_text() else 2:]
    for until in times:
        command = [gridspace, "run", scenario, "--dry-run", "--until", until, "--set", "expect={}"]
        if subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False).returncode == 0:
            return until
    return times[-1]  # the run says why not


def one_start(gridspace, scenario, out, until):
    """(seconds, mistake or None) of a run that is ended when the clock has gone a little."""
    began = time.monotonic()
    run = start(gridspace, scenario, out, "--until", until, "--set", "expect={}")
    try:
        said, _ = run.communicate(timeout=600)
    except subprocess.TimeoutExpired:
        run.kill()
        said = f"not done after 600 s\n{run.communicate()[0]}"
    if run.returncode != 0:
        return time.monotonic() - began, f"exit code {run.returncode}; run folder {out}\n{said}"
    shutil.rmtree(out, ignore_errors=True)
    return time.monotonic() - began, None


def starts(gridspace, scenario, times, folder, at_once):
    """Mistakes of a scenario that is started so many times."""
    until = a_little_of(gridspace, scenario)
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        ends = list(pool.map(lambda i: one_start(gridspace, scenario, folder / f"start_{scenario.stem}_{i}", until), range(times)))
    mistakes = [f"{scenario.stem}, start {i}: {mistake}" for i, (_, mistake) in enumerate(ends) if mistake]
    print(f"{scenario.stem:36} {times - len(mistakes)} of {times} starts, slowest {max(s for s, _ in ends):.1f} s", flush=True)
    return mistakes


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--gridspace", default=ROOT / "build/release/bin/gridspace", type=pathlib.Path)
    parser.add_argument("--seconds", type=int, default=int(os.environ.get("GRIDSPACE_SOAK_SECONDS", "3600")), help="of the long run; 0: none")
    parser.add_argument("--starts", type=int, default=int(os.environ.get("GRIDSPACE_SOAK_STARTS", "100")), help="of each scenario; 0: none")
    parser.add_argument("--at-once", type=int, default=2, help="starts of a scenario at a time")
    parser.add_argument("--busy", type=int, default=4, help="busy loops beside the starts")
    parser.add_argument("--only", metavar="NAME", action="append", help="starts of this scenario (default: of all of configs/ that run natively)")
    arguments = parser.parse_args()

    folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace_soak_"))
    mistakes = long_run(arguments.gridspace, SCENARIOS / "protection.yaml", arguments.seconds, folder) if arguments.seconds else []
    busy = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(arguments.busy if arguments.starts else 0)]
    try:
        names = arguments.only or sorted(f.stem for f in SCENARIOS.glob("*.yaml") if "arm64" not in f.stem)
        for name in names if arguments.starts else []:
            mistakes += starts(arguments.gridspace, SCENARIOS / f"{name}.yaml", arguments.starts, folder, arguments.at_once)
    finally:
        for loop in busy:
            loop.kill()
    for mistake in mistakes:
        print("FAILED " + mistake)
    if not mistakes:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{len(mistakes)} mistakes")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
