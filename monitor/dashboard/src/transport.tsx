// A recorded run: where one looks, and playing it again.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { events, run, seek } from "./model";
import { opening } from "./opening";
import { choice, choose } from "./state";
import { time } from "./text";

const playing = signal(false);
let opened = choice.value.at !== null || choice.value.t0 !== null; // the address says where to look
const pace = signal(0); // simulated seconds per second; 0: the whole run in half a minute

/** The instant that is shown: the chosen one, or the end. */
export const position = () => choice.value.at ?? run.value?.time_s ?? 0;

export function Transport() {
  const r = run.value!;
  const end = r.time_s || r.duration_s, at = position(); // a run may have ended before its time
  const known = r.state === "recorded"; // while it is read, later instants are not there yet
  useEffect(() => { if (known) seek(choice.value.at); }, [known, choice.value.at]);
  useEffect(() => {
    if (opened || !known || !events.value.length) return;
    opened = true;
    const first = opening(events.value, end);
    if (first) choose(first);
  }, [known, events.value]);
  useEffect(() => {
    if (!playing.value) return;
    const timer = setInterval(() => {
      const next = position() + 0.1 * (pace.value || end / 30);
      if (next >= end) playing.value = false;
      choose({ at: Math.min(next, end) });
    }, 100);
    return () => clearInterval(timer);
  }, [playing.value, pace.value, end]);
  const jump = (forward: boolean) => {
    const times = [...new Set(events.value.map(e => e.time_s))].sort((a, b) => a - b);
    const to = forward ? times.find(t => t > at + 1e-9) : times.reverse().find(t => t < at - 1e-9);
    choose({ at: to ?? (forward ? end : 0) });
  };
  const play = () => {
    if (!playing.value && at >= end) choose({ at: 0 });
    playing.value = !playing.value;
  };
  return (
    <div class="transport" role="group" aria-label="recorded run">
      <button aria-label="to the event before" title="to the event before" onClick={() => jump(false)}>|◀</button>
      <button aria-label={playing.value ? "pause" : "play"} title={playing.value ? "pause" : "play"} onClick={play}>{playing.value ? "❚❚" : "▶"}</button>
      <button aria-label="to the next event" title="to the next event" onClick={() => jump(true)}>▶|</button>
      <select aria-label="pace" value={String(pace.value)} onChange={e => { pace.value = Number(e.currentTarget.value); }}>
        {[0, 0.01, 0.1, 1, 60, 3600].map(p => <option key={p} value={p}>{p ? `x${p}` : "in 30 s"}</option>)}
      </select>
      <input type="range" aria-label="instant" min={0} max={end} step={end / 10000} value={at}
        onInput={e => choose({ at: Number(e.currentTarget.value) })} />
      <span class="time">t = {time(at, end)} of {time(end, end)}</span>
    </div>
  );
}
