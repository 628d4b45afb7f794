// Colours of the fields in charts and tables: Okabe and Ito's, which people with any colour vision tell apart.
import { Hydrometeor } from "../../gen/thunderhead/v1/scene_pb";

const COLORS: Readonly<Record<Hydrometeor, string>> = {
  [Hydrometeor.UNSPECIFIED]: "#bbbbbb",
  [Hydrometeor.CLOUD]: "#e69f00",
  [Hydrometeor.RAIN]: "#56b4e9",
  [Hydrometeor.ICE]: "#cc79a7",
  [Hydrometeor.SNOW]: "#f0e442",
  [Hydrometeor.GRAUPEL]: "#2fbf8f",
  [Hydrometeor.HAIL]: "#ff7f50",
};

export function colorOfField(hydrometeor: Hydrometeor): string {
  return COLORS[hydrometeor] ?? "#bbbbbb";
}
