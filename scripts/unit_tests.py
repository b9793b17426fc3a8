#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Every unit test of a build: each test program once, two at a time (as many as there are processors), those that measure last and alone.

CTest starts a program for each test, which in emulation and with sanitizers takes longer than the test. It stays the way to run one:
ctest --test-dir build/release -R NAME. What failed is printed; the last line holds the counts; --times gets "seconds name" a line.
"""
import argparse
import concurrent.futures
import contextlib
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys


def run(program, part, parts, emulator, patience_s, folder):
    """[(name, seconds, "passed" | "skipped" | what went wrong)] of the tests of one program, or of part `part` of `parts` of them."""
    results, log = folder / f"{program.name}.{part}.json", folder / f"{program.name}.{part}.log"
    environment = {**os.environ, "GTEST_TOTAL_SHARDS": str(parts), "GTEST_SHARD_INDEX": str(part)}
    ended = None
    with log.open("w") as output:
        with contextlib.suppress(subprocess.TimeoutExpired):
            ended = subprocess.run([*emulator, program, f"--gtest_output=json:{results}", "--gtest_color=no"], cwd=folder, env=environment,
                                   stdout=output, stderr=subprocess.STDOUT, timeout=patience_s).returncode
    out = []
    try:
        suites = json.loads(results.read_text())["testsuites"]
    except (OSError, ValueError):
        suites = []
    for suite in suites:
        for test in suite["testsuite"]:
            if test["status"] != "RUN":
                continue
            failures = "\n".join(f["failure"] for f in test.get("failures", []))
            verdict = failures or ("skipped" if test["result"] == "SKIPPED" else "passed")
            out.append((f"{program.name}.{test['classname']}.{test['name']}", float(test["time"].rstrip("s")), verdict))
    # A sanitizer may complain when all tests have passed: what a program returns counts too.
    failed = any(verdict not in ("passed", "skipped") for _, _, verdict in out)
    if ended is None or not suites or (ended != 0 and not failed):
        printed = log.read_text(errors="replace").splitlines()
        begun = [line.split("]")[1].strip() for line in printed if line.startswith("[ RUN ")] or ["no test"]
        how = f"not at its end after {patience_s} s" if ended is None else f"ended with {ended}"
        out.append((f"{program.name}.{begun[-1]}", 0.0, "\n".join([how, *printed[-60:]])))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build", type=pathlib.Path, help="its folder; the list of programs is its unit_tests.txt")
    parser.add_argument("--emulator", default="", help="the command that runs them")
    parser.add_argument("--patience", type=int, default=1200, help="seconds for a program")
    parser.add_argument("--allowed-skips", type=pathlib.Path, help="names that may be skipped; any other skip fails")
    parser.add_argument("--times", type=pathlib.Path, help="a file to append to")
    arguments = parser.parse_args()
    names = arguments.build / "unit_tests.txt"
    if not names.exists():
        sys.exit(f"{names} is not there: build the tests first (./gridspace test --only build)")
    programs = [line.split() for line in names.read_text().splitlines() if line.strip()]
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
    wrong = bool(failed) or not results
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
