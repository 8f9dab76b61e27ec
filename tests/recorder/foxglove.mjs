// Reads an MCAP file with the libraries that Foxglove reads it with, and prints what is in it.
// Run in the folder that holds their node_modules; the file is the first argument.
import { createRequire } from "node:module";
import { open } from "node:fs/promises";

const require = createRequire(`${process.cwd()}/`);
const { McapIndexedReader } = require("@mcap/core");
const { FileHandleReadable } = require("@mcap/nodejs");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const file = await open(process.argv[2], "r");
const reader = await McapIndexedReader.Initialize({
  readable: new FileHandleReadable(file),
  decompressHandlers: await loadDecompressHandlers(),
});
const text = new TextDecoder();
const decoders = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  const cdr = () => new MessageReader(parse(text.decode(schema.data), { ros2: true }));
  decoders.set(
    channel.id,
    schema.encoding === "ros2msg" ? cdr() : { readMessage: (data) => JSON.parse(text.decode(data)) },
  );
}
const messages = [];
for await (const { channelId, logTime, data } of reader.readMessages({ validateCrcs: true })) {
  const { topic } = reader.channelsById.get(channelId);
  messages.push({ topic, time: String(logTime), message: decoders.get(channelId).readMessage(data) });
}
await file.close();
console.log(
  JSON.stringify(messages, (_, value) => {
    if (typeof value === "bigint") return Number(value);
    return ArrayBuffer.isView(value) ? Array.from(value) : value;
  }),
);
