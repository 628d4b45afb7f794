// Tests of saving and restoring: texts in PNG files, scenes in files, undo, named views, the
// pictures of a movie.

import { deflateSync } from "node:zlib";
import { create, equals } from "@bufbuild/protobuf";
import { Code, ConnectError, createRouterTransport } from "@connectrpc/connect";
import { describe, expect, test } from "vitest";
import { BackOff } from "../src/core/back_off";
import { cameraOfPose, type OrbitPose, poseOfCamera, type SpotterPose } from "../src/core/camera";
import { isSameDomain } from "../src/core/domain";
import { History } from "../src/core/history";
import { cameraPath, type MovieDraft, movieScenes, pictureCount } from "../src/core/movie_plan";
import { RememberedMovies } from "../src/core/movie_work";
import { NamedViews } from "../src/core/named_views";
import { crc32, pngText, withPngText } from "../src/core/png_text";
import { withDisplay, withField, withSun, withSunClock, withTime } from "../src/core/scene";
import { sceneOfFile, sceneToText, withScene } from "../src/core/scene_file";
import { RenderJobPictureState_State, RenderJobService } from "../src/gen/thunderhead/v1/job_pb";
import {
  Hydrometeor,
  Preset,
  type Scene,
  SceneSchema,
  ToneMap,
} from "../src/gen/thunderhead/v1/scene_pb";
import { StormDescriptionSchema, StormTimeSchema } from "../src/gen/thunderhead/v1/storm_pb";
import { type DrawnPicture, RenderCalls } from "../src/transport/render_calls";

const ORBIT: OrbitPose = {
  kind: "orbit",
  targetM: [1000, 2000, 3000],
  azimuthDeg: 350,
  elevationDeg: 10,
  distanceM: 50_000,
  fieldOfViewDeg: 35,
};

function chunk(type: string, data: Uint8Array): Buffer {
  const body = Buffer.concat([Buffer.from(type), data]);
  const whole = Buffer.alloc(body.length + 8);
  whole.writeUInt32BE(data.length);
  body.copy(whole, 4);
  whole.writeUInt32BE(crc32(body), body.length + 4);
  return whole;
}

// This PNG is one grey pixel.
const PNG = new Uint8Array(
  Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]),
    chunk("IHDR", Buffer.from([0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0])),
    chunk("IDAT", deflateSync(Buffer.from([0, 128]))),
    chunk("IEND", Buffer.alloc(0)),
  ]),
);

function someScene(): Scene {
  return create(SceneSchema, {
    stormId: "anvil – ä",
    timeIndex: 2,
    camera: cameraOfPose(ORBIT),
    display: { exposureEv: 0.7 },
  });
}

test("checksums are those of ISO 3309", () => {
  expect(crc32(new TextEncoder().encode("123456789"))).toBe(0xcbf43926);
  // Every PNG ends with this checksum.
  expect(crc32(new TextEncoder().encode("IEND"))).toBe(0xae426082);
});

test("a text in a PNG is found again", () => {
  const file = withPngText(PNG, "a key", "Grüße\nand more");
  expect(file).toBeDefined();
  expect(pngText(file ?? PNG, "a key")).toBe("Grüße\nand more");
  expect(pngText(file ?? PNG, "another")).toBeUndefined();
  const at = Buffer.from(file ?? PNG).indexOf("iTXt");
  const view = new DataView((file ?? PNG).buffer);
  const length = view.getUint32(at - 4);
  const body = (file ?? PNG).subarray(at, at + 4 + length);
  expect(view.getUint32(at + 4 + length)).toBe(crc32(body));
});

test("what is no PNG gets no text and has none", () => {
  expect(withPngText(new Uint8Array([1, 2, 3]), "a", "b")).toBeUndefined();
  expect(pngText(new Uint8Array([1, 2, 3]), "a")).toBeUndefined();
  // The chunk's length extends beyond the file.
  const cut = PNG.slice(0, 40);
  expect(pngText(cut, "a")).toBeUndefined();
});

test("a scene comes back from a picture and from JSON", () => {
  const scene = someScene();
  const file = withScene(PNG, scene) ?? PNG;
  expect(equals(SceneSchema, sceneOfFile(file), scene)).toBe(true);
  const json = new TextEncoder().encode(sceneToText(scene));
  expect(equals(SceneSchema, sceneOfFile(json), scene)).toBe(true);
});

