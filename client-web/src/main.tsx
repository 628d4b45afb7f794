// The page's entry: builds it, puts it into the document, and takes it down again on a hot reload.
import { render } from "preact";
import { createSameOriginTransport, sameOriginInteract } from "./transport/grpc_web";
import { App } from "./view/app";
import { Page } from "./view/page";

const root = document.getElementById("page");
if (root === null) throw new Error("index.html has no element #page");

const page = new Page(
  createSameOriginTransport(document.baseURI),
  sameOriginInteract(document.baseURI),
  window,
);
render(<App page={page} />, root);

import.meta.hot?.dispose(() => {
  render(null, root);
  page.dispose();
});
