#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A detector that is not Gridspace's: reads the frames of a run, writes verdicts that `gridspace ids score` judges.

A sinusoid of the grid's frequency obeys x[n] = 2 cos(w) x[n-1] - x[n-2]. The score of a sample is how far it is from that, as a
share of the largest current of the last cycle. Standard library only.

    kink_detector.py RUN > verdicts.csv
    gridspace ids score RUN verdicts.csv
"""
import argparse
import collections
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))
import gridspace  # noqa: E402


def scores(samples, rate_hz, frequency_hz):
    """(number of the sample in the run, score) of one stream; samples are (number, phase currents), in order."""
    turn = 2 * math.cos(2 * math.pi * frequency_hz / rate_hz)
    recent = collections.deque(maxlen=round(rate_hz / frequency_hz))
    for number, currents in samples:
        peak = max((abs(i) for old in recent for i in old), default=0.0)
        if len(recent) == recent.maxlen and peak > 0:
            one, two = recent[-1], recent[-2]
            yield number, max(abs(i - turn * a + b) for i, a, b in zip(currents, one, two)) / peak
        recent.append(currents)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("run", help="run folder with frames")
    parser.add_argument("--rate-hz", type=float, default=4800)
    parser.add_argument("--frequency-hz", type=float, default=60)
    parser.add_argument("--limit", type=float, default=0.05, help="flagged from this score on")
    arguments = parser.parse_args()
    streams = {}
    for s in gridspace.open(arguments.run).sampled_values():
        if ":" not in s.port:  # what its receivers hear, not what passes inside a cable
            second = round(s.time_s - s.count / arguments.rate_hz)
            streams.setdefault(s.stream, {}).setdefault(round(second * arguments.rate_hz) + s.count, s.floats()[:3])
    print("stream,sample,score,verdict")
    for stream, samples in streams.items():
        for number, score in scores(sorted(samples.items()), arguments.rate_hz, arguments.frequency_hz):
            print(f"{stream},{number},{score:.6g},{int(score >= arguments.limit)}")


if __name__ == "__main__":
    main()
