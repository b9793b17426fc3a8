#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""An isolation forest (scikit-learn) that learns from genuine samples alone, as an example of an unsupervised detector.

    gridspace ids export runs/study-attacks --out data
    isolation_forest.py data RUN > verdicts.csv         # trained on genuine rows of the part "train" without RUN
    gridspace ids score runs/study-attacks/runs/RUN/run verdicts.csv
"""
import argparse

import numpy
from sklearn.ensemble import IsolationForest

import features


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("data", help="data set of gridspace ids export")
    parser.add_argument("run", help="the run that is judged")
    parser.add_argument("--split", choices=("attack", "grid"), default="attack", help="which part of the data trains")
    parser.add_argument("--trees", type=int, default=100)
    parser.add_argument("--rows", type=int, default=20000, help="genuine rows that are trained on, at most")
    parser.add_argument("--false-positives", type=float, default=0.004, help="share of genuine training rows that may be flagged")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    train = [run for run in features.runs_of(arguments.data, arguments.split, "train") if run != arguments.run]
    x, y = features.training_rows(arguments.data, train, arguments.rows, arguments.seed)
    genuine = x[y == 0]
    forest = IsolationForest(n_estimators=arguments.trees, random_state=arguments.seed, n_jobs=1).fit(genuine)
    limit = numpy.quantile(-forest.score_samples(genuine), 1 - arguments.false_positives)
    scored = [(stream, numbers, -forest.score_samples(x)) for stream, numbers, x, _ in features.samples(arguments.data, arguments.run)]
    features.write_verdicts(scored, limit)


if __name__ == "__main__":
    main()
