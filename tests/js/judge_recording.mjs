// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// judge_recording.mjs data.mcap: opens a recording with @mcap/core and decodes every message with Foxglove's IDL reader. Prints what it
// has seen as JSON; exit code 1 and the reason when something is wrong. Nothing here was written by the recorder's authors.
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader } from "@foxglove/omgidl-serialization";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };

class FileReadable {
  constructor(handle, size) {
    this.handle = handle;
    this.bytes = BigInt(size);
  }
  async size() {
    return this.bytes;
  }
  async read(offset, length) {
    const buffer = new Uint8Array(Number(length));
    const { bytesRead } = await this.handle.read(buffer, 0, Number(length), Number(offset));
    if (bytesRead !== Number(length)) {
      throw new Error(`${length} octets at ${offset}: only ${bytesRead} there`);
    }
    return buffer;
  }
}

class Judge {
  constructor() {
    this.topics = {};
    this.readers = new Map();
    this.last = -1n;
    this.sequences = new Map();
    this.previous = null;
  }
  take(message, channel, schema) {
    if (channel.messageEncoding !== "cdr" || schema.encoding !== "omgidl") {
      throw new Error(`${channel.topic}: ${channel.messageEncoding} with ${schema.encoding}`);
    }
    if (message.logTime < this.last) {
      throw new Error(`${channel.topic}: a message of ${message.logTime} comes after one of ${this.last}`);
    }
    if (message.publishTime !== message.logTime) {
      throw new Error(`${channel.topic}: publish time ${message.publishTime} is not log time ${message.logTime}`);
    }
    this.last = message.logTime;
    const expected = (this.sequences.get(channel.id) ?? 0) + 1;
    if (message.sequence !== expected) {
      throw new Error(`${channel.topic}: sequence ${message.sequence} instead of ${expected}`);
    }
    this.sequences.set(channel.id, expected);
    if (!this.readers.has(schema.id)) {
      const definition = parseIDL(new TextDecoder().decode(schema.data));
      this.readers.set(schema.id, new MessageReader(schema.name, definition));
    }
    const value = this.readers.get(schema.id).readMessage(message.data);
    const topic = (this.topics[channel.topic] ??= { type: schema.name, messages: 0, first: null, last: null, low: null, high: null });
    topic.messages += 1;
    topic.first ??= value;
    topic.last = value;
    for (const [name, number] of Object.entries(value)) {
      if (typeof number === "number") {
        if (!Number.isFinite(number)) {
          throw new Error(`${channel.topic}: ${name} is ${number}`);
        }
        (topic.low ??= {})[name] = Math.min(topic.low[name] ?? number, number);
        (topic.high ??= {})[name] = Math.max(topic.high[name] ?? number, number);
      }
    }
  }
  result() {
    return { topics: this.topics, processes: this.processes, messages: Object.values(this.topics).reduce((n, t) => n + t.messages, 0) };
  }
}

async function byIndex(handle, size) {
  const reader = await McapIndexedReader.Initialize({ readable: new FileReadable(handle, size), decompressHandlers });
  const judge = new Judge();
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    judge.take(message, channel, reader.schemasById.get(channel.schemaId));
  }
  const counted = Number(reader.statistics?.messageCount ?? -1);
  if (counted !== judge.result().messages) {
    throw new Error(`the statistics say ${counted} messages, there are ${judge.result().messages}`);
  }
  judge.processes = [...new Set([...reader.channelsById.values()].map((c) => c.metadata.get("process")))].sort();
  return judge.result();
}

async function byStream(handle) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const schemas = new Map();
  const channels = new Map();
  const judge = new Judge();
  for (let offset = 0; ; ) {
    const buffer = new Uint8Array(1 << 20);
    const { bytesRead } = await handle.read(buffer, 0, buffer.length, offset);
    if (bytesRead === 0) {
      break;
    }
    offset += bytesRead;
    reader.append(buffer.subarray(0, bytesRead));
    for (let record; (record = reader.nextRecord()); ) {
      if (record.type === "Schema") {
        schemas.set(record.id, record);
      } else if (record.type === "Channel") {
        channels.set(record.id, record);
      } else if (record.type === "Message") {
        const channel = channels.get(record.channelId);
        judge.take(record, channel, schemas.get(channel.schemaId));
      }
    }
  }
  if (!reader.done()) {
    throw new Error("the file ends in the middle of a record");
  }
  return judge.result();
}

const text = (value) => JSON.stringify(value, (_, v) => (typeof v === "bigint" ? v.toString() : v));
try {
  const handle = await open(process.argv[2]);
  const { size } = await handle.stat();
  const indexed = await byIndex(handle, size);
  const streamed = await byStream(handle);
  if (indexed.messages !== streamed.messages) {
    throw new Error(`by index ${indexed.messages} messages, by stream ${streamed.messages}`);
  }
  console.log(text(indexed));
} catch (error) {
  console.error(`${process.argv[2]}: ${error.message}`);
  process.exit(1);
}
