// How the picture is made and how far to trust it: quality, what is missing, exposure, colours.
import { AccuracySection } from "../accuracy_section";
import type { Page } from "../page";
import { PictureSection } from "../picture_section";
import { QualitySection } from "../quality_section";

export function LookTool({ page }: { page: Page }) {
  return (
    <>
      <QualitySection state={page.state} />
      <AccuracySection state={page.state} />
      <PictureSection page={page} />
    </>
  );
}
