// A relay around a fault: the currents that it hears, what it and its breakers said, and of a line differential its restraint plane.
import { useEffect, useRef, useState } from "preact/hooks";
import { phaseColour } from "./canvas";
import { ask, drawn, events, forget, network, run, signals, type Relay, type Series } from "./model";
import { choice, choose } from "./state";
import { brief } from "./text";

const kBefore = 0.02, kAfter = 0.06; // s around the fault
const kPhases = ["a", "b", "c"], kLane = 22, kLeft = 62, kPlot = 190;

/** The instant that times are counted from: the fault, or what the relay said first. */
function origin(relay: Relay): { t: number; said: string } | null {
  const faults = (network.value?.faults ?? []).map(f => f.at_s), now = run.value?.time_s ?? 0;
  const fault = faults.filter(t => t <= now).sort((a, b) => a - b)[0];
  if (fault !== undefined) return { t: fault, said: "the fault" };
  const first = events.value.find(e => e.source === relay.name && /pickup|trip/.test(e.event));
  return first ? { t: first.time_s, said: `the first ${first.event}` } : null;
}

/** A round step of which about n make the stretch. */
function step(stretch: number, n: number): number {
  const raw = stretch / n, ten = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map(k => k * ten).find(s => s >= raw) ?? raw;
}
const marks = (from: number, to: number, n: number) => {
  const by = step(to - from, n), out = [];
  for (let k = Math.ceil(from / by - 1e-9); k * by <= to + 1e-9 * by; ++k) out.push(Number((k * by).toPrecision(10)));
  return out;
};

function useWidth(): [preact.RefObject<HTMLDivElement>, number] {
  const box = useRef<HTMLDivElement>(null), [width, setWidth] = useState(600);
  useEffect(() => {
    const fit = new ResizeObserver(() => { if (box.current) setWidth(Math.max(box.current.clientWidth, 240)); });
    if (box.current) fit.observe(box.current);
    return () => fit.disconnect();
  }, []);
  return [box, width];
}

/** Values that were told for the same instants, in the order of time. */
function pairs(x: Series | undefined, y: Series | undefined): { t: number; x: number; y: number }[] {
  if (!x || !y) return [];
  const at = new Map<number, number>();
  x.t.forEach((t, i) => at.set(t, x.v[i]));
  return Array.from(y.t, (t, i) => ({ t, x: at.get(t) ?? NaN, y: y.v[i] })).filter(p => isFinite(p.x) && isFinite(p.y));
}

function Plane({ relay, from, zero }: { relay: Relay; from: Series[]; zero: number }) {
  const [box, width] = useWidth();
  const of = (quantity: string, phase: string) => from.find(s => s.name === `relay.${relay.name}.${quantity}.${phase}`);
  const paths = kPhases.map(p => ({ phase: p, points: pairs(of("restraint_a", p), of("differential_a", p)) })).filter(p => p.points.length > 1);
  if (!paths.length) return <div ref={box}><p class="empty">its differential and restraint currents have not come yet</p></div>;
  const needed = kPhases.flatMap(p => pairs(of("restraint_a", p), of("operate_at_a", p))).sort((a, b) => a.x - b.x);
  const all = paths.flatMap(p => p.points), height = 270, right = 10, bottom = 36;
  const most_x = 1.05 * Math.max(...all.map(p => p.x)), most_y = 1.1 * Math.max(...all.map(p => p.y), ...needed.map(p => p.y));
  const px = (v: number) => kLeft + (v / most_x) * (width - kLeft - right), py = (v: number) => height - bottom - (v / most_y) * (height - bottom - 12);
  // Below the least restraint that was seen the pickup alone counts, or the same slope: what was applied there is the least of all.
  const curve = needed.length ? [`M${px(0)} ${py(needed[0].y)}`, ...needed.map(p => `L${px(p.x).toFixed(1)} ${py(p.y).toFixed(1)}`)].join("") : "";
  const at = choice.value.at;
  return (
    <div ref={box}>
      <svg class="plane" width={width} height={height} viewBox={`0 0 ${width} ${height}`} role="img" aria-label={`differential over restraint current of ${relay.name}`}>
        {marks(0, most_y, 4).map(v => <g key={v}><path class="gridline" d={`M${kLeft} ${py(v)}H${width - right}`} /><text class="small end" x={kLeft - 6} y={py(v) + 4}>{v}</text></g>)}
        {marks(0, most_x, 5).map(v => <g key={v}><path class="gridline" d={`M${px(v)} 12V${height - bottom}`} /><text class="small middle" x={px(v)} y={height - bottom + 14}>{v}</text></g>)}
        <text class="small end" x={width - right} y={height - 4}>restraint, A</text><text class="small" x={4} y={10}>differential, A</text>
        {curve && <path class="characteristic" d={curve} />}
        {paths.map(({ phase, points }) => {
          const shown = at === null ? points[points.length - 1] : points.reduce((best, p) => (Math.abs(p.t - at) < Math.abs(best.t - at) ? p : best));
          return (
            <g key={phase}>
              <path class="phase" stroke={phaseColour(phase)} d={points.map((p, i) => `${i ? "L" : "M"}${px(p.x).toFixed(1)} ${py(p.y).toFixed(1)}`).join("")} />
              <circle cx={px(points[0].x)} cy={py(points[0].y)} r={3} fill={phaseColour(phase)} />
              <circle cx={px(shown.x)} cy={py(shown.y)} r={5} fill={phaseColour(phase)}><title>{`phase ${phase}, ${((shown.t - zero) * 1e3).toFixed(1)} ms: differential ${brief(shown.y)} A, restraint ${brief(shown.x)} A`}</title></circle>
            </g>
          );
        })}
      </svg>
    </div>
  );
}

