// The times of a storm that are in the server's memory, as stretches of a time line.

export interface Stretch {
  // Positions from 0 to 1.
  readonly from: number;
  readonly to: number;
}

// Returns one stretch for each run of adjacent times. A time extends halfway to its neighbours.
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
