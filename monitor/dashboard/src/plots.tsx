// Waveforms: each plot shows the signals of a pattern; all share the time axis and the cursor.
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { ask, drawn, events, forget, network, run, signals, type Drawn } from "./model";
import { choice, choose } from "./state";
import { compact, matches, stamp } from "./text";

// Okabe and Ito's colours (colour-blind safe), darker or lighter by theme; then dashes tell them apart.
const kLight = ["#0060ad", "#c4570a", "#007a57", "#a3498a", "#8a6d00", "#1b1f27", "#3a9bd4"];
const kDark = ["#6fb1ff", "#ff9d5c", "#3fcf9f", "#e39ccb", "#e6c84a", "#e8ebf0", "#8fd3ff"];
const kMost = 12; // lines in a plot

const dark = () => {
  const theme = document.documentElement.dataset.theme;
  return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
};
const css = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** "bus.*.v_pu" for bus.B1.v_pu; with the phase open where there are three. */
export function patternOf(name: string): string {
  const parts = name.split(".");
  if (parts.length < 3) return name;
  if (/^[abc]$/.test(parts[parts.length - 1])) return [...parts.slice(0, -1), "*"].join("."); // one place, three phases
  return [parts[0], "*", ...parts.slice(2)].join(".");
}

/** What a stranger wants to see first. */
const kFirst = ["bus.*.v_pu", "ev.*.soc_percent", "line.TL*.from.i.*", "line.*.from.i_a", "machine.*.frequency_hz", "bus.*.frequency_hz", "ev.*.current_a"];
export function defaults(names: string[]): string[] {
  const patterns = new Set(names.map(patternOf));
  const faulty = network.value?.faults?.find(f => f.line)?.line; // what the scenario is about
  const threePhase = [...patterns].filter(p => p.endsWith(".i.*"))
    .sort((a, b) => Number(b === `line.${faulty}.from.i.*`) - Number(a === `line.${faulty}.from.i.*`)).slice(0, 1);
  const usual = kFirst.filter(p => patterns.has(p));
  const out = [...new Set([...threePhase, ...(threePhase.length ? usual.filter(p => p.includes("frequency")).slice(0, 1) : []), ...usual])].slice(0, 2);
  return out.length ? out : [...patterns].slice(0, 2);
}

/** The series on one axis of times: each signal has its own, and a value holds until the next. */
function join(d: Drawn): uPlot.AlignedData {
  const tables = d.series.map(s => [Array.from(s.t), Array.from(s.v)] as unknown as uPlot.AlignedData);
  return tables.length ? uPlot.join(tables, d.series.map(() => [0, 2])) : [[]];
}

