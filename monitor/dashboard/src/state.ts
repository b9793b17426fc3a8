// What the user has chosen; it lives in the address, so that a link shows the same.
import { effect, signal } from "@preact/signals";

export interface Choice {
  plots: string[]; // patterns: bus.*.v_pu
  window: string;  // seconds, or "all"
  t0: number | null; t1: number | null; // a stretch that was picked with the mouse
  at: number | null; // of a recorded run: the instant that is shown; null: its end
  framework: boolean; observers: boolean; // shown in the graph
  find: string; // marked in the graph
  ids: string;  // relay.stream.phase whose verdicts are drawn
  relay: string; // whose currents are drawn
  theme: string; // "", light, dark
}
const initial: Choice = { plots: [], window: "all", t0: null, t1: null, at: null, framework: false, observers: false, find: "", ids: "", relay: "", theme: "" };

function read(): Choice {
  const q = new URLSearchParams(location.hash.slice(1));
  const time = (name: string) => (q.has(name) && isFinite(Number(q.get(name))) ? Number(q.get(name)) : null);
  return {
    plots: q.get("plots")?.split(";").filter(Boolean) ?? initial.plots,
    window: q.get("window") ?? initial.window,
    t0: time("t0"), t1: time("t1"), at: time("at"),
    framework: q.has("framework"), observers: q.has("observers"),
    find: q.get("find") ?? "", ids: q.get("ids") ?? "", relay: q.get("relay") ?? "", theme: q.get("theme") ?? "",
  };
}
export const choice = signal<Choice>(read());
export const choose = (change: Partial<Choice>) => { choice.value = { ...choice.value, ...change }; };

/** What the drawer shows: a process or a topic. */
export const picked = signal<{ kind: "process" | "topic"; name: string } | null>(null);

effect(() => {
  const c = choice.value;
  const q = new URLSearchParams();
  if (c.plots.length) q.set("plots", c.plots.join(";"));
  if (c.window !== initial.window) q.set("window", c.window);
  if (c.t0 !== null && c.t1 !== null) { q.set("t0", String(c.t0)); q.set("t1", String(c.t1)); }
  if (c.at !== null) q.set("at", String(Number(c.at.toPrecision(9))));
  if (c.framework) q.set("framework", "1");
  if (c.observers) q.set("observers", "1");
  if (c.find) q.set("find", c.find);
  if (c.ids) q.set("ids", c.ids);
  if (c.relay) q.set("relay", c.relay);
  if (c.theme) { q.set("theme", c.theme); document.documentElement.dataset.theme = c.theme; }
  else delete document.documentElement.dataset.theme;
  history.replaceState(null, "", "#" + q.toString());
});
addEventListener("hashchange", () => { choice.value = read(); });
