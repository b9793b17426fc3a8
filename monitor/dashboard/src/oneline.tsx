// The one-line diagram: voltages by band, breakers by shape, flows, what hangs on the buses.
import { network, run, values, type Branch, type Bus, type Device, type Fault } from "./model";
import { choose, choice } from "./state";
import { fixed } from "./text";
import { position as instant } from "./transport";

const kColumn = 156, kPad = 8, kStub = 14, kDevice = 25;

/** Places for buses that have none in the network file: by distance from the first, as far as branches reach. */
function places(buses: Bus[], branches: Branch[]): Map<string, [number, number]> {
  const out = new Map<string, [number, number]>();
  buses.forEach(b => { if (b.x !== undefined && b.y !== undefined) out.set(b.name, [b.x, b.y]); });
  if (out.size === buses.length) return out;
  out.clear();
  const used = new Map<number, number>();
  for (const root of buses) {
    let front = out.has(root.name) ? [] : [root.name];
    for (let x = 0; front.length; ++x) {
      const next: string[] = [];
      for (const name of front) {
        if (out.has(name)) continue;
        const y = used.get(x) ?? 0;
        out.set(name, [x, y]);
        used.set(x, y + 1);
        branches.forEach(b => {
          if (b.from === name && !out.has(b.to)) next.push(b.to);
          if (b.to === name && !out.has(b.from)) next.push(b.from);
        });
      }
      front = next;
    }
  }
  return out;
}

/** What stands in the circle of a machine or an inverter; the others are arrows, and stores show their charge. */
const kCircle: Record<string, string> = { machine: "~", generator: "~", pv: "☀", induction_machine: "M", wind_turbine: "" };
const kStores = ["ev", "battery", "supercapacitor"];
const kBlades = [-90, 30, 150].map(a => (a * Math.PI) / 180).map(a => `M0 0L${(6.5 * Math.cos(a)).toFixed(2)} ${(6.5 * Math.sin(a)).toFixed(2)}`).join("");

function band(v: number | undefined): string {
  return v === undefined ? "none" : v < 0.95 || v > 1.05 ? "out" : v < 0.97 ? "low" : "good";
}
const mark: Record<string, string> = { none: "", out: " ✕", low: " ▾", good: "" };

