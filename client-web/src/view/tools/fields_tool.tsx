// The storm's contents, with a row for each of its fields.
import { FieldsSection } from "../fields_section";
import type { Page } from "../page";

export function FieldsTool({ page }: { page: Page }) {
  return <FieldsSection state={page.state} />;
}
