// The one-line diagram: the monitor draws it, the report shows the same; here it gets what is measured: voltages by band, breakers by
// shape, flows, what hangs on the buses, and the faults of the moment.
import { useEffect, useRef } from "preact/hooks";
import { FlowTable, useFlows, type Flow } from "./flows";
import { drawn, network, run, signals, values, type Network } from "./model";
import { choice, choose } from "./state";
import { fixed } from "./text";
import { position as instant } from "./transport";

const kStates = ["intermediate", "open", "closed", "bad"], kLooks = ["between", "opened", "closed", "between"]; // of a double point

function band(v: number | undefined): string {
  return v === undefined ? "none" : v < 0.95 || v > 1.05 ? "out" : v < 0.97 ? "low" : "good";
}
const mark: Record<string, string> = { none: "", out: " ✕", low: " ▾", good: "" };

/** An element of the diagram; what is said in it is put where the picture has a place for that. */
function say(group: Element, look: string, value?: string, title?: string) {
  group.setAttribute("class", look);
  const place = group.querySelector(":scope > text > .value"), name = group.querySelector(":scope > title");
  if (place && value !== undefined && place.textContent !== value) place.textContent = value;
  if (name && title !== undefined && name.textContent !== title) name.textContent = title;
}

function dress(svg: Element, net: Network, flows: Flow[]) {
  const now = values.value, t = run.value?.recorded ? instant() : (run.value?.time_s ?? 0);
  const position = (name: string) => now.get(`breaker.${name}.position`) ?? now.get(`fuse.${name}.position`); // 1 open, 2 closed
  const each = (look: string, body: (group: Element, name: string) => void) => svg.querySelectorAll(`g.${look}`).forEach(g => body(g, (g as SVGElement).dataset.name!));
  each("bus", (g, name) => {
    const bus = net.buses.find(b => b.name === name)!, v = now.get(`bus.${name}.v_pu`), state = band(v);
    say(g, `bus ${state}`, v !== undefined ? v.toFixed(3) + mark[state] : "",
      `bus ${bus.label}, ${bus.voltage_v} V${v !== undefined ? `: ${v.toFixed(4)} p.u., ${fixed(now.get(`bus.${name}.angle_deg`), 2)} deg` : ""}`);
  });
  each("breaker", (g, name) => {
    const p = position(name);
    say(g, `breaker ${p === undefined ? "closed" : kLooks[p] ?? "between"}`, undefined, `${name}: ${p === undefined ? "not told" : kStates[p]}`);
  });
  each("branch", (g, name) => {
    const open = net.breakers.some(c => c.line === name && position(c.name) === 1);
    const f = flows.find(o => o.branch.name === name), b = net.branches.find(o => o.name === name)!, amps = f?.i.map(i => fixed(i, 2)).join(", ");
    say(g, `branch${open ? " open" : ""}`, open ? "open" : f?.p !== undefined ? `${f.p.toFixed(1)} kW` : amps ? `${fixed(f!.i[0], 1)} A` : "",
      `${b.kind} ${b.label}${amps ? `: ${amps} A` : ""}${f?.p !== undefined ? `, ${fixed(f.p, 2)} kW, ${fixed(f.q, 2)} kvar into it from ${b.from}` : ""}; click: its current`);
  });
  each("device", (g, name) => {
    const kind = g.classList[1], of = (quantity: string) => now.get(`${kind}.${name}.${quantity}`);
    const p = of("p_kw"), soc = of("soc_percent"), cell = g.querySelector(".charge");
    const power = p !== undefined ? `${p.toFixed(1)} kW` : "";
    say(g, `device ${kind}`, kind === "ev" ? `${fixed(soc, 1)} % ${fixed(of("current_a"), 1)} A` : cell ? `${fixed(soc, 1)} % ${power}` : power);
    cell?.setAttribute("width", String(0.27 * Math.min(Math.max(soc ?? 0, 0), 100)));
  });
  net.faults.forEach(f => {
    const g = svg.querySelector(`g[data-name="${CSS.escape(f.name)}"]:is(.fault, .later)`);
    g?.setAttribute("class", t >= f.at_s && (f.until_s === undefined || t < f.until_s) ? "fault" : "later");
  });
}

/** What is told of the current of a branch: its magnitude, or the phases at its begin. */
function currentOf(name: string): string {
  const b = network.value?.branches.find(o => o.name === name), ct = network.value?.cts.find(c => c.line === name), end = `${b?.kind}.${name}.from`;
  const told = (n: string) => signals.value.some(s => s.name === n);
  return told(`${end}.i_a`) ? `${end}.i_a` : told(`${end}.i.a`) ? `${end}.i.*` : ct && told(`ct.${ct.name}.i.a`) ? `ct.${ct.name}.i.*` : "";
}

/** A click on an element: its signals are plotted. */
function plot(target: Element) {
  const g = target.closest<SVGElement>("g[data-name]"), name = g?.dataset.name, kind = g?.classList[1] ?? "";
  const pattern = !g ? "" : g.classList[0] === "bus" ? "bus.*.v_pu" : g.classList[0] === "branch" ? currentOf(name!) : g.classList[0] === "ct" ? `ct.${name}.i.*`
    : g.classList[0] === "device" ? (g.querySelector(".charge") ? `${kind}.*.soc_percent` : `${kind}.${name}.p_kw`) : "";
  if (pattern) choose({ plots: [pattern, ...choice.value.plots.filter(p => p !== pattern)].slice(0, 3) });
}

export function OneLine() {
  const holder = useRef<HTMLDivElement>(null), net = network.value;
  const flows = useFlows(), now = values.value, at = run.value?.recorded ? instant() : run.value?.time_s;
  const shown = net && net.buses.length > 0;
  useEffect(() => { if (holder.current) holder.current.innerHTML = net?.diagram ?? ""; }, [net?.diagram, shown]);
  useEffect(() => { if (holder.current && shown) dress(holder.current, net, flows); }, [now, at, net, drawn.value]);
  if (!shown) return <p class="empty">the monitor was not told of a network</p>;
  return (
    <>
      {!net.diagram && <p class="empty">a grid of {net.buses.length} buses is not drawn</p>}
      <div class="scroll" tabindex={0} aria-label="one-line diagram" ref={holder} onClick={e => plot(e.target as Element)} />
      <FlowTable flows={flows} />
    </>
  );
}
