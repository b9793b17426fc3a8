#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of this tree on this machine: every figure beside its baseline in the same run, medians of some rounds with their spread.

    ./gridspace bench                          everything, three rounds (ten minutes on two cores)
    ./gridspace bench codec emt --rounds 5     some of it
    ./gridspace bench --compare 1a2b3c4        beside what was measured at that commit on this machine

Writes bench.json and bench.html into --out (build/bench/results), and keeps each result by its commit in ~/.cache/gridspace/bench.
Asserts nothing: what matters is the ratio, on a machine that does nothing else (the load is in the result).
"""
import argparse
import datetime
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import page  # noqa: E402
from measures import MEASURES, ROOT, Build, Figure, NotMeasured  # noqa: E402

HISTORY = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "gridspace/bench"


def commit() -> str:
    """The commit of the tree, "-dirty" when something is not committed."""
    done = subprocess.run(["git", "describe", "--always", "--abbrev=12", "--dirty", "--exclude=*"], capture_output=True, text=True, cwd=ROOT)
    return done.stdout.strip() or "unknown"


def machine() -> str:
    model = next((line.split(":")[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")), platform.machine())
    return f"{os.cpu_count()} x {model}, Linux {platform.release()}"


def load() -> float:
    return round(os.getloadavg()[0], 2)


def row_of(measure: str, rounds: list[Figure]) -> dict:
    """One row of the result: the medians of the rounds, and the spread (least, most) of what counts: the ratio where there is one."""
    first = rounds[0]
    row = {"measure": measure, "key": first.key, "what": first.what, "unit": first.unit, "more_is_better": first.more_is_better, "aim": first.aim,
           "value": statistics.median(figure.value for figure in rounds), "rounds": len(rounds), "baseline": None, "baseline_what": first.baseline_what, "ratio": None}
    counted = [figure.value for figure in rounds]
    beside = [figure for figure in rounds if figure.baseline]
    if beside:
        row["baseline"] = statistics.median(figure.baseline for figure in beside)
        counted = [figure.value / figure.baseline for figure in beside]
        row["ratio"] = statistics.median(counted)
    return row | {"least": min(counted), "most": max(counted)}


def measured(names: list[str], rounds: int, build: Build) -> tuple[list[dict], list[str]]:
    """(rows, what could not be measured and why). The rounds of a measure follow each other, so that each is beside its baseline."""
    rows, missing = [], []
    for name in names:
        found: dict[str, list[Figure]] = {}
        for number in range(rounds):
            print(f"bench: {name}, round {number + 1} of {rounds}", file=sys.stderr, flush=True)
            try:
                for figure in MEASURES[name](build):
                    found.setdefault(figure.key, []).append(figure)
            except (NotMeasured, subprocess.TimeoutExpired, KeyError, ValueError) as e:
                missing.append(f"{name}: {e}")
                break
        rows += [row_of(name, figures) for figures in found.values()]
    return rows, missing


def earlier(wanted: str) -> dict:
    """What was measured at a commit, by the beginning of its name."""
    kept = sorted(HISTORY.glob("*.json"), key=lambda file: file.stat().st_mtime)
    fitting = [file for file in kept if wanted and file.stem.startswith(wanted)]
    if not fitting:
        sys.exit(f"error: nothing was measured here at '{wanted}'; there is {', '.join(file.stem for file in kept) or 'nothing yet'}")
    return json.loads(fitting[-1].read_text())


def main() -> int:
    parser = argparse.ArgumentParser(prog="gridspace bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measures", nargs="*", metavar="MEASURE", help=", ".join(MEASURES))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--compare", metavar="COMMIT")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/bench/results")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/bench", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if unknown := [name for name in asked.measures if name not in MEASURES]:
        parser.error(f"there is no measure '{unknown[0]}': expected {', '.join(MEASURES)}")
    if asked.rounds < 1:
        parser.error(f"--rounds {asked.rounds}: expected at least 1")
    before = earlier(asked.compare) if asked.compare else None
    result = {"commit": commit(), "measured": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"), "machine": machine(), "load_before": load()}
    result["rows"], result["not_measured"] = measured(asked.measures or list(MEASURES), asked.rounds, Build(asked.build))
    result["load_after"] = load()
    asked.out.mkdir(parents=True, exist_ok=True)
    HISTORY.mkdir(parents=True, exist_ok=True)
    for file in (asked.out / "bench.json", HISTORY / f"{result['commit']}.json"):
        file.write_text(json.dumps(result, indent=1) + "\n")
    (asked.out / "bench.html").write_text(page.html(result, before))
    print(page.text(result, before))
    print(f"{asked.out}/bench.html")
    return 1 if result["not_measured"] else 0


if __name__ == "__main__":
    sys.exit(main())
