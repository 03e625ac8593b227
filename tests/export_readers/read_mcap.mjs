// Prints what the readers of MCAP and ROS 2 messages by Foxglove find in a file, as JSON. Every
// checksum is verified, the index is followed, and the definitions of messages in the file are
// compared with those of ROS 2 Humble.
import { readFileSync } from "node:fs";
import { isDeepStrictEqual } from "node:util";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";

const bytes = readFileSync(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
};

const stream = new McapStreamReader({ validateCrcs: true });
stream.append(bytes);
let streamed = 0;
for (let record; (record = stream.nextRecord());) {
  if (record.type === "Message") ++streamed;
}
if (!stream.done()) throw new Error("the file has no end");

const reader = await McapIndexedReader.Initialize({ readable });
if (Number(reader.statistics.messageCount) !== streamed) throw new Error("messages are missing");

/// The type of each field, by the name of the type.
function fieldsOf(definitions) {
  const fields = {};
  for (const { name, definitions: of } of definitions) {
    fields[name ?? "message"] = of.map(({ name, type, isArray, arrayLength, isConstant, value }) =>
      ({ name, type, isArray, arrayLength, isConstant, value }));
  }
  return fields;
}

/// Numbers that JSON lacks become text, bytes become base 64.
function plain(value) {
  if (typeof value === "bigint") return String(value);
  if (typeof value === "number") return Number.isFinite(value) ? value : String(value);
  if (value instanceof Uint8Array) return Buffer.from(value).toString("base64");
  if (ArrayBuffer.isView(value)) return Array.from(value).map(plain);
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, of]) => [key, plain(of)]));
}

const readers = new Map();
const topics = {};
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
  // The types that the message uses, as the package of definitions has them.
  const published = Object.fromEntries(Object.values(ros2humble).map(({ name, definitions: of }) =>
    [name, fieldsOf([{ definitions: of }]).message]));
  const own = fieldsOf(definitions);
  own[schema.name.replace("/msg/", "/")] = own.message;
  delete own.message;
  for (const [name, fields] of Object.entries(own)) {
    const expected = published[name] ?? published[name.replace("/", "/msg/")];
    if (!isDeepStrictEqual(normal(fields), normal(expected))) {
      throw new Error(`${name} is not that of ROS 2: ${JSON.stringify([fields, expected])}`);
    }
  }
  readers.set(channel.id, new MessageReader(definitions));
  topics[channel.topic] = {
    type: schema.name,
    encodings: [schema.encoding, channel.messageEncoding],
    quality: channel.metadata.get("offered_qos_profiles"),
    messages: [],
  };
}
/// Types without their package's `/msg`, and values as numbers.
function normal(fields) {
  return fields?.map((field) => ({
    ...field,
    type: field.type.replace("/msg/", "/"),
    value: field.value === undefined ? undefined : Number(field.value),
  }));
}

for await (const message of reader.readMessages()) {
  const topic = topics[reader.channelsById.get(message.channelId).topic];
  const decoded = readers.get(message.channelId).readMessage(message.data);
  topic.messages.push([String(message.logTime), plain(decoded)]);
}
console.log(JSON.stringify({ profile: reader.header.profile, topics }));
