#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs every shipped scenario by its README command and judges it by its exit code.

scenarios.json beside this file says for each what must come out: the exit code (1 where the failing expectation is the test), whether
a second run must compare as identical to the first, which scenarios only --all runs, and which belong to the tier arm64 (processes in
emulation: `--arm64` runs these and no others, and compares each with the same scenario run natively). A scenario file that it does not
mention is a failure: nothing is skipped silently.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def call(command, timeout_s, environment=None):
    """(exit code or "none", what it said) of a command that is ended when it takes too long, as Ctrl-C would."""
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        said = process.communicate(timeout=timeout_s)[0]
        return process.returncode, said
    except subprocess.TimeoutExpired:
        pass
    process.terminate()
    try:
        said = process.communicate(timeout=60)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        said = process.communicate()[0]
    return "none", f"{said}\nnot done after {timeout_s} s"


def run(gridspace, scenario, out, environment, settings=()):
    began = time.monotonic()
    options = [word for setting in settings for word in ("--set", setting)]
    code, text = call([gridspace, "run", scenario, "--out", out, "--quiet", *options], 600, environment)
    return code, time.monotonic() - began, text


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gridspace", required=True)
    parser.add_argument("--all", action="store_true", help="also the scenarios that are marked so")
    parser.add_argument("--sanitizer", action="store_true", help="a sanitizer build: one run of each, and its reports are failures")
    parser.add_argument("--arm64", action="store_true", help="the scenarios with emulated processes, and no others")
    parser.add_argument("--only", metavar="NAME", help="this scenario of those, and no other")
    parser.add_argument("--keep", type=pathlib.Path, help="keep the run folders here")
    arguments = parser.parse_args()

    wanted = json.loads((pathlib.Path(__file__).parent / "scenarios.json").read_text())
    misbehaviour = pathlib.Path(__file__).parent / "misbehaviour"
    files = sorted((ROOT / "configs" / "scenarios").glob("*.yaml")) + sorted(misbehaviour.glob("*.yaml"))
    failures = [f"{f.name} is a scenario, but tests/scenarios/scenarios.json does not say what must come out" for f in files if f.stem not in wanted]
    failures += [f"scenarios.json names {name}, but there is no such scenario file" for name in wanted if name not in {f.stem for f in files}]
    folder = arguments.keep or pathlib.Path(tempfile.mkdtemp(prefix="gridspace_scenarios_"))
    folder.mkdir(parents=True, exist_ok=True)
    environment = dict(os.environ)
    if arguments.sanitizer:
        environment["ASAN_OPTIONS"] = "new_delete_type_mismatch=0"  # Fast DDS 2.9's own mismatch

    ran = 0
    for file in files:
        plan = wanted.get(file.stem)
        if plan is None or (arguments.only and file.stem != arguments.only):
            continue
        if arguments.arm64 != ("arm64" in plan):
            if not arguments.arm64:
                print(f"{file.stem:32} not in this tier (runs in the tier arm64)")
            continue
        if plan.get("root") and os.geteuid() != 0:
            print(f"{file.stem:32} NOT RUN: needs root")
            continue
        if (arguments.sanitizer and plan.get("sanitizer") is False):
            continue
        if "not_yet" in plan:
            print(f"{file.stem:32} NOT RUN: {plan['not_yet']}")
            continue
        if plan.get("only_all") and not arguments.all and not arguments.sanitizer:
            print(f"{file.stem:32} not in this tier (runs with --all)")
            continue
        outs = [folder / f"{file.stem}_{i}" for i in range(2 if (plan.get("repeat") or "arm64" in plan) and not arguments.sanitizer else 1)]
        for out in outs:
            shutil.rmtree(out, ignore_errors=True)
            # The emulated run comes first, its native twin second.
            settings = plan["arm64"]["native"] if "arm64" in plan and out is outs[1] else []
            code, wall, text = run(arguments.gridspace, file, out, environment, settings)
            ran += 1
            good = code == plan["exit"]
            for log in sorted((out / "logs").glob("*")) if (out / "logs").exists() else []:
                if "ERROR: AddressSanitizer" in log.read_text(errors="replace") or "runtime error:" in log.read_text(errors="replace"):
                    good = False
                    text += f"\n{log}: a sanitizer report"
            print(f"{file.stem:32} exit {code} (expected {plan['exit']}), {wall:.1f} s {'ok' if good else 'FAILED'}")
            if not good:
                failures.append(f"{file.stem}: exit {code}, expected {plan['exit']}; run folder {out}\n{text}")
        if len(outs) == 2:
            code, text = call([arguments.gridspace, "compare", outs[0], outs[1]], 300)
            print(f"{'':32} {text.strip()}")
            if code != 0:
                failures.append(f"{file.stem}: two runs differ\n{text}")
    for failure in failures:
        print("FAILED " + failure)
    if not failures and not arguments.keep:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{ran} runs, {len(failures)} failures")
    return 1 if failures or ran == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