test("a file may name the accurate preset by its earlier name", () => {
  const json = '{"rendering": {"preset": "PRESET_TRUE"}}';
  const scene = sceneOfFile(new TextEncoder().encode(json));
  expect(scene.rendering?.technique).toEqual({ case: "preset", value: Preset.ACCURATE });
});

test("a file without a scene says so", () => {
  expect(() => sceneOfFile(PNG)).toThrow("contains no scene");
  expect(() => sceneOfFile(new TextEncoder().encode("[1]"))).toThrow("not a Thunderhead scene");
});

const EMPTY = create(SceneSchema);

test("edits in one gesture are undone together, and a new edit ends what could be redone", () => {
  let now = 0;
  const history = new History(() => now);
  const [first, second, third] = [0, 1, 2].map((time) => withTime(EMPTY, time)) as [
    Scene,
    Scene,
    Scene,
  ];
  history.edited(first, second);
  now += 100;
  history.edited(second, third);
  expect(history.undo()?.(third).timeIndex).toBe(0);
  expect(history.canUndo.value).toBe(false);
  expect(history.redo()?.(first).timeIndex).toBe(2);
  expect(history.canRedo.value).toBe(false);
  expect(history.undo()?.(third).timeIndex).toBe(0);
  now += 5000;
  history.edited(first, second);
  expect(history.canRedo.value).toBe(false);
  expect(history.undo()?.(second).timeIndex).toBe(0);
  expect(history.undo()).toBeUndefined();
});

test("a step undone leaves what somebody else has changed meanwhile", () => {
  const history = new History(() => 0);
  const before = create(SceneSchema, {
    timeIndex: 1,
    fields: [{ hydrometeor: Hydrometeor.RAIN }, { hydrometeor: Hydrometeor.SNOW, scale: 1 }],
  });
  const after = withField(withDisplay(before, { exposureEv: 2 }), Hydrometeor.SNOW, { scale: 3 });
  history.edited(before, after);
  const theirs = withField(
    withDisplay(withTime(after, 0), { toneMap: ToneMap.LINEAR }),
    Hydrometeor.RAIN,
    { scale: 5 },
  );
  const undone = history.undo()?.(theirs);
  expect(undone?.timeIndex).toBe(0);
  expect(undone?.display?.exposureEv).toBeUndefined();
  expect(undone?.display?.toneMap).toBe(ToneMap.LINEAR);
  expect(undone?.fields.map(({ scale }) => scale)).toEqual([5, 1]);
  const done = history.redo()?.(undone ?? theirs);
  expect(equals(SceneSchema, done ?? EMPTY, theirs)).toBe(true);
});

test("what an edit has added goes again where nobody put more into it", () => {
  const history = new History(() => 0);
  const after = withSunClock(EMPTY, { latitudeDeg: 35 });
  history.edited(EMPTY, after);
  expect(history.undo()?.(after).sun).toBeUndefined();
  expect(history.redo()?.(EMPTY).sun?.clock?.latitudeDeg).toBe(35);
  const theirs = withSun(after, { azimuthDeg: 90 });
  const undone = history.undo()?.(theirs);
  expect(undone?.sun?.azimuthDeg).toBe(90);
  expect(undone?.sun?.clock).toBeUndefined();
});

test("named views are kept for their domain", () => {
  const stored = new Map<string, string>();
  const store = {
    getItem: (key: string) => stored.get(key) ?? null,
    setItem: (key: string, value: string) => void stored.set(key, value),
  };
  let domain = "a";
  const views = new NamedViews(store, () => domain);
  views.load();
  expect(views.freeName()).toBe("View 1");
  const time = { validTime: "2013-05-20_20:10:00", timeIndex: 1 };
  const kept = views.keep({ name: "View 1", camera: cameraOfPose(ORBIT), ...time, picture: "" });
  expect(kept).toBe(true);
  expect(views.freeName()).toBe("View 2");
  domain = "b";
  views.load();
  expect(views.all.value).toEqual([]);
  domain = "a";
  const again = new NamedViews(store, () => domain);
  again.load();
  expect(again.all.value.map(({ name }) => name)).toEqual(["View 1"]);
  expect(poseOfCamera(again.all.value[0]?.camera)).toEqual(ORBIT);
  again.forget("View 1");
  expect(again.all.value).toEqual([]);
  stored.set("thunderhead.views", '{"a":[{"name":"x"},"y"]}');
  again.load();
  expect(again.all.value.length).toBeLessThan(2);
});

