#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""A random forest (scikit-learn) that learns from the labels of a data set, as an example of a supervised detector.

    gridspace ids export runs/study-attacks --out data
    random_forest.py data RUN > verdicts.csv            # trained on the runs of the part "train" without RUN
    gridspace ids score runs/study-attacks/runs/RUN/run verdicts.csv
"""
import argparse

from sklearn.ensemble import RandomForestClassifier

import features


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("data", help="data set of gridspace ids export")
    parser.add_argument("run", help="the run that is judged")
    parser.add_argument("--split", choices=("attack", "grid"), default="attack", help="which part of the data trains")
    parser.add_argument("--trees", type=int, default=60)
    parser.add_argument("--rows", type=int, default=20000, help="genuine and altered rows that are trained on, each at most")
    parser.add_argument("--limit", type=float, default=0.5, help="flagged from this share of trees on")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    train = [run for run in features.runs_of(arguments.data, arguments.split, "train") if run != arguments.run]
    x, y = features.training_rows(arguments.data, train, arguments.rows, arguments.seed)
    if not 0 < y.sum() < len(y):
        parser.error("the runs to train on have no altered samples, or no genuine ones")
    forest = RandomForestClassifier(arguments.trees, min_samples_leaf=3, class_weight="balanced", random_state=arguments.seed, n_jobs=1).fit(x, y)
    scored = [(stream, numbers, forest.predict_proba(x)[:, 1]) for stream, numbers, x, _ in features.samples(arguments.data, arguments.run)]
    features.write_verdicts(scored, arguments.limit)


if __name__ == "__main__":
    main()
