// The global data space: processes left and right, topics and streams between them, arrows by who writes and who reads.
import { graph, topics } from "./model";
import { choice, choose, picked } from "./state";
import { rate } from "./text";

const kRow = 40, kBox = 30, kProcess = 118, kTopic = 148, kGap = 92, kTop = 14;
const kObservers = new Set(["gridspace-recorder", "gridspace-monitor"]);

interface Arrow { process: string; middle: string; out: boolean; problems: string[] }

/** Names in an order in which few arrows cross: each at the mean height of what it is tied to. */
function order(names: string[], ties: (name: string) => number[]): string[] {
  const height = (name: string) => {
    const at = ties(name).filter(i => i >= 0);
    return at.length ? at.reduce((a, b) => a + b, 0) / at.length : 1e9;
  };
  return [...names].sort((a, b) => height(a) - height(b) || a.localeCompare(b));
}

export function GraphView() {
  const g = graph.value;
  if (!g) return <p class="empty">waiting for the first participants</p>;
  const { framework, observers, find } = choice.value;
  const programs = new Map(g.processes.map(p => [p.name, p]));
  const visible = (name: string) => observers || !kObservers.has(programs.get(name)?.program ?? "");
  const hidden = new Set(g.topics.filter(t => t.framework).map(t => t.name));
  const arrows: Arrow[] = [
    ...g.edges.filter(e => visible(e.process) && (framework || !hidden.has(e.topic)))
      .map(e => ({ process: e.process, middle: e.topic, out: e.writes, problems: e.problems })),
    ...g.wires.filter(w => visible(w.process)).map(w => ({ process: w.process, middle: w.stream, out: w.publishes, problems: [] })),
  ];
  const streams = new Set(g.wires.map(w => w.stream));
  const processes = g.processes.map(p => p.name).filter(visible);
  // The simulator stands left with whatever is on its host; everybody else right: the published picture.
  const left0 = processes.filter(p => programs.get(p)?.program === "gridspace-sim" || kObservers.has(programs.get(p)?.program ?? ""));
  const right0 = processes.filter(p => !left0.includes(p));
  const middle = order([...new Set(arrows.map(a => a.middle))],
    m => arrows.filter(a => a.middle === m).map(a => right0.indexOf(a.process)));
  const byMiddle = (p: string) => arrows.filter(a => a.process === p).map(a => middle.indexOf(a.middle));
  const left = order(left0, byMiddle), right = order(right0, byMiddle);

  const rows = Math.max(left.length, middle.length, right.length, 1);
  const height = rows * kRow + 2 * kTop, xMiddle = kProcess + kGap, xRight = xMiddle + kTopic + kGap, width = xRight + kProcess;
  const y = (list: string[], name: string) => kTop + ((list.indexOf(name) + 0.5) * rows * kRow) / Math.max(list.length, 1);
  const found = (name: string) => find !== "" && name.toLowerCase().includes(find.toLowerCase());
  const chosen = picked.value?.name;
  const near = (a: Arrow) => chosen === undefined || a.process === chosen || a.middle === chosen;
  const rates = new Map(topics.value.map(t => [t.name, t.samples_per_second]));

  const box = (name: string, x: number, list: string[], kind: "process" | "topic") => {
    const p = programs.get(name);
    const cls = kind === "process" ? `process ${p?.state}` : streams.has(name) ? "stream" : "topic";
    const w = kind === "process" ? kProcess : kTopic;
    const open = () => { if (!streams.has(name)) picked.value = chosen === name ? null : { kind, name }; };
    const per = rates.get(name);
    const said = kind === "process" ? `${p?.program} on ${p?.host}: ${p?.state}` : per === undefined ? name : `${name}: ${rate(per)}`;
    return (
      <g class={`node ${cls}${found(name) ? " found" : ""}${chosen === name ? " chosen" : ""}`} key={kind + name} tabindex={0}
        role="button" aria-label={`${kind} ${said}`} onClick={open} onKeyDown={e => { if (e.key === "Enter") open(); }}>
        <title>{said}</title>
        <rect x={x} y={y(list, name) - kBox / 2} width={w} height={kBox} rx={kind === "process" || streams.has(name) ? 5 : 15} />
        <text x={x + w / 2} y={y(list, name) + 4}>
          {p && p.state === "lost" ? "✕ " : ""}{name.length > 19 ? name.slice(0, 18) + "…" : name}
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
        <a href={"/api/v1/graph.svg" + (framework ? "?framework=1" : "")} download="graph.svg">SVG</a>
      </div>
      <div class="scroll">
        <svg viewBox={`0 0 ${width} ${height}`} style={{ minHeight: `${Math.min(height, 300)}px` }} class="graph" role="group" aria-label="who talks to whom">
          <defs>
            <marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" /></marker>
            <marker id="badtip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" /></marker>
          </defs>
          {arrows.map(a => {
            const onLeft = left.includes(a.process);
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
