import { render } from "preact";
import { useEffect, useState } from "preact/hooks";
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Control } from "./control";
import { GraphView } from "./graph";
import { detectors, Ids } from "./ids";
import { kindOf } from "./kinds";
import { connect, connected, dropped, ended, events, graph, network, over, run, signals, standing, topics, verdict } from "./model";
import { OneLine } from "./oneline";
import { Plots } from "./plots";
import { choice, choose, picked } from "./state";
import { rate, stamp, time } from "./text";
import { jumpTo, Timeline } from "./timeline";
import { Relays } from "./relay";
import { position, Transport } from "./transport";
import { useVerdict, VerdictView } from "./verdict";
import { Wire } from "./wire";

function Header() {
  const r = run.value;
  const all = r?.processes.length ?? 0, gone = ended.value || (r?.recorded ?? false); // nobody is alive any more
  const alive = r?.processes.filter(p => p.state === "alive" || (gone && p.state === "ended")).length ?? 0;
  const lost = r?.processes.some(p => p.state === "lost");
  const part = r && r.duration_s > 0 ? Math.min(r.time_s / r.duration_s, 1) : 0;
  const mode = !r ? "" : r.mode === "lockstep" ? `lockstep ${r.speed === "max" ? "max" : "x" + r.speed}` : "real time";
  const dark = choice.value.theme ? choice.value.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  return (
    <header>
      <h1>Gridspace</h1>
      <span>{r?.scenario}</span>
      {mode && <span class={`pill${r!.mode !== "lockstep" && r!.state === "running" && r!.factor > 0 && r!.factor < 0.95 * (Number(r!.speed) || 1) ? " bad" : ""}`}>{mode}{r!.factor > 0 ? ` · now x${r!.factor >= 10 ? Math.round(r!.factor) : r!.factor.toFixed(2)}` : ""}</span>}
      <span class={`pill ${lost ? "bad" : all && alive === all && !gone ? "good" : ""}`} role="status">{lost ? "✕ " : ""}{gone && lost ? `${all - alive} of ${all} lost` : `${alive} of ${all} ${gone ? "took part" : "alive"}`}</span>
      {r?.recorded && r.state === "recorded" ? <Transport /> : <><div class="progress" role="progressbar" aria-valuenow={Math.round(part * 100)} aria-label="progress of the run"><i style={{ width: `${part * 100}%` }} /></div>
      {r && <span class="time">t = {time(r.time_s, r.duration_s)}{r.duration_s > 0 ? ` of ${time(r.duration_s, r.duration_s)}` : ""}</span>}</>}
      {r?.control && connected.value && <Control />}
      <span class={connected.value ? "soft" : "pill bad"} role="status">{connected.value ? (dropped.value ? `dropped ${dropped.value}` : r?.recorded ? r.state : over() ? "finished" : "live") : ended.value ? (r?.recorded ? "its monitor is gone" : "run is over") : "connecting"}</span>
      <button aria-label="light or dark" title="light or dark" onClick={() => choose({ theme: dark ? "light" : "dark" })}>{dark ? "☀" : "☾"}</button>
    </header>
  );
}

