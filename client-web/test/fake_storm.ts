// Test support: pictures of a made-up storm. They show a few soft blobs over a sky that follow the
// scene's camera, sun and fields. This is sufficient to see whether the page sends the right scene.
import jpeg from "jpeg-js";
import { poseOfCamera } from "../src/core/camera";
import { settingsOf, sharedSettingsOf } from "../src/core/rendering";
import { effectiveField } from "../src/core/scene";
import { Hydrometeor, type Scene, Transport } from "../src/gen/thunderhead/v1/scene_pb";

export interface Blob3 {
  readonly hydrometeor: Hydrometeor;
  readonly at: readonly [number, number, number];
  readonly radius: number;
}

export const BLOBS: readonly Blob3[] = [
  { hydrometeor: Hydrometeor.RAIN, at: [0, 0, 1500], radius: 5000 },
  { hydrometeor: Hydrometeor.CLOUD, at: [0, 0, 5000], radius: 6000 },
  { hydrometeor: Hydrometeor.GRAUPEL, at: [2000, 0, 7000], radius: 4000 },
  { hydrometeor: Hydrometeor.SNOW, at: [9000, 0, 11000], radius: 7000 },
  { hydrometeor: Hydrometeor.ICE, at: [22000, 3000, 12000], radius: 7000 },
  { hydrometeor: Hydrometeor.ICE, at: [-9000, -4000, 12000], radius: 5000 },
];

export function drawFakeStorm(scene: Scene, widthPx: number, heightPx: number): Uint8Array {
  const data = Buffer.alloc(widthPx * heightPx * 4);
  const blobs = project(scene, widthPx, heightPx);
  const elevation = scene.sun?.elevationDeg ?? 35;
  const light = Math.max(0.05, Math.sin((elevation * Math.PI) / 180)) ** 0.5;
  const gain = 2 ** (scene.display?.exposureEv ?? 0);
  const { transport, detail, falseColors } = sharedSettingsOf(settingsOf(scene.rendering));
  // Transport, detail and false colours change the picture visibly, although not realistically.
  const brightness = (transport === Transport.DIFFUSION ? 100 : 20) + (detail ? 20 : 0);
  const tint = falseColors ? [1, 0.2, 0.2] : [1, 1, 1];
  for (let y = 0; y < heightPx; y += 1) {
    const down = y / heightPx;
    for (let x = 0; x < widthPx; x += 1) {
      let color = [40 + 60 * down, 90 + 70 * down, 160 + 40 * down].map((c) => c * light);
      for (const blob of blobs) {
        const distance = Math.hypot(x - blob.x, y - blob.y) / blob.r;
        if (distance >= 1) continue;
        const opacity = (1 - distance * distance) * blob.opacity;
        const shade = 50 + brightness + (100 * (blob.y - y)) / blob.r;
        color = color.map((c, k) => c * (1 - opacity) + opacity * light * shade * (tint[k] ?? 1));
      }
      const at = 4 * (y * widthPx + x);
      for (let k = 0; k < 3; k += 1)
        data[at + k] = Math.min(255, Math.max(0, (color[k] ?? 0) * gain));
      data[at + 3] = 255;
    }
  }
  return jpeg.encode({ data, width: widthPx, height: heightPx }, 80).data;
}

function project(scene: Scene, widthPx: number, heightPx: number) {
  const pose = poseOfCamera(scene.camera);
  if (pose?.kind !== "orbit") return [];
  const azimuth = (pose.azimuthDeg * Math.PI) / 180;
  const elevation = (pose.elevationDeg * Math.PI) / 180;
  const focalPx = heightPx / 2 / Math.tan((pose.fieldOfViewDeg * Math.PI) / 360);
  const grown = 1 + (scene.timeIndex ?? 0) * 0.35;
  return BLOBS.flatMap((blob) => {
    const field = effectiveField(scene, blob.hydrometeor, undefined);
    if (!field.visible) return [];
    const [targetX, targetY, targetZ] = pose.targetM;
    const x = blob.at[0] * grown - targetX;
    const y = blob.at[1] * grown - targetY;
    const z = blob.at[2] - targetZ;
    const right = -Math.cos(azimuth) * x + Math.sin(azimuth) * y;
    const towards = Math.sin(azimuth) * x + Math.cos(azimuth) * y;
    const up = -towards * Math.sin(elevation) + z * Math.cos(elevation);
    const depth = pose.distanceM - towards * Math.cos(elevation) - z * Math.sin(elevation);
    if (depth <= 0) return [];
    return {
      x: widthPx / 2 + (focalPx * right) / depth,
      y: heightPx / 2 - (focalPx * up) / depth,
      r: Math.max(1, (focalPx * blob.radius * Math.sqrt(grown)) / depth),
      depth,
      opacity: Math.min(1, 0.9 * (field.scale ?? 1)),
    };
  }).sort((a, b) => b.depth - a.depth);
}
