// Converts the list of a storm's times that are in the server's memory to shaded sections of the
// time line.

export interface Stretch {
  // Positions on the time line: 0 is the first time and 1 the last.
  readonly from: number;
  readonly to: number;
}

// Returns one section for each group of adjacent times. A time's section extends halfway to the
// neighbouring times.
export function stretchesOf(indices: readonly number[], count: number): Stretch[] {
  const last = count - 1;
  const within = indices.filter((index) => index <= last);
  if (last < 1) return within.length > 0 ? [{ from: 0, to: 1 }] : [];
  const rows: { first: number; last: number }[] = [];
  for (const index of within) {
    const row = rows.at(-1);
    if (row !== undefined && row.last + 1 === index) row.last = index;
    else rows.push({ first: index, last: index });
  }
  return rows.map((row) => ({
    from: Math.max(0, (row.first - 0.5) / last),
    to: Math.min(1, (row.last + 0.5) / last),
  }));
}
