#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs the shipped scenarios by their README command, one more at once than there are processors, and judges each by its exit code.

scenarios.json beside this file says for each
  exit       what must come out (1 where the failing expectation is the test)
  tier       who runs it: short (the default: contributors), all (CI), long (by command), arm64 (processes in emulation; each is
             compared with the same scenario run natively, with the settings of `arm64: native`)
  repeat     a second run must compare as identical to the first
  alone      it measures time: nothing runs beside it
  sanitizer  it runs in the tier of the sanitizers too, once; a report of theirs is a failure
  root       it needs root
A scenario file that it does not mention is a failure: nothing is skipped silently.
"""
import argparse
import concurrent.futures
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


class Outcome:
    """What one scenario gave: lines for the log, and failures with what was said."""

    def __init__(self, runs=0):
        self.runs, self.lines, self.failures = runs, [], []


def sanitizer_reports(out):
    """The logs of a run that hold a report of a sanitizer."""
    folder = out / "logs"
    for log in sorted(folder.glob("*")) if folder.exists() else []:
        text = log.read_text(errors="replace")
        if "ERROR: AddressSanitizer" in text or "runtime error:" in text or "WARNING: ThreadSanitizer" in text:
            yield f"{log}: a sanitizer report"


def try_scenario(gridspace, file, plan, folder, environment, once):
    """Runs a scenario, and once more when two runs are to be compared."""
    twice = (plan.get("repeat") or "arm64" in plan) and not once
    outcome = Outcome(2 if twice else 1)
    outs = [folder / f"{file.stem}_{i}" for i in range(outcome.runs)]
    for out in outs:
        shutil.rmtree(out, ignore_errors=True)
        # The emulated run comes first, its native twin second.
        settings = plan["arm64"]["native"] if "arm64" in plan and out is outs[-1] else []
        code, wall, text = run(gridspace, file, out, environment, settings)
        reports = list(sanitizer_reports(out))
        good = code == plan["exit"] and not reports
        outcome.lines.append(f"{file.stem:32} exit {code} (expected {plan['exit']}), {wall:.1f} s {'ok' if good else 'FAILED'}")
        if not good:
            outcome.failures.append("\n".join([f"{file.stem}: exit {code}, expected {plan['exit']}; run folder {out}", text, *reports]))
    if twice:
        code, text = call([gridspace, "compare", outs[0], outs[1]], 300)
        outcome.lines.append(f"{'':32} {text.strip()}")
        if code != 0:
            outcome.failures.append(f"{file.stem}: two runs differ\n{text}")
    if not outcome.failures:
        for out in outs:
            shutil.rmtree(out, ignore_errors=True)
    return outcome


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--gridspace", required=True)
    parser.add_argument("--tier", default="short", choices=("short", "all", "long", "arm64"))
    parser.add_argument("--sanitizer", action="store_true", help="those that are marked so, once, whatever their tier")
    parser.add_argument("--only", metavar="NAME", help="this scenario and no other, whatever its tier")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() + 1, help="how many at once (default: one more than processors: each waits a little)")
    parser.add_argument("--keep", type=pathlib.Path, help="leave the folders of failed runs here")
    arguments = parser.parse_args()

    wanted = json.loads((pathlib.Path(__file__).parent / "scenarios.json").read_text())
    here = pathlib.Path(__file__).parent
    files = [f for folder in (ROOT / "configs" / "scenarios", here / "misbehaviour", here / "attacks", here / "controls", here / "relays", here / "islanding", here / "clock") for f in sorted(folder.glob("*.yaml"))]
    failures = [f"{f.name} is a scenario, but tests/scenarios/scenarios.json does not say what must come out" for f in files if f.stem not in wanted]
    failures += [f"scenarios.json names {name}, but there is no such scenario file" for name in wanted if name not in {f.stem for f in files}]
    folder = arguments.keep or pathlib.Path(tempfile.mkdtemp(prefix="gridspace_scenarios_"))
    folder.mkdir(parents=True, exist_ok=True)

    def belongs(file):
        plan = wanted.get(file.stem)
        if plan is None or arguments.only:
            return plan is not None and file.stem == arguments.only
        return plan.get("sanitizer", False) if arguments.sanitizer else plan.get("tier", "short") == arguments.tier

    ran = 0
    chosen = [f for f in files if belongs(f)]
    for file in [f for f in chosen if wanted[f.stem].get("root") and os.geteuid() != 0]:
        print(f"{file.stem:32} NOT RUN: needs root")
        chosen.remove(file)
    for alone in (False, True):
        with concurrent.futures.ThreadPoolExecutor(1 if alone else max(1, arguments.jobs)) as pool:
            outcomes = [pool.submit(try_scenario, arguments.gridspace, f, wanted[f.stem], folder, dict(os.environ), arguments.sanitizer)
                        for f in chosen if wanted[f.stem].get("alone", False) == alone]
            for outcome in (o.result() for o in outcomes):
                print("\n".join(outcome.lines), flush=True)
                failures += outcome.failures
                ran += outcome.runs
    for failure in failures:
        print("FAILED " + failure)
    if not failures and not arguments.keep:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{ran} runs, {len(failures)} failures")
    return 1 if failures or ran == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
