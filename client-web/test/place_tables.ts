// Test support: tables of places as the server makes them, from the formula of a map projection.
const NODES = 65;

// `project` returns metres on the map of a longitude and latitude. The table's coordinates are metres
// from the middle.
export function tableOf(
  middle: { readonly longitudeDeg: number; readonly latitudeDeg: number },
  project: (longitudeDeg: number, latitudeDeg: number) => [number, number],
  reachDeg: number,
) {
  const radian = Math.PI / 180;
  const [fromX, fromY] = project(middle.longitudeDeg, middle.latitudeDeg);
  const [sin, cos] = [Math.sin(middle.latitudeDeg * radian), Math.cos(middle.latitudeDeg * radian)];
  const xM: number[] = [];
  const yM: number[] = [];
  const along = (node: number) => radian * reachDeg * ((2 * node) / (NODES - 1) - 1);
  for (let row = 0; row < NODES; row += 1) {
    for (let column = 0; column < NODES; column += 1) {
      // Latitude and longitude of a node by Snyder 1987, "Map Projections - A Working Manual",
      // equations 20-14 and 20-15.
      const [x, y] = [along(column), along(row)];
      const c = Math.hypot(x, y);
      const up = c === 0 ? 0 : (y * Math.sin(c)) / c;
      const latitude = Math.asin(Math.cos(c) * sin + up * cos);
      const turn = Math.atan2(c === 0 ? 0 : (x * Math.sin(c)) / c, Math.cos(c) * cos - up * sin);
      const longitudeDeg = middle.longitudeDeg + turn / radian;
      const wrappedDeg = longitudeDeg - 360 * Math.round(longitudeDeg / 360);
      const [toX, toY] = project(wrappedDeg, latitude / radian);
      xM.push(toX - fromX);
      yM.push(toY - fromY);
    }
  }
  return { nodes: NODES, reachDeg, xM, yM };
}
