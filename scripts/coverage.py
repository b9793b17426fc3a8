#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of the given sources that a build with --coverage has run through, all its programs together. A line counts once,
however many objects hold it (a header is in many)."""
import argparse
import collections
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


def counts(build, wanted):
    """{source: {line: how often}} of everything that has run."""
    lines = collections.defaultdict(dict)
    for data in sorted(build.rglob("*.gcda")):
        done = subprocess.run(["gcov", "--json-format", "--stdout", str(data)], capture_output=True, text=True, check=True, cwd=build)
        for report in done.stdout.splitlines():
            said = json.loads(report)
            for file in said["files"]:
                # Relative to the folder of the compilation where a compiler cache is in between, absolute elsewhere.
                path = pathlib.Path(said["current_working_directory"], file["file"]).resolve()
                name = str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else ""
                if name in wanted:
                    for line in file["lines"]:
                        known = lines[name]
                        known[line["line_number"]] = known.get(line["line_number"], 0) + line["count"]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--least", type=float, default=0, help="percent of all lines together")
    parser.add_argument("sources", nargs="+")
    arguments = parser.parse_args()
    lines = counts(arguments.build.resolve(), set(arguments.sources))
    total = run = absent = 0
    for source in arguments.sources:
        known = lines.get(source, {})
        missed = sorted(n for n, count in known.items() if count == 0)
        total, run, absent = total + len(known), run + len(known) - len(missed), absent + (not known)
        share = 100 * (1 - len(missed) / len(known)) if known else 0
        print(f"{source:<34} {share:6.1f} %  of {len(known):4}  missed: {', '.join(map(str, missed)) or 'none'}")
    percent = 100 * run / total if total else 0
    print(f"{'together':<34} {percent:6.1f} %  of {total:4}  (at least {arguments.least:g})")
    if absent:
        print(f"{absent} of the sources are in no program of {arguments.build}: misspelt, or not run")
    return 0 if not absent and percent >= arguments.least else 1


if __name__ == "__main__":
    sys.exit(main())
