// What the monitor sends, as signals that views depend on.
import { signal } from "@preact/signals";

export interface Process { name: string; program: string; host: string; state: string; incarnation: number; tick?: number; cpu_percent?: number; memory_octets?: number }
export interface Run {
  scenario: string; mode: string; speed: string; recorded: boolean; control: boolean; state: string; time_s: number; duration_s: number; factor: number; tick: number;
  processes: Process[];
}
export interface GraphProcess extends Process { addresses: string[]; networks: string[] }
export interface GraphTopic { name: string; network: string; type: string; framework: boolean; writers: number; readers: number; not_heard?: string[] }
export interface Edge {
  process: string; topic: string; network: string; writes: boolean; endpoints: number; matched: boolean; problems: string[];
}
export interface Wire { process: string; stream: string; kind: string; link: string; publishes: boolean }
export interface Endpoint {
  id: string; process: string; network: string; topic: string; type: string; writer: boolean; keyed: boolean;
  qos: Record<string, unknown>;
}
export interface Graph {
  revision: number; processes: GraphProcess[]; topics: GraphTopic[]; edges: Edge[]; wires: Wire[]; endpoints: Endpoint[];
}
export interface Bus { name: string; label: string; voltage_v: number; x?: number; y?: number }
export interface Branch { name: string; label: string; from: string; to: string; kind: string }
export interface Breaker { name: string; line: string; end: string }
export interface Ct { name: string; line: string; end: string }
export interface Device { name: string; label: string; bus: string; kind: string }
/** A relay, the device numbers of what it does (87L: differential of a line), its current transformers and the breakers that it trips. */
export interface Relay { name: string; functions: string[]; cts: string[]; breakers: string[] }
export interface Fault { name: string; line?: string; bus?: string; position_percent?: number; at_s: number; until_s?: number }
export interface Network { diagram: string; frequency_hz: number; buses: Bus[]; branches: Branch[]; breakers: Breaker[]; cts: Ct[]; devices: Device[]; relays: Relay[]; faults: Fault[] }
export interface SignalInfo { name: string; unit: string; source: string }
export interface TopicState {
  name: string; network: string; type: string; framework: boolean; writers: number; readers: number; samples: number;
  octets: number; samples_per_second: number;
}
export interface StreamEnd {
  process: string; sends: boolean; state: string; time_s: number; frames: number; rate_hz: number; lost: number; duplicate: number; late: number;
  refused: number; silences: number; dropped: number;
}
export interface StreamState { name: string; kind: string; from: string[]; to: string[]; counted: StreamEnd[] }
export interface RunEvent { number: number; time_s: number; source: string; event: string; text: string }
/** While the run goes on: `passed` and `failed` whatever comes; the others may change. */
export type Standing = "unknown" | "holds" | "not_yet" | "passed" | "failed" | "shown";
export interface Expectation { name: string; rule: string; accepted: string; unit: string; advisory: boolean; value: number | null; pass: boolean | null; detail: string; standing: Standing | null }
export interface Verdict { judged: boolean; expectations: Expectation[]; reached_s?: number; exit?: number; cause?: string; simulated_s?: number; wall_s?: number; overruns?: number }
export interface Series { name: string; unit: string; steps: boolean; t: Float64Array; v: Float64Array }
export interface Drawn { t0: number; t1: number; series: Series[] }

export const connected = signal(false);
export const ended = signal(false); // it was connected once
export const dropped = signal(0);
export const run = signal<Run | null>(null);
export const graph = signal<Graph | null>(null);
export const network = signal<Network | null>(null);
export const signals = signal<SignalInfo[]>([]);
export const topics = signal<TopicState[]>([]);
export const streams = signal<StreamState[]>([]);
export const verdict = signal<Verdict | null>(null);
export const events = signal<RunEvent[]>([]);
export const values = signal<Map<string, number>>(new Map());
export const drawn = signal<Record<string, Drawn>>({});

/** Nothing more will come: a recorded run, one that has reached its end, or one whose monitor is gone. */
export const over = () => ended.value || (run.value?.recorded ?? false) || ["final", "aborted"].includes(run.value?.state ?? "");

/** What is said of a process, and its class: nobody is alive any more once the run is over and its monitor gone. */
export function standing(state: string): { said: string; look: string } {
  const recorded = run.value?.recorded ?? false, was = state === "alive" || (recorded && state === "ended");
  return was && (recorded || ended.value) ? { said: recorded ? "took part" : "was alive", look: "past" } : { said: state, look: state };
}

/** What a plot asks for: names, and either a window that follows the newest sample (negative: everything) or fixed ends. */
export interface View { id: string; names: string[]; window_s: number; t0: number; t1: number; px: number }

const views = new Map<string, View>();
let socket: WebSocket | null = null;

export function ask(view: View): void {
  views.set(view.id, view);
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ op: "view", ...view }));
}
export function forget(id: string): void {
  views.delete(id);
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ op: "view", id, names: [] }));
}

/** Of a recorded run: the instant whose values are wanted; null: the end. */
export function seek(at: number | null): void {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ op: "seek", t: at }));
}

/** Length of the header, the header (JSON), then the times and values of each series as little-endian doubles. */
function series(bytes: ArrayBuffer): void {
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  let at = 4 + length;
  const take = (n: number) => {
    const out = new Float64Array(bytes, at, n);
    at += 8 * n;
    return out;
  };
  const list: Series[] = header.series.map((s: { name: string; unit: string; steps?: boolean; points: number }) => ({
    name: s.name, unit: s.unit, steps: s.steps ?? false, t: take(s.points), v: take(s.points),
  }));
  drawn.value = { ...drawn.value, [header.id]: { t0: header.t0, t1: header.t1, series: list } };
}

export function connect(): void {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws/v1`);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    connected.value = true;
    ended.value = false;
    events.value = [];
    views.forEach(ask);
  };
  socket.onmessage = message => {
    if (typeof message.data !== "string") return series(message.data);
    const told = JSON.parse(message.data);
    switch (told.op) {
      case "state": {
        run.value = told.run;
        const list = signals.value;
        const map = new Map<string, number>();
        for (let i = 0; i < list.length && i < told.values.length; ++i)
          if (told.values[i] !== null) map.set(list[i].name, told.values[i]);
        values.value = map;
        break;
      }
      case "graph": graph.value = told.graph; break;
      case "network": network.value = told.network; break;
      case "signals": signals.value = told.list.signals; break;
      case "topics": topics.value = told.list.topics; break;
      case "streams": streams.value = told.list.streams; break;
      case "events": events.value = [...events.value, ...told.list.events].slice(-2000); break;
      case "dropped": dropped.value = told.count; break;
    }
  };
  socket.onclose = () => {
    if (connected.value) ended.value = true;
    connected.value = false;
    setTimeout(connect, 1000);
  };
}
