// The wire: what is known of every stream, and how its delays and intervals are spread.
import { useEffect } from "preact/hooks";
import { ask, drawn, forget, graph, run, signals, streams, values, type StreamEnd } from "./model";
import { Messages } from "./goose";
import { choose, choice } from "./state";
import { brief } from "./text";

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

function Histogram({ s, unit, limit }: { s: Spread; unit: string; limit?: number }) {
  const w = 220, h = 44, top = Math.max(...s.counts), x = (v: number) => ((v - s.low) / (s.high - s.low)) * w;
  return (
    <svg viewBox={`0 0 ${w} ${h + 14}`} class="histogram" role="img" aria-label={`from ${brief(s.low)} to ${brief(s.high)}, median ${brief(s.p50)}`}>
      {s.counts.map((c, i) => c > 0 && <rect key={i} x={(i * w) / kBars} width={w / kBars - 0.6} y={h - Math.max(1, (c / top) * h)} height={Math.max(1, (c / top) * h)} />)}
      {limit !== undefined && limit < s.high && <path d={`M${x(limit)} 0V${h}`} class="limit" />}
      <text x={0} y={h + 12} class="tiny">{brief(s.low)}</text>
      <text x={w} y={h + 12} class="tiny right">{brief(s.high)} {unit}</text>
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
      <Histogram s={s} unit={unit} limit={limit} />
      <table class="plain"><tbody>
        <tr><td class="soft">median</td><td class="number">{brief(s.p50)} {unit}</td></tr>
        <tr><td class="soft">99 %</td><td class={`number ${limit !== undefined && s.p99 > limit ? "bad" : ""}`}>{brief(s.p99)} {unit}</td></tr>
        <tr><td class="soft">most</td><td class="number">{brief(s.max)} {unit}</td></tr>
      </tbody></table>
    </div>
  );
}

const kQuantities: [string, string, number | undefined][] = [
  ["wire_delay_ms", "wire delay", kClass], ["publish_age_ms", "age when sent", undefined], ["arrival_age_ms", "age when it arrives", kClass],
  ["interval_ms", "interval between frames", undefined],
];

interface Counted { rate?: number; sent: string; received: string; lost?: number; duplicate?: number; late?: number; state: string; said: string }

const whole = (v: number | undefined) => (v === undefined ? "–" : Math.round(v).toLocaleString("en"));

/** What the devices have counted themselves; they say so once a second. */
function of_devices(ends: StreamEnd[]): Counted {
  const senders = ends.filter(e => e.sends), receivers = ends.filter(e => !e.sends);
  const waiting = !receivers.length || receivers.some(e => e.state === "waiting"); // nothing has been counted
  const sum = (of: (e: StreamEnd) => number) => (!waiting ? receivers.reduce((a, e) => a + of(e), 0) : undefined);
  const frames = (list: StreamEnd[]) => [...new Set(list.map(e => whole(e.frames)))].join(" / ") || "–";
  const states = receivers.map(e => e.state);
  return {
    rate: receivers.find(e => e.frames > 1)?.rate_hz, sent: frames(senders), received: waiting ? "–" : frames(receivers),
    lost: sum(e => e.lost + e.dropped), duplicate: sum(e => e.duplicate), late: sum(e => e.late),
    state: waiting ? "waiting" : states.includes("lost") ? "lost" : "alive",
    said: ends.map(e => `${e.process}: ${whole(e.frames)} ${e.sends ? "sent" : "received"}, ${e.refused} refused, ${e.silences} silences, at ${e.time_s.toFixed(1)} s`).join("\n"),
  };
}

/** The same from recorded signals, as far as they go. */
function of_signals(told: (what: string) => number | undefined): Counted {
  const early = told("received") === 0 && told("lost") === 0; // nothing has been counted yet
  const counted = (what: string) => (early ? undefined : told(what));
  const st = told("st_num"), sq = told("sq_num");
  return {
    rate: told("rate_hz"), sent: "–", received: whole(counted("received")), lost: counted("lost"), duplicate: counted("duplicate"), late: counted("late"),
    state: st !== undefined && sq !== undefined ? `stNum ${st}, sqNum ${sq}` : "", said: "",
  };
}

export function Wire() {
  const g = graph.value, now = values.value;
  const names = new Set(signals.value.map(s => s.name));
  const wires = [...new Set(g?.wires.filter(w => w.publishes).map(w => w.stream) ?? [])].sort();
  if (!wires.length) return <p class="empty">this scenario has no raw frames</p>;
  const recorded = run.value?.recorded ?? false;
  return (
    <div class="scroll" tabindex={0} aria-label="streams">
      <table class="plain">
        <thead><tr><th>stream</th><th>from</th><th>to</th><th>state</th><th class="number">rate</th>{!recorded && <th class="number">sent</th>}<th class="number">received</th>
          <th class="number" title="missing between those received, and dropped by the kernel">lost</th><th class="number">twice</th><th class="number" title="behind newer ones">late</th></tr></thead>
        <tbody>
          {wires.map(s => {
            const ends = g!.wires.filter(w => w.stream === s);
            const devices = (publishes: boolean) => [...new Set(ends.filter(w => w.publishes === publishes).map(w => w.process))].join(", ");
            const c = recorded ? of_signals(what => now.get(`stream.${s}.${what}`)) : of_devices(streams.value.find(x => x.name === s)?.counted ?? []);
            return (
              <tr key={s} title={c.said}>
                <td>{s} <span class="soft">{ends[0].kind === "goose" ? "GOOSE" : "SMV"}</span></td>
                <td class="soft">{devices(true)}</td><td class="soft">{devices(false)}</td>
                <td class={c.state === "lost" ? "bad" : c.state === "alive" ? "good" : "soft"}>{c.state === "lost" ? "✕ " : c.state === "alive" ? "● " : ""}{c.state || "–"}</td>
                <td class="number">{c.rate === undefined ? "–" : `${c.rate.toFixed(1)} /s`}</td>
                {!recorded && <td class="number">{c.sent}</td>}<td class="number">{c.received}</td>
                <td class={`number ${c.lost ? "bad" : ""}`}>{c.lost ? "✕ " : ""}{whole(c.lost)}</td>
                <td class="number">{whole(c.duplicate)}</td><td class="number">{whole(c.late)}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      {run.value?.mode === "lockstep" && <p class="soft">In lockstep the wall clock means nothing: delays are measured in real time only.</p>}
      {wires.map(s => {
        const there = kQuantities.filter(([what]) => names.has(`stream.${s}.${what}`));
        return there.length > 0 && (
          <section key={s} class="spreads" aria-label={`delays of ${s}`}>
            <h3>{s}</h3>
            <Messages stream={s} />
            <div class="quantities">{there.map(([what, label, limit]) => <Quantity key={what} name={`stream.${s}.${what}`} label={label} unit="ms" limit={limit} />)}</div>
          </section>
        );
      })}
    </div>
  );
}
