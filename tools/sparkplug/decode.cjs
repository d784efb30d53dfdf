// Decodes Sparkplug B payloads with the npm package sparkplug-payload: lines "hex types" in, a line of JSON each out.
// `types` is JSON: data type by alias, as births told them. Messages of data carry no types; a host remembers them.
const path = require("path");
const root = process.env.SPARKPLUG_NODE_MODULES || path.join(process.cwd(), "node_modules");
const { get } = require(path.join(root, "sparkplug-payload"));
const proto = require(path.join(root, "sparkplug-payload/lib/sparkplugPayloadProto.js"));
const Payload = proto.org.eclipse.tahu.protobuf.Payload;
const codec = get("spBv1.0");

const plain = (key, value) =>
  value && typeof value === "object" && "low" in value && "high" in value
    ? Number((BigInt(value.high >>> 0) << 32n) | BigInt(value.low >>> 0))
    : value;

require("readline")
  .createInterface({ input: process.stdin })
  .on("line", (line) => {
    const [hex, types] = [line.slice(0, line.indexOf(" ")), JSON.parse(line.slice(line.indexOf(" ") + 1))];
    const message = Payload.decode(Buffer.from(hex, "hex"));
    for (const metric of message.metrics) {
      const known = types[String(metric.alias)];
      if (!metric.datatype && known) metric.datatype = known;
    }
    const decoded = codec.decodePayload(Payload.encode(message).finish());
    // A metric without a value: the package gives the field's default.
    decoded.metrics.forEach((metric, k) => {
      if (message.metrics[k].isNull) metric.value = null;
    });
    console.log(JSON.stringify(decoded, plain));
  });
