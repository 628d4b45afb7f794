// Tests the controls of the tools and of every setting, by real input against the real server. Each control must change
// the scene.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { freePort, ROOT, startServer } from "../../tests/e2e/server_process.mjs";
import { complete, ready, rests, startDesktop } from "./desktop_process.mjs";
import { difference, eventually, pixelsLike, region } from "./pixels.mjs";
import { startDisplay } from "./xvfb.mjs";

const SIZE = { width: 1280, height: 800 };
const STORM = { x: 440, y: 330, width: 400, height: 200 };
const ACCENT = [255, 209, 107];

let display;
let server;
let desktop;

before(async () => {
  display = await startDisplay(SIZE.width, SIZE.height);
  const flags = { httpPort: await freePort(), grpcPort: await freePort(), data: `${ROOT}samples` };
  server = await startServer(flags);
  const window = ["--width", String(SIZE.width), "--height", String(SIZE.height), "--scale", "1"];
  desktop = startDesktop(display, flags.grpcPort, window);
  await desktop.until("the first picture", ready);
});

after(async () => {
  await desktop?.stop();
  await server?.stop();
  await display?.stop();
});

// Calls `act`, and waits for the picture of the changed scene for which `holds` returns true.
async function change(what, act, holds = () => true) {
  const { revision } = desktop.status();
  await act();
  const now = await desktop.until(what, (now) => rests(now) && now.revision > revision && holds(now));
  assert.deepEqual({ problem: now.problem, notice: now.notice }, { problem: "", notice: "" });
  return now;
}

// Opens a tool or panel by its key, calls `act`, and closes the tool or panel.
async function within(key, act) {
  await desktop.key(key);
  try {
    await act();
  } finally {
    await desktop.key("Escape", "Escape");
  }
}

const near = (value, wanted, tolerance) => Math.abs(value - wanted) <= tolerance;
const picture = () => region(display.pixels(), STORM);

test("a quality and a goal take each other's place", async () => {
  const QUALITIES = { x: 114, y: 118, width: 302, height: 26 };
  const chosen = () => pixelsLike(region(display.pixels(), QUALITIES), ACCENT) > 500;
  await within("k", async () => {
    assert.ok(chosen(), "no quality is chosen");
    await change("a goal", async () => {
      await desktop.click(265, 590);
      await desktop.click(180, 669); // chooses "At most this time per frame"
    });
    display.screenshot("goal");
    await eventually("a quality beside the goal", () => !chosen());
    // This is the number field of the slider that sets the goal's time.
    await change("another time", () => desktop.fill(356, 641, "5000"));
    await change("Fast", () => desktop.click(162, 131));
    await eventually("no quality after the goal", chosen);
    await change("the first of the papers' settings", async () => {
      await desktop.click(265, 641);
      await desktop.click(180, 697);
    });
    await eventually("a quality beside the papers' settings", () => !chosen());
    await change("Fast again", () => desktop.click(162, 131));
  });
});

test("every setting is searched, changed and reset", async () => {
  await within("x", async () => {
    await desktop.click(1000, 131);
    await desktop.type("azimuth of the sun");
    display.screenshot("searched");
    await change("the sun elsewhere", () => desktop.fill(1205, 217, "100"), (now) => near(now.sun_azimuth_deg, 100, 0.1));
    await change("the default again", () => desktop.click(909, 267), (now) => near(now.sun_azimuth_deg, 275, 0.1));
  });
});

test("the sun stands where it is put by hand, and by the clock", async () => {
  await within("l", async () => {
    await change("the sun in the south", () => desktop.fill(366, 211, "180"), (now) => near(now.sun_azimuth_deg, 180, 0.1));
    await change("the sun high", () => desktop.fill(366, 262, "50"), (now) => near(now.sun_elevation_deg, 50, 0.1));
    await change("the sun by the clock", () => desktop.click(188, 131), (now) => !near(now.sun_elevation_deg, 50, 0.1));
    const { sun_elevation_deg } = desktop.status();
    const stays = (now) => near(now.sun_elevation_deg, sun_elevation_deg, 0.1);
    await change("by hand, where the clock has put it", () => desktop.click(340, 131), stays);
    await change("the sun low", () => desktop.fill(366, 262, "18"), (now) => near(now.sun_elevation_deg, 18, 0.1));
  });
});

test("a field is switched off and on, and has another amount", async () => {
  await desktop.until("the complete picture", complete);
  const whole = picture();
  await within("f", () => change("no cloud", () => desktop.click(127, 131)));
  await desktop.until("the complete picture without cloud", complete);
  const without = picture();
  const apart = difference(whole, without);
  assert.ok(apart > 0.1, "the picture without cloud is the same");
  // The first pictures are coarser, and the last one is compressed, so this comparison has a tolerance.
  const isLike = (one) => difference(one, picture()) < apart / 4;
  await within("f", () => change("cloud", () => desktop.click(127, 131)));
  await eventually("the cloud is another one", () => isLike(whole));
  await within("f", () => change("little cloud", () => desktop.fill(366, 182, "0")));
  await eventually("an amount of 0 shows a cloud", () => isLike(without));
  await within("f", () => change("as much cloud", () => desktop.fill(366, 182, "1")));
  await eventually("an amount of 1 is not the model's", () => isLike(whole));
});

test("keys go into a panel: arrows choose a control, space uses it, Enter edits a number", async () => {
  await desktop.until("the complete picture", complete);
  const whole = picture();
  await within("f", async () => {
    await desktop.key("Tab");
    await change("no cloud", () => desktop.key("space"));
  });
  assert.ok(difference(whole, picture()) > 0.02, "space has not switched the cloud off");
  await change("cloud", () => desktop.key("ctrl+z"));
  await within("l", async () => {
    await desktop.key("Tab");
    for (const key of ["Down", "Right", "Return"]) await desktop.key(key);
    display.screenshot("keys_in_panel");
    await desktop.key("ctrl+a");
    await desktop.type("35");
    await change("the typed direction", () => desktop.key("Return"), (now) => near(now.sun_azimuth_deg, 35, 0.1));
  });
});

test("the camera's kinds, and a spotter's place by numbers", async () => {
  await within("m", async () => {
    await change("from above", () => desktop.click(366, 138), (now) => now.camera === "top_down");
    await change("from the ground", () => desktop.click(265, 138), (now) => now.camera === "spotter");
    await change("another place to the east", () => desktop.fill(265, 239, "20"), (now) => near(now.x_m, 20_000, 50));
    await change("another place to the north", () => desktop.fill(265, 290, "-35"), (now) => near(now.y_m, -35_000, 50));
    await change("another direction", () => desktop.fill(265, 341, "10"), (now) => near(now.azimuth_deg, 10, 0.1));
    const { x_m, y_m } = desktop.status();
    assert.ok(near(x_m, 20_000, 50) && near(y_m, -35_000, 50), "it has left its place");
    await change("around", () => desktop.click(163, 138), (now) => now.camera === "orbit");
  });
});

test("another storm is chosen", async () => {
  await within("o", async () => {
    await change("the other storm", () => desktop.click(1000, 185), (now) => now.storm === "supercell-500m");
    await change("the first storm", () => desktop.click(1000, 137), (now) => now.storm === "supercell");
  });
});
