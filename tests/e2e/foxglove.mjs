// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The Foxglove WebSocket protocol, judged by its authors' own client library and IDL reader.
import protocol from "@foxglove/ws-protocol"; // CommonJS
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import WebSocket from "ws";
import { check, start } from "./harness.mjs";

const { FoxgloveClient } = protocol;

/** The first of these events that satisfies a condition. */
const event = (client, name, condition = () => true) => new Promise((done, fail) => {
  const late = setTimeout(() => fail(new Error(`waited 30 s for ${name}`)), 30_000);
  client.on(name, e => {
    if (!condition(e)) return;
    clearTimeout(late);
    done(e);
  });
});

export async function foxglove() {
  const run = await start("configs/scenarios/ev_charging.yaml", "--set", "clock.speed=300");
  const client = new FoxgloveClient({ ws: new WebSocket(run.url.replace("http", "ws"), [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const channels = new Map();
  client.on("advertise", list => list.forEach(c => channels.set(c.topic, c)));
  client.on("error", e => check("the client sees no error", false, e.message ?? e));
  const problems = [];
  client.on("status", s => problems.push(s));
  const info = await event(client, "serverInfo");
  check("Foxglove's client is greeted", info.name.includes("ev_charging") && info.capabilities.includes("time"), info.name);
  while (!["bus_measurements", "requests", "simulation_clock"].every(t => channels.has(t))) await event(client, "advertise");
  check("every topic is advertised as CDR with its IDL", [...channels.values()].every(c => c.encoding === "cdr" && c.schemaEncoding === "omgidl" && c.schema.includes(c.schemaName)));

  const channel = channels.get("bus_measurements");
  const reader = new MessageReader(channel.schemaName, parseIDL(channel.schema));
  const subscription = client.subscribe(channel.id);
  const seen = new Map();
  let last = -1n;
  await event(client, "message", m => {
    if (m.subscriptionId !== subscription) return false;
    const sample = reader.readMessage(new Uint8Array(m.data.buffer, m.data.byteOffset, m.data.byteLength));
    if (m.timestamp < last) check("samples are stamped in order of simulated time", false, `${m.timestamp} after ${last}`);
    last = m.timestamp;
    seen.set(sample.bus, sample);
    return seen.size === 4 && m.timestamp > 0n;
  });
  check("samples of all four buses are decoded by Foxglove's own IDL reader", ["B1", "B2", "B3", "B4"].every(b => seen.has(b)), [...seen.keys()].join());
  const volts = [...seen.values()].map(s => s.v_pu ?? s.voltage_pu);
  check("and say voltages near 1 p.u.", volts.every(v => v > 0.9 && v < 1.1), volts.join());
  client.unsubscribe(subscription);

  const time = await event(client, "time");
  check("the time is simulated time", time.timestamp >= 0n && time.timestamp < 28_800_000_000_000n, time.timestamp);
  client.subscribeConnectionGraph();
  const graph = await event(client, "connectionGraphUpdate", g => g.publishedTopics.some(t => t.name === "bus_measurements" && t.publisherIds.includes("sim")));
  check("the connection graph says who reads", graph.subscribedTopics.some(t => t.name === "decisions" && t.subscriberIds.includes("sim")));
  check("nothing was complained of", problems.length === 0, JSON.stringify(problems));
  client.subscribe(9999);
  const complaint = await event(client, "status");
  check("a channel that is not there is complained of", /channel/.test(complaint.message), complaint.message);

  const refused = await new Promise(done => {
    const stranger = new WebSocket(run.url.replace("http", "ws") + "/elsewhere", ["somebody.else.v1"]);
    stranger.on("unexpected-response", (_, answer) => done(answer.statusCode));
    stranger.on("open", () => done(101));
    stranger.on("error", () => {});
  });
  check("another protocol elsewhere is refused", refused === 404, refused);
  client.close();
  run.child.kill("SIGTERM");
  await run.ended;
}
