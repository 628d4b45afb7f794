// Writes and reads a text inside a PNG file, in an iTXt chunk (PNG specification, third edition,
// 11.3.3.4). Programs that do not know the text's keyword keep or skip the chunk.

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10];
// Number of bytes of a chunk in addition to its data: the length and the type before the data, and
// the checksum after the data.
const CHUNK_BYTES = 12;

// Returns the file with the text inserted before its first image data; undefined if it is not a
// PNG.
export function withPngText(
  file: Uint8Array,
  keyword: string,
  text: string,
): Uint8Array<ArrayBuffer> | undefined {
  const at = chunksOf(file)?.find(({ type }) => type === "IDAT")?.begin;
  if (at === undefined) return undefined;
  const chunk = itxtChunk(keyword, text);
  const result = new Uint8Array(file.length + chunk.length);
  result.set(file.subarray(0, at));
  result.set(chunk, at);
  result.set(file.subarray(at), at + chunk.length);
  return result;
}

// Returns the text with that keyword; undefined if the file has no such text or is not a PNG.
export function pngText(file: Uint8Array, keyword: string): string | undefined {
  for (const { type, data } of chunksOf(file) ?? []) {
    if (type !== "iTXt") continue;
    const end = data.indexOf(0);
    if (new TextDecoder().decode(data.subarray(0, end)) !== keyword) continue;
    // Only uncompressed texts are read. The language and the translated keyword are skipped.
    if (data[end + 1] !== 0) continue;
    const language = data.indexOf(0, end + 3);
    const translated = data.indexOf(0, language + 1);
    return new TextDecoder().decode(data.subarray(translated + 1));
  }
  return undefined;
}

interface Chunk {
  readonly type: string;
  readonly begin: number;
  readonly data: Uint8Array;
}

function chunksOf(file: Uint8Array): Chunk[] | undefined {
  if (SIGNATURE.some((byte, at) => file[at] !== byte)) return undefined;
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  const chunks: Chunk[] = [];
  for (let begin = SIGNATURE.length; begin + CHUNK_BYTES <= file.length; ) {
    const length = view.getUint32(begin);
    if (begin + CHUNK_BYTES + length > file.length) break;
    const type = String.fromCharCode(...file.subarray(begin + 4, begin + 8));
    chunks.push({ type, begin, data: file.subarray(begin + 8, begin + 8 + length) });
    begin += CHUNK_BYTES + length;
  }
  return chunks;
}

function itxtChunk(keyword: string, text: string): Uint8Array {
  // The zero bytes mean no compression, no language and no translated keyword.
  const data = new TextEncoder().encode(`iTXt${keyword}\0\0\0\0\0${text}`);
  const chunk = new Uint8Array(data.length + 8);
  const view = new DataView(chunk.buffer);
  view.setUint32(0, data.length - 4);
  chunk.set(data, 4);
  view.setUint32(4 + data.length, crc32(data));
  return chunk;
}

// Computes the CRC of ISO 3309, which PNG uses.
export function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return (crc ^ 0xffffffff) >>> 0;
}
