// What is there: a click on the picture asks the server.
import type { Page } from "../page";

export function ProbeTool(_: { page: Page }) {
  return <p class="quiet">Click on the storm.</p>;
}