function Processes() {
  const r = run.value;
  const lockstep = r?.mode === "lockstep" && r.processes.some(p => p.tick !== undefined);
  const used = !ended.value && r?.processes.some(p => p.memory_octets !== undefined || p.cpu_percent !== undefined);
  const sign: Record<string, string> = { alive: "●", lost: "✕", ended: "○", past: "○", expected: "…" };
  return (
    <table class="plain">
      <thead><tr><th>process</th><th>host</th><th>state</th>{used && <><th class="number" title="of one processor, lately">CPU</th><th class="number" title="resident memory">MB</th></>}{lockstep && <th class="number" title="the last tick that it acknowledged">tick</th>}</tr></thead>
      <tbody>
        {r?.processes.map(p => ({ p, ...standing(p.state) })).map(({ p, said, look }) => (
          <tr key={p.name} class={`state ${look}`}>
            <td class="name" title={p.name}><button class="link" onClick={() => { picked.value = { kind: "process", name: p.name }; }}>{p.name}</button></td>
            <td class="soft host">{p.host}</td>
            <td class="sign">{sign[look]} {said}{p.incarnation > 0 ? ` (restarted ${p.incarnation}x)` : ""}</td>
            {used && <><td class="number">{p.cpu_percent === undefined ? "–" : `${p.cpu_percent < 9.95 ? p.cpu_percent.toFixed(1) : Math.round(p.cpu_percent)} %`}</td>
              <td class="number">{p.memory_octets === undefined ? "–" : Math.round(p.memory_octets / 1e6)}</td></>}
            {lockstep && <td class="number soft">{p.tick?.toLocaleString("en") ?? ""}</td>}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Events() {
  const whole = run.value?.duration_s || 1;
  const list = events.value.slice(-200).reverse();
  return list.length === 0 ? <p class="empty">{over() ? "nothing has happened" : "nothing has happened yet"}</p> : (
    <table class="plain">
      <tbody>
        {list.map(e => (
          <tr key={e.number} class={`${kindOf(e) === "fault" || kindOf(e) === "lost" ? "bad" : ""}${run.value?.recorded && e.time_s > position() ? " later" : ""}`}>
            <td class="number"><button class="link" title="show this moment" onClick={() => jumpTo(e.time_s)}>{stamp(e.time_s, whole)}</button></td>
            <td class="soft source">{e.source}</td><td>{e.event === "event" || !e.text ? "" : `${e.event}: `}{e.text || e.event}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Topics() {
  const { framework, find } = choice.value;
  const known = topics.value.filter(t => framework || !t.framework);
  const all = known.length > 60 && find ? known.filter(t => t.name.toLowerCase().includes(find.toLowerCase())) : known, list = all.slice(0, 200);
  return (
    <table class="plain">
      <thead><tr><th>topic</th><th class="number">rate</th><th class="number">samples</th></tr></thead>
      <tbody>
        {list.map(t => (
          <tr key={t.network + t.name}>
            <td><button class="link" title={`${t.type}, ${t.writers} writers, ${t.readers} readers`} onClick={() => { picked.value = { kind: "topic", name: t.name }; }}>{t.name}</button></td>
            <td class="number">{rate(t.samples_per_second)}</td><td class="number">{t.samples.toLocaleString("en")}</td>
          </tr>
        ))}
        {all.length > list.length && <tr><td colspan={3} class="soft">{all.length - list.length} more: find them by name</td></tr>}
      </tbody>
    </table>
  );
}

interface Last { type: string; last: { process: string; key?: string; error?: string; fields?: Record<string, unknown> }[] }

/** What is known of a topic or process that was clicked. */
function Drawer() {
  const p = picked.value, g = graph.value;
  const [last, setLast] = useState<Last | null>(null);
  const [idl, setIdl] = useState("");
  useEffect(() => {
    setLast(null);
    setIdl("");
    if (p?.kind !== "topic") return;
    const path = `/api/v1/topics/${encodeURIComponent(p.name)}`;
    const get = () => fetch(path + "/last").then(r => (r.ok ? r.json() : null)).then(setLast).catch(() => {});
    fetch(path).then(r => (r.ok ? r.json() : null)).then(t => setIdl(t?.idl ?? "")).catch(() => {});
    get();
    const timer = setInterval(get, 500);
    return () => clearInterval(timer);
  }, [p?.kind, p?.name]);
  useEffect(() => {
    const close = (e: KeyboardEvent) => { if (e.key === "Escape") picked.value = null; };
    addEventListener("keydown", close);
    return () => removeEventListener("keydown", close);
  }, []);
  if (!p || !g) return null;
  const process = g.processes.find(x => x.name === p.name);
  const ends = g.endpoints.filter(e => (p.kind === "topic" ? e.topic === p.name : e.process === p.name) && (choice.value.framework || p.kind === "topic" || !g.topics.find(t => t.name === e.topic)?.framework));
  const problems = g.edges.filter(e => (p.kind === "topic" ? e.topic : e.process) === p.name).flatMap(e => e.problems.map(x => `${e.process}, ${e.topic}: ${x}`));
  return (
    <aside class="drawer" aria-label={`${p.kind} ${p.name}`}>
      <div class="tools"><h2>{p.kind} {p.name}</h2><button aria-label="close" onClick={() => { picked.value = null; }}>×</button></div>
      {process && p.kind === "process" && <p>{process.program} on {process.host}, <b>{standing(process.state).said}</b>, {process.addresses.join(", ")}</p>}
      {p.kind === "topic" && g.topics.filter(t => t.name === p.name).flatMap(t => t.not_heard ?? []).map(x => <p class="bad" key={x}>✕ the monitor hears nothing from {x}</p>)}
      {problems.map(x => <p class="bad" key={x}>✕ {x}</p>)}
      {last && <h3>Last samples</h3>}
      {last?.last.map((s, i) => (
        <table class="plain" key={(s.key ?? "") + i}>
          <tbody>
            {s.error && <tr><td class="bad">{s.error}</td></tr>}
            {Object.entries(s.fields ?? {}).map(([name, value]) => <tr key={name}><td class="soft">{name}</td><td class="number">{String(value)}</td></tr>)}
          </tbody>
        </table>
      ))}
      <h3>Readers and writers</h3>
      <table class="plain">
        <tbody>
          {ends.map(e => <tr key={e.id}><td>{e.writer ? "→" : "←"} {p.kind === "topic" ? e.process : e.topic}</td><td class="soft">{String(e.qos.reliability)}, {String(e.qos.durability)}</td></tr>)}
        </tbody>
      </table>
      {idl && <><h3>IDL</h3><pre>{idl}</pre></>}
    </aside>
  );
}

function Panel({ title, note, area, children }: { title: string; note?: string; area: string; children: preact.ComponentChildren }) {
  return <section class={`panel ${area}`} aria-label={title}><div class="head"><h2>{title}</h2><span>{note}</span></div>{children}</section>;
}

function App() {
  const g = graph.value;
  const watched = detectors(new Set(signals.value.map(s => s.name))).length > 0;
  useVerdict();
  const expects = (verdict.value?.expectations.length ?? 0) > 0;
  const broken = g?.edges.filter(e => !e.writes && e.problems.length).length ?? 0;
  return (
    <>
      <Header />
      <main class={expects ? "judged" : ""}>
        {expects && <Panel area="verdict" title="Verdict" note={`${verdict.value!.expectations.length} expectations`}><VerdictView /></Panel>}
        <Panel area="line" title="One-line diagram" note={network.value ? "p.u., line to line" : ""}><OneLine /></Panel>
        <Panel area="happened" title="Events" note={events.value.length ? String(events.value.length) : ""}><div class="scroll grow" tabindex={0} aria-label="events, the newest first"><Events /></div></Panel>
        {events.value.length > 0 && <Panel area="axis" title="Timeline" note="click: this moment everywhere"><Timeline /></Panel>}
        <Panel area="waves" title="Signals"><Plots /></Panel>
        {(network.value?.relays.length ?? 0) > 0 && <Panel area="relay" title="Relays" note="times relative to the fault"><Relays /></Panel>}
        <Panel area="side" title="Processes"><div class="scroll" tabindex={0} aria-label="processes"><Processes /></div></Panel>
        {watched && <Panel area="ids" title="Intrusion detection" note="verdicts of the relays"><Ids /></Panel>}
        {(g?.wires.length ?? 0) > 0 && <Panel area="wire" title="Wire timing" note="SMV and GOOSE"><Wire /></Panel>}
        <Panel area="space" title="Global data space" note={broken ? `${broken} mismatches` : `${g?.topics.filter(t => !t.framework).length ?? 0} topics`}><GraphView /></Panel>
        <Panel area="topics" title="Topics" note="seen by the monitor"><div class="scroll" tabindex={0} aria-label="topics"><Topics /></div></Panel>
      </main>
      <Drawer />
    </>
  );
}

connect();
render(<App />, document.getElementById("app")!);
