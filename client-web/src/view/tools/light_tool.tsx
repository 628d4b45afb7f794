// The sources of light: the sun by the clock or by hand, and other lights.
import { LightsSection } from "../lights_section";
import type { Page } from "../page";
import { SunControls } from "../sun_section";

export function LightTool({ page }: { page: Page }) {
  return (
    <>
      <SunControls state={page.state} />
      <LightsSection state={page.state} />
    </>
  );
}
