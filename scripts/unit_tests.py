#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Every unit test of a build: each test program once, two at a time (as many as there are processors), those that measure last and alone.

CTest starts a program for each test, which in emulation and with sanitizers takes longer than the test. It stays the way to run one:
ctest --test-dir build/release -R NAME. What failed is printed; the last line holds the counts; --times gets "seconds name" a line.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys


def run(program, part, parts, emulator, patience_s, folder):
    """[(name, seconds, "passed" | "skipped" | what went wrong)] of the tests of one program, or of part `part` of `parts` of them."""
    results = folder / f"{program.name}.{part}.json"
    command = [*emulator, str(program), f"--gtest_output=json:{results}", "--gtest_color=no"]
    try:
        environment = {**os.environ, "GTEST_TOTAL_SHARDS": str(parts), "GTEST_SHARD_INDEX": str(part)}
        done = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=patience_s)
        printed, ending = done.stdout, "" if done.returncode in (0, 1) else f"ended with {done.returncode}"
    except subprocess.TimeoutExpired as late:
        printed = (late.stdout or b"").decode(errors="replace")
        ending = f"not at its end after {patience_s} s"
    (folder / f"{program.name}.{part}.log").write_text(printed)
    out = []
    try:
        suites = json.loads(results.read_text())["testsuites"]
    except (OSError, ValueError):
        suites, ending = [], ending or "it wrote no results"
    for suite in suites:
        for test in suite["testsuite"]:
            if test["status"] != "RUN":
                continue
            failures = "\n".join(f["failure"] for f in test.get("failures", []))
            verdict = failures or ("skipped" if test["result"] == "SKIPPED" else "passed")
            out.append((f"{program.name}.{test['classname']}.{test['name']}", float(test["time"].rstrip("s")), verdict))
    if ending:
        last = [line for line in printed.splitlines() if line.startswith("[ RUN ")]
        begun = last[-1].split("]")[1].strip() if last else "its start"
        out.append((f"{program.name}.{begun}", 0.0, f"{ending}:\n" + "\n".join(printed.splitlines()[-60:])))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build", type=pathlib.Path, help="its folder; the list of programs is its unit_tests.txt")
    parser.add_argument("--emulator", default="", help="the command that runs them")
    parser.add_argument("--patience", type=int, default=1200, help="seconds for a program")
    parser.add_argument("--allowed-skips", type=pathlib.Path, help="names that may be skipped; any other skip fails")
    parser.add_argument("--times", type=pathlib.Path, help="a file to append to")
    arguments = parser.parse_args()
    programs = [line.split() for line in (arguments.build / "unit_tests.txt").read_text().splitlines() if line.strip()]
    if not programs:
        sys.exit("no unit tests in " + str(arguments.build))
    arguments.build = arguments.build.resolve()
    folder = arguments.build / "unit_results"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    emulator = shlex.split(arguments.emulator)
    results = []

    def one(task):
        name, part, parts = task
        return run(arguments.build / "tests" / name, part, int(parts), emulator, arguments.patience, folder)

    beside = [(name, part, parts) for name, parts, how in programs if how == "beside" for part in range(int(parts))]
    alone = [(name, part, parts) for name, parts, how in programs if how == "alone" for part in range(int(parts))]
    # What takes long is not left for the end: those in parts, then the largest.
    beside.sort(key=lambda task: (-int(task[2]), -(arguments.build / "tests" / task[0]).stat().st_size))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(one, beside):
            results += found
    for task in alone:
        results += one(task)

    skipped = [name for name, _, verdict in results if verdict == "skipped"]
    failed = [(name, verdict) for name, _, verdict in results if verdict not in ("passed", "skipped")]
    for name, verdict in failed:
        print(f"{name}\n{verdict}\n")
    if arguments.times:
        with arguments.times.open("a") as times:
            times.writelines(f"{seconds:.2f} {name}\n" for name, seconds, _ in results)
    wrong = bool(failed)
    if arguments.allowed_skips:
        allowed = {line.split()[0] for line in arguments.allowed_skips.read_text().splitlines() if line.strip() and not line.startswith("#")}
        unexpected = [name for name in skipped if name not in allowed]
        if unexpected:
            print("not expected to be skipped: " + " ".join(unexpected))
            wrong = True
    if skipped:
        print("skipped: " + " ".join(skipped))
    if failed:
        print(f"the whole output: {folder}")
    print(f"{len(results)} tests, {len(failed)} failed, {len(skipped)} skipped")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
