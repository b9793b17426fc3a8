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
    features.add_arguments(parser)
    parser.add_argument("--trees", type=int, default=60)
    parser.add_argument("--limit", type=float, default=0.5, help="flagged from this share of trees on")
    arguments = parser.parse_args()

    def train(x, y):
        if not 0 < y.sum() < len(y):
            parser.error("the runs to train on have no altered samples, or no genuine ones")
        forest = RandomForestClassifier(arguments.trees, min_samples_leaf=3, class_weight="balanced", random_state=arguments.seed, n_jobs=1).fit(x, y)
        return lambda rows: forest.predict_proba(rows)[:, 1], arguments.limit

    features.judge(arguments, train)


if __name__ == "__main__":
    main()
