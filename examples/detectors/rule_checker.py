#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Rules on headers, counters and times of sampled values and GOOSE, as commercial checkers have them. No waveform, no training.

    gridspace ids export runs/mine --out data
    rule_checker.py data RUN > verdicts.csv             # samples, for gridspace ids score
    rule_checker.py data RUN --messages > messages.csv  # GOOSE: frame,stream,altered,verdict,rules; the count on standard error
    rule_checker.py data RUN --alarms > alarms.csv      # both: when an alarm came and went, for gridspace ids score
"""
import argparse
import pathlib
import sys

from data_set import number, table, tables_of

ALARM_STANDS_S = 0.04  # after the last row that breaks a rule, as gridspace ids score does it for verdicts


def sample_rules(row, first, period_us):
    """The rules that a sample breaks; first: what the stream's first row said, period_us: from there to the second."""
    step, gap = number(row["count_step"] or 1), number(row["gap_us"])
    yield "wrong_source", row["source"] != first["source"]
    yield "duplicate_count", step == 0
    yield "count_jump", step not in (0, 1)
    yield "simulated", row["simulated"] == "1"
    yield "not_synchronised", row["smp_synch"] != first["smp_synch"]
    yield "late", gap > 3 * period_us


def message_rules(row, first, newest):
    """The rules that a message breaks; newest: the largest (stNum, sqNum) of the stream's first source."""
    state = (int(row["st_num"]), int(row["sq_num"]))
    yield "wrong_source", row["source"] != first["source"]
    yield "old_number", state <= newest
    yield "state_jump", state[0] > newest[0] + 1
    yield "old_time", number(row["age_ms"]) > 60_000
    yield "time_ahead", number(row["age_ms"]) < -10
    yield "simulated", row["simulated"] == "1"
    yield "long_time_to_live", number(row["live_ms"]) > 10_000
    yield "change_without_state", row["data_changed"] == "1" and row["st_step"] == "0"
    yield "flood", bool(row["gap_ms"]) and number(row["gap_ms"]) < 0.5


def samples_of(file):
    """Rows of a table of samples, each with the rules that it breaks."""
    first, period_us = {}, {}
    for row in table(file):
        known = first.setdefault(row["stream"], row)
        if row is not known:
            period_us.setdefault(row["stream"], number(row["gap_us"]))
        yield row, [name for name, is_broken in sample_rules(row, known, period_us.get(row["stream"], 1e9)) if is_broken]


def messages_of(file):
    """Rows of a table of GOOSE messages, each with the rules that it breaks."""
    first, newest = {}, {}
    for row in table(file):
        stream = row["stream"]
        known = first.setdefault(stream, row)
        yield row, [name for name, is_broken in message_rules(row, known, newest.get(stream, (0, -1))) if is_broken]
        if row["source"] == known["source"]:
            newest[stream] = max(newest.get(stream, (0, -1)), (int(row["st_num"]), int(row["sq_num"])))


def judge_samples(data, run, out):
    print("stream,sample,verdict,rules", file=out)
    for file in tables_of(data, run, "samples"):
        found = {}
        for row, broken in samples_of(file):
            found.setdefault((row["stream"], int(row["sample"])), set()).update(broken)
        for (stream, sample), rules in sorted(found.items()):
            if sample >= 0:
                print(f"{stream},{sample},{int(bool(rules))},{' '.join(sorted(rules))}", file=out)


def judge_messages(data, run, out):
    print("frame,stream,altered,verdict,rules", file=out)
    count = {}
    for file in tables_of(data, run, "messages"):
        for row, broken in messages_of(file):
            key = (row["altered"] == "1", bool(broken))
            count[key] = count.get(key, 0) + 1
            print(f"{row['frame']},{row['stream']},{row['altered']},{int(bool(broken))},{' '.join(broken)}", file=out)
    print(f"{run}: messages: forged {count.get((True, True), 0)} found, {count.get((True, False), 0)} missed; "
          f"genuine {count.get((False, True), 0)} flagged, {count.get((False, False), 0)} not", file=sys.stderr)


def judge_alarms(data, run, out):
    print("time_s,alarm", file=out)
    rows = sorted((number(row["time_s"]), bool(broken)) for kind, rows_of in (("samples", samples_of), ("messages", messages_of))
                  for file in tables_of(data, run, kind) for row, broken in rows_of(file))
    until_s = None  # no alarm stands
    for at_s, broken in rows:
        if until_s is not None and at_s > until_s:
            print(f"{until_s:.9g},0", file=out)
            until_s = None
        if broken:
            if until_s is None:
                print(f"{at_s:.9g},1", file=out)
            until_s = at_s + ALARM_STANDS_S


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("data", help="data set of gridspace ids export")
    parser.add_argument("run", nargs="+", help="the run that is judged; of several each gets OUT/RUN.csv")
    parser.add_argument("--out", type=pathlib.Path, help="folder of the verdicts, instead of standard output")
    parser.add_argument("--messages", action="store_true", help="GOOSE instead of sampled values")
    parser.add_argument("--alarms", action="store_true", help="alarms of both, instead of verdicts")
    arguments = parser.parse_args()
    if len(arguments.run) > 1 and arguments.out is None:
        parser.error("several runs: --out FOLDER")
    judge = judge_alarms if arguments.alarms else judge_messages if arguments.messages else judge_samples
    for run in arguments.run:
        if arguments.out is None:
            judge(arguments.data, run, sys.stdout)
        else:
            arguments.out.mkdir(parents=True, exist_ok=True)
            with open(arguments.out / f"{run}.csv", "w", newline="") as out:
                judge(arguments.data, run, out)


if __name__ == "__main__":
    main()
