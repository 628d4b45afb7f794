// Takes screenshots of every tool, panel and kind of picture at three window sizes, for people to look at.
//   node screenshots.mjs [folder] [tool ...]
import { mkdirSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { launchBrowser, openPanel, openTool, restedAndFits } from "./driver.mjs";
import { freePort, startServer } from "./server_process.mjs";

const SIZES = [
  { width: 390, height: 844, isMobile: true, hasTouch: true },
  { width: 900, height: 700 },
  { width: 1920, height: 1080 },
];
const TOOLS = ["none", "map", "time", "light", "look", "fields", "probe", "marks"];
const PANELS = ["storms", "share", "people", "keep", "compare", "help", "drawer"];
// Kinds of pictures. Their screenshots are taken last, because each changes the scene.
const PICTURES = {
  spotter: (page) => cameraOf(page, "From the ground"),
  above: (page) => cameraOf(page, "From above"),
  "false-colours": async (page) => {
    await cameraOf(page, "Around");
    await openTool(page, "look");
    await page.getByTestId("colours").getByText("False colours").click();
  },
  comparison: async (page) => {
    await openTool(page, "look");
    await page.getByTestId("colours").getByText("Photograph").click();
    await openTool(page, undefined);
    await openPanel(page, "compare");
    await page.getByTestId("compare-time").selectOption("0");
    await page.keyboard.press("Escape");
    await restedAndFits(page, "compared-canvas");
  },
};
const folder = process.argv[2] ?? fileURLToPath(new URL("../../build/screenshots/", import.meta.url));
const only = process.argv.slice(3);
// The only window width to use; all widths if it is not set.
const onlyWidth = Number(process.env.THUNDERHEAD_WIDTH ?? 0);
const wanted = (name) => only.length === 0 || only.includes(name);

async function cameraOf(page, kind) {
  await openTool(page, "map");
  await page.getByTestId("camera-kind").getByText(kind, { exact: true }).click();
}

// Fills a tool with typical contents before its screenshot.
async function prepare(page, tool) {
  const come = (locator) => locator.waitFor();
  if (tool === "map") await come(page.locator("[data-testid=inset-map] canvas"));
  if (tool === "probe") {
    await page.getByTestId("probe-middle").click();
    await come(page.getByTestId("probe-found"));
    await come(page.getByTestId("cores"));
    await page.getByTestId("probe-found").evaluate((found) => found.scrollIntoView({ block: "nearest" }));
  }
  if (tool === "marks") {
    await page.getByTestId("tool-text").click();
    await page.getByTestId("mark-words").fill("CORE");
    await page.getByTestId("mark-middle").click();
    await come(page.getByTestId("mark"));
  }
}

// Waits until a change is on the screen.
const painted = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

mkdirSync(folder, { recursive: true });
const data = fileURLToPath(new URL("../../samples/", import.meta.url));
const server = await startServer({ httpPort: await freePort(), grpcPort: await freePort(), data });
const browser = await launchBrowser();
try {
  const sizes = SIZES.filter((size) => onlyWidth === 0 || size.width === onlyWidth);
  for (const { width, height, ...rest } of sizes) {
    const context = await browser.newContext({ viewport: { width, height }, ...rest });
    const page = await context.newPage();
    page.on("pageerror", (error) => console.log(`${width}: ${error}`));
    page.on("console", (message) => message.type() === "error" && console.log(message.text()));
    await page.goto(server.url);
    await restedAndFits(page);
    // Without a folder argument the screenshots are small JPEG files. With this argument they are PNG files, for a
    // closer look.
    const file = process.argv[2] === undefined ? { type: "jpeg", quality: 80 } : { type: "png" };
    const shoot = async (name) => {
      await restedAndFits(page);
      await painted(page);
      await page.screenshot({ path: `${folder}/${name}-${width}.${file.type}`, ...file });
    };
    for (const name of TOOLS.filter(wanted)) {
      await openTool(page, name === "none" ? undefined : name);
      await prepare(page, name);
      await shoot(name);
    }
    // Otherwise the marks would cover all following pictures.
    if (wanted("marks")) await page.getByTestId("clear-marks").click();
    await openTool(page, undefined);
    for (const name of PANELS.filter(wanted)) {
      await openPanel(page, name);
      await shoot(name);
      await page.keyboard.press("Escape");
    }
    for (const [name, show] of Object.entries(PICTURES).filter(([each]) => wanted(each))) {
      await show(page);
      await openTool(page, undefined);
      await shoot(name);
    }
    await context.close();
  }
} finally {
  await browser.close();
  await server.stop();
}
