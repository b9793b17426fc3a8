// The drawings of a study's page. `study` holds columns, states and labels of the runs.
const svgns = "http://www.w3.org/2000/svg";
const palette = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6A51A3", "#7F7F7F"];
const stateColours = { passed: "#0072B2", failed: "#D55E00", ended_early: "#000000", open: "#7F7F7F" };
const text = v => typeof v === "number" ? String(Number(v.toPrecision(5))) : String(v);
const named = c => c.unit ? `${c.name}, ${c.unit}` : c.name;

function add(parent, tag, attributes, content) {
  const e = document.createElementNS(svgns, tag);
  for (const [k, v] of Object.entries(attributes || {})) e.setAttribute(k, v);
  if (content !== undefined) e.textContent = content;
  parent.append(e);
  return e;
}

function ticks(low, high, count) {
  const raw = (high - low) / count, magnitude = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map(m => m * magnitude).find(s => s >= raw);
  const out = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) out.push(Math.abs(v) < 1e-12 * step ? 0 : v);
  return out;
}

// A column as an axis: numbers as they are, words in the order in which they come.
function axis(column) {
  const words = column.numbers ? [] : [...new Set(column.values)];
  const places = column.numbers ? column.values : column.values.map(v => words.indexOf(v));
  const known = places.filter(v => v !== null);
  let low = known.reduce((a, b) => Math.min(a, b), Infinity), high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  if (!(low <= high)) { low = 0; high = 1; }
  const pad = high > low ? 0.04 * (high - low) : Math.max(Math.abs(high) * 0.05, 0.5);
  return { places, words, low: low - pad, high: high + pad };
}

const short = word => String(word).length > 14 ? String(word).slice(0, 13) + "…" : String(word);
const marks = (a, count) => a.words.length ? a.words.map((w, i) => [i, short(w)]) : ticks(a.low, a.high, count).map(v => [v, text(v)]);

function limits(column, draw) {
  for (const v of [column.low, column.high]) if (v !== null && v !== undefined) draw(v);
}

// How much of one column a straight line of the other explains: 0 to 1.
function correlation(a, b) {
  const pairs = a.values.map((v, i) => [v, b.values[i]]).filter(([v, w]) => typeof v === "number" && typeof w === "number");
  const mean = k => pairs.reduce((sum, p) => sum + p[k], 0) / pairs.length, ma = mean(0), mb = mean(1);
  const sum = f => pairs.reduce((s, p) => s + f(p[0] - ma, p[1] - mb), 0), both = sum((x, y) => x * y);
  const of = sum(x => x * x) * sum((x, y) => y * y);
  return of > 0 ? both * both / of : 0;
}

function choose(run) {
  for (const e of document.querySelectorAll("tr.chosen")) e.classList.remove("chosen");
  const row = document.getElementById(`run-${run + 1}`);
  if (row) { row.classList.add("chosen"); row.scrollIntoView({ block: "center" }); }
}

