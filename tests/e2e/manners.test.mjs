// Tests of the page as a whole. axe-core must find no violations, and targets must be large enough for fingers. The
// first load must be small and from one origin. No animation may run for people who prefer reduced motion.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { changing, chooseQuality, holdingMovie, launchBrowser, openPanel, openTool, rested, until } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const TOOLS = ["map", "time", "light", "look", "fields", "probe", "marks"];
const PANELS = ["storms", "share", "people", "keep", "compare", "help", "drawer"];
const MAX_BYTES = 200_000;
const TOUCH_PX = 44;

let server;
let browser;
// The address of the page with a scene of the quality "Fast". These tests check the page instead of the pictures, so
// pictures should be final soon.
let fast;

before(async () => {
  // The tests need more sessions than the server allows a client by default: each visit opens a session, and each
  // comparison opens a second one.
  const more = ["--max-sessions-each", "64"];
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort(), more });
  browser = await launchBrowser();
  fast = await addressOfFast();
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

async function addressOfFast() {
  const permissions = ["clipboard-read", "clipboard-write"];
  const page = await (await browser.newContext({ viewport: { width: 900, height: 560 }, permissions })).newPage();
  await page.goto(server.url);
  await openTool(page, "look");
  await changing(() => chooseQuality(page, "Fast"), page);
  await openPanel(page, "share");
  const link = await page.getByTestId("viewers-link").inputValue();
  await page.getByTestId("copy-link").click();
  let copied = "";
  await until("a link", async () => {
    copied = await page.evaluate(() => navigator.clipboard.readText());
    return copied.startsWith(`${link}#scene=`);
  });
  await page.context().close();
  return `${server.url}${new URL(copied).hash}`;
}

async function visit(options, address = fast) {
  // The page allows only its own scripts, so the test bypasses its policy to run axe-core.
  const context = await browser.newContext({ bypassCSP: true, ...options });
  const page = await context.newPage();
  await page.goto(address);
  await rested(page);
  return page;
}

// Letters lie over the picture on translucent panels. axe-core can measure their contrast if the picture is removed and
// the page behind them is white, like the brightest cloud. (The thumbnails of saved views are removed too.) An element
// whose contrast axe-core still cannot measure counts as a violation. The exceptions are letters in a drawing, whose
// background axe-core does not know, and elements that a panel covers.
const isRead = ({ html, any }) => !html.startsWith("<text") && any[0]?.data?.messageKey !== "bgOverlap";

async function findings(page) {
  await page.evaluate(AXE);
  const style = await page.addStyleTag({ content: "canvas.storm, svg.annotations, svg.overlay { display: none } html, body, .view { background: #fff none !important }" });
  const { violations, incomplete } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations", "incomplete"] }));
  await style.evaluate((element) => element.remove());
  const unknown = incomplete
    .filter(({ id }) => id === "color-contrast")
    .map(({ id, nodes }) => ({ id, nodes: nodes.filter(isRead) }))
    .filter(({ nodes }) => nodes.length > 0);
  return [...violations, ...unknown].map(
    ({ id, nodes }) => `${id}: ${nodes.map(({ html, any }) => `${html.slice(0, 120)} (${any[0]?.data?.messageKey ?? ""} ${any[0]?.data?.contrastRatio ?? ""})`).join(" | ")}`,
  );
}

// After a tool opens or closes, the page's layout is done in the next painted frame.
const painted = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

const placeOf = (page, panel) => page.locator(panel === "drawer" ? ".drawer" : ".popover");

async function showPanel(page, panel) {
  await openPanel(page, panel);
  await placeOf(page, panel).waitFor();
  await painted(page);
}

// Opens every details element, so that folded sections are checked too.
const unfold = (page) =>
  page.evaluate(() => {
    for (const each of document.querySelectorAll("aside details, .popover details")) each.open = true;
  });

// Fills in controls that appear only after others were used: a named view, a lamp, colours of fields, the results of a
// probe.
async function fill(page) {
  await openTool(page, "map");
  await page.getByTestId("keep-view").click();
  await page.getByTestId("view-name").fill("Inflow");
  await page.keyboard.press("Enter");
  await page.getByTestId("named-view").waitFor();
  await openTool(page, "light");
  await unfold(page);
  await page.getByTestId("add-light").click();
  await openTool(page, "look");
  await page.getByTestId("colours").getByText("False colours").click();
  await openTool(page, "probe");
  await page.getByTestId("probe-middle").click();
  await page.getByTestId("probe-place").first().waitFor();
  await openTool(page, undefined);
}

