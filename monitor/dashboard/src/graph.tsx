// The global data space: processes left and right, topics and streams between them, arrows by who writes and who reads.
import { graph, standing, topics } from "./model";
import { choice, choose, picked } from "./state";
import { rate } from "./text";

const kRow = 40, kBox = 30, kProcess = 118, kTopic = 148, kTop = 14;
const kGap = () => (innerWidth <= 760 ? 32 : 92); // a phone has no room for long arrows
const kMany = 60, kMost = 150; // rows: beyond the first a search leaves out what it does not find, beyond the second the rest is told only
const kObservers = new Set(["gridspace-recorder", "gridspace-monitor"]);

interface Arrow { process: string; middle: string; out: boolean; problems: string[] }

/** Names in an order in which few arrows cross: each at the mean height of what it is tied to. */
function order(names: string[], ties: (name: string) => number[]): string[] {
  const height = (name: string) => {
    const at = ties(name).filter(i => i >= 0);
    return at.length ? at.reduce((a, b) => a + b, 0) / at.length : 1e9;
  };
  const heights = new Map(names.map(name => [name, height(name)]));
  return [...names].sort((a, b) => heights.get(a)! - heights.get(b)! || a.localeCompare(b));
}

export function GraphView() {
  const g = graph.value;
  if (!g) return <p class="empty">waiting for the first participants</p>;
  const { framework, observers, find } = choice.value;
  const programs = new Map(g.processes.map(p => [p.name, p]));
  const visible = (name: string) => observers || !kObservers.has(programs.get(name)?.program ?? "");
  const hidden = new Set(g.topics.filter(t => t.framework).map(t => t.name));
  const found = (name: string) => find !== "" && name.toLowerCase().includes(find.toLowerCase());
  const chosen = picked.value?.name;
  let arrows: Arrow[] = [
    ...g.edges.filter(e => visible(e.process) && (framework || !hidden.has(e.topic)))
      .map(e => ({ process: e.process, middle: e.topic, out: e.writes, problems: e.problems })),
    ...g.wires.filter(w => visible(w.process)).map(w => ({ process: w.process, middle: w.stream, out: w.publishes, problems: [] })),
  ];
  const streams = new Set(g.wires.map(w => w.stream));
  let processes = g.processes.map(p => p.name).filter(visible);
  let left_out = 0;
  if (new Set(arrows.map(a => a.middle)).size > kMany || processes.length > kMany) { // a crowd: what was asked for, and its neighbours
    if (find || chosen) {
      const asked = (name: string) => found(name) || name === chosen;
      arrows = arrows.filter(a => asked(a.process) || asked(a.middle));
      processes = processes.filter(p => asked(p) || arrows.some(a => a.process === p));
    }
    const middles = [...new Set(arrows.map(a => a.middle))], shown = new Set(middles.slice(0, kMost)), kept = new Set(processes.slice(0, kMost));
    left_out = middles.length - shown.size + processes.length - kept.size;
    arrows = arrows.filter(a => shown.has(a.middle) && kept.has(a.process));
    processes = [...kept];
  }
  // The simulator stands left with whatever is on its host; everybody else right: the published picture.
  const left0 = processes.filter(p => programs.get(p)?.program === "gridspace-sim" || kObservers.has(programs.get(p)?.program ?? ""));
  const right0 = processes.filter(p => !left0.includes(p));
  const group = (key: (a: Arrow) => string) => {
    const out = new Map<string, Arrow[]>();
    for (const a of arrows) out.set(key(a), [...(out.get(key(a)) ?? []), a]);
    return out;
  };
  const ofMiddle = group(a => a.middle), ofProcess = group(a => a.process);
  const rank = new Map(right0.map((p, i) => [p, i]));
  const middle = order([...ofMiddle.keys()], m => ofMiddle.get(m)!.map(a => rank.get(a.process) ?? -1));
  const at = new Map(middle.map((m, i) => [m, i]));
  const byMiddle = (p: string) => (ofProcess.get(p) ?? []).map(a => at.get(a.middle) ?? -1);
  const left = order(left0, byMiddle), right = order(right0, byMiddle);

  const rows = Math.max(left.length, middle.length, right.length, 1);
  const height = rows * kRow + 2 * kTop, xMiddle = kProcess + kGap(), xRight = xMiddle + kTopic + kGap(), width = xRight + kProcess;
  const places = new Map([left, middle, right].map(list => [list, new Map(list.map((name, i) => [name, i]))]));
  const y = (list: string[], name: string) => kTop + (((places.get(list)!.get(name) ?? 0) + 0.5) * rows * kRow) / Math.max(list.length, 1);
  const near = (a: Arrow) => chosen === undefined || a.process === chosen || a.middle === chosen;
  const rates = new Map(topics.value.map(t => [t.name, t.samples_per_second]));

  const box = (name: string, x: number, list: string[], kind: "process" | "topic") => {
    const p = programs.get(name);
    const cls = kind === "process" ? `process ${p && standing(p.state).look}` : streams.has(name) ? "stream" : "topic";
    const w = kind === "process" ? kProcess : kTopic;
    const open = () => { if (!streams.has(name)) picked.value = chosen === name ? null : { kind, name }; };
    const per = rates.get(name);
    // As many letters as the box has room for, the mark of a lost one among them.
    const label = (kind === "process" && p?.state === "lost" ? "✕ " : "") + name, most = kind === "process" ? 17 : 19;
    const said = kind === "process" ? `${p?.program} on ${p?.host}: ${p && standing(p.state).said}` : per === undefined ? name : `${name}: ${rate(per)}`;
    return (
      <g class={`node ${cls}${found(name) ? " found" : ""}${chosen === name ? " chosen" : ""}`} key={kind + name} tabindex={0}
        role="button" aria-label={`${kind} ${said}`} onClick={open} onKeyDown={e => { if (e.key === "Enter") open(); }}>
        <title>{said}</title>
        <rect x={x} y={y(list, name) - kBox / 2} width={w} height={kBox} rx={kind === "process" || streams.has(name) ? 5 : 15} />
        <text x={x + w / 2} y={y(list, name) + 4}>
          {label.length > most ? label.slice(0, most - 1) + "…" : label}
        </text>
      </g>
    );
  };
  return (
    <>
      <div class="tools">
        <input type="search" placeholder="find" aria-label="find in the graph" value={find}
          onInput={e => choose({ find: e.currentTarget.value })} />
        <label><input type="checkbox" checked={observers} onChange={() => choose({ observers: !observers })} /> observers</label>
        <label><input type="checkbox" checked={framework} onChange={() => choose({ framework: !framework })} /> framework topics</label>
        {left_out > 0 && <span role="status">{left_out} more: find them by name</span>}
        <a href={"/api/v1/graph.svg" + (framework ? "?framework=1" : "")} download="graph.svg">SVG</a>
      </div>
      <div class="scroll" tabindex={0} aria-label="global data space">
        <svg viewBox={`-1 0 ${width + 2} ${height}`} style={{ minHeight: `${Math.min(height, 300)}px`, maxWidth: `${Math.round(1.15 * width)}px`, margin: "0 auto" }} class="graph" role="group" aria-label="who talks to whom">
          <defs>
            <marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" /></marker>
            <marker id="badtip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" /></marker>
          </defs>
          {arrows.map(a => {
            const onLeft = places.get(left)!.has(a.process);
            const xp = onLeft ? kProcess : xRight, xm = onLeft ? xMiddle : xMiddle + kTopic;
            // Writing and reading meet the box at two heights, so that two arrows are two.
            const yp = y(onLeft ? left : right, a.process) + (a.out ? -5 : 5), ym = y(middle, a.middle) + (a.out ? -5 : 5);
            const [x1, y1, x2, y2] = a.out ? [xp, yp, xm, ym] : [xm, ym, xp, yp];
            const bad = a.problems.length > 0;
            return (
              <path key={`${a.process} ${a.middle} ${a.out}`} class={`arrow${bad ? " bad" : ""}${near(a) ? "" : " far"}`}
                d={`M${x1} ${y1}C${(x1 + x2) / 2} ${y1} ${(x1 + x2) / 2} ${y2} ${x2} ${y2}`} marker-end={bad ? "url(#badtip)" : "url(#tip)"}>
                {bad && <title>{a.problems.join("\n")}</title>}
              </path>
            );
          })}
          {left.map(p => box(p, 0, left, "process"))}
          {middle.map(m => box(m, xMiddle, middle, "topic"))}
          {right.map(p => box(p, xRight, right, "process"))}
        </svg>
      </div>
    </>
  );
}
