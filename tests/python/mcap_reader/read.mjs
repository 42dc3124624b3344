// Reads an MCAP file with the libraries that Foxglove and Lichtblick use, and prints it as lines of JSON:
// first what the file says about itself, then every message, decoded by the schema in the file.
//   node read.mjs FILE.mcap
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const json = (value) =>
  JSON.stringify(value, (_, part) => {
    if (typeof part === "bigint") return part.toString();
    if (typeof part === "number" && !Number.isFinite(part)) return String(part);
    if (ArrayBuffer.isView(part)) return Array.from(part);
    return part;
  });

const decompressHandlers = await loadDecompressHandlers();
const handle = await open(process.argv[2], "r");
const reader = await McapIndexedReader.Initialize({ readable: new FileHandleReadable(handle), decompressHandlers });

const readers = new Map();
const schemas = {};
for (const schema of reader.schemasById.values()) {
  if (schema.encoding !== "ros2msg") throw new Error(`${schema.name}: encoding ${schema.encoding}`);
  const text = new TextDecoder().decode(schema.data);
  schemas[schema.name] = text;
  readers.set(schema.id, new MessageReader(parse(text, { ros2: true })));
}
let indexed = 0;
for await (const _ of reader.readMessages()) ++indexed;
const attachments = {};
for await (const attachment of reader.readAttachments()) {
  attachments[attachment.name] = new TextDecoder().decode(attachment.data);
}
console.log(json({ profile: reader.header.profile, statistics: reader.statistics, indexed, attachments, schemas }));

// In the order of the file, which the indexed reader does not promise for equal times.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
const channels = new Map();
for await (const part of handle.createReadStream({ start: 0, autoClose: false })) {
  stream.append(part);
  for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    const message = readers.get(channel.schemaId).readMessage(record.data);
    console.log(json({ topic: channel.topic, logTime: record.logTime, publishTime: record.publishTime, message }));
  }
}
if (!stream.done()) throw new Error("the file does not end as MCAP files do");
await handle.close();
