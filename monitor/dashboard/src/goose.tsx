// GOOSE, message by message: a stick for each, as high as the time since the one before; where stNum changes a new state begins.
import { useEffect } from "preact/hooks";
import { ask, drawn, forget, signals } from "./model";
import { choice } from "./state";
import { brief } from "./text";

const kWidth = 640, kHeight = 118, kLeft = 44, kBottom = 26, kTop = 18, kBefore = 6, kAfter = 22;

/** The value that held at t. */
function held(t: ArrayLike<number>, v: ArrayLike<number>, at: number): number {
  let i = 0;
  while (i + 1 < t.length && t[i + 1] <= at + 1e-9) ++i;
  return v[i];
}

export function Messages({ stream }: { stream: string }) {
  const id = `goose ${stream}`, names = ["interval_ms", "st_num", "sq_num"].map(what => `stream.${stream}.${what}`);
  const there = names.every(n => signals.value.some(s => s.name === n));
  const { t0, t1 } = choice.value;
  useEffect(() => {
    if (!there) return;
    ask(t0 !== null && t1 !== null ? { id, names, window_s: 0, t0, t1, px: 4000 } : { id, names, window_s: -1, t0: 0, t1: 0, px: 4000 });
    return () => forget(id);
  }, [stream, there, t0, t1]);
  const d = drawn.value[id], [interval, state, count] = names.map(n => d?.series.find(s => s.name === n));
  if (!interval?.t.length || !state?.t.length || !count?.t.length) return null;
  const all = Array.from(interval.t, (t, i) => ({ t, ms: interval.v[i], st: held(state.t, state.v, t), sq: held(count.t, count.v, t) }));
  const changed = all.findIndex((m, i) => i > 0 && m.st !== all[i - 1].st), from = changed < 0 ? 0 : Math.max(changed - kBefore, 0);
  const shown = all.slice(from, from + kBefore + kAfter).filter(m => isFinite(m.ms) && m.ms > 0);
  if (shown.length < 2) return null;
  const low = Math.min(0.5, ...shown.map(m => m.ms)), high = Math.max(...shown.map(m => m.ms)) * 1.3, step = (kWidth - kLeft - 8) / shown.length;
  const y = (ms: number) => kTop + ((Math.log(high) - Math.log(ms)) / (Math.log(high) - Math.log(low))) * (kHeight - kTop - kBottom);
  const begin = changed < 0 ? undefined : all[changed];
  return (
    <div class="scroll" tabindex={0} aria-label={`messages of ${stream}`}>
      <svg class="messages" viewBox={`0 0 ${kWidth} ${kHeight}`} role="img" aria-label={`interval to the message before, of ${shown.length} messages of ${stream}`}>
        <text class="small" x={0} y={11}>ms since the message before (logarithmic){begin ? `; stNum ${begin.st} from ${begin.t.toFixed(4)} s` : ""}</text>
        {[0.1, 1, 10, 100, 1000, 10000].filter(v => v > low && v < high).map(v => <g key={v}><path class="gridline" d={`M${kLeft} ${y(v)}H${kWidth}`} /><text class="small end" x={kLeft - 6} y={y(v) + 4}>{v}</text></g>)}
        {shown.map((m, i) => {
          const x = kLeft + (i + 0.5) * step, first = i > 0 && m.st !== shown[i - 1].st;
          return (
            <g key={m.t} class={first ? "first" : ""}>
              <title>{`${m.t.toFixed(4)} s: stNum ${m.st}, sqNum ${m.sq}, ${brief(m.ms)} ms after the one before`}</title>
              {first && <path class="change" d={`M${x - step / 2} ${kTop - 4}V${kHeight - kBottom}`} />}
              <path class="stick" d={`M${x} ${kHeight - kBottom}V${y(m.ms)}`} /><circle cx={x} cy={y(m.ms)} r={3.4} />
              {(m.sq < 100 || i % 3 === 0) && <text class="tiny middle" x={x} y={kHeight - kBottom + 12}>{m.sq}</text>}
            </g>
          );
        })}
        <text class="small end" x={kWidth} y={kHeight - 2}>sqNum</text>
      </svg>
    </div>
  );
}
