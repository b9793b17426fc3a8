// Intrusion detection: what the detectors in front of the relays say, against what an attacker really did where that is known.
import { useEffect } from "preact/hooks";
import { Lines, type Look } from "./canvas";
import { ask, drawn, forget, run, signals, values, type Series } from "./model";
import { choice, choose } from "./state";

const kAlarms = ["flagged", "one end only", "unconfirmed pick-up", "noise", "locked out", "not armed", "measuring chain"]; // bits of alarm_reasons
const kAround = 0.0125; // s on both sides of a moment: one and a half cycles of 60 Hz

/** Relays with a detector, and the streams that each of them watches. */
export function detectors(names: Set<string>): { relay: string; streams: string[] }[] {
  const found = new Map<string, Set<string>>();
  for (const name of names) {
    const parts = name.split(".");
    if (parts[0] !== "ids") continue;
    if (parts.length === 3 && parts[2] === "alarm" && !found.has(parts[1])) found.set(parts[1], new Set());
    if (parts.length === 4 && (parts[3] === "samples" || parts[3] === "judged")) {
      if (!found.has(parts[1])) found.set(parts[1], new Set());
      found.get(parts[1])!.add(parts[2]);
    }
  }
  return [...found].map(([relay, streams]) => ({ relay, streams: [...streams].sort() })).sort((a, b) => a.relay.localeCompare(b.relay));
}

const whole = (v: number | undefined) => (v === undefined ? "–" : Math.round(v).toLocaleString("en"));
const percent = (v: number | undefined, digits = 2) => (v === undefined ? "–" : `${v.toFixed(digits)} %`);

function Alarm({ relay }: { relay: string }) {
  const alarm = values.value.get(`ids.${relay}.alarm`), bits = values.value.get(`ids.${relay}.alarm_reasons`) ?? 0;
  const granted = values.value.get(`ids.${relay}.granted`), told = values.value.get(`ids.${relay}.alarms`);
  const reasons = kAlarms.filter((_, i) => Math.round(bits) & (1 << i));
  return (
    <div class="tools">
      <h3>{relay}</h3>
      {alarm ? <span class="pill bad" role="status">◆ alarm{reasons.length ? `: ${reasons.join(", ")}` : ""}</span>
        : <span class={`pill ${alarm === undefined ? "" : "good"}`} role="status">{alarm === undefined ? "not told yet" : "● no alarm"}</span>}
      {told !== undefined && !(alarm && !told) && <span class="soft">{whole(told)} alarms so far</span>}
      {granted !== undefined && <span class="soft">{granted ? "trip granted" : "no trip granted"}</span>}
    </div>
  );
}

