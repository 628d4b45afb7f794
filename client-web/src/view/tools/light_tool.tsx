// Where the light comes from: the sun by the clock or by hand, and other lights.
import { LightsSection } from "../lights_section";
import type { Page } from "../page";
import { SunSection } from "../sun_section";

export function LightTool({ page }: { page: Page }) {
  return (
    <>
      <SunSection state={page.state} />
      <LightsSection state={page.state} />
    </>
  );
}
