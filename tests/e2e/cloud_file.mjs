// Makes small storm files in netCDF's classic format (CDF-1). Each contains a ball of cloud at one time, either by the
// CF conventions or as WRF writes a model run.
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
const attribute = (value) =>
  typeof value === "number"
    ? Buffer.concat([int32(TYPE.float), int32(1), numbers(TYPE.float, [value])])
    : Buffer.concat([int32(TYPE.char), name(value)]);
const attributes = (values) =>
  list(
    TAG.attributes,
    Object.entries(values).map(([key, value]) => Buffer.concat([name(key), attribute(value)])),
  );

function numbers(type, values) {
  const bytes = Buffer.alloc(values.length * BYTES[type]);
  values.forEach((value, i) => {
    if (type === TYPE.char) bytes.writeUInt8(value, i);
    else if (type === TYPE.float) bytes.writeFloatBE(value, 4 * i);
    else bytes.writeDoubleBE(value, 8 * i);
  });
  return padded(bytes);
}

// Returns the bytes of a file. Each of `dimensions` is [name, length]. Each of `variables` is [name, indices of
// dimensions, attributes, type, values].
function classicFile(dimensions, texts, variables) {
  const data = variables.map(([, , , type, values]) => numbers(type, values));
  const header = (firstByte) => {
    let begin = firstByte;
    const described = variables.map(([label, ids, own, type], i) => {
      const at = begin;
      begin += data[i].length;
      return Buffer.concat([
        name(label),
        int32(ids.length),
        ...ids.map(int32),
        attributes(own),
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
      attributes(texts),
      list(TAG.variables, described),
    ]);
  };
  return Buffer.concat([header(header(0).length), ...data]);
}

const axis = (low) => Array.from({ length: CELLS }, (_, i) => low + (i + 0.5) * SPACING_M);
const SIDE = axis((-CELLS / 2) * SPACING_M);
const UP = axis(0);
const MIDDLE = (CELLS / 2) * SPACING_M;
const ball = (radiusM, inside) =>
  UP.flatMap((z) => SIDE.flatMap((y) => SIDE.map((x) => (Math.hypot(x, y, z - MIDDLE) < radiusM ? inside : 0))));

export function cloudFile(hour, radiusM = RADIUS_M) {
  const dimensions = [
    ["time", 1],
    ["z", CELLS],
    ["y", CELLS],
    ["x", CELLS],
  ];
  return classicFile(dimensions, { Conventions: "CF-1.8" }, [
    ["time", [0], { units: "hours since 2020-05-20 00:00:00", axis: "T" }, TYPE.double, [hour]],
    ["z", [1], { units: "m", axis: "Z", positive: "up" }, TYPE.double, UP],
    ["y", [2], { units: "m", axis: "Y" }, TYPE.double, SIDE],
    ["x", [3], { units: "m", axis: "X" }, TYPE.double, SIDE],
    ["lwc", [0, 1, 2, 3], { units: "kg m-3" }, TYPE.float, ball(radiusM, 1e-3)],
  ]);
}

// The middle of the runs' grid, on the border between Libya and Egypt.
export const PLACE = { latitudeDeg: 27, longitudeDeg: 24.979 };
const METERS_PER_DEG = 111_200;
const PROJECTION = { MAP_PROJ: 1, TRUELAT1: 30, TRUELAT2: 60, STAND_LON: 24.979, MOAD_CEN_LAT: 27 };

// Returns a file of a run. `run` and `valid` are times as WRF writes them, such as 2020-05-20_06:00:00. Without
// geographical coordinates (`hasPlace`), the storm has no local time.
export function runFile(run, valid, radiusM, { hasPlace = false } = {}) {
  const dimensions = [
    ["Time", 1],
    ["DateStrLen", valid.length],
    ["bottom_top", CELLS],
    ["bottom_top_stag", CELLS + 1],
    ["south_north", CELLS],
    ["west_east", CELLS],
  ];
  const all = (value) => Array(CELLS ** 3).fill(value);
  const interfaces = Array.from({ length: (CELLS + 1) * CELLS ** 2 }, (_, i) => Math.floor(i / CELLS ** 2) * SPACING_M);
  const [full, half, flat] = [
    [0, 3, 4, 5],
    [0, 2, 4, 5],
    [0, 4, 5],
  ];
  const latitudes = SIDE.flatMap((y) => SIDE.map(() => PLACE.latitudeDeg + y / METERS_PER_DEG));
  const perDeg = METERS_PER_DEG * Math.cos((PLACE.latitudeDeg * Math.PI) / 180);
  const longitudes = SIDE.flatMap(() => SIDE.map((x) => PLACE.longitudeDeg + x / perDeg));
  return classicFile(
    dimensions,
    { TITLE: " OUTPUT FROM WRF V4.5 MODEL", SIMULATION_START_DATE: run, DX: SPACING_M, DY: SPACING_M, ...(hasPlace ? PROJECTION : {}) },
    [
      ["Times", [0, 1], {}, TYPE.char, [...valid].map((letter) => letter.charCodeAt(0))],
      ...(hasPlace
        ? [
            ["XLAT", flat, { units: "degree_north" }, TYPE.float, latitudes],
            ["XLONG", flat, { units: "degree_east" }, TYPE.float, longitudes],
          ]
        : []),
      ["PHB", full, { units: "m2 s-2" }, TYPE.float, interfaces.map((height) => 9.81 * height)],
      ["PH", full, { units: "m2 s-2" }, TYPE.float, interfaces.map(() => 0)],
      ["PB", half, { units: "Pa" }, TYPE.float, all(60_000)],
      ["P", half, { units: "Pa" }, TYPE.float, all(0)],
      ["T", half, { units: "K" }, TYPE.float, all(0)],
      ["QVAPOR", half, { units: "kg kg-1" }, TYPE.float, all(0)],
      ["QCLOUD", half, { units: "kg kg-1" }, TYPE.float, ball(radiusM, 1.5e-3)],
    ],
  );
}
