# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Reads the tables of a data set of `gridspace ids export`. Standard library only."""
import csv
import pathlib
import sys


def table(file):
    with open(file, newline="") as stream:
        yield from csv.DictReader(stream)


def tables_of(data, run, kind):
    """The tables of what receivers hear: vantage points inside of a cable are left out."""
    data = pathlib.Path(data)
    found = [row["file"] for row in table(data / "captures.csv") if row["run"] == run and ":" not in row["vantage"]]
    if not found:
        sys.exit(f"'{data}' has no run '{run}'")
    return [data / f"{file}.{kind}.csv" for file in found]


def number(text):
    return float(text) if text else 0.0
