// A picture of some signals over time; all pictures share the cursor.
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { kindOf } from "./kinds";
import { drawn, events, run, type Drawn } from "./model";
import { choice, choose } from "./state";
import { compact, stamp, within } from "./text";

// Okabe and Ito's colours (colour-blind safe), darker or lighter by theme; then dashes tell them apart.
const kLight = ["#0060ad", "#c4570a", "#007a57", "#a3498a", "#8a6d00", "#1b1f27", "#3a9bd4"];
const kDark = ["#6fb1ff", "#ff9d5c", "#3fcf9f", "#e39ccb", "#e6c84a", "#e8ebf0", "#8fd3ff"];
const dark = () => {
  const theme = document.documentElement.dataset.theme;
  return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
};
/** Of phase a, b or c. */
export const phaseColour = (phase: string) => (dark() ? kDark : kLight)["abc".indexOf(phase)];
const css = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Of three phases the colours are the same everywhere: a, b, c by their letter, other places of the same quantity by dashes. */
function look_of(names: string[]): { colour: number; dash: number }[] {
  const phases = names.map(n => /\.([abc])$/.exec(n)?.[1]), places = [...new Set(names.map(n => n.slice(0, -2)))];
  if (names.length && phases.every(p => p !== undefined)) return names.map((n, i) => ({ colour: "abc".indexOf(phases[i]!), dash: places.indexOf(n.slice(0, -2)) }));
  return names.map((_, i) => ({ colour: i % kLight.length, dash: Math.floor(i / kLight.length) }));
}
const kDashes = [undefined, [6, 4], [2, 3]];

/** The series on one axis of times: each signal has its own, and a value holds until the next. */
function join(d: Drawn): uPlot.AlignedData {
  const tables = d.series.map(s => [Array.from(s.t), Array.from(s.v, v => (isNaN(v) ? null : v))] as unknown as uPlot.AlignedData);
  return tables.length ? uPlot.join(tables, d.series.map(() => [0, 2])) : [[]];
}

/** How many decimals tell multiples of a step: 3 of 0.025, 4 of 0.0025. */
function digitsOf(step: number): number {
  let digits = 0;
  for (let scaled = step; digits < 9 && Math.abs(scaled - Math.round(scaled)) > 1e-6 * scaled; scaled *= 10) ++digits;
  return digits;
}

/** What a picture shows in addition to the signals: names and dashes of its lines, marks at instants. */
export interface Look { label?: (name: string) => string; dash?: (name: string) => number[] | undefined; marks?: number[] }

