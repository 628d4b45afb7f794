// The bytes of a small storm file: a ball of cloud at one time, as CF in netCDF's classic format (CDF-1).
const CELLS = 16;
const SPACING_M = 500;
const RADIUS_M = 2500;
const TYPE = { char: 2, float: 5, double: 6 };
const BYTES = { [TYPE.char]: 1, [TYPE.float]: 4, [TYPE.double]: 8 };
const TAG = { dimensions: 10, variables: 11, attributes: 12 };

const int32 = (value) => {
  const bytes = Buffer.alloc(4);
  bytes.writeInt32BE(value);
  return bytes;
};
const padded = (bytes) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
const name = (text) => Buffer.concat([int32(text.length), padded(Buffer.from(text))]);
const list = (tag, items) => Buffer.concat([int32(items.length > 0 ? tag : 0), int32(items.length), ...items]);
const attributes = (texts) =>
  list(
    TAG.attributes,
    Object.entries(texts).map(([key, text]) => Buffer.concat([name(key), int32(TYPE.char), name(text)])),
  );

function numbers(type, values) {
  const bytes = Buffer.alloc(values.length * BYTES[type]);
  values.forEach((value, i) => {
    if (type === TYPE.float) bytes.writeFloatBE(value, 4 * i);
    else bytes.writeDoubleBE(value, 8 * i);
  });
  return padded(bytes);
}

export function cloudFile(hour) {
  const dimensions = [
    ["time", 1],
    ["z", CELLS],
    ["y", CELLS],
    ["x", CELLS],
  ];
  const axis = (low) => Array.from({ length: CELLS }, (_, i) => low + (i + 0.5) * SPACING_M);
  const side = axis((-CELLS / 2) * SPACING_M);
  const up = axis(0);
  const middle = (CELLS / 2) * SPACING_M;
  const water = up.flatMap((z) =>
    side.flatMap((y) => side.map((x) => (Math.hypot(x, y, z - middle) < RADIUS_M ? 1e-3 : 0))),
  );
  const variables = [
    ["time", [0], { units: "hours since 2020-05-20 00:00:00", axis: "T" }, TYPE.double, [hour]],
    ["z", [1], { units: "m", axis: "Z", positive: "up" }, TYPE.double, up],
    ["y", [2], { units: "m", axis: "Y" }, TYPE.double, side],
    ["x", [3], { units: "m", axis: "X" }, TYPE.double, side],
    ["lwc", [0, 1, 2, 3], { units: "kg m-3" }, TYPE.float, water],
  ];
  const data = variables.map(([, , , type, values]) => numbers(type, values));
  const header = (firstByte) => {
    let begin = firstByte;
    const described = variables.map(([label, ids, texts, type], i) => {
      const at = begin;
      begin += data[i].length;
      return Buffer.concat([
        name(label),
        int32(ids.length),
        ...ids.map(int32),
        attributes(texts),
        int32(type),
        int32(data[i].length),
        int32(at),
      ]);
    });
    return Buffer.concat([
      Buffer.from("CDF\x01"),
      int32(0),
      list(
        TAG.dimensions,
        dimensions.map(([label, length]) => Buffer.concat([name(label), int32(length)])),
      ),
      attributes({ Conventions: "CF-1.8" }),
      list(TAG.variables, described),
    ]);
  };
  return Buffer.concat([header(header(0).length), ...data]);
}
