# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The results of a bench as text and as a page."""
import html as escape

HEAD = ("figure", "value", "baseline", "ratio", "spread", "aim", "at the other commit")
STYLE = """body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:72rem;padding:0 1rem;color:#1b1f24;background:#fff}
table{border-collapse:collapse;width:100%}td,th{padding:.25rem .6rem;border-bottom:1px solid #d8dee4;text-align:right;vertical-align:top}
td:first-child,th:first-child{text-align:left}tr.part td{font-weight:600;padding-top:1rem}.met{color:#116329}.missed{color:#a40e26}
@media(prefers-color-scheme:dark){body{color:#e6edf3;background:#0d1117}td,th{border-color:#30363d}.met{color:#56d364}.missed{color:#ff7b72}}"""


def number(value):
    """Four figures, no exponent where none is needed."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def meets(row):
    """Whether the aim is met; None where there is none."""
    counted = row["value"] if row["ratio"] is None else row["ratio"]
    if row["aim"] is None:
        return None
    return counted >= row["aim"] if row["more_is_better"] else counted <= row["aim"]


def change(row, before):
    """What the earlier result said, and by how much it differs: better or worse."""
    old = next((r for r in (before or {}).get("rows", []) if (r["measure"], r["key"]) == (row["measure"], row["key"])), None)
    if old is None:
        return "" if before is None else "not measured"
    of = "value" if row["ratio"] is None or old["ratio"] is None else "ratio"
    if not old[of]:
        return number(old[of])
    by = 100 * (row[of] / old[of] - 1)
    word = "same" if abs(by) < 1 else "better" if (by > 0) == row["more_is_better"] else "worse"
    return f"{number(old[of])} ({by:+.0f} %, {word})"


def cells(row, before):
    aim = "-" if row["aim"] is None else f"{'>=' if row['more_is_better'] else '<='} {number(row['aim'])}: {'met' if meets(row) else 'missed'}"
    return [row["what"], f"{number(row['value'])} {row['unit']}", f"{number(row['baseline'])} ({row['baseline_what']})" if row["baseline"] is not None else "-",
            number(row["ratio"]), f"{number(row['least'])} to {number(row['most'])}", aim, change(row, before)]


def heading(result, before):
    words = f"commit {result['commit']}, {result['measured']}; {result['machine']}; load {result['load_before']} before, {result['load_after']} after"
    return words if before is None else f"{words}; beside commit {before['commit']} of {before['measured']}"


def text(result, before):
    """A table for the terminal."""
    columns = len(HEAD) - (before is None)
    rows = [list(HEAD[:columns])] + [cells(row, before)[:columns] for row in result["rows"]]
    widths = [max(len(row[i]) for row in rows) for i in range(columns)]
    lines = ["  ".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in rows]
    return "\n".join([heading(result, before), "", *lines, *(f"not measured: {why}" for why in result["not_measured"])])


def html(result, before):
    """A page without scripts."""
    columns = len(HEAD) - (before is None)
    out, part = [], None
    for row in result["rows"]:
        if row["measure"] != part:
            part = row["measure"]
            out.append(f'<tr class="part"><td colspan="{columns}">{escape.escape(part)}</td></tr>')
        kinds = ["", "", "", "", "", {True: "met", False: "missed", None: ""}[meets(row)], ""]
        out.append("<tr>" + "".join(f'<td class="{kind}">{escape.escape(cell)}</td>' for kind, cell in list(zip(kinds, cells(row, before)))[:columns]) + "</tr>")
    missing = "".join(f"<p class=missed>not measured: {escape.escape(why)}</p>" for why in result["not_measured"])
    return (f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>Gridspace bench</title><style>{STYLE}</style>"
            f"<h1>How fast</h1><p>{escape.escape(heading(result, before))}</p>{missing}<p>Medians of the rounds. The spread is that of the ratio where there is a "
            f"baseline, of the value elsewhere.</p><table><tr>{''.join(f'<th>{escape.escape(name)}</th>' for name in HEAD[:columns])}</tr>{''.join(out)}</table></html>\n")
