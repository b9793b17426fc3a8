#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Every file of this folder has one mistake; `gridspace validate` must say exactly what <file>.expected says, and exit with 2.

A file that starts with `# base: NAME` is made from a valid file of base/ by the lines that follow, so that the mistake is all
that there is to read:
    # base: ev_charging.yaml            the scenario, or ev_microgrid.yaml, the network
    # replace: duration_h: 8            a text that occurs in it once ...
    # with: duraton_h: 8                ... and what stands there instead (several pairs are allowed; \\n is a line end)
Everything else is taken as it is. After a message has been improved on purpose: invalid_configs_test.py --accept, and read the diff.
"""
import argparse
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BIN = pathlib.Path(os.environ.get("GRIDSPACE_BIN_DIR", SOURCE / "build/release/bin"))
BASES = {name: HERE / "base" / name for name in ("ev_charging.yaml", "ev_microgrid.yaml", "fdi.yaml", "study.yaml", "wire.yaml")}  # copies: line numbers stay
MODEL = (SOURCE / "configs/models/ar_20.json").read_text()
BESIDE = {  # what the bases refer to
    "adn_set_a.yaml": (SOURCE / "configs/networks/adn_set_a.yaml").read_text(),
    "ar_20.json": MODEL,
    "damaged.json": MODEL.replace('"scale_a": 0.', '"scale_a": 0.5', 1),  # one digit, and the hash does not fit
    "table.csv": "load_kw,requested_h,requested_h\n5,4,5\n",
    "weather.idl": "@final struct Weather { string<32> place; double celsius; };\n",
    "other_weather.idl": "@final struct Weather { string<32> place; double kelvin; };\n",
    "request.idl": "@final struct ChargingRequest { double current_a; };\n",
    "damaged.idl": "@final struct Weather {\n    double celsius\n};\n",
    "other_rate.json": (HERE / "base" / "model_4000_hz.json").read_text(),
}
VALID = ["ev_charging.yaml", "ev_microgrid.yaml", "fdi.yaml", "study.yaml", "wire.yaml"]  # the negative control: without a mistake nothing is said


def make(file, folder):
    """Writes the configuration that `file` describes into `folder`, laid out like configs/."""
    text = file.read_bytes()
    out = folder / file.name
    if not text.startswith(b"# base: "):
        out.write_bytes(text)
        return out
    lines = text.decode().splitlines()
    made = BASES[lines[0].removeprefix("# base: ")].read_text().replace("../networks/", "")
    wanted = None
    for line in lines[1:]:
        key, _, value = line.removeprefix("# ").partition(": ")
        if key == "replace":
            wanted = value.replace("\\n", "\n")
        elif key == "with":
            if made.count(wanted) != 1:
                raise ValueError(f"{file.name}: {wanted!r} occurs {made.count(wanted)} times in its base")
            made = made.replace(wanted, value.replace("\\n", "\n").replace("\\t", "\t"))
    out.write_text(made)
    return out


def judge(file):
    """(exit code, what validate says), without this machine's paths."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for name, base in BASES.items():
            (folder / name).write_text(base.read_text().replace("../networks/", ""))
        for name, text in BESIDE.items():
            (folder / name).write_text(text)
        made = make(file, folder) if file else None
        names = [made.name] if made else VALID
        done = subprocess.run([BIN / "gridspace", "validate", *names], cwd=folder, capture_output=True, timeout=60)
        said = (done.stderr + done.stdout).decode("utf-8", "replace").replace(str(folder), ".").replace(str(SOURCE), "SOURCE")
        # A list of all keys would change with every new one: its beginning is enough.
        return done.returncode, re.sub(r"((?:expected|exactly) one of: (?:\w+, ){3})\w.*", r"\1...", said)


def cases():
    return sorted(f for f in HERE.iterdir() if f.suffix in (".yaml", ".m"))


def check(file):
    expected_file = file.with_name(file.name + ".expected")
    code, said = judge(file)
    expected = expected_file.read_text() if expected_file.exists() else ""
    problems = [] if code == 2 else [f"exit code {code} instead of 2"]
    if said != expected:
        problems.append("".join(difflib.unified_diff(expected.splitlines(True), said.splitlines(True), "expected", "said")))
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--accept", action="store_true", help="write what is said now as what is expected")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("names", nargs="*", help="only files whose names begin so; `valid` for the negative control")
    arguments = parser.parse_args()
    chosen = [f for f in cases() if not arguments.names or f.name.startswith(tuple(arguments.names))]
    if arguments.list:
        print("\n".join(f.name for f in chosen))
        return 0
    if arguments.accept:
        for file in chosen:
            code, said = judge(file)
            file.with_name(file.name + ".expected").write_text(said)
            print(f"--- {file.name} (exit code {code})\n{said}", end="")
        return 0
    failed = 0
    if not arguments.names or "valid" in arguments.names:
        code, said = judge(None)
        if code != 0 or "error" in said:
            print(f"the valid files are not valid: {code}\n{said}")
            failed += 1
    for file in chosen:
        for problem in check(file):
            print(f"{file.name}: {problem}")
            failed += 1
    known = {f.name for f in cases()}
    stray = [f.name for f in HERE.glob("*.expected") if f.with_suffix("").name not in known]
    if stray:
        print(f"expected texts without a file: {stray}")
        failed += 1
    print(f"{len(chosen)} invalid files, {failed} problems")
    return 1 if failed or not (chosen or "valid" in arguments.names) else 0


if __name__ == "__main__":
    sys.exit(main())