function Course({ relay, currents, states, zero }: { relay: Relay; currents: Series[]; states: Series[]; zero: number }) {
  const [box, width] = useWidth();
  const ms = (t: number) => (t - zero) * 1e3, right = 26, from = -kBefore * 1e3, to = kAfter * 1e3;
  const x = (t: number) => kLeft + ((Math.min(Math.max(ms(t), from), to) - from) / (to - from)) * (width - kLeft - right);
  const values = currents.flatMap(s => Array.from(s.v)).filter(isFinite), most = 1.05 * Math.max(1e-9, ...values.map(Math.abs));
  const y = (v: number) => 10 + (1 - (v / most + 1) / 2) * (kPlot - 20);
  const lanes: [string, string, (v: number) => boolean][] = [
    ["pickup", `relay.${relay.name}.pickup`, v => v !== 0], ["trip", `relay.${relay.name}.trip`, v => v !== 0],
    ...relay.breakers.map(b => [`${b} open`, `breaker.${b}.position`, (v: number) => v === 1] as [string, string, (v: number) => boolean]),
  ];
  const height = kPlot + lanes.length * kLane + 30, at = choice.value.at;
  const known = Math.min(zero + kAfter, run.value?.recorded ? Infinity : run.value?.time_s ?? Infinity); // what comes later nobody knows
  return (
    <div ref={box}>
      <svg class="plane" width={width} height={height} viewBox={`0 0 ${width} ${height}`} role="img" aria-label={`currents of ${relay.name}, its pickup and trip, and its breakers`}>
        {marks(-most, most, 4).map(v => <g key={v}><path class="gridline" d={`M${kLeft} ${y(v)}H${width - right}`} /><text class="small end" x={kLeft - 6} y={y(v) + 4}>{v}</text></g>)}
        {marks(from, to, Math.max(4, width / 90)).map((v, i, list) => <g key={v}><path class="gridline" d={`M${x(zero + v / 1e3)} 8V${height - 24}`} /><text class="small middle" x={x(zero + v / 1e3)} y={height - 8}>{v}{i === list.length - 1 ? " ms" : ""}</text></g>)}
        <text class="small" x={4} y={10}>A</text>
        {currents.map(s => {
          const phase = s.name.slice(-1), far = relay.cts.length > 1 && s.name.startsWith(`ct.${relay.cts[1]}.`);
          return <path key={s.name} class={`phase${far ? " far" : ""}`} stroke={phaseColour(phase)} d={Array.from(s.t, (t, i) => `${i ? "L" : "M"}${x(t).toFixed(1)} ${y(s.v[i]).toFixed(1)}`).join("")} />;
        })}
        {lanes.map(([name, signal, up], lane) => {
          const s = states.find(one => one.name === signal), top = kPlot + lane * kLane;
          const spans: [number, number][] = [];
          s?.t.forEach((t, i) => {
            if (!up(s.v[i])) return;
            const end = i + 1 < s.t.length ? s.t[i + 1] : known, last = spans[spans.length - 1];
            if (last?.[1] === t) last[1] = end; else spans.push([t, end]); // a row that repeats it
          });
          const begin = spans.find(([a]) => a > zero - kBefore);
          return (
            <g key={name}>
              <text class="small end" x={kLeft - 6} y={top + 15}>{name}</text><path class="track" d={`M${kLeft} ${top + kLane - 4}H${width - right}`} />
              {spans.map(([a, b]) => <rect key={a} class="digital" x={x(a)} y={top + 5} width={Math.max(x(b) - x(a), 0)} height={kLane - 9} />)}
              {begin && ms(begin[0]) <= to && <text class="small" x={x(begin[0]) > width - 90 ? x(begin[0]) - 54 : x(begin[0]) + 5} y={top + 15} style={{ fill: x(begin[0]) > width - 90 ? undefined : "var(--panel)" }}>{ms(begin[0]).toFixed(1)} ms</text>}
            </g>
          );
        })}
        <path class="faulted" d={`M${x(zero)} 8V${height - 24}`} />
        {run.value?.recorded && at !== null && at > zero - kBefore && at < zero + kAfter && <path class="moment" d={`M${x(at)} 8V${height - 24}`} />}
      </svg>
    </div>
  );
}