function Verdicts({ relay, streams, shown }: { relay: string; streams: string[]; shown: string }) {
  const told = (stream: string, what: string) => values.value.get(`ids.${relay}.${stream}.${what}`);
  return (
    <table class="plain">
      <thead><tr>
        <th>stream</th><th class="number" title="values of which there was a forecast">judged</th><th class="number" title="values too far from their forecast">flagged</th>
        <th class="number" title="flagged, and the attacker had not touched them">false positives</th><th class="number" title="of the values that nobody had touched">share</th>
        <th class="number" title="the same for a forecaster that is not fed its own replacements: what the publication counts">open loop</th>
        <th class="number" title="values that the attacker has changed">fakes</th><th class="number">detected</th>
        <th class="number" title="values for which the forecast was taken">replaced</th><th class="number" title="missing samples that were filled">filled</th><th class="number">unusable</th>
      </tr></thead>
      <tbody>
        {streams.map(s => {
          const judged = told(s, "judged"), share = told(s, "false_positive_percent"), fakes = told(s, "fakes");
          const open = told(s, "open_loop_false_positive_percent");
          const pick = () => choose({ ids: `${relay}.${s}.${choice.value.ids.split(".")[2] ?? "a"}` });
          return (
            <tr key={s} class={shown === s ? "chosen" : ""}>
              <td><button class="link" onClick={pick} title="draw it">{s}</button>{told(s, "locked_out") ? <span class="bad"> ✕ locked out</span> : ""}</td>
              <td class="number">{whole(judged ?? told(s, "samples"))}</td>
              <td class="number">{whole(told(s, "flagged_samples") ?? told(s, "flagged"))}</td>
              <td class="number">{whole(told(s, "false_positives"))}</td>
              <td class="number">{percent(share)}</td>
              <td class={`number ${open !== undefined && open > 2 ? "bad" : ""}`}>{percent(open)}</td>
              <td class="number">{whole(fakes)}</td>
              <td class={`number ${fakes ? "good" : ""}`}>{fakes ? percent(told(s, "detected_percent"), 1) : "–"}</td>
              <td class="number">{whole(told(s, "replaced"))}</td><td class="number">{whole(told(s, "filled"))}</td><td class="number">{whole(told(s, "unusable"))}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

const told = new WeakMap<Series, number[]>();

/** The instants at which a series of flags is set. */
function flaggedTimes(flags: Series | undefined): number[] {
  if (!flags) return [];
  let out = told.get(flags);
  if (!out) {
    out = [];
    for (let i = 0; i < flags.t.length; ++i) if (flags.v[i] > 0 && out[out.length - 1] !== flags.t[i]) out.push(flags.t[i]);
    told.set(flags, out);
  }
  return out;
}

function Waveform({ relay, stream, phase, streams }: { relay: string; stream: string; phase: string; streams: string[] }) {
  const prefix = `ids.${relay}.${stream}`, { window, t0, t1 } = choice.value;
  const there = signals.value.some(s => s.name === `${prefix}.raw.${phase}`);
  useEffect(() => {
    if (!there) return;
    const stretch = t0 !== null && t1 !== null ? { window_s: 0, t0, t1 } : { window_s: window === "all" ? -1 : Number(window) || -1, t0: 0, t1: 0 };
    ask({ id: "ids", names: ["raw", "forecast", "accepted"].map(w => `${prefix}.${w}.${phase}`), ...stretch, px: 1400 });
    ask({ id: "ids marks", names: [`${prefix}.flagged.${phase}`], ...stretch, px: 1400 });
    ask({ id: "ids flagged", names: [`${prefix}.flagged.${phase}`], window_s: -1, t0: 0, t1: 0, px: 4000 }); // where else to look
    return () => { ["ids", "ids marks", "ids flagged"].forEach(forget); };
  }, [prefix, phase, there, window, t0, t1]);
  const marks = flaggedTimes(drawn.value["ids marks"]?.series[0]), all = flaggedTimes(drawn.value["ids flagged"]?.series[0]);
  if (!there) return <p class="empty">its verdicts on single samples are not published (ids: verdicts)</p>;
  const look: Look = {
    label: name => ({ raw: "as received", forecast: "forecast", accepted: "accepted by the relay" })[name.split(".")[3]] ?? name,
    dash: name => (name.includes(".forecast.") ? [6, 4] : name.includes(".accepted.") ? [2, 3] : undefined),
    marks,
  };
  const shown = t0 !== null && t1 !== null ? (t0 + t1) / 2 : -1;
  const jump = (forward: boolean) => {
    const to = forward ? all.find(t => t > shown + 1e-6) : [...all].reverse().find(t => shown < 0 || t < shown - 1e-6);
    if (to === undefined) return;
    choose({ t0: Math.max(0, to - kAround), t1: to + kAround, ...(run.value?.recorded ? { at: to } : {}) });
  };
  return (
    <>
      <div class="tools">
        <select aria-label="stream" value={stream} onChange={e => choose({ ids: `${relay}.${e.currentTarget.value}.${phase}` })}>{streams.map(s => <option key={s}>{s}</option>)}</select>
        <select aria-label="phase" value={phase} onChange={e => choose({ ids: `${relay}.${stream}.${e.currentTarget.value}` })}>{["a", "b", "c"].map(p => <option key={p} value={p}>phase {p}</option>)}</select>
        <span class="soft">A</span>
        <button disabled={!all.length} onClick={() => jump(false)} aria-label="to the flagged sample before">◀ flagged</button>
        <button disabled={!all.length} onClick={() => jump(true)} aria-label="to the next flagged sample">flagged ▶</button>
        <span class="soft">▾ flagged samples</span>
        {t0 !== null && <button onClick={() => choose({ t0: null, t1: null })}>whole stretch</button>}
      </div>
      <Lines id="ids" pattern={`${prefix}.*.${phase}`} height={190} look={look} />
    </>
  );
}

export function Ids() {
  const all = detectors(new Set(signals.value.map(s => s.name)));
  const [relay, stream, phase] = choice.value.ids.split(".");
  const chosen = all.find(d => d.relay === relay) ?? all[0];
  // Whoever looks first wants to see where something was forged.
  const busiest = chosen && [...chosen.streams].sort((a, b) => (values.value.get(`ids.${chosen.relay}.${b}.fakes`) ?? 0) - (values.value.get(`ids.${chosen.relay}.${a}.fakes`) ?? 0))[0];
  const shown = chosen?.streams.includes(stream) ? stream : busiest ?? "";
  if (!chosen) return null;
  return (
    <>
      {all.map(d => <section key={d.relay} aria-label={`detector of ${d.relay}`}><Alarm relay={d.relay} /><Verdicts {...d} shown={d === chosen ? shown : ""} /></section>)}
      {shown && <Waveform relay={chosen.relay} stream={shown} phase={phase ?? "a"} streams={chosen.streams} />}
    </>
  );
}