export function OneLine() {
  const net = network.value, now = values.value;
  if (!net || net.buses.length === 0) return <p class="empty">the monitor was not told of a network</p>;
  const at = places(net.buses, net.branches);
  const shown = [...at.values()];
  const xs = [...new Set(shown.map(p => p[0]))].sort((a, b) => a - b), ys = [...new Set(shown.map(p => p[1]))].sort((a, b) => a - b);
  const devices = (bus: string) => net.devices.filter(d => d.bus === bus && d.kind !== "source");
  const horizontal = (b: Branch) => at.get(b.from)![0] !== at.get(b.to)![0];
  const barOf = (bus: string) => 46 + Math.max(devices(bus).length, 1) * kDevice;
  const rowHeight = ys.map(y => Math.max(...net.buses.filter(b => at.get(b.name)![1] === y).map(b => barOf(b.name))) + 52);
  const yOf = (y: number) => kPad + 14 + rowHeight.slice(0, ys.indexOf(y)).reduce((a, b) => a + b, 0);
  const hasSource = net.devices.some(d => d.kind === "source");
  const labels = net.buses.filter(b => at.get(b.name)![0] === xs[0]).map(b => 3.7 * (b.label.length + 6)); // half of it lies left of the bar
  const lead = Math.max(hasSource ? 50 : 34, ...labels);
  const xOf = (x: number) => kPad + lead + xs.indexOf(x) * kColumn;
  const longest = Math.max(4, ...net.devices.filter(d => at.get(d.bus)?.[0] === xs[xs.length - 1]).map(d => d.label.length + (kStores.includes(d.kind) ? 17 : 10)));
  const width = xOf(xs[xs.length - 1]) + Math.min(kColumn - 2, 36 + 6.2 * longest), height = yOf(ys[ys.length - 1]) + rowHeight[rowHeight.length - 1] - 20;
  const tapY = (bus: string, b: Branch) => // parallel lines side by side
    yOf(at.get(bus)![1]) + 16 + net.branches.filter(o => (o.from === b.from && o.to === b.to) || (o.from === b.to && o.to === b.from)).indexOf(b) * 9;

  const position = (name: string) => now.get(`breaker.${name}.position`) ?? now.get(`fuse.${name}.position`); // double point: 1 open, 2 closed
  const plot = (pattern: string) => choose({ plots: [pattern, ...choice.value.plots.filter(p => p !== pattern)].slice(0, 3) });

  const t = run.value?.recorded ? instant() : (run.value?.time_s ?? 0);
  const applied = (net.faults ?? []).filter(f => t >= f.at_s && (f.until_s === undefined || t < f.until_s));
  const bolt = (f: Fault, x: number, y: number) => (
    <g key={f.name} class="fault" role="img" aria-label={`fault ${f.name}`}>
      <title>{`${f.name}, since ${f.at_s} s`}</title>
      <path d={`M${x + 4} ${y - 22}L${x - 6} ${y - 6}H${x + 3}L${x - 3} ${y + 8}L${x + 8} ${y - 10}H${x - 1}L${x + 9} ${y - 22}z`} />
    </g>
  );

  const branch = (b: Branch) => {
    const breakers = net.breakers.filter(c => c.line === b.name);
    const open = breakers.some(c => position(c.name) === 1);
    const flow = now.get(`line.${b.name}.from.i_a`), power = now.get(`line.${b.name}.from.p_kw`);
    let x1 = xOf(at.get(b.from)![0]), x2 = xOf(at.get(b.to)![0]), y1 = tapY(b.from, b), y2 = tapY(b.to, b);
    if (!horizontal(b)) { // a tie between two bars of one column
      const [upper, lower] = at.get(b.from)![1] < at.get(b.to)![1] ? [b.from, b.to] : [b.to, b.from];
      x1 = x2; y1 = yOf(at.get(upper)![1]) + barOf(upper); y2 = yOf(at.get(lower)![1]);
    }
    const text = b.label + (open ? " open" : power !== undefined ? ` ${power.toFixed(1)} kW` : flow !== undefined ? ` ${flow.toFixed(1)} A` : "");
    return (
      <g key={b.name} class={`branch${open ? " open" : ""}`} onClick={() => plot(`line.${b.name}.from.i_a`)}>
        <title>{`${b.kind} ${b.label}${flow !== undefined ? `: ${flow.toFixed(2)} A` : ""}; click: its current`}</title>
        <path d={`M${x1} ${y1}L${x2} ${y2}`} />
        {horizontal(b) && <text x={(x1 + x2) / 2} y={(y1 + y2) / 2 - 7} class="small middle">{text}</text>}
        {!horizontal(b) && <text x={x1 + 7} y={(y1 + y2) / 2 + 4} class="small">{text}</text>}
        {applied.filter(f => f.line === b.name).map(f => bolt(f, x1 + (x2 - x1) * (f.position_percent ?? 50) / 100, 18 + y1 + (y2 - y1) * (f.position_percent ?? 50) / 100))}
        {breakers.map(c => {
          const from = c.end === "from", p = position(c.name);
          const dx = Math.sign(x2 - x1) * 28, x = from ? x1 + dx : x2 - dx, y = from ? y1 : y2;
          const cls = p === 2 || p === undefined ? "closed" : p === 1 ? "opened" : "between";
          return (
            <g key={c.name} class={`breaker ${cls}`}>
              <title>{`${c.name}: ${p === undefined ? "not told" : ["intermediate", "open", "closed", "bad"][p]}`}</title>
              <rect x={x - 5.5} y={y - 5.5} width={11} height={11} />
              {cls === "between" && <path d={`M${x - 4} ${y + 4}L${x + 4} ${y - 4}`} />}
              <text x={x} y={y + 19} class="small middle">{c.name}</text>
            </g>
          );
        })}
      </g>
    );
  };

  const device = (d: Device, i: number, x: number, y: number) => {
    const p = now.get(`${d.kind}.${d.name}.p_kw`), soc = now.get(`${d.kind}.${d.name}.soc_percent`), amps = now.get(`ev.${d.name}.current_a`);
    const stores = kStores.includes(d.kind);
    const yd = y + 54 + i * kDevice, xd = x + kStub;
    const source = d.kind in kCircle;
    const says = d.kind === "ev" ? `${d.label} ${fixed(soc, 1)} % ${fixed(amps, 1)} A` : stores ? `${d.label} ${fixed(soc, 1)} %${p !== undefined ? ` ${p.toFixed(1)} kW` : ""}` : `${d.label}${p !== undefined ? ` ${p.toFixed(1)} kW` : ""}`;
    return (
      <g key={d.kind + d.name} class={`device ${d.kind}`} onClick={() => plot(stores ? `${d.kind}.*.soc_percent` : `${d.kind}.${d.name}.p_kw`)}>
        <title>{`${d.kind} ${d.label}`}</title>
        <path d={`M${x} ${yd}H${xd}`} />
        {source ? <circle cx={xd + 8} cy={yd} r={8} /> : stores
          ? <><rect x={xd} y={yd - 6} width={30} height={12} rx={2} class="cell" />
            <rect x={xd + 1.5} y={yd - 4.5} width={27 * Math.min(Math.max((soc ?? 0) / 100, 0), 1)} height={9} rx={1} class="charge" /></>
          : <path d={`M${xd} ${yd - 4.5}L${xd + 9} ${yd}L${xd} ${yd + 4.5}z`} class="arrowhead" />}
        {source && <text x={xd + 8} y={yd + 3.5} class="tiny middle">{kCircle[d.kind]}</text>}
        {d.kind === "wind_turbine" && <path d={kBlades} transform={`translate(${xd + 8} ${yd})`} />}
        <text x={xd + (stores ? 35 : source ? 21 : 14)} y={yd + 4} class="small">{says}</text>
      </g>
    );
  };
  return (
    <div class="scroll" tabindex={0} aria-label="one-line diagram">
      <svg viewBox={`0 0 ${width} ${height}`} class="oneline" style={{ minHeight: `${Math.min(height, 240)}px`, minWidth: `${Math.round(0.66 * width)}px` }} role="group" aria-label="one-line diagram">
        {net.branches.filter(b => at.has(b.from) && at.has(b.to)).map(branch)}
        {net.buses.map(b => {
          const x = xOf(at.get(b.name)![0]), y = yOf(at.get(b.name)![1]);
          const v = now.get(`bus.${b.name}.v_pu`), state = band(v);
          const tied = net.branches.some(o => (o.from === b.name || o.to === b.name) && at.has(o.from) && at.has(o.to) && !horizontal(o)
            && at.get(o.from === b.name ? o.to : o.from)![1] < at.get(b.name)![1]); // a branch comes from above
          const source = net.devices.find(d => d.bus === b.name && d.kind === "source");
          return (
            <g key={b.name} class={`bus ${state}`} onClick={() => plot("bus.*.v_pu")}>
              <title>{`bus ${b.label}, ${b.voltage_v} V${v !== undefined ? `: ${v.toFixed(4)} p.u., ${fixed(now.get(`bus.${b.name}.angle_deg`), 2)} deg` : ""}`}</title>
              <path d={`M${x} ${y}V${y + barOf(b.name)}`} class="bar" />
              <text x={tied ? x - 7 : x} y={y - 8} class={tied ? "end" : "middle"}>{b.label} <tspan class="value">{v !== undefined ? v.toFixed(3) + mark[state] : ""}</tspan></text>
              {source && <g class="device source"><path d={`M${x} ${y + 16}H${x - 22}`} /><rect x={x - 44} y={y + 7} width={22} height={18} /><text x={x - 33} y={y + 20} class="tiny middle">grid</text></g>}
              {applied.filter(f => f.bus === b.name).map(f => bolt(f, x, y + 20))}
              {devices(b.name).map((d, i) => device(d, i, x, y))}
            </g>
          );
        })}
      </svg>
    </div>
  );
}
