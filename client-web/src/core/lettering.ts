// Arrows and letters as lines that a pen draws. The server stores each mark as a single line. A
// corner that occurs twice in succession means that the pen is lifted and moves to the next corner.
import type { StrokePoint } from "./stroke";

type Strokes = readonly (readonly StrokePoint[])[];

// The strokes of each letter on a grid: x is 0 to 4 to the right, and y is 0 to 6 down. Each point
// is written as two digits, x and y. A space separates two strokes.
const LETTERS: Readonly<Record<string, string>> = {
  A: "062046 1434",
  B: "0600304142331303 3344453606",
  C: "4130100105163645",
  D: "06002041452606",
  E: "46060040 0333",
  F: "060040 0333",
  G: "41301001051636454323",
  H: "0006 4046 0343",
  I: "1030 2026 1636",
  J: "4045361605",
  K: "0006 400346",
  L: "000646",
  M: "0600234046",
  N: "06004640",
  O: "103041453616050110",
  P: "06003041423303",
  Q: "103041453616050110 2446",
  R: "06003041423303 2346",
  S: "413010010213334445361605",
  T: "0040 2026",
  U: "000516364540",
  V: "002640",
  W: "0016233640",
  X: "0046 4006",
  Y: "002340 2326",
  Z: "00400646",
  0: "103041453616050110 0541",
  1: "112026 1636",
  2: "01103041420646",
  3: "00402333444536 361605",
  4: "36300444",
  5: "400002324345361605",
  6: "30100105163645443303",
  7: "004016",
  8: "10304142331302 020110 1304051636454433",
  9: "4313020110304145 453616",
  "-": "1333",
  "+": "1333 2224",
  ".": "2526",
  ",": "2516",
  "?": "01103041423324 2526",
  "!": "2024 2526",
  ":": "2223 2526",
  "/": "4006",
  "°": "20313222 1120",
  Ä: "062246 1434 1011 3031",
  Ö: "123243453616050312 1011 3031",
  Ü: "020516364542 1011 3031",
  "(": "30212536",
  ")": "10212516",
  "%": "4006 0010110100 3545463635",
  "=": "1232 1434",
  "<": "420344",
  ">": "024304",
  "'": "2021",
  _: "0646",
  " ": "",
};

const ADVANCE = 6;
const HEIGHT = 6;
const LETTER_WIDTH = 4;
// Maximum number of corners of a mark that the session accepts.
const MAX_CORNERS = 256;
// Maximum number of letters in a mark. Letters with many corners reach MAX_CORNERS earlier.
export const MAX_LETTERS = 40;

interface Written {
  // The strokes of each letter of the text, written as in LETTERS.
  readonly letters: readonly string[];
  readonly unknown: readonly string[];
  // The end of the text that does not fit into the MAX_CORNERS corners of one mark.
  readonly tooLong: string;
}

function written(words: string): Written {
  const letters: string[] = [];
  const unknown: string[] = [];
  let corners = 0;
  const all = [...words.normalize("NFC").toUpperCase()];
  for (const [at, letter] of all.entries()) {
    // A letter without strokes for its accent is written without the accent.
    const strokes = LETTERS[letter] ?? LETTERS[letter.normalize("NFD").charAt(0)];
    if (strokes === undefined) {
      unknown.push(letter);
      continue;
    }
    // Each stroke takes one corner more than it has points, because a lift of the pen repeats a
    // corner.
    corners += strokes.split(" ").reduce((sum, stroke) => sum + stroke.length / 2 + 1, 0);
    if (corners > MAX_CORNERS) return { letters, unknown, tooLong: all.slice(at).join("") };
    letters.push(strokes);
  }
  return { letters, unknown, tooLong: "" };
}

// Returns the strokes of a text. The letters begin at `place` and are `heightPx` high.
export function letterStrokes(words: string, place: StrokePoint, heightPx: number): Strokes {
  const unit = heightPx / HEIGHT;
  return written(words).letters.flatMap((letter, at) =>
    letter.split(" ").flatMap((digits) => {
      const points = (digits.match(/\d\d/g) ?? []).map((pair) => ({
        left: place.left + unit * (at * ADVANCE + Number(pair[0])),
        top: place.top + unit * Number(pair[1]),
      }));
      return points.length > 1 ? [points] : [];
    }),
  );
}

// Returns the distance from the left of the first letter to the right of the last, for letters that
// are `heightPx` high.
export function wordsWidthPx(words: string, heightPx: number): number {
  const count = written(words).letters.length;
  return count === 0 ? 0 : (heightPx / HEIGHT) * (ADVANCE * count - (ADVANCE - LETTER_WIDTH));
}

// Returns a sentence about the letters that letterStrokes() leaves out; undefined if it writes
// everything.
export function leftOutInWords(words: string): string | undefined {
  const { unknown, tooLong } = written(words);
  const said = [
    unknown.length > 0 ? `Cannot be written: ${[...new Set(unknown)].join(" ")}` : "",
    tooLong === "" ? "" : `Too long for one mark, left out: ${tooLong}`,
  ].filter((part) => part !== "");
  return said.length > 0 ? said.join(". ") : undefined;
}

const HEAD_PX = 16;
const HEAD_DEG = 28;

export function arrowStrokes(tail: StrokePoint, tip: StrokePoint): Strokes {
  const back = Math.atan2(tail.top - tip.top, tail.left - tip.left);
  const barb = (deg: number) => ({
    left: tip.left + HEAD_PX * Math.cos(back + (deg * Math.PI) / 180),
    top: tip.top + HEAD_PX * Math.sin(back + (deg * Math.PI) / 180),
  });
  return [
    [tail, tip],
    [barb(HEAD_DEG), tip, barb(-HEAD_DEG)],
  ];
}

export function ringStroke(middle: StrokePoint, radiusPx: number): readonly StrokePoint[] {
  return Array.from({ length: 33 }, (_, at) => ({
    left: middle.left + radiusPx * Math.cos((2 * Math.PI * at) / 32),
    top: middle.top + radiusPx * Math.sin((2 * Math.PI * at) / 32),
  }));
}

// Joins all strokes to one line.
export function joined<P>(strokes: readonly (readonly P[])[]): P[] {
  return strokes.flatMap((stroke, at) => {
    const last = stroke.at(-1);
    return last !== undefined && at < strokes.length - 1 ? [...stroke, last] : [...stroke];
  });
}

// Splits one line into its strokes.
export function parted<P>(line: readonly P[], same: (a: P, b: P) => boolean): P[][] {
  const strokes: P[][] = [[]];
  line.forEach((point, at) => {
    const before = line[at - 1];
    if (before !== undefined && same(before, point)) strokes.push([]);
    else strokes.at(-1)?.push(point);
  });
  return strokes.filter((stroke) => stroke.length > 1);
}
