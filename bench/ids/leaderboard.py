#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables of docs/benchmarks/intrusion_detection.md, of studies whose runs were kept.

    gridspace sweep configs/studies/ids_benchmark.yaml --keep --out runs/ids_benchmark
    gridspace sweep configs/studies/ids_benchmark_published.yaml --keep --out runs/ids_published
    python3 bench/ids/leaderboard.py runs/ids_published runs/ids_benchmark --out runs/ids_leaderboard

Writes leaderboard.json and tables.md; `leaderboard.py --tables leaderboard.json` prints the tables of figures that are there. Ours were in the loop of their own runs; foreign detectors read the data set of the runs
of one of ours, which raises alarms and lets samples pass as they came, and were not in the loop.
"""
import argparse
import csv
import json
import os
import pathlib
import random
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples/detectors"
FOREIGN = {  # name: (what makes the verdicts, with DATA, RUN... and --out)
    "rules on headers": "rule_checker.py DATA RUN",
    "random forest": "random_forest.py DATA RUN --train other-kinds",
    "isolation forest": "isolation_forest.py DATA RUN --train other-kinds",
}
LATE_MS = 0.21  # a sample
DRAWS = 1000


def ours(row):
    """The name of one of our detectors, from the parameters of its run."""
    model = pathlib.Path(row["model"]).stem
    return f"supervision ({row['on_unconfirmed']}), {model}" if "on_unconfirmed" in row else f"published loop, {model}"


def text_of(command, **kwargs):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, timeout=600, **kwargs).stdout


def score(program, run, *verdicts):
    return json.loads(text_of([program, "ids", "score", run, *verdicts, "--json"]))


def ratio(of, all_):
    return of / all_ if all_ else None


def pooled(scores):
    tp, fp, tn, fn = (sum(s[name] for s in scores) for name in ("true_positives", "false_positives", "true_negatives", "false_negatives"))
    return {"precision": ratio(tp, tp + fp), "recall": ratio(tp, tp + fn), "false_positives": ratio(fp, fp + tn)}


def with_intervals(scores, seed=1):
    """Figures of all runs together; 95 % percentiles of a bootstrap that draws runs."""
    drawn = random.Random(seed)
    again = [pooled(drawn.choices(scores, k=len(scores))) for _ in range(DRAWS)]
    out = {}
    for name, value in pooled(scores).items():
        values = sorted(a[name] for a in again if a[name] is not None)
        out[name] = {"value": value, "low": values[int(0.025 * len(values))] if values else None, "high": values[int(0.975 * len(values)) - 1] if values else None}
    return out


def percent(e):
    return "-" if e["value"] is None else f"{100 * e['value']:.3g} ({100 * e['low']:.3g} to {100 * e['high']:.3g})"


def consequence(rows):
    def number(row, name):
        return float(row[name]) if row[name] else 0.0

    real, tripped = (sum(number(r, n) for r in rows) for n in ("real_faults", "real_faults_tripped"))
    late = sum(1 for r in rows if r["real_fault_trip_added_ms"] and float(r["real_fault_trip_added_ms"]) > LATE_MS)
    return {"real_faults": int(real), "lost": int(real - tripped), "late": late, "false": int(sum(number(r, "false_trips") for r in rows)),
            "false_without": int(sum(number(r, "without") for r in rows))}


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    if sys.argv[1:2] == ["--tables"]:  # of figures that are there
        print(tables(json.loads(pathlib.Path(sys.argv[2]).read_text())), end="")
        return
    parser.add_argument("study", type=pathlib.Path, nargs="+", help="folders of the studies, made with --keep")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/gridspace")
    parser.add_argument("--python", default=sys.executable, help="one that has scikit-learn")
    parser.add_argument("--foreign", nargs="*", choices=list(FOREIGN), default=list(FOREIGN), help="which foreign detectors; all when left out")
    arguments = parser.parse_args()
    rows = []
    for study in arguments.study:
        with (study / "results.csv").open(newline="") as stream:
            rows += [row for row in csv.DictReader(stream) if row["state"] in ("passed", "failed")]
    if not rows:
        parser.error("there is no finished run")
    arguments.out.mkdir(parents=True, exist_ok=True)
    detectors = {}
    for row in rows:
        detectors.setdefault(ours(row), []).append(row)
    seen_by = next(name for name in sorted(detectors) if name.startswith("supervision (delay)") and "ar_20" in name)
    data = arguments.out / "data"
    if not data.exists():
        text_of([arguments.program, "ids", "export", *(row["folder"] for row in detectors[seen_by]), "--out", data])
    scores = {}
    for name, its_rows in detectors.items():
        print(name, file=sys.stderr)
        folder = arguments.out / "verdicts" / name.replace(" ", "_")
        folder.mkdir(parents=True, exist_ok=True)
        for row in its_rows:
            file = folder / f"{row['key']}.csv"
            if not file.exists():
                file.write_text(text_of([sys.executable, EXAMPLES / "recorded_verdicts.py", row["folder"]]))
            its = score(arguments.program, row["folder"], file)
            its["alarms"] = score(arguments.program, row["folder"])["alarms"]  # as operated: those that its relay raised
            scores.setdefault(name, []).append((row, its))
    for name, command in ((name, FOREIGN[name]) for name in arguments.foreign):
        print(name, file=sys.stderr)
        folder = arguments.out / "verdicts" / name.replace(" ", "_")
        words = command.split()
        runs = [row["key"] for row in detectors[seen_by]]
        text_of([arguments.python, EXAMPLES / words[0], data, *runs, *words[3:], "--out", folder])
        for row in detectors[seen_by]:
            scores.setdefault(name, []).append((row, score(arguments.program, row["folder"], folder / f"{row['key']}.csv")))
    write(arguments.out, scores, detectors)


def write(out, scores, detectors):
    board, by_attack = {}, {}
    for name, its in scores.items():
        alarms = [s["alarms"] for _, s in its]
        delays = [a["delay_ms"] for s in alarms for a in s["attacks"] if a["alarmed"]]
        board[name] = {**with_intervals([s for _, s in its]), "runs": len(its), "seen": sum(any(a["seen"] for a in s["attacks"]) for _, s in its),
                       "alarmed": sum(any(a["alarmed"] for a in s["attacks"]) for s in alarms), "delay_ms_median": statistics.median(delays) if delays else None,
                       "false_alarms": sum(s["false"] for s in alarms), "false_share": sum(s["false_s"] for s in alarms) / sum(s["genuine_s"] for s in alarms),
                       "consequence": consequence(detectors[name]) if name in detectors else None}
        for row, s in its:
            at = by_attack.setdefault(row["attack"].replace("bias_a: ~, ", ""), {}).setdefault(name, {"altered": 0, "found": 0, "seen": 0, "runs": 0, "rows": []})
            at["altered"] += s["true_positives"] + s["false_negatives"]
            at["found"] += s["true_positives"]
            at["seen"] += any(a["seen"] for a in s["attacks"])
            at["runs"] += 1
            at["rows"].append(row)
    for its in by_attack.values():
        for at in its.values():
            at["consequence"] = consequence(at.pop("rows"))
    found = {"detectors": board, "by_attack": by_attack, "load": os.getloadavg()}
    (out / "leaderboard.json").write_text(json.dumps(found, indent=2) + "\n")
    (out / "tables.md").write_text(tables(found))
    print(tables(found))


def tables(found):
    """Detectors, with intervals; what of each attack was found; what it did to trips."""
    board, by_attack = found["detectors"], found["by_attack"]
    in_loop = [name for name, b in board.items() if b["consequence"] is not None]
    lines = ["| detector | attacks alarmed | first alarm, ms, median | false alarms, their share of the time | attacks flagged | precision, % | recall of samples, % "
             "| false positives, % | trips lost, late, false |", "|---|" + "---|" * 8]
    for name, b in board.items():
        c = b["consequence"]
        delay = "-" if b["delay_ms_median"] is None else format(b["delay_ms_median"], ".3g")
        lines.append(f"| {name} | {b['alarmed']} of {b['runs']} | {delay} | {b['false_alarms']}, {100 * b['false_share']:.3g} % | {b['seen']} of {b['runs']} | "
                     f"{percent(b['precision'])} | {percent(b['recall'])} | {percent(b['false_positives'])} | {'not in the loop' if c is None else '{lost} of {real_faults}, {late}, {false}'.format(**c)} |")

    def table(title, names, cell):
        lines.extend(["", f"| {title} | " + " | ".join(names) + " |", "|---|" + "---|" * len(names)])
        for attack, its in by_attack.items():
            lines.append(f"| `{attack.strip()[1:-1]}` | " + " | ".join(cell(its[name]) for name in names) + " |")

    shown = [name for name in board if name.startswith("published") or "delay" in name or name not in in_loop]
    table("samples found, %", shown, lambda at: f"{100 * at['found'] / at['altered']:.3g}")
    table("trips lost / false, of 2 runs", [name for name in in_loop if "ar_20" in name or "mlp" in name],
          lambda at: "{lost} / {false}".format(**at["consequence"]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
