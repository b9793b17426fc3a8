// Where a recording opens: at its first event, in a window that shows what followed from it.
import { kindOf } from "./kinds";
import type { RunEvent } from "./model";

/** The instant and the window; null where nothing has happened that is worth one, then the whole run is shown. */
export function opening(events: RunEvent[], end: number): { at: number; t0: number; t1: number } | null {
  const caused = events.filter(e => kindOf(e) === "fault" || e.event === "event" || e.event.endsWith(".begins"));
  const first = caused[0] ?? events.find(e => kindOf(e) !== "note");
  if (!first) return null;
  // What follows belongs to it until nothing happens for long, compared with its length so far.
  let last = first.time_s;
  for (const e of events) if (e.time_s > last && e.time_s - last <= Math.max(5 * (last - first.time_s), end / 50)) last = e.time_s;
  const cycles = end < 100 ? 0.03 : 0; // s: of a run of waveforms some periods are to be seen
  const length = Math.max(last - first.time_s, end / 200, cycles);
  return { at: first.time_s, t0: Math.max(first.time_s - 0.5 * length, 0), t1: Math.min(last + length, end) };
}
