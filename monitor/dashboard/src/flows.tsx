// Flows into the branches at their begin, by the last cycle: of waveforms r.m.s. currents and powers are made here, from what is measured;
// of phasors they are published.
import { useEffect } from "preact/hooks";
import { ask, drawn, forget, network, run, signals, values, type Branch, type Network, type Series } from "./model";
import { fixed } from "./text";
import { position as instant } from "./transport";

const kPhases = ["a", "b", "c"], kMost = 40; // branches
const kId = "flows";

export interface Flow { branch: Branch; i: (number | undefined)[]; p?: number; q?: number } // A; kW and kvar into the branch

/** Where a branch is measured: phases of a current and of the voltage there, and powers if they are published. */
interface Meter { branch: Branch; i: string[]; v: string[]; p?: string; q?: string }

function meters(net: Network, told: Set<string>): Meter[] {
  const three = (stem: string) => { const names = kPhases.map(p => `${stem}.${p}`); return names.every(n => told.has(n)) ? names : []; };
  return net.branches.slice(0, kMost).flatMap(branch => {
    const end = `${branch.kind}.${branch.name}.from`, ct = net.cts.find(c => c.line === branch.name && c.end === "from" && told.has(`ct.${c.name}.i.a`));
    const direct = three(`${end}.i`), i = direct.length ? direct : ct ? three(`ct.${ct.name}.i`) : told.has(`${end}.i_a`) ? [`${end}.i_a`] : [];
    const p = told.has(`${end}.p_kw`) ? `${end}.p_kw` : undefined, q = told.has(`${end}.q_kvar`) ? `${end}.q_kvar` : undefined;
    return i.length || p ? [{ branch, i, v: three(`bus.${branch.from}.v`), p, q }] : [];
  });
}

/** The samples of the last whole cycle. */
function cycle(s: Series | undefined, seconds: number): number[] {
  if (!s || s.t.length < 8) return [];
  const n = Math.round(seconds / ((s.t[s.t.length - 1] - s.t[0]) / (s.t.length - 1)));
  return s.t.length >= n ? Array.from(s.v.slice(-n)) : [];
}
const mean = (v: number[]) => v.reduce((a, b) => a + b, 0) / v.length;
const rms = (v: number[]) => Math.sqrt(mean(v.map(x => x * x)));

/** Active and reactive power of three phases by their instantaneous values (IEEE 1459, 3.2.2.1): kW and kvar. */
function powers(v: number[][], i: number[][]): [number, number] {
  const at = (k: number) => [0, 1, 2].map(p => [v[p][k], i[p][k]]);
  const n = Math.min(...v.map(x => x.length), ...i.map(x => x.length));
  let p = 0, q = 0;
  for (let k = 0; k < n; ++k) {
    const [[va, ia], [vb, ib], [vc, ic]] = at(k);
    p += va * ia + vb * ib + vc * ic;
    q += ((vb - vc) * ia + (vc - va) * ib + (va - vb) * ic) / Math.sqrt(3);
  }
  return [p / n / 1000, q / n / 1000];
}

function flow(m: Meter, seconds: number, series: Map<string, Series>): Flow {
  const now = values.value, told = (name?: string) => (name ? now.get(name) : undefined);
  if (!seconds) return { branch: m.branch, i: m.i.map(n => now.get(n)), p: told(m.p), q: told(m.q) };
  const of = (names: string[]) => names.map(n => cycle(series.get(n), seconds)), i = of(m.i), v = of(m.v);
  const whole = (list: number[][]) => list.length === 3 && list.every(x => x.length > 0 && x.length === list[0].length);
  const out: Flow = { branch: m.branch, i: i.filter(x => x.length).map(rms) };
  if (m.p) {
    const p = cycle(series.get(m.p), seconds), q = m.q ? cycle(series.get(m.q), seconds) : [];
    return { ...out, p: p.length ? mean(p) : undefined, q: q.length ? mean(q) : undefined };
  }
  if (whole(i) && whole(v) && i[0].length === v[0].length) [out.p, out.q] = powers(v, i);
  return out;
}

/** All flows that can be told; asks the monitor for the cycle that they need. */
export function useFlows(): Flow[] {
  const net = network.value, names = new Set(signals.value.map(s => s.name));
  const all = net ? meters(net, names) : [], waves = all.some(m => m.i.length === 3), hz = net?.frequency_hz ?? 0;
  const needed = waves && hz > 0 ? [...new Set(all.flatMap(m => (m.p ? [m.p, ...(m.q ? [m.q] : []), ...m.i] : [...m.i, ...m.v])))] : [];
  const at = run.value?.recorded ? instant() : null, key = needed.join(" "), stretch = hz ? 1.2 / hz : 0;
  useEffect(() => {
    if (!needed.length) return;
    ask(at === null ? { id: kId, names: needed, window_s: stretch, t0: 0, t1: 0, px: 4000 } : { id: kId, names: needed, window_s: 0, t0: Math.max(0, at - stretch), t1: at, px: 4000 });
    return () => forget(kId);
  }, [key, at, stretch]);
  const series = new Map((drawn.value[kId]?.series ?? []).map(s => [s.name, s]));
  return all.map(m => flow(m, waves && hz ? 1 / hz : 0, series)).filter(f => f.p !== undefined || f.i.length > 0);
}

export function FlowTable({ flows }: { flows: Flow[] }) {
  if (!flows.length) return null;
  const phases = flows.some(f => f.i.length === 3), waves = phases;
  return (
    <details class="flows" open={flows.length <= 12}>
      <summary>Flows, at the begin of each branch into it{waves ? "; of the last cycle" : ""}</summary>
      <table class="plain">
        <thead><tr><th>branch</th>{phases ? kPhases.map(p => <th key={p} class="number">I {p}, A</th>) : <th class="number">I, A</th>}<th class="number">P, kW</th><th class="number">Q, kvar</th></tr></thead>
        <tbody>
          {flows.map(f => (
            <tr key={f.branch.name} data-branch={f.branch.name}><td>{f.branch.label} <span class="soft">from {f.branch.from}</span></td>
              {(phases ? [0, 1, 2] : [0]).map(k => <td key={k} class="number">{fixed(f.i[k], 2)}</td>)}
              <td class="number p">{fixed(f.p, 2)}</td><td class="number q">{fixed(f.q, 2)}</td></tr>
          ))}
        </tbody>
      </table>
    </details>
  );
}