function create(node: HTMLElement, d: Drawn, height: number, pattern: string, look: () => Look): uPlot {
  const colours = dark() ? kDark : kLight, ink = css("--soft"), line = css("--line");
  const whole = run.value?.duration_s || 1;
  const short = (name: string) => {
    const parts = name.split("."), fixedParts = pattern.split(".");
    return fixedParts.length === parts.length ? parts.filter((p, i) => fixedParts[i] !== p).join(".") || name : name;
  };
  const drawing = look_of(d.series.map(s => s.name));
  const volts = pattern.endsWith(".v_pu");
  return new uPlot({
    width: node.clientWidth, height, padding: [null, whole >= 7200 ? 36 : 24, null, null], // half of the last label
    legend: { live: true },
    cursor: { sync: { key: "time" }, drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
    scales: {
      x: { time: false, range: (u, lo, hi) => { const b = (u as uPlot & { ends?: [number, number] }).ends; return b && b[1] > b[0] ? b : [lo, hi > lo ? hi : lo + 1]; } },
      y: { range: (_u, lo, hi) => { const pad = (hi - lo) * 0.08 || Math.abs(hi) * 0.02 || 1; return [lo - pad, hi + pad]; } },
    },
    axes: [
      { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, values: (_u, at, _i, _s, incr) => at.map((t, i) => (whole < 7200 ? t.toFixed(digitsOf(incr)) : stamp(t, whole)) + (i === at.length - 1 ? (whole < 7200 ? " s" : " h") : "")), space: 90, size: 34,
        incrs: whole >= 7200 ? [1, 5, 10, 30, 60, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400] : undefined },
      { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, size: 62, values: (_u, at, _i, _s, incr) => at.map(v => (incr < 1e-6 || incr >= 1e6 ? compact(v) : v.toFixed(digitsOf(incr)))) },
    ],
    series: [
      { label: "t", value: (_u, t) => (t == null ? "" : `${stamp(t, whole)} ${whole < 7200 ? "s" : "h"}`) },
      ...d.series.map((s, i) => ({
        label: look().label?.(s.name) ?? short(s.name), stroke: colours[drawing[i].colour], width: 1.5, spanGaps: true,
        dash: look().dash?.(s.name) ?? kDashes[Math.min(drawing[i].dash, kDashes.length - 1)], points: { show: false },
        paths: s.steps ? uPlot.paths.stepped!({ align: 1 }) : undefined, // published on change: holds until then
        value: (u: uPlot, v: number | null) => (v === null || v === undefined ? "" : `${within(v, u.scales.y.max! - u.scales.y.min!)} ${s.unit}`),
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
          if (x >= left && x <= left + width) stroke(kindOf(e) === "fault" ? css("--bad") : ink, x, top, x, top + h);
        }
        u.ctx.setLineDash([]);
        u.ctx.fillStyle = css("--bad");
        const size = 5 * devicePixelRatio;
        for (const t of look().marks ?? []) {
          const x = u.valToPos(t, "x", true);
          if (x < left || x > left + width) continue;
          u.ctx.beginPath();
          u.ctx.moveTo(x - size, top);
          u.ctx.lineTo(x + size, top);
          u.ctx.lineTo(x, top + 1.6 * size);
          u.ctx.fill();
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

/** Draws what the monitor sends for the view `id`. */
export function Lines({ id, pattern, height, look }: { id: string; pattern: string; height: number; look?: Look }) {
  const holder = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const made = useRef("");
  const latest = useRef<Look>({});
  latest.current = look ?? {};
  const d = drawn.value[id], theme = choice.value.theme;
  // What the legend says while no pointer is over the picture: the instant that is looked at, or the newest.
  const tell = () => {
    const u = plot.current, times = u?.data[0];
    if (!u || !times?.length || (u.cursor.left ?? -1) >= 0) return;
    const until = (run.value?.recorded ? choice.value.at : null) ?? d?.t1 ?? Infinity;
    let idx = times.length - 1;
    while (idx > 0 && times[idx] > until) --idx;
    // Each signal has instants of its own: what it said last.
    const held = (values: ArrayLike<unknown>) => {
      let i = idx;
      while (i > 0 && values[i] === undefined) --i;
      return i;
    };
    u.setLegend({ idxs: u.data.map((values, i) => (i ? held(values) : idx)) });
  };
  useEffect(() => { plot.current?.redraw(false); requestAnimationFrame(tell); }, [choice.value.at, look?.marks, events.value]);
  useEffect(() => {
    const node = holder.current;
    if (!node || !d || !d.series.length) return;
    const shape = d.series.map(s => s.name + (s.steps ? "/" : "")).join(" ") + theme + (run.value?.duration_s ?? 0);
    if (!plot.current || made.current !== shape) {
      plot.current?.destroy();
      plot.current = create(node, d, height, pattern, () => latest.current);
      made.current = shape;
    }
    (plot.current as uPlot & { ends?: [number, number] }).ends = [d.t0, d.t1];
    plot.current.setData(join(d));
    requestAnimationFrame(tell); // once it is drawn: drawing empties the legend
  }, [d, theme]);
  useEffect(() => {
    const fit = new ResizeObserver(() => { if (holder.current) plot.current?.setSize({ width: holder.current.clientWidth, height }); });
    if (holder.current) fit.observe(holder.current);
    return () => { fit.disconnect(); plot.current?.destroy(); plot.current = null; };
  }, []);
  return <div ref={holder} class="canvas" style={{ minHeight: `${height}px` }} />;
}