function scatter(parent, x, y, colour) {
  const w = 1100, h = 430, left = 74, right = 16, top = 12, bottom = 46;
  const svg = add(parent, "svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": `${y.name} over ${x.name}` });
  const ax = axis(x), ay = axis(y);
  const px = v => left + (v - ax.low) / (ax.high - ax.low) * (w - left - right), py = v => h - bottom - (v - ay.low) / (ay.high - ay.low) * (h - top - bottom);
  for (const [v, name] of marks(ax, 10)) {
    add(svg, "line", { class: "grid", x1: px(v), x2: px(v), y1: top, y2: h - bottom });
    add(svg, "text", { x: px(v), y: h - bottom + 16, "text-anchor": "middle" }, name);
  }
  for (const [v, name] of marks(ay, 7)) {
    add(svg, "line", { class: "grid", x1: left, x2: w - right, y1: py(v), y2: py(v) });
    add(svg, "text", { x: left - 7, y: py(v) + 4, "text-anchor": "end" }, name);
  }
  limits(y, v => { if (v > ay.low && v < ay.high) add(svg, "line", { class: "limit", x1: left, x2: w - right, y1: py(v), y2: py(v) }); });
  limits(x, v => { if (v > ax.low && v < ax.high) add(svg, "line", { class: "limit", x1: px(v), x2: px(v), y1: top, y2: h - bottom }); });
  add(svg, "path", { class: "axis", fill: "none", d: `M${left} ${top}V${h - bottom}H${w - right}` });
  add(svg, "text", { x: (left + w - right) / 2, y: h - 8, "text-anchor": "middle" }, named(x));
  add(svg, "text", { transform: `translate(14 ${(top + h - bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, named(y));
  let key = [], colourOf;
  if (!colour) {
    colourOf = run => stateColours[study.states[run]];
    key = Object.entries(stateColours).filter(([s]) => study.states.includes(s)).map(([s, c]) => [s.replace("_", " "), c]);
  } else if (!colour.numbers || new Set(colour.values).size <= 8) {
    const values = [...new Set(colour.values)].filter(v => v !== null).sort((a, b) => colour.numbers ? a - b : 0);
    colourOf = run => palette[Math.max(0, values.indexOf(colour.values[run])) % palette.length];
    key = values.slice(0, 16).map((v, i) => [`${colour.name} = ${text(v)}`, palette[i % palette.length]]);
  } else { // blue to orange, dark to bright: told apart with any colour vision
    const a = axis(colour), mix = v => `hsl(${215 - 180 * v} 80% ${38 + 18 * v}%)`;
    colourOf = run => a.places[run] === null ? "#7F7F7F" : mix((a.places[run] - a.low) / (a.high - a.low));
    key = [0, 0.5, 1].map(v => [text(a.low + v * (a.high - a.low)), mix(v)]);
  }
  let drawn = 0;
  study.states.forEach((state, run) => {
    if (ax.places[run] === null || ay.places[run] === null) return;
    ++drawn;
    const dot = add(svg, "circle", { class: "dot", cx: px(ax.places[run]), cy: py(ay.places[run]), r: study.states.length > 600 ? 3 : 4.5, fill: colourOf(run) });
    add(dot, "title", {}, `run ${run + 1}, ${state.replace("_", " ")}\n${named(x)}: ${text(x.values[run])}\n${named(y)}: ${text(y.values[run])}\n${study.labels[run]}`);
    dot.addEventListener("click", () => choose(run));
  });
  const legend = document.createElement("div");
  legend.className = "key";
  legend.textContent = drawn < study.states.length ? `${drawn} of ${study.states.length} runs have both. ` : "A click on a run shows its row. ";
  for (const [name, c] of key) {
    const i = document.createElement("i");
    i.style.background = c;
    legend.append(i, name);
  }
  parent.append(legend);
}

function histogram(parent, column) {
  const values = column.values.filter(v => v !== null);
  const figure = document.createElement("div"), title = document.createElement("b");
  title.textContent = named(column);
  figure.append(title);
  parent.append(figure);
  const w = 340, h = 170, left = 34, right = 8, top = 8, bottom = 26;
  const svg = add(figure, "svg", { viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": `distribution of ${column.name}` });
  const a = axis(column), bins = Math.max(5, Math.min(40, Math.ceil(Math.sqrt(values.length)) + 3));
  const counts = new Array(bins).fill(0), width = (a.high - a.low) / bins;
  for (const v of values) ++counts[Math.min(bins - 1, Math.floor((v - a.low) / width))];
  const top_count = counts.reduce((x, y) => Math.max(x, y), 1);
  const px = v => left + (v - a.low) / (a.high - a.low) * (w - left - right), py = n => h - bottom - n / top_count * (h - top - bottom);
  for (const n of ticks(0, top_count, 4).filter(Number.isInteger)) {
    add(svg, "line", { class: "grid", x1: left, x2: w - right, y1: py(n), y2: py(n) });
    add(svg, "text", { x: left - 5, y: py(n) + 4, "text-anchor": "end" }, text(n));
  }
  for (const v of ticks(a.low, a.high, 4)) add(svg, "text", { x: px(v), y: h - bottom + 16, "text-anchor": "middle" }, text(v));
  counts.forEach((n, i) => {
    if (n === 0) return;
    const from = a.low + i * width;
    const bar = add(svg, "rect", { class: "bar", x: px(from) + 0.5, width: Math.max(1, px(from + width) - px(from) - 1), y: py(n), height: h - bottom - py(n) });
    add(bar, "title", {}, `${n} runs from ${text(from)} to ${text(from + width)}`);
  });
  limits(column, v => {
    if (v <= a.low || v >= a.high) return;
    for (const style of ["halo", "limit"]) add(svg, "line", { class: style, x1: px(v), x2: px(v), y1: top, y2: h - bottom });
  });
  add(svg, "path", { class: "axis", fill: "none", d: `M${left} ${top}V${h - bottom}H${w - right}` });
}

function select(parent, label, options, chosen, changed) {
  const l = document.createElement("label"), s = document.createElement("select");
  l.append(label, s);
  options.forEach(([name], i) => s.append(new Option(name, i, false, i === chosen)));
  s.addEventListener("change", changed);
  parent.append(l);
  return () => options[s.value][1];
}

(function () {
  const drawable = study.columns.filter(c => c.values.some(v => v !== null));
  const box = document.getElementById("scatter"), choices = document.createElement("div"), plot = document.createElement("div");
  choices.className = "choices";
  box.append(choices, plot);
  const options = drawable.map(c => [named(c), c]), numbers = drawable.filter(c => c.result && c.numbers && !c.condition);
  const spread = c => new Set(c.values).size;
  const y0 = numbers.slice().sort((a, b) => spread(b) - spread(a))[0] || drawable[drawable.length - 1];
  const x0 = drawable.filter(c => !c.result && c.numbers && spread(c) > 1).sort((a, b) => correlation(b, y0) - correlation(a, y0))[0] || drawable[0];
  if (!drawable.length || !y0) { box.closest("section").remove(); } else {
    const draw = () => { plot.replaceChildren(); scatter(plot, x(), y(), colour()); };
    const x = select(choices, "across", options, drawable.indexOf(x0), draw), y = select(choices, "up", options, drawable.indexOf(y0), draw);
    const colour = select(choices, "colour", [["state", null], ...options], 0, draw);
    draw();
  }
  const shown = document.getElementById("histograms");
  numbers.slice(0, 40).forEach(c => histogram(shown, c));
  if (!numbers.length) shown.closest("section").remove();

  for (const button of document.querySelectorAll(".copy")) button.addEventListener("click", async () => {
    const command = button.dataset.text;
    try { await navigator.clipboard.writeText(command); } catch { window.prompt("The command that repeats the run:", command); return; } // a page of a file may not copy everywhere
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy command"; }, 1200);
  });

  const table = document.querySelector(".runs");
  table.querySelectorAll("thead th").forEach((th, column) => th.addEventListener("click", () => {
    const body = table.tBodies[0], down = th.dataset.order === "up";
    const cell = row => row.cells[column].textContent, value = row => parseFloat(cell(row));
    const rows = [...body.rows].sort((a, b) => {
      const by = value(a) - value(b);
      return Number.isNaN(by) ? cell(a).localeCompare(cell(b)) : by;
    });
    th.dataset.order = down ? "down" : "up";
    body.append(...(down ? rows.reverse() : rows));
  }));
})();
