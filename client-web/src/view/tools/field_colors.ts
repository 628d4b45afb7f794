// Colours of the fields in charts and tables: Okabe and Ito's, which people with any colour vision tell apart.
import type { Hydrometeor } from "../../gen/thunderhead/v1/scene_pb";

const UNKNOWN = "#bbbbbb";
// In the order of the enumerators: cloud, rain, ice, snow, graupel, hail, then those of fields to come.
const COLORS = ["#e69f00", "#56b4e9", "#cc79a7", "#f0e442", "#2fbf8f", "#ff7f50", "#0072b2"];

export function colorOfField(hydrometeor: Hydrometeor): string {
  return COLORS[hydrometeor - 1] ?? UNKNOWN;
}