function create(node: HTMLElement, d: Drawn, height: number, pattern: string): uPlot {
  const colours = dark() ? kDark : kLight, ink = css("--soft"), line = css("--line");
  const whole = run.value?.duration_s || 1;
  const short = (name: string) => {
    const parts = name.split("."), fixedParts = pattern.split(".");
    return fixedParts.length === parts.length ? parts.filter((p, i) => fixedParts[i] !== p).join(".") || name : name;
  };
  const volts = pattern.endsWith(".v_pu");
  return new uPlot({
    width: node.clientWidth, height,
    legend: { live: true },
    cursor: { sync: { key: "time" }, drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
    scales: {
      x: { time: false, range: (u, lo, hi) => { const b = (u as uPlot & { ends?: [number, number] }).ends; return b && b[1] > b[0] ? b : [lo, hi > lo ? hi : lo + 1]; } },
      y: { range: (_u, lo, hi) => { const pad = (hi - lo) * 0.08 || Math.abs(hi) * 0.02 || 1; return [lo - pad, hi + pad]; } },
    },
    axes: [
      { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, values: (_u, at, _i, _s, incr) => at.map(t => (whole < 7200 ? t.toFixed(Math.max(0, Math.ceil(-Math.log10(incr) - 1e-9))) : stamp(t, whole))), space: 90, size: 34,
        incrs: whole >= 7200 ? [1, 5, 10, 30, 60, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400] : undefined },
      { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, size: 62, values: (_u, at) => at.map(compact) },
    ],
    series: [
      { label: "t", value: (_u, t) => (t === null ? "" : stamp(t, whole)) },
      ...d.series.map((s, i) => ({
        label: short(s.name), stroke: colours[i % colours.length], width: 1.5, spanGaps: true,
        dash: i >= colours.length ? [6, 4] : undefined, points: { show: false },
        value: (_u: uPlot, v: number | null) => (v === null || v === undefined ? "" : `${compact(v)} ${s.unit}`),
      })),
    ],
    hooks: {
      drawClear: [u => { // limits of the voltage band, and what happened
        const { left, top, width, height: h } = u.bbox;
        u.ctx.save();
        u.ctx.beginPath();
        u.ctx.rect(left, top, width, h);
        u.ctx.clip();
        u.ctx.setLineDash([5, 4]);
        u.ctx.lineWidth = 1;
        const stroke = (colour: string, x1: number, y1: number, x2: number, y2: number) => {
          u.ctx.strokeStyle = colour;
          u.ctx.beginPath();
          u.ctx.moveTo(x1, y1);
          u.ctx.lineTo(x2, y2);
          u.ctx.stroke();
        };
        if (volts) for (const limit of [0.95, 1.05]) {
          const y = u.valToPos(limit, "y", true);
          stroke(css("--bad"), left, y, left + width, y);
        }
        for (const e of events.value) {
          const x = u.valToPos(e.time_s, "x", true);
          if (x >= left && x <= left + width) stroke(e.event === "fault" ? css("--bad") : ink, x, top, x, top + h);
        }
        if (run.value?.recorded && choice.value.at !== null) { // where one looks
          const x = u.valToPos(choice.value.at, "x", true);
          u.ctx.setLineDash([]);
          u.ctx.lineWidth = 2;
          if (x >= left && x <= left + width) stroke(css("--accent"), x, top, x, top + h);
        }
        u.ctx.restore();
      }],
      setSelect: [u => {
        if (u.select.width > 4) {
          choose({ t0: u.posToVal(u.select.left, "x"), t1: u.posToVal(u.select.left + u.select.width, "x") });
          u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
        }
      }],
    },
  }, join(d), node);
}

function Plot({ pattern, index }: { pattern: string; index: number }) {
  const holder = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const made = useRef("");
  const id = `plot${index}`;
  const names = signals.value.map(s => s.name).filter(n => matches(pattern, n)).slice(0, kMost);
  const { window, t0, t1, theme } = choice.value;
  const key = names.join(" ");
  useEffect(() => {
    if (!names.length) return;
    const px = Math.round((holder.current?.clientWidth ?? 800) * Math.min(devicePixelRatio, 2));
    ask(t0 !== null && t1 !== null ? { id, names, window_s: 0, t0, t1, px }
      : { id, names, window_s: window === "all" ? -1 : Number(window) || -1, t0: 0, t1: 0, px });
    return () => forget(id);
  }, [key, window, t0, t1]);
  const d = drawn.value[id];
  useEffect(() => { plot.current?.redraw(false); }, [choice.value.at]);
  useEffect(() => {
    const node = holder.current;
    if (!node || !d || !d.series.length) return;
    const shape = d.series.map(s => s.name).join(" ") + theme + (run.value?.duration_s ?? 0);
    if (!plot.current || made.current !== shape) {
      plot.current?.destroy();
      plot.current = create(node, d, 168, pattern);
      made.current = shape;
    }
    (plot.current as uPlot & { ends?: [number, number] }).ends = [d.t0, d.t1];
    plot.current.setData(join(d));
    if ((plot.current.cursor.left ?? -1) < 0) plot.current.setLegend({ idx: Math.max(plot.current.data[0].length - 1, 0) }); // the newest
  }, [d, theme]);
  useEffect(() => {
    const fit = new ResizeObserver(() => { if (holder.current) plot.current?.setSize({ width: holder.current.clientWidth, height: 168 }); });
    if (holder.current) fit.observe(holder.current);
    return () => { fit.disconnect(); plot.current?.destroy(); plot.current = null; };
  }, []);
  const patterns = [...new Set(signals.value.map(s => patternOf(s.name)))].sort();
  const unit = signals.value.find(s => s.name === names[0])?.unit ?? "";
  const all = choice.value.plots;
  const replace = (p: string | null) => {
    const list = all.length ? [...all] : defaults(signals.value.map(s => s.name));
    if (p === null) list.splice(index, 1); else list[index] = p;
    choose({ plots: list });
  };
  return (
    <section class="plot" onDblClick={() => choose({ t0: null, t1: null })}>
      <div class="tools">
        <select aria-label="signals of this plot" value={patterns.includes(pattern) ? pattern : ""} onChange={e => replace(e.currentTarget.value)}>
          {!patterns.includes(pattern) && <option value="">{pattern}</option>}
          {patterns.map(p => <option key={p} value={p}>{p}</option>)}
        </select>
        <span class="soft">{unit}{names.length === kMost ? `, the first ${kMost}` : ""}</span>
        <button title="remove this plot" aria-label={`remove the plot of ${pattern}`} onClick={() => replace(null)}>×</button>
      </div>
      <div ref={holder} class="canvas">{!names.length && <p class="empty">no signal is called {pattern}</p>}</div>
    </section>
  );
}

export function Plots() {
  const list = choice.value.plots.length ? choice.value.plots : defaults(signals.value.map(s => s.name));
  const [asked, setAsked] = useState("");
  const zoomed = choice.value.t0 !== null;
  const export_csv = () => {
    const rows = ["time_s,signal,value,unit"];
    Object.values(drawn.value).forEach(d => d.series.forEach(s => s.t.forEach((t, i) => rows.push(`${t},${s.name},${s.v[i]},${s.unit}`))));
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([rows.join("\n") + "\n"], { type: "text/csv" }));
    link.download = "view.csv";
    link.click();
    URL.revokeObjectURL(link.href);
  };
  return (
    <>
      <div class="tools">
        <select aria-label="stretch of time" value={choice.value.window} onChange={e => choose({ window: e.currentTarget.value, t0: null, t1: null })}>
          {["all", "14400", "3600", "600", "60", "10", "1", "0.1"].map(w =>
            <option key={w} value={w}>{w === "all" ? "everything" : Number(w) >= 3600 ? `last ${Number(w) / 3600} h` : `last ${w} s`}</option>)}
        </select>
        {zoomed && <button onClick={() => choose({ t0: null, t1: null })}>follow again</button>}
        <form onSubmit={e => { e.preventDefault(); if (asked) choose({ plots: [...list, asked].slice(-6) }); setAsked(""); }}>
          <input list="signal-names" placeholder="add: line.*.from.i_a" aria-label="add a plot of these signals" value={asked} onInput={e => setAsked(e.currentTarget.value)} />
          <datalist id="signal-names">{[...new Set(signals.value.map(s => patternOf(s.name)))].map(p => <option key={p} value={p} />)}</datalist>
        </form>
        <span class="soft wide">drag to zoom, double click to follow again</span>
        <button onClick={export_csv}>CSV</button>
      </div>
      {list.map((p, i) => <Plot key={`${i} ${p}`} pattern={p} index={i} />)}
    </>
  );
}