export function Relays() {
  const all = network.value?.relays ?? [], relay = all.find(r => r.name === choice.value.relay) ?? all.find(r => signals.value.some(s => s.name === `relay.${r.name}.restraint_a.a`)) ?? all[0];
  const zero = relay ? origin(relay) : null, there = new Set(signals.value.map(s => s.name));
  const element = relay ? ["differential_a", "restraint_a", "operate_at_a"].flatMap(q => kPhases.map(p => `relay.${relay.name}.${q}.${p}`)).filter(n => there.has(n)) : [];
  const currents = relay ? relay.cts.flatMap(ct => kPhases.map(p => `ct.${ct}.i.${p}`)).filter(n => there.has(n)) : [];
  const states = relay ? ["pickup", "trip"].map(s => `relay.${relay.name}.${s}`).concat(relay.breakers.map(b => `breaker.${b}.position`)).filter(n => there.has(n)) : [];
  const key = [...element, ...currents, ...states].join(" ");
  useEffect(() => {
    if (!zero) return;
    const stretch = { window_s: 0, t0: zero.t - kBefore, t1: zero.t + kAfter, px: 4000 }; // every sample: values of one instant belong together
    const views = Object.entries({ "relay element": element, "relay currents": currents, "relay states": states }).filter(([, names]) => names.length);
    views.forEach(([id, names]) => ask({ id, names, ...stretch }));
    return () => views.forEach(([id]) => forget(id));
  }, [key, zero?.t]);
  if (!relay) return null;
  const of = (id: string) => drawn.value[id]?.series ?? [];
  return (
    <>
      <div class="tools">
        {all.length > 1 ? <select aria-label="relay" value={relay.name} onChange={e => choose({ relay: e.currentTarget.value })}>{all.map(r => <option key={r.name}>{r.name}</option>)}</select> : <h3>{relay.name}</h3>}
        {zero && <span class="soft">times since {zero.said}</span>}
        {kPhases.map(p => <span key={p}><i class="key" style={{ background: phaseColour(p) }} />{p}</span>)}
        {relay.cts.length > 1 && <span class="soft">solid: {relay.cts[0]}, dashed: {relay.cts[1]}</span>}
        {!element.length && relay.functions.includes("87L") && <span class="soft">its restraint plane is drawn where it publishes its values (element: publish_values)</span>}
        {element.length > 0 && <span class="soft">left: above the dashed characteristic the element picks up; small dots: begin, large: {choice.value.at === null ? "end" : "the moment that is shown"}</span>}
      </div>
      {zero === null ? <p class="empty">no fault yet, and nothing has picked up</p> : (
        <div class={element.length ? "planes" : ""}>
          {element.length > 0 && <Plane relay={relay} from={of("relay element")} zero={zero.t} />}
          <Course relay={relay} currents={of("relay currents")} states={of("relay states")} zero={zero.t} />
        </div>
      )}
    </>
  );
}
