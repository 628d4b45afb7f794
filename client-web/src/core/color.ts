// Converts colours between the scene (linear sRGB primaries) and a colour picker (#rrggbb, sRGB
// encoded; IEC 61966-2-1).

export interface LinearColor {
  readonly red: number;
  readonly green: number;
  readonly blue: number;
}

export function hexOfColor(color: LinearColor): string {
  const channels = [color.red, color.green, color.blue].map((linear) => {
    const byte = Math.round(encodeSrgb(Math.min(1, Math.max(0, linear))) * 255);
    return byte.toString(16).padStart(2, "0");
  });
  return `#${channels.join("")}`;
}

export function colorOfHex(hex: string): LinearColor {
  const match = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(hex);
  if (!match) throw new Error(`a colour is written #rrggbb, not "${hex}"`);
  const [red, green, blue] = match
    .slice(1)
    .map((byte) => decodeSrgb(Number.parseInt(byte, 16) / 255));
  return { red: red ?? 0, green: green ?? 0, blue: blue ?? 0 };
}

function encodeSrgb(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}

function decodeSrgb(encoded: number): number {
  return encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
}