for (const [name, options] of [
  ["a desktop", { viewport: { width: 1280, height: 800 } }],
  ["a phone", { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }],
])
  test(`axe-core finds nothing on ${name}, whatever is open`, async () => {
    const page = await visit(options);
    const found = await findings(page);
    await fill(page);
    for (const tool of TOOLS) {
      await openTool(page, tool);
      await unfold(page);
      await painted(page);
      for (const each of await findings(page)) found.push(`${tool}: ${each}`);
    }
    await openTool(page, undefined);
    for (const panel of PANELS) {
      await showPanel(page, panel);
      await unfold(page);
      for (const each of await findings(page)) found.push(`${panel}: ${each}`);
      await page.keyboard.press("Escape");
    }
    await openPanel(page, "compare");
    await page.getByTestId("compare-time").selectOption("0");
    await page.keyboard.press("Escape");
    await page.getByTestId("compared-canvas").waitFor();
    await rested(page);
    for (const each of await findings(page)) found.push(`a comparison: ${each}`);
    assert.deepEqual(found, []);
    await page.context().close();
  });

// The target of a checkbox or radio button is its label.
const TARGETS = "button, select, summary, label:has(> input:is([type=checkbox], [type=radio])), input:not([type=checkbox], [type=radio], [type=file])";

test("fingers find every button, slider and switch", async () => {
  const page = await visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const small = [];
  const measure = async (where) => {
    const found = await page.evaluate(([least, targets]) => {
      const seen = [...document.querySelectorAll(targets)];
      return seen
        .filter((element) => element.checkVisibility() && !element.closest(".visually-hidden"))
        .map((element) => [element, element.getBoundingClientRect()])
        .filter(([, { width, height }]) => width > 0 && (height < least - 0.5 || width < least - 0.5))
        .map(([element, { width, height }]) => `${element.dataset.testid ?? `${element.tagName} ${element.className} ${element.textContent.slice(0, 20)}`} ${width.toFixed(0)} x ${height.toFixed(0)}`);
    }, [TOUCH_PX, TARGETS]);
    small.push(...found.map((each) => `${where}: ${each}`));
  };
  await fill(page);
  for (const tool of TOOLS) {
    await openTool(page, tool);
    await unfold(page);
    await measure(tool);
  }
  await openTool(page, undefined);
  for (const panel of PANELS) {
    await showPanel(page, panel);
    await unfold(page);
    await measure(panel);
    await page.keyboard.press("Escape");
  }
  assert.deepEqual(small, []);
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(overflow <= 0, `the page is ${overflow} pixels wider than the screen`);
  await page.context().close();
});

// Technical words of the rendering techniques. They may appear only in the last section of the tool Look and in the
// list of settings.
const JARGON = /\b(spp|slices?|diffusion|light (model|volume)|half-angle|octaves)\b/i;

