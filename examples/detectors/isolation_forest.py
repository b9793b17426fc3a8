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
    features.add_arguments(parser)
    parser.add_argument("--trees", type=int, default=100)
    parser.add_argument("--false-positives", type=float, default=0.004, help="share of genuine training rows that may be flagged")
    arguments = parser.parse_args()

    def train(x, y):
        genuine = x[y == 0]
        forest = IsolationForest(n_estimators=arguments.trees, random_state=arguments.seed, n_jobs=1).fit(genuine)
        limit = numpy.quantile(-forest.score_samples(genuine), 1 - arguments.false_positives)
        return lambda rows: -forest.score_samples(rows), limit

    features.judge(arguments, train)


if __name__ == "__main__":
    main()