test("a view that cannot be stored lasts as long as the page, also while others are shown", () => {
  const full = () => {
    throw new Error("full");
  };
  let domain = "a";
  const views = new NamedViews({ getItem: () => '{"a":[]}', setItem: full }, () => domain);
  views.load();
  const time = { validTime: "", timeIndex: 1 };
  expect(views.keep({ name: "x", camera: cameraOfPose(ORBIT), ...time, picture: "" })).toBe(false);
  domain = "b";
  views.load();
  expect(views.all.value).toEqual([]);
  domain = "a";
  views.load();
  expect(views.all.value.map(({ name }) => name)).toEqual(["x"]);
});

test("two views of one name are two views", () => {
  const views = new NamedViews(undefined, () => "a");
  views.load();
  const view = { camera: cameraOfPose(ORBIT), picture: "", validTime: "" };
  // Without storage the view does not outlast the page.
  expect(views.keep({ ...view, name: "Inflow", timeIndex: 1 })).toBe(false);
  views.keep({ ...view, name: "Inflow", timeIndex: 2 });
  expect(views.all.value.map(({ name }) => name)).toEqual(["Inflow", "Inflow 2"]);
  views.forget("Inflow");
  expect(views.all.value.map(({ timeIndex }) => timeIndex)).toEqual([2]);
  // These entries have the format of an earlier page.
  const stored = JSON.stringify({
    a: ["x", "x"].map((name) => ({ name, camera: { orbit: {} }, timeIndex: 0 })),
  });
  const old = new NamedViews({ getItem: () => stored, setItem: () => undefined }, () => "a");
  old.load();
  expect(old.all.value.map(({ name }) => name)).toEqual(["x", "x 2"]);
});

test("a named view finds its time again where times came before it, and in another run", () => {
  const times = (...clocks: string[]) =>
    clocks.map((clock) => create(StormTimeSchema, { validTime: `2013-05-20_${clock}:00` }));
  const views = new NamedViews(undefined, () => "a");
  const camera = cameraOfPose(ORBIT);
  views.keep({ name: "x", camera, validTime: "2013-05-20_20:10:00", timeIndex: 1, picture: "" });
  const index = (...clocks: string[]) => views.at(times(...clocks))[0]?.timeIndex;
  expect(index("20:00", "20:10", "20:20")).toBe(1);
  expect(index("19:50", "20:00", "20:10", "20:20")).toBe(2);
  expect(index("20:05", "20:15", "20:45")).toBe(0);
  // No date is near, so the index stays the same, limited to the available times.
  expect(
    views.at([create(StormTimeSchema, { validTime: "1999-05-03_00:00:00" })])[0]?.timeIndex,
  ).toBe(0);
});

test("storms of one domain share views, whatever their files are called", () => {
  const grid = {
    nx: 200,
    ny: 160,
    nz: 60,
    dxM: 1000,
    dyM: 1000,
    low: { xM: -1e5, yM: -8e4, zM: 0 },
  };
  const here = { latitudeDeg: 35.2, longitudeDeg: -97.4 };
  const storm = (change: object) => create(StormDescriptionSchema, { grid, ...here, ...change });
  const a = storm({ id: "wrfout_1" });
  expect(isSameDomain(a, storm({ id: "run42", grid: { ...grid, nz: 80 } }))).toBe(true);
  expect(isSameDomain(a, storm({ grid: { ...grid, dxM: 500 } }))).toBe(false);
  expect(isSameDomain(a, storm({ latitudeDeg: 36.2 }))).toBe(false);
  expect(isSameDomain(undefined, undefined)).toBe(false);
});

const DRAFT: MovieDraft = {
  from: 3,
  to: 1,
  picturesPerSecond: 4,
  picturesPerView: 4,
  alongViews: false,
  widthPx: 640,
  heightPx: 360,
  format: "webm",
};

test("a movie has each time from the first to the last, also backwards, at its size", () => {
  const scenes = movieScenes(someScene(), DRAFT, []);
  expect(scenes.map(({ timeIndex }) => timeIndex)).toEqual([3, 2, 1]);
  expect(pictureCount(DRAFT, [])).toBe(3);
  expect(scenes[0]?.output?.widthPx).toBe(640);
  expect(poseOfCamera(scenes[0]?.camera)).toEqual(ORBIT);
});

