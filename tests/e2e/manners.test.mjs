// What holds for the page as a whole: nothing that axe-core finds, targets large enough for fingers, a small first load from one
// origin, no motion for who wants none.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { gzipSync } from "node:zlib";
import { launchBrowser, openPanel, openTool, rested } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const TOOLS = ["map", "time", "light", "look", "fields", "probe", "marks"];
const PANELS = ["storms", "share", "people", "keep", "compare", "help", "drawer"];
const MOST_BYTES = 200_000;
const TOUCH_PX = 44;

let server;
let browser;

before(async () => {
  server = await startServer({ httpPort: await freePort(), grpcPort: await freePort() });
  browser = await launchBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
});

async function visit(options) {
  // The page lets no scripts in but its own; axe-core is one of the test.
  const context = await browser.newContext({ bypassCSP: true, ...options });
  const page = await context.newPage();
  await page.goto(server.url);
  await rested(page);
  return page;
}

async function findings(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(" | ")}`);
}

// Every details element, so that what is folded is looked at too.
const unfold = (page) =>
  page.evaluate(() => {
    for (const each of document.querySelectorAll("aside details, .popover details")) each.open = true;
  });

for (const [name, options] of [
  ["a desktop", { viewport: { width: 1280, height: 800 } }],
  ["a phone", { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }],
])
  test(`axe-core finds nothing on ${name}, whatever is open`, { timeout: 300_000 }, async () => {
    const page = await visit(options);
    const found = await findings(page);
    for (const tool of TOOLS) {
      await openTool(page, tool);
      await unfold(page);
      await page.waitForTimeout(300);
      for (const each of await findings(page)) found.push(`${tool}: ${each}`);
    }
    await openTool(page, undefined);
    for (const panel of PANELS) {
      if (!(await openPanel(page, panel))) continue;
      await page.waitForTimeout(300);
      await unfold(page);
      for (const each of await findings(page)) found.push(`${panel}: ${each}`);
      await page.keyboard.press("Escape");
    }
    assert.deepEqual(found, []);
    await page.context().close();
  });

test("fingers find every button and slider", async () => {
  const page = await visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const small = [];
  const measure = async (where) => {
    const found = await page.evaluate((least) => {
      const seen = [...document.querySelectorAll("button, select, summary, input:not([type=checkbox], [type=radio], [type=file])")];
      return seen
        .filter((element) => element.checkVisibility() && !element.closest(".visually-hidden"))
        .map((element) => [element, element.getBoundingClientRect()])
        .filter(([, { width, height }]) => width > 0 && (height < least - 0.5 || width < 24))
        .map(([element, { width, height }]) => `${element.dataset.testid ?? element.className ?? element.tagName} ${width.toFixed(0)} x ${height.toFixed(0)}`);
    }, TOUCH_PX);
    small.push(...found.map((each) => `${where}: ${each}`));
  };
  for (const tool of TOOLS) {
    await openTool(page, tool);
    await unfold(page);
    await measure(tool);
  }
  await openTool(page, undefined);
  for (const panel of ["storms", "share", "keep", "help", "drawer"]) {
    await openPanel(page, panel);
    await page.waitForTimeout(300);
    await unfold(page);
    await measure(panel);
    await page.keyboard.press("Escape");
  }
  assert.deepEqual(small, []);
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(overflow <= 0, `the page is ${overflow} pixels wider than the screen`);
  await page.context().close();
});

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

// Texts over the picture that leave the window, or lie on one another or under a bar.
const unreadable = (page) =>
  page.evaluate(() => {
    const boxes = (selector) =>
      [...document.querySelectorAll(selector)]
        .map((element) => ({ name: element.textContent.slice(0, 30), box: element.getBoundingClientRect() }))
        .filter(({ box }) => box.width > 0);
    const texts = boxes("[data-testid=annotations] text");
    const over = [...texts, ...boxes(".top-bar, .time-line, .rail, aside")];
    const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    return texts.flatMap(({ name, box }, at) => [
      ...(box.left < 0 || box.right > innerWidth || box.bottom > innerHeight ? [`${name} is clipped`] : []),
      ...over.flatMap((other, place) => (place > at && meet(box, other.box) ? [`${name} meets ${other.name}`] : [])),
    ]);
  });

for (const [name, options] of [
  ["a phone", PHONE],
  ["a small phone", { ...PHONE, viewport: { width: 320, height: 640 } }],
  ["a phone held across", { ...PHONE, viewport: { width: 844, height: 390 } }],
])
  test(`all that is written over the picture is read on ${name}`, async () => {
    const page = await visit(options);
    for (const units of ["metric", "aviation"]) {
      await openTool(page, "time");
      await page.getByTestId("units").selectOption(units);
      await openTool(page, undefined);
      assert.ok((await page.locator("[data-testid=annotations] text").count()) >= 2);
      assert.deepEqual(await unreadable(page), []);
    }
    for (const tool of TOOLS) {
      await openTool(page, tool);
      assert.deepEqual(await unreadable(page), [], `with ${tool} open`);
    }
    await page.context().close();
  });

test("the first load is small, and everything comes from the server itself", async () => {
  const page = await (await browser.newContext()).newPage();
  const origins = new Set();
  const files = new Map();
  page.on("request", (request) => request.url().startsWith("http") && origins.add(new URL(request.url()).origin));
  page.on("response", async (response) => {
    if (/\.(js|css|html|svg)$|\/$/.test(new URL(response.url()).pathname)) files.set(response.url(), response.body());
  });
  await page.goto(server.url);
  await rested(page);
  const bodies = await Promise.all(files.values());
  const bytes = bodies.reduce((sum, body) => sum + gzipSync(body, { level: 9 }).length, 0);
  console.log(`first load: ${files.size} files, ${bytes} bytes compressed`);
  assert.ok(files.size >= 3, `only ${[...files.keys()]}`);
  assert.ok(bytes <= MOST_BYTES, `${bytes} bytes`);
  assert.deepEqual([...origins], [new URL(server.url).origin]);
  await page.context().close();
});

// While the server does not answer, the page says that it opens the storm: all that ever moves by itself.
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
