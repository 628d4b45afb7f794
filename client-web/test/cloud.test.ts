import { describe, expect, it } from "vitest";
import { FIRST_CLOUD, requestOfCloud } from "../src/core/cloud";
import { GenerateCloudRequest_Preset as Preset } from "../src/gen/thunderhead/v1/cloud_pb";

describe("a cloud to be made", () => {
  it("leaves all but kind and seed to the preset until the user wants a shape of their own", () => {
    const request = requestOfCloud({
      ...FIRST_CLOUD,
      preset: Preset.CONGESTUS,
      seed: 9,
      octaves: 7,
    });
    expect(request.preset).toBe(Preset.CONGESTUS);
    expect(request.seed).toBe(9);
    expect(request.octaves).toBeUndefined();
    expect(requestOfCloud({ ...FIRST_CLOUD, ownShape: true, octaves: 7 }).octaves).toBe(7);
  });

  it("reads ellipsoids, with and without rotation", () => {
    const ellipsoids = "0,0,1200, 600,400,300\n\n 1e2,-5,900,50,50,50, 0,0,30";
    const request = requestOfCloud({ ...FIRST_CLOUD, ownShape: true, ellipsoids });
    expect(request.ellipsoids).toHaveLength(2);
    expect(request.ellipsoids[0]).toMatchObject({ zM: 1200, radiusXM: 600, rotationZDeg: 0 });
    expect(request.ellipsoids[1]).toMatchObject({ xM: 100, yM: -5, rotationZDeg: 30 });
  });

  it("names the line that is no ellipsoid", () => {
    for (const line of ["1,2,3", "a,b,c,d,e,f", "1,2,3,4,5,", "1,2,3,4,5,6,7"]) {
      const draft = { ...FIRST_CLOUD, ownShape: true, ellipsoids: `0,0,1,2,3,4\n${line}` };
      expect(() => requestOfCloud(draft)).toThrow(/Line 2 /);
    }
  });
});
