// Converts rays to the form of the messages.
import type { WorldRay } from "../core/projection";

export function rayMessage({ originM, direction }: WorldRay) {
  const [xM, yM, zM] = originM;
  const [x, y, z] = direction;
  return { origin: { xM, yM, zM }, direction: { x, y, z } };
}
