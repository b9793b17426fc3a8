// The wire: what is known of every stream, and how its delays and intervals are spread.
import { useEffect } from "preact/hooks";
import { ask, drawn, forget, graph, run, signals, values } from "./model";
import { choose, choice } from "./state";
import { compact } from "./text";

const kClass = 3; // ms, IEC 61850-5 class of sampled values and trips
const kBars = 48;

interface Spread { low: number; high: number; counts: number[]; p50: number; p99: number; max: number; n: number }

/** How the values of a series are spread; null without any. */
export function spread(v: ArrayLike<number>): Spread | null {
  const sorted = Array.from(v).filter(isFinite).sort((a, b) => a - b);
  const n = sorted.length;
  if (!n) return null;
  const at = (q: number) => sorted[Math.min(n - 1, Math.ceil(q * n) - 1)];
  const low = Math.min(0, sorted[0]), high = Math.max(at(0.999) * 1.05, low + 1e-6);
  const counts = new Array(kBars).fill(0);
  sorted.forEach(x => { ++counts[Math.min(kBars - 1, Math.floor(((x - low) / (high - low)) * kBars))]; });
  return { low, high, counts, p50: at(0.5), p99: at(0.99), max: sorted[n - 1], n };
}

function Histogram({ s, limit }: { s: Spread; limit?: number }) {
  const w = 220, h = 44, top = Math.max(...s.counts), x = (v: number) => ((v - s.low) / (s.high - s.low)) * w;
  return (
    <svg viewBox={`0 0 ${w} ${h + 14}`} class="histogram" role="img" aria-label={`from ${compact(s.low)} to ${compact(s.high)}, median ${compact(s.p50)}`}>
      {s.counts.map((c, i) => c > 0 && <rect key={i} x={(i * w) / kBars} width={w / kBars - 0.6} y={h - Math.max(1, (c / top) * h)} height={Math.max(1, (c / top) * h)} />)}
      {limit !== undefined && limit < s.high && <path d={`M${x(limit)} 0V${h}`} class="limit" />}
      <text x={0} y={h + 12} class="tiny">{compact(s.low)}</text>
      <text x={w} y={h + 12} class="tiny right">{compact(s.high)}</text>
    </svg>
  );
}

/** One quantity of a stream over the whole run: drawn from the newest 4000 pixels' worth of samples. */
function Quantity({ name, label, unit, limit }: { name: string; label: string; unit: string; limit?: number }) {
  const id = `wire ${name}`;
  useEffect(() => {
    ask({ id, names: [name], window_s: -1, t0: 0, t1: 0, px: 4000 });
    return () => forget(id);
  }, [name]);
  const s = spread(drawn.value[id]?.series[0]?.v ?? []);
  const pattern = name.replace(/^stream\.[^.]+\./, "stream.*.");
  return !s ? null : (
    <div class="quantity">
      <button class="link" title="draw it over time" onClick={() => choose({ plots: [pattern, ...choice.value.plots.filter(p => p !== pattern)].slice(0, 4) })}>{label}</button>
      <Histogram s={s} limit={limit} />
      <table class="plain"><tbody>
        <tr><td class="soft">median</td><td class="number">{compact(s.p50)} {unit}</td></tr>
        <tr><td class="soft">99 %</td><td class={`number ${limit !== undefined && s.p99 > limit ? "bad" : ""}`}>{compact(s.p99)} {unit}</td></tr>
        <tr><td class="soft">most</td><td class="number">{compact(s.max)} {unit}</td></tr>
      </tbody></table>
    </div>
  );
}

const kQuantities: [string, string, number | undefined][] = [
  ["wire_delay_ms", "wire delay", kClass], ["publish_age_ms", "age when sent", undefined], ["arrival_age_ms", "age when it arrives", kClass],
  ["interval_ms", "interval between frames", undefined],
];

export function Wire() {
  const g = graph.value, now = values.value;
  const names = new Set(signals.value.map(s => s.name));
  const streams = [...new Set(g?.wires.filter(w => w.publishes).map(w => w.stream) ?? [])].sort(); // others are whole links
  if (!streams.length) return <p class="empty">this scenario has no raw frames</p>;
  const told = (stream: string, what: string) => now.get(`stream.${stream}.${what}`);
  const whole = (v: number | undefined) => (v === undefined ? "–" : Math.round(v).toLocaleString("en"));
  return (
    <div class="scroll">
      <table class="plain">
        <thead><tr><th>stream</th><th>from</th><th>to</th><th class="number">rate</th><th class="number">received</th><th class="number">lost</th><th class="number">twice</th><th class="number">late</th></tr></thead>
        <tbody>
          {streams.map(s => {
            const ends = g!.wires.filter(w => w.stream === s);
            const lost = told(s, "lost");
            return (
              <tr key={s}>
                <td>{s} <span class="soft">{ends[0].kind === "goose" ? "GOOSE" : "SMV"}</span></td>
                <td class="soft">{ends.filter(w => w.publishes).map(w => w.process).join(", ")}</td>
                <td class="soft">{ends.filter(w => !w.publishes).map(w => w.process).join(", ")}</td>
                <td class="number">{told(s, "rate_hz") !== undefined ? `${told(s, "rate_hz")!.toFixed(1)} /s` : "–"}</td>
                <td class="number">{whole(told(s, "received") ?? told(s, "sq_num"))}</td>
                <td class={`number ${lost ? "bad" : ""}`}>{lost ? "✕ " : ""}{whole(lost)}</td>
                <td class="number">{whole(told(s, "duplicate"))}</td>
                <td class="number">{whole(told(s, "late"))}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      {run.value?.mode === "lockstep" && <p class="soft">In lockstep the wall clock means nothing: delays are measured in real time only.</p>}
      {streams.map(s => {
        const there = kQuantities.filter(([what]) => names.has(`stream.${s}.${what}`));
        return there.length > 0 && (
          <section key={s} class="spreads" aria-label={`delays of ${s}`}>
            <h3>{s}</h3>
            <div class="quantities">{there.map(([what, label, limit]) => <Quantity key={what} name={`stream.${s}.${what}`} label={label} unit="ms" limit={limit} />)}</div>
          </section>
        );
      })}
    </div>
  );
}
