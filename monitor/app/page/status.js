// The plain page: what is known, as tables, twice a second. The dashboard does better; this one needs nothing.
"use strict";
const by = id => document.getElementById(id);
const short = v => typeof v === "number" ? (Number.isInteger(v) ? String(v) : v.toPrecision(6).replace(/\.?0+$/, "")) : v ?? "";
function table(id, heads, rows) {
  const node = by(id);
  node.replaceChildren();
  const add = (cells, tag) => {
    const tr = node.insertRow();
    cells.forEach((c, i) => {
      const cell = document.createElement(tag);
      cell.textContent = short(c && c.text !== undefined ? c.text : c);
      if (c && c.kind) cell.className = c.kind;
      if (typeof c === "number" || (tag === "th" && heads[i].startsWith(">"))) cell.className = "n";
      if (tag === "th") cell.textContent = heads[i].replace(">", "");
      tr.append(cell);
    });
  };
  add(heads, "th");
  rows.forEach(r => add(r, "td"));
}
const get = async path => (await fetch(path)).json();
async function refresh() {
  try {
    const [run, topics, signals, events] = await Promise.all(
      ["run", "topics", "signals", "events"].map(what => get("/api/v1/" + what)));
    document.title = `${run.scenario || "bus"} · Gridspace`;
    by("scenario").textContent = run.scenario;
    by("progress").value = run.duration_s > 0 ? run.time_s / run.duration_s : 0;
    by("clock").textContent = [
      run.state || "no clock seen", `t = ${run.time_s.toFixed(3)} s` + (run.duration_s > 0 ? ` of ${run.duration_s} s` : ""),
      `x${run.factor.toFixed(2)} real time`, run.mode, run.speed && `speed ${run.speed}`].filter(Boolean).join(", ");
    table("processes", ["process", "program", "host", "state", ">tick"],
      run.processes.map(p => [p.name, p.program, p.host, { text: p.state, kind: p.state }, p.tick ?? ""]));
    table("topics", ["topic", "type", "network", ">samples", ">per second"],
      topics.topics.map(t => [t.name, t.type, t.network, t.samples, t.samples_per_second]));
    table("signals", ["signal", ">value", "unit"], signals.signals.map(s => [s.name, s.value ?? "", s.unit]));
    table("events", [">t, s", "source", "event"], events.events.slice(-30).reverse().map(e => [e.time_s, e.source, e.text]));
  } catch {
    by("clock").textContent = "the monitor does not answer: the run is over, or the connection is";
  }
  setTimeout(refresh, 500);
}
refresh();