test("the tools use no words of the renderers but in Look's last section", async () => {
  const page = await visit({ viewport: { width: 1280, height: 900 } });
  for (const tool of TOOLS) {
    await openTool(page, tool);
    await unfold(page);
    if (tool === "look") {
      const last = page.getByTestId("technique-settings");
      assert.match(await last.innerText(), JARGON);
      await last.evaluate((section) => {
        section.open = false;
      });
    }
    const words = await page.getByTestId("tool-panel").innerText();
    assert.doesNotMatch(words, JARGON, tool);
    if (tool === "look") assert.match(words, /(Estimated|Measured) error [\d.]+ % \(/);
  }
  await page.context().close();
});

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

// Waits until at least `least` texts are over the picture. While the picture changes size, it may have no space for
// some texts.
const written = (page, least) =>
  page.waitForFunction((count) => document.querySelectorAll("[data-testid=annotations] text").length >= count, least);

// Returns a description of each unreadable part of the page. These are texts over the picture that extend beyond the
// window, and bars (including names of compared pictures) that touch the window's edge. Texts or bars that overlap
// count too. Only the list of all settings may cover a bar, because it fills a narrow window.
async function unreadable(page) {
  await painted(page);
  return page.evaluate(() => {
    const boxes = (selector) =>
      [...document.querySelectorAll(selector)]
        .map((element) => ({ name: element.textContent.slice(0, 30), box: element.getBoundingClientRect(), covers: element.matches(".drawer") }))
        .filter(({ box }) => box.width > 0);
    const texts = boxes("[data-testid=annotations] text");
    // The progress of a movie (.at-work) has a separate position on phones. In wide windows it is in the top bar.
    const [pill] = document.querySelectorAll(".at-work");
    const pillIsABar = pill !== undefined && getComputedStyle(pill).position === "fixed";
    const bars = boxes(`.top-bar, .time-line, .session-bar, .rail, .error-line, aside, .compared-name${pillIsABar ? ", .at-work" : ""}`);
    const all = [...texts, ...bars];
    const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const mayMeet = (one, other) => bars.includes(one) && bars.includes(other) && (one.covers || other.covers);
    const atEdge = bars.filter(({ box }) => box.left < 1 || box.right > innerWidth - 1 || box.bottom > innerHeight - 1);
    const clipped = texts.filter(({ box }) => box.left < 0 || box.right > innerWidth || box.bottom > innerHeight);
    return [
      ...atEdge.map(({ name }) => `${name} touches the window's edge`),
      ...clipped.map(({ name }) => `${name} is clipped`),
      ...all.flatMap((one, at) =>
        all.slice(at + 1).flatMap((other) => (meet(one.box, other.box) && !mayMeet(one, other) ? [`${one.name} meets ${other.name}`] : [])),
      ),
    ];
  });
}

const whileAMovieIsMade = (page, look) =>
  holdingMovie(page, async () => {
    await openPanel(page, "keep");
    await page.getByTestId("keep-movie").locator("summary").click();
    await page.getByTestId("save-movie").click();
    await page.keyboard.press("Escape");
    await page.getByTestId("at-work").waitFor();
    await look();
    await page.getByTestId("at-work-cancel").click();
    await page.getByTestId("at-work").waitFor({ state: "detached" });
  });

for (const [name, options] of [
  ["a phone", PHONE],
  ["a small phone", { ...PHONE, viewport: { width: 320, height: 640 } }],
  ["a phone held across", { ...PHONE, viewport: { width: 844, height: 390 } }],
  ["a tablet", { viewport: { width: 900, height: 700 } }],
  ["a small window", { viewport: { width: 1000, height: 620 } }],
  ["a laptop", { viewport: { width: 1280, height: 720 } }],
])
  test(`all that is written over the picture is read on ${name}`, async () => {
    const page = await visit(options);
    for (const units of ["metric", "aviation"]) {
      await openTool(page, "time");
      await page.getByTestId("units").selectOption(units);
      await openTool(page, undefined);
      await written(page, 2);
      assert.deepEqual(await unreadable(page), []);
    }
    for (const tool of TOOLS) {
      await openTool(page, tool);
      assert.deepEqual(await unreadable(page), [], `with ${tool} open`);
    }
    await openTool(page, undefined);
    await whileAMovieIsMade(page, async () => assert.deepEqual(await unreadable(page), [], "while a movie is made"));
    await showPanel(page, "drawer");
    assert.deepEqual(await unreadable(page), [], "with every setting open");
    await openPanel(page, "drawer");
    await openTool(page, "map");
    await page.getByTestId("camera-kind").getByText("From the ground", { exact: true }).click();
    await page.waitForFunction(() => document.querySelector("[data-testid=storm-canvas]").dataset.camera === "spotter");
    await openTool(page, undefined);
    // These texts are the time and the degrees along the horizon.
    await written(page, 4);
    assert.deepEqual(await unreadable(page), [], "from the ground");
    // Shows the largest contents in the corners of the window.
    await openTool(page, "look");
    await page.getByTestId("colours").getByText("False colours").click();
    await openTool(page, undefined);
    await page.locator("[data-testid=annotations] rect").first().waitFor();
    await openPanel(page, "compare");
    await page.getByTestId("compare-time").selectOption("0");
    await page.keyboard.press("Escape");
    await page.getByTestId("compared-canvas").waitFor();
    for (const tool of [undefined, "look"]) {
      await openTool(page, tool);
      assert.deepEqual(await unreadable(page), [], `a comparison, with ${tool ?? "no tool"} open`);
    }
    await page.context().close();
  });

// On a phone a separate bar shows who has control.
test("all that is written over the picture is read on a student's phone", async () => {
  const teacher = await visit({ viewport: { width: 900, height: 700 } });
  await openTool(teacher, "look");
  await teacher.getByTestId("colours").getByText("False colours").click();
  const page = await visit(PHONE, teacher.url().replace(/#.*/, ""));
  await page.getByTestId("who-steers").waitFor();
  await page.locator("[data-testid=annotations] rect").first().waitFor();
  assert.deepEqual(await unreadable(page), []);
  for (const tool of TOOLS) {
    await openTool(page, tool);
    assert.deepEqual(await unreadable(page), [], `with ${tool} open`);
  }
  await openTool(page, undefined);
  const looksWell = async (when) => assert.deepEqual(await unreadable(page), [], when);
  await whileAMovieIsMade(page, () => looksWell("while a movie is made"));
  await openPanel(page, "compare");
  await page.getByTestId("compare-time").selectOption("0");
  await page.keyboard.press("Escape");
  await page.getByTestId("compared-canvas").waitFor();
  await looksWell("a comparison");
  await whileAMovieIsMade(page, () => looksWell("a comparison while a movie is made"));
  for (const each of [page, teacher]) await each.context().close();
});

test("a panel of the bar leaves the time line free on a desktop", async () => {
  const page = await visit({ viewport: { width: 1920, height: 1080 } });
  const line = await page.locator(".time-line").boundingBox();
  for (const panel of PANELS) {
    await showPanel(page, panel);
    await unfold(page);
    const box = await placeOf(page, panel).boundingBox();
    assert.ok(box.y + box.height <= line.y, `${panel} ends at ${box.y + box.height}, the time line begins at ${line.y}`);
    await page.keyboard.press("Escape");
  }
  await page.context().close();
});

test("fields and cores are a line each on a desktop, and all five fields are seen without scrolling", async () => {
  const page = await visit({ viewport: { width: 1920, height: 1080 } });
  await openTool(page, "fields");
  const isCut = await page.getByTestId("tool-panel").evaluate((panel) => panel.scrollHeight > panel.clientHeight + 1);
  assert.equal(isCut, false, "fields are cut");
  for (const name of ["cloud", "rain", "ice", "snow", "graupel"]) {
    const parts = ["visible", "scale", "scale-number"].map((part) => page.getByTestId(`field-${name}-${part}`).boundingBox());
    const middles = (await Promise.all(parts)).map(({ y, height }) => y + height / 2);
    assert.ok(Math.max(...middles) - Math.min(...middles) < 6, `switch and amount of ${name} are at ${middles}`);
  }
  await openTool(page, "probe");
  await page.getByTestId("core-graupel").waitFor();
  const heights = await page.locator(".cores button").evaluateAll((buttons) => buttons.map(({ offsetHeight }) => offsetHeight));
  assert.ok(Math.max(...heights) < 40, `the cores' buttons are ${heights} pixels high`);
  await page.context().close();
});

// Returns the test id or the HTML of the element at the middle of the probe's cross, which must lie between the bars
// and an open tool.
const probeCross = (page) =>
  page.evaluate(() => {
    const cross = document.querySelector("[data-testid=probe-marks] .aim").getBoundingClientRect();
    const over = document.elementFromPoint(cross.x + cross.width / 2, cross.y + cross.height / 2);
    return over?.dataset.testid ?? over?.outerHTML.slice(0, 80);
  });

for (const [name, options, most] of [
  ["a phone", PHONE, 0.02],
  ["a tablet", { viewport: { width: 900, height: 700 } }, 0.02],
  ["a small window", { viewport: { width: 1000, height: 620 } }, 0.02],
])
  test(`an open tool covers next to nothing of the picture on ${name}, and the date stays in the bar`, async () => {
    const page = await visit(options);
    for (const tool of [undefined, "look", "probe"]) {
      await openTool(page, tool);
      await rested(page);
      assert.match(await page.getByTestId("top-time").innerText(), /day 1\s+01:20Z/);
    }
    assert.equal(await probeCross(page), "storm-canvas");
    const covered = await page.evaluate(() => {
      const canvas = document.querySelector("[data-testid=storm-canvas]").getBoundingClientRect();
      const panel = document.querySelector("[data-testid=tool-panel]").getBoundingClientRect();
      const width = Math.max(0, Math.min(canvas.right, panel.right) - Math.max(canvas.left, panel.left));
      const height = Math.max(0, Math.min(canvas.bottom, panel.bottom) - Math.max(canvas.top, panel.top));
      return (width * height) / (canvas.width * canvas.height);
    });
    assert.ok(covered < most, `${covered} of the picture is covered`);
    // If the line about the error is visible, it is next to the tool.
    const errorLine = page.getByTestId("error-line");
    if (await errorLine.isVisible()) {
      const [line, panel] = await Promise.all([errorLine.boundingBox(), page.getByTestId("tool-panel").boundingBox()]);
      assert.ok(line.x >= panel.x + panel.width, `the line begins at ${line.x}, the tool ends at ${panel.x + panel.width}`);
    }
    await page.context().close();
  });

test("pictures are compared on a phone too, and its keys are found", async () => {
  const page = await visit(PHONE);
  await page.getByTestId("storms").tap();
  await page.getByTestId("storms-compare").tap();
  await page.getByTestId("compare-time").selectOption("0");
  await page.getByTestId("compared-canvas").waitFor();
  await page.getByTestId("compare-end").tap();
  assert.equal(await page.getByTestId("compared-canvas").count(), 0);
  await page.keyboard.press("Escape");
  await page.getByTestId("storms").tap();
  await page.getByTestId("storms-help").tap();
  await page.getByTestId("help-panel").waitFor();
  await page.context().close();
});

test("the focus goes back to the rail when a tool or the list of settings is closed", async () => {
  const page = await visit({ viewport: { width: 1280, height: 720 } });
  const focused = () => page.evaluate(() => document.activeElement?.dataset.testid);
  await page.getByTestId("rail-look").focus();
  await page.keyboard.press("Enter");
  await page.getByRole("button", { name: "Close Look" }).focus();
  await page.keyboard.press("Enter");
  assert.equal(await focused(), "rail-look");
  for (const close of ["Escape", "Enter"]) {
    await page.keyboard.press("x");
    await page.waitForFunction(() => document.activeElement?.dataset.testid === "drawer-search");
    if (close === "Enter") await page.getByRole("button", { name: "Close every setting" }).focus();
    await page.keyboard.press(close);
    await page.waitForFunction(() => document.activeElement?.dataset.testid === "rail-settings");
  }
  await page.context().close();
});

// Returns the controls whose text would not fit if every word were 1.4 times as long as in English. Words of a German
// translation would be about this long.
const cutWords = (page) =>
  page.evaluate(() => {
    const LONGER = 0.4;
    const words = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
    const inControl = "button, label, summary, h2, h3, dt, legend, option";
    const before = [];
    while (words.nextNode()) {
      const { currentNode: node } = words;
      const text = node.data.trim();
      // Numbers, units and names of storms have the same length in any language, so they are skipped.
      if (!node.parentElement?.closest(inControl) || node.parentElement.closest(".storm-name, .visually-hidden, svg") || !/[a-z]{3}/.test(text)) continue;
      before.push([node, node.data]);
      node.data = node.data.replace(/[A-Za-z]{3,}/g, (word) => word + "n".repeat(Math.round(LONGER * word.length)));
    }
    const pen = document.createElement("canvas").getContext("2d");
    const found = [];
    for (const control of document.querySelectorAll("button, label, summary, select, h2, h3")) {
      if (!control.checkVisibility() || control.closest(".visually-hidden, .storm-name")) continue;
      const box = control.getBoundingClientRect();
      const style = getComputedStyle(control);
      const name = `${control.dataset.testid ?? control.className} "${control.textContent.slice(0, 30)}"`;
      if (control.matches("select")) {
        pen.font = style.font;
        const chosen = control.selectedOptions[0]?.label ?? "";
        const room = box.width - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - 20;
        // A title of a storm may have any length.
        if (!control.matches("[data-testid=storm], [data-testid=compare-storm]") && pen.measureText(chosen).width > room)
          found.push(`${control.dataset.testid} shows ${room.toFixed(0)} of ${pen.measureText(chosen).width.toFixed(0)} pixels of ${chosen}`);
        continue;
      }
      const rects = [];
      const texts = document.createTreeWalker(control, NodeFilter.SHOW_TEXT);
      while (texts.nextNode()) {
        const range = document.createRange();
        range.selectNodeContents(texts.currentNode);
        if (!texts.currentNode.parentElement.closest(".visually-hidden, option")) rects.push(...range.getClientRects());
      }
      const panel = control.closest("aside, .popover, .rail, .top-bar, .time-line") ?? document.documentElement;
      const outer = panel.getBoundingClientRect();
      const clips = style.overflow !== "visible" && control.scrollWidth > control.clientWidth + 1;
      const shown = rects.filter(({ width, height }) => width > 1 && height > 1);
      const leaves = shown.some(({ left, right }) => right > outer.right + 1 || left < outer.left - 1);
      const spills = control.matches("button, summary, label") && shown.some(({ left, right }) => right > box.right + 1 || left < box.left - 1);
      if (clips || leaves || spills) found.push(`${name} is cut${clips ? ", clipped" : ""}${leaves ? ", leaves its panel" : ""}${spills ? ", spills" : ""}`);
    }
    for (const [node, data] of before) node.data = data;
    return found;
  });

for (const width of [1920, 900, 390])
  test(`words 1.4 times as long fit into their controls at ${width} pixels`, async () => {
    const phone = width < 900;
    const page = await visit(phone ? PHONE : { viewport: { width, height: phone ? 844 : 900 } });
    const cut = [];
    for (const tool of TOOLS) {
      await openTool(page, tool);
      if (tool === "map") await page.locator("[data-testid=inset-map] canvas").waitFor();
      await unfold(page);
      await painted(page);
      for (const each of await cutWords(page)) cut.push(`${tool}: ${each}`);
    }
    await openTool(page, undefined);
    for (const panel of PANELS.filter((each) => each !== "drawer")) {
      await showPanel(page, panel);
      await unfold(page);
      for (const each of await cutWords(page)) cut.push(`${panel}: ${each}`);
      await page.keyboard.press("Escape");
    }
    assert.deepEqual([...new Set(cut)], []);
    await page.context().close();
  });

test("the first load is small, and everything comes from the server itself", async () => {
  const page = await (await browser.newContext()).newPage();
  const origins = new Set();
  const files = new Map();
  page.on("request", (request) => request.url().startsWith("http") && origins.add(new URL(request.url()).origin));
  page.on("response", (response) => {
    if (/\.(js|css|html|svg)$|\/$/.test(new URL(response.url()).pathname)) files.set(response.url(), response);
  });
  await page.goto(server.url);
  await rested(page);
  let bytes = 0;
  for (const [url, response] of files) {
    // The browser loads the page's icon (an SVG) separately, and does not report its content encoding.
    if (!url.endsWith(".svg")) assert.equal(await response.headerValue("content-encoding"), "gzip", url);
    bytes += (await response.request().sizes()).responseBodySize;
  }
  console.log(`first load: ${files.size} files, ${bytes} bytes on the wire`);
  assert.ok(files.size >= 3, `only ${[...files.keys()]}`);
  assert.ok(bytes <= MAX_BYTES, `${bytes} bytes`);
  assert.deepEqual([...origins], [new URL(server.url).origin]);
  await page.context().close();
});

// Returns the number of animations while the page waits for the server and says that it opens the storm. No other
// animation runs without user action.
async function movingWhileOpening(reducedMotion) {
  const page = await (await browser.newContext({ reducedMotion })).newPage();
  await page.route(/thunderhead\.v1/, () => undefined);
  await page.goto(server.url);
  await page.getByTestId("connecting").waitFor();
  const moving = await page.evaluate(() => document.getAnimations().length);
  await page.context().close();
  return moving;
}

test("nothing moves for who wants no motion", async () => {
  assert.ok((await movingWhileOpening("no-preference")) > 0);
  assert.equal(await movingWhileOpening("reduce"), 0);
  const page = await visit({ reducedMotion: "reduce" });
  for (const tool of TOOLS) {
    await openTool(page, tool);
    const moving = await page.evaluate(() => document.getAnimations().length);
    assert.equal(moving, 0, `something moves in ${tool}`);
  }
  await page.context().close();
});
