// Finds the time zones of the storm's place and of the sun's clock. The table of time zones is
// loaded when the first place is known.
import { effect } from "@preact/signals-core";
import { zoneOfLongitude } from "../core/moment";
import type { PageState } from "../core/state";

export function followZones(state: PageState): () => void {
  let asked = "";
  return effect(() => {
    const clock = state.clockHere.value;
    const storm = state.storm.value;
    const hasPlace = storm?.latitudeDeg !== undefined && storm.longitudeDeg !== undefined;
    const latitudeDeg = clock?.latitudeDeg ?? storm?.latitudeDeg;
    const longitudeDeg = clock?.longitudeDeg ?? storm?.longitudeDeg;
    if (latitudeDeg === undefined || longitudeDeg === undefined) return;
    const key = `${latitudeDeg} ${longitudeDeg} ${hasPlace}`;
    if (key === asked) return;
    asked = key;
    const adopt = (zone: string) => {
      if (key !== asked) return;
      state.sunZone.value = zone;
      // Only a real place has a local time. For an idealised run only the sun uses the zone.
      state.zone.value = hasPlace ? zone : undefined;
    };
    adopt(zoneOfLongitude(longitudeDeg));
    import("@photostructure/tz-lookup").then(
      ({ default: zoneOf }) => adopt(zoneOf(latitudeDeg, longitudeDeg)),
      // If the table cannot be loaded, the nautical zone of the longitude is used.
      () => undefined,
    );
  });
}
