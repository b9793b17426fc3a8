#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What a detector in the loop said while the run was made (topic ids_verdicts), as verdicts for `gridspace ids score`.

A sample is flagged when one of its phases is; its score is the largest error of a forecast, as a share of its limit.

    recorded_verdicts.py RUN > verdicts.csv
    gridspace ids score RUN verdicts.csv
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
import gridspace  # noqa: E402

JUDGED, FLAGGED = 1, 2  # idl/intrusion.idl


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("run", help="run folder whose relay has `ids: {verdicts: ids_verdicts}`")
    parser.add_argument("--topic", default="ids_verdicts")
    arguments = parser.parse_args()
    print("stream,sample,score,verdict")
    for message in gridspace.open(arguments.run).samples(arguments.topic):
        i = 0
        while f"samples_{i}_a_flags" in message:
            phases = [{name: message[f"samples_{i}_{phase}_{name}"] for name in ("raw_a", "forecast_a", "limit_a", "flags")} for phase in "abc"]
            judged = [p for p in phases if p["flags"] & JUDGED]
            if judged:
                score = max(abs(p["raw_a"] - p["forecast_a"]) / p["limit_a"] if p["limit_a"] > 0 else 0 for p in judged)
                print(f"{message['stream']},{message['first_index'] + i},{score:.6g},{int(any(p['flags'] & FLAGGED for p in judged))}")
            i += 1


if __name__ == "__main__":
    main()
