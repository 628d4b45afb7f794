// Where the picture is taken from.
import { CameraControls } from "../camera_section";
import type { Page } from "../page";

export function MapTool({ page }: { page: Page }) {
  return <CameraControls page={page} />;
}
