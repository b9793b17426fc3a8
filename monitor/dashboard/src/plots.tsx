// Waveforms: each plot shows the signals of a pattern; all share the time axis and the cursor.
import { useEffect, useRef, useState } from "preact/hooks";
import { Lines } from "./canvas";
import { ask, drawn, forget, network, over, signals } from "./model";
import { choice, choose } from "./state";
import { matches } from "./text";

const kMost = 12; // lines in a plot

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
  const its = [`line.${faulty}.from.i.*`, ...(network.value?.cts ?? []).filter(c => c.line === faulty).map(c => `ct.${c.name}.i.*`)];
  const about = (p: string) => (its.includes(p) ? its.indexOf(p) : its.length);
  const threePhase = [...patterns].filter(p => p.endsWith(".i.*")).sort((a, b) => about(a) - about(b)).slice(0, 1);
  const usual = kFirst.filter(p => patterns.has(p));
  const out = [...new Set([...threePhase, ...(threePhase.length ? usual.filter(p => p.includes("frequency")).slice(0, 1) : []), ...usual])].slice(0, 2);
  return out.length ? out : [...patterns].slice(0, 2);
}

function Plot({ pattern, index }: { pattern: string; index: number }) {
  const holder = useRef<HTMLDivElement>(null);
  const id = `plot${index}`;
  const names = signals.value.map(s => s.name).filter(n => matches(pattern, n)).slice(0, kMost);
  const { window, t0, t1 } = choice.value;
  const key = names.join(" ");
  useEffect(() => {
    if (!names.length) return;
    const px = Math.round((holder.current?.clientWidth ?? 800) * Math.min(devicePixelRatio, 2));
    ask(t0 !== null && t1 !== null ? { id, names, window_s: 0, t0, t1, px }
      : { id, names, window_s: window === "all" ? -1 : Number(window) || -1, t0: 0, t1: 0, px });
    return () => forget(id);
  }, [key, window, t0, t1]);
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
      <div ref={holder}>{names.length ? <Lines id={id} pattern={pattern} height={168} /> : <p class="empty">no signal is called {pattern}</p>}</div>
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
        {zoomed && <button onClick={() => choose({ t0: null, t1: null })}>{over() ? "the whole run" : "follow again"}</button>}
        <form onSubmit={e => { e.preventDefault(); if (asked) choose({ plots: [...list, asked].slice(-6) }); setAsked(""); }}>
          <input list="signal-names" placeholder="add: line.*.from.i_a" aria-label="add a plot of these signals" value={asked} onInput={e => setAsked(e.currentTarget.value)} />
          <datalist id="signal-names">{[...new Set(signals.value.map(s => patternOf(s.name)))].map(p => <option key={p} value={p} />)}</datalist>
        </form>
        <span class="soft wide">drag to zoom, double click to see all again</span>
        <button onClick={export_csv}>CSV</button>
      </div>
      {list.map((p, i) => <Plot key={`${i} ${p}`} pattern={p} index={i} />)}
    </>
  );
}
