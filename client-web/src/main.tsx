// The page's entry point. It builds the page, puts it into the document, and removes it again on a
// hot reload.
import { render } from "preact";
import { AccessToken } from "./core/access_token";
import { Participant } from "./core/participant";
import { createSameOriginTransport, sameOriginInteract } from "./transport/grpc_web";
import { App } from "./view/app";
import { Page } from "./view/page";

const root = document.getElementById("page");
if (root === null) throw new Error("index.html has no element #page");

const tabStore = sessionStorageOf(window);
const token = new AccessToken(tabStore);
const participant = new Participant(tabStore);
const page = new Page(
  createSameOriginTransport(document.baseURI, () => token.value),
  sameOriginInteract(document.baseURI, () => token.value),
  window,
  token,
  participant,
  tabStore,
);
render(<App page={page} />, root);

import.meta.hot?.dispose(() => {
  render(null, root);
  page.dispose();
});

function sessionStorageOf(window: Window): Storage | undefined {
  try {
    return window.sessionStorage;
  } catch {
    return undefined;
  }
}