test("a camera path goes the shorter way around, and through every view", () => {
  const to: OrbitPose = { ...ORBIT, azimuthDeg: 10, distanceM: 30_000 };
  const view = (pose: OrbitPose | SpotterPose, timeIndex: number) => ({
    name: "",
    camera: cameraOfPose(pose),
    validTime: "",
    timeIndex,
    picture: "",
  });
  const path = cameraPath([view(ORBIT, 0), view(to, 2)], 4);
  expect(path.length).toBe(5);
  const azimuths = path.map(({ pose }) => (pose as OrbitPose).azimuthDeg);
  expect(azimuths[0]).toBe(350);
  expect(azimuths[2]).toBeCloseTo(360, 6);
  expect(azimuths[4]).toBe(10);
  expect((path[2]?.pose as OrbitPose | undefined)?.distanceM).toBeCloseTo(40_000, 6);
  expect(path.map(({ timeIndex }) => timeIndex)).toEqual([0, 0, 1, 2, 2]);
});

test("a movie of each storm is remembered until it is forgotten, and what is no movie is none", () => {
  const texts = new Map<string, string>();
  const store = {
    getItem: (name: string) => texts.get(name) ?? null,
    setItem: (name: string, text: string) => void texts.set(name, text),
  };
  const movies = new RememberedMovies(store);
  expect(movies.of("supercell")).toBeUndefined();
  const work = { jobId: "j1", pictures: 3, draft: DRAFT, stormId: "supercell" };
  const other = { ...work, jobId: "j2", stormId: "squall line" };
  expect(movies.remember(work)).toBe(true);
  expect(movies.remember(other)).toBe(true);
  expect(new RememberedMovies(store).of("supercell")).toEqual(work);
  movies.forget("supercell");
  expect(new RememberedMovies(store).of("supercell")).toBeUndefined();
  expect(new RememberedMovies(store).of("squall line")).toEqual(other);
  for (const text of ["{", "[]", '{"jobId":"j1"}']) {
    for (const name of texts.keys()) texts.set(name, text);
    expect(new RememberedMovies(store).of("squall line")).toBeUndefined();
  }
  expect(new RememberedMovies(undefined).remember(work)).toBe(false);
});

describe("pictures of a job", () => {
  const all = { index: 0, state: RenderJobPictureState_State.DRAWN };
  const drawn = [all, { ...all, index: 1 }, { ...all, index: 2 }];

  // Makes a server whose first connections are cut after the given numbers of results.
  function callsTo(cuts: number[], states = drawn) {
    const fetched: number[] = [];
    let left = 0;
    const transport = createRouterTransport(({ service }) => {
      service(RenderJobService, {
        async *watchRenderJob() {
          left = cuts.shift() ?? Number.POSITIVE_INFINITY;
          yield { pictures: states };
        },
        async *fetchRenderResult({ index }) {
          if (left === 0) throw new ConnectError("cut", Code.Unavailable);
          left -= 1;
          fetched.push(index);
          yield { picture: {}, chunk: new Uint8Array([index]) };
        },
      });
    });
    return { calls: new RenderCalls(transport), fetched };
  }
  async function bytesOf(pictures: AsyncGenerator<DrawnPicture>): Promise<number[]> {
    const bytes: number[] = [];
    for await (const picture of pictures) bytes.push(...picture.bytes);
    return bytes;
  }
  const noDelay = () => new BackOff(() => 0);

  test("a lost connection delays them, and none is fetched twice", async () => {
    const { calls, fetched } = callsTo([1, 0, 1]);
    const never = new AbortController().signal;
    expect(await bytesOf(calls.picturesOfJob("j1", 3, never, noDelay()))).toEqual([0, 1, 2]);
    expect(fetched).toEqual([0, 1, 2]);
  });

  test("a picture that failed ends them with its problem", async () => {
    const failed = {
      index: 1,
      state: RenderJobPictureState_State.FAILED,
      problem: { message: "no storm" },
    };
    const { calls } = callsTo([], [drawn[0] as typeof all, failed as never]);
    const pictures = calls.picturesOfJob("j1", 3, new AbortController().signal, noDelay());
    await expect(bytesOf(pictures)).rejects.toThrow("picture 2: no storm");
  });

  test("who gives up waits no longer", async () => {
    const { calls } = callsTo([0]);
    const giving = new AbortController();
    // The back-off draws its random delay just before the wait, so this aborts the call during the
    // wait.
    const backOff = new BackOff(() => {
      queueMicrotask(() => giving.abort());
      return 1;
    });
    const pictures = calls.picturesOfJob("j1", 3, giving.signal, backOff);
    await expect(bytesOf(pictures)).rejects.toThrow();
  });
});
