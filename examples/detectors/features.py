# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Features of a data set for detectors that learn, and verdicts for `gridspace ids score`."""
import pathlib
import sys

import numpy

from data_set import number, table, tables_of

LAGS = 4  # samples that a row looks back
NAMES = [f"{name}_{lag}" for lag in range(LAGS) for name in ("kink_a", "kink_b", "kink_c", "sum")] + ["growth", "step", "gap"]


def add_arguments(parser):
    """What both forests are told."""
    parser.add_argument("data", help="data set of gridspace ids export")
    parser.add_argument("run", nargs="+", help="the run that is judged; of several each gets OUT/RUN.csv")
    parser.add_argument("--out", type=pathlib.Path, help="folder of the verdicts, instead of standard output")
    parser.add_argument("--train", choices=("attack", "grid", "other-kinds"), default="attack",
                        help="on the part train of split_by_attack or split_by_grid, or on all runs without the kinds of attack of the judged one")
    parser.add_argument("--rows", type=int, default=20000, help="genuine and altered rows that are trained on, each at most")
    parser.add_argument("--seed", type=int, default=1)


def runs_to_train_on(data, judged, how):
    """Never the judged run itself."""
    rows = list(table(pathlib.Path(data) / "runs.csv"))
    kinds = {row["run"]: set(filter(None, row["attack_kinds"].split("+"))) for row in rows}
    if judged not in kinds:
        sys.exit(f"'{data}' has no run '{judged}'")
    if how == "other-kinds":
        found = [row["run"] for row in rows if not kinds[row["run"]] & kinds[judged]]
    else:
        found = [row["run"] for row in rows if row[f"split_by_{how}"] == "train"]
    return tuple(run for run in found if run != judged)


def judge(arguments, train):
    """train(x, y) gives (what scores rows, the limit); runs with the same training share it."""
    trained = {}
    if len(arguments.run) > 1 and arguments.out is None:
        sys.exit("several runs: --out FOLDER")
    for run in arguments.run:
        runs = runs_to_train_on(arguments.data, run, arguments.train)
        if runs not in trained:
            trained[runs] = train(*training_rows(arguments.data, runs, arguments.rows, arguments.seed))
        score, limit = trained[runs]
        scored = [(stream, numbers, score(x)) for stream, numbers, x, _ in samples(arguments.data, run)]
        if arguments.out is None:
            write_verdicts(scored, limit)
        else:
            arguments.out.mkdir(parents=True, exist_ok=True)
            with open(arguments.out / f"{run}.csv", "w", newline="") as out:
                write_verdicts(scored, limit, out)


def samples(data, run):
    """(stream, sample numbers, features, labels) of each stream of a run: every size as a share of the peak of the last cycle."""
    for file in tables_of(data, run, "samples"):
        streams = {}
        for row in table(file):
            if row["ia_a"]:
                streams.setdefault(row["stream"], []).append(row)
        for stream, rows in sorted(streams.items()):
            peak = numpy.maximum([number(r["peak_a"]) for r in rows], 1e-6)
            now = numpy.column_stack([numpy.abs([number(r[c]) for r in rows]) / peak for c in ("kink_a_a", "kink_b_a", "kink_c_a", "sum_a")])
            lagged = [numpy.vstack([numpy.zeros((lag, 4)), now[:len(now) - lag]]) if lag else now for lag in range(LAGS)]
            largest = numpy.max(numpy.abs([[number(r[c]) for c in ("ia_a", "ib_a", "ic_a")] for r in rows]), axis=1)
            gaps = numpy.array([number(r["gap_us"]) for r in rows])
            usual = numpy.median(gaps[1:]) if len(gaps) > 1 else 1.0
            others = numpy.column_stack([largest / peak, numpy.abs([number(r["count_step"] or 1) - 1 for r in rows]), numpy.abs(gaps / max(usual, 1e-6) - 1)])
            first = slice(int(round(len(rows) > 80) * 80), None)  # a cycle until the peak is one
            yield (stream, numpy.array([int(r["sample"]) for r in rows])[first], numpy.clip(numpy.hstack(lagged + [others]), 0, 100)[first],
                   numpy.array([int(r["altered"]) for r in rows])[first])


def training_rows(data, runs, most, seed):
    """Features and labels of runs; at most so many genuine and so many altered rows, drawn by the seed."""
    parts = [(x, y) for run in runs for _, _, x, y in samples(data, run)]
    if not parts:
        sys.exit("there is no run to train on: another --train, or more runs")
    x, y = (numpy.concatenate(part) for part in zip(*parts))
    random = numpy.random.default_rng(seed)
    kept = numpy.concatenate([random.permutation(numpy.flatnonzero(y == kind))[:most] for kind in (0, 1)])
    return x[kept], y[kept]


def write_verdicts(scored, threshold, out=sys.stdout):
    """scored: (stream, sample numbers, scores) of each stream. Of two frames with one number the more suspicious counts."""
    print("stream,sample,score,verdict", file=out)
    for stream, numbers, scores in scored:
        worst = {}
        for number_, score in zip(numbers.tolist(), scores.tolist()):
            worst[number_] = max(score, worst.get(number_, score))
        for number_, score in sorted(worst.items()):
            if number_ >= 0:
                print(f"{stream},{number_},{score:.6g},{int(score >= threshold)}", file=out)
