// What has happened, on one axis of time: a lane for each source.
import { useEffect, useRef, useState } from "preact/hooks";
import { kindOf } from "./kinds";
import { events, run, type RunEvent } from "./model";
import { choice, choose } from "./state";
import { stamp } from "./text";
import { position } from "./transport";

const kLane = 22, kAxis = 20, kName = 92, kRight = 26, kMostLanes = 10, kLetter = 6.2;

/** Shows the moment t everywhere. */
export function jumpTo(t: number): void {
  if (run.value?.recorded) choose({ at: t });
  const half = Math.max((run.value?.duration_s || 1) / 200, 0.02);
  choose({ t0: Math.max(t - half, 0), t1: t + half });
}

/** Round steps that give about n marks. */
function steps(from: number, to: number, n: number): number[] {
  const hours = to - from >= 7200, raw = (to - from) / Math.max(n, 1);
  const base = hours ? [60, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400] : [1, 2, 5, 10].map(k => k * 10 ** Math.floor(Math.log10(raw)));
  const step = base.find(b => b >= raw) ?? base[base.length - 1];
  const out = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + step * 1e-9; ++k) out.push(k * step);
  return out;
}

const shape: Record<string, (x: number, y: number) => string> = {
  fault: (x, y) => `M${x + 2} ${y - 8}L${x - 5} ${y + 1}H${x}L${x - 2} ${y + 8}L${x + 5} ${y - 2}H${x}z`,
  act: (x, y) => `M${x - 5} ${y - 5}H${x + 5}L${x} ${y + 5}z`,
  alarm: (x, y) => `M${x} ${y - 6}L${x + 6} ${y}L${x} ${y + 6}L${x - 6} ${y}z`,
  lost: (x, y) => `M${x - 5} ${y - 5}L${x + 5} ${y + 5}M${x + 5} ${y - 5}L${x - 5} ${y + 5}`,
  note: (x, y) => `M${x - 3.5} ${y}a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z`,
};

export function Timeline() {
  const box = useRef<HTMLDivElement>(null);
  const [width, setWidth] = useState(900);
  useEffect(() => {
    const fit = new ResizeObserver(() => { if (box.current) setWidth(box.current.clientWidth); });
    if (box.current) fit.observe(box.current);
    return () => fit.disconnect();
  }, []);
  const list = events.value;
  const { t0, t1 } = choice.value, zoomed = t0 !== null && t1 !== null;
  const end = Math.max(run.value?.recorded ? 0 : run.value?.duration_s || 0, run.value?.time_s ?? 0, ...list.slice(-1).map(e => e.time_s)) || 1;
  const now = run.value?.recorded ? position() : (run.value?.time_s ?? 0);
  const all = [...new Set(list.map(e => e.source))], lanes = all.slice(0, kMostLanes);
  const laneOf = (e: RunEvent) => Math.min(all.indexOf(e.source), kMostLanes - 1);
  const x = (t: number) => kName + (Math.min(Math.max(t, 0), end) / end) * (width - kName - kRight);
  const marks = steps(0, end, (width - kName) / 110);
  const height = Math.max(lanes.length, 1) * kLane + kAxis;
  // A label stands where it does not run into the next event of its lane; events that fall together share one.
  const labelled = lanes.map((_, lane) => {
    const own = list.filter(e => laneOf(e) === lane), out = new Map<number, string>();
    for (let i = 0, free = 0; i < own.length; ) {
      const at = x(own[i].time_s);
      let end = i;
      while (end < own.length && x(own[end].time_s) < at + 3) ++end;
      const names = [...new Set(own.slice(i, end).map(e => (e.event === "event" ? e.text.slice(0, 28) : e.event)))].join(", ");
      const after = at + 9 + names.length * kLetter, next = end < own.length ? x(own[end].time_s) - 8 : width;
      if (at + 9 >= free && after < next) {
        out.set(own[end - 1].number, names);
        free = after;
      }
      i = end;
    }
    return out;
  });
  return (
    <div ref={box}>
      <svg class="timeline" width={width} height={height} viewBox={`0 0 ${width} ${height}`} role="group" aria-label="events over time">
        {zoomed && <rect class="zoomed" x={x(t0)} y={0} width={Math.max(x(t1) - x(t0), 2)} height={height - kAxis} />}
        {marks.map((t, i) => (
          <g key={t}><path class="gridline" d={`M${x(t)} 0V${height - kAxis}`} /><text class="small middle" x={x(t)} y={height - 6}>{end < 7200 ? `${Number(t.toPrecision(6))}${i === marks.length - 1 ? " s" : ""}` : stamp(t, end).replace(/:00$/, "") + (i === marks.length - 1 ? " h" : "")}</text></g>
        ))}
        {lanes.map((source, i) => (
          <g key={source}>
            <path class="lane" d={`M${kName} ${i * kLane + kLane / 2}H${width - kRight}`} />
            <text class="small" x={0} y={i * kLane + kLane / 2 + 4}>{i === kMostLanes - 1 && all.length > kMostLanes ? "others" : source.length > 14 ? source.slice(0, 13) + "…" : source}</text>
          </g>
        ))}
        <path class="now" d={`M${x(now)} 0V${height - kAxis}`} />
        {list.slice(-1000).map(e => {
          const lane = laneOf(e), y = lane * kLane + kLane / 2, kind = kindOf(e), at = x(e.time_s);
          const said = `${stamp(e.time_s, end)} ${e.source}: ${e.event}${e.text && e.event !== "event" ? ", " : " "}${e.text}`;
          return (
            <g key={e.number} class={`mark ${kind}${run.value?.recorded && e.time_s > now ? " later" : ""}`} tabindex={0} role="button" aria-label={said}
              onClick={() => jumpTo(e.time_s)} onKeyDown={k => { if (k.key === "Enter") jumpTo(e.time_s); }}>
              <title>{said}</title>
              <path d={shape[kind](at, y)} />
              <text class="tiny" x={at + 9} y={y + 3.5}>{labelled[lane].get(e.number)}</text>
            </g>
          );
        })}
      </svg>
    </div>
  );
}
