// Reads and writes a scene as a file: Protobuf JSON, either alone or inside a PNG.
import { fromJson, toJson } from "@bufbuild/protobuf";
import { type Scene, SceneSchema } from "../gen/thunderhead/v1/scene_pb";
import { pngText, withPngText } from "./png_text";

const KEYWORD = "thunderhead.scene";

export function sceneToText(scene: Scene): string {
  return JSON.stringify(toJson(SceneSchema, scene), null, 2);
}

// Reads a scene from JSON. Throws an Error with a message for people if the text is not a scene.
export function sceneOfText(text: string): Scene {
  try {
    return fromJson(SceneSchema, JSON.parse(text), { ignoreUnknownFields: true });
  } catch (error) {
    throw new Error(`the file is not a Thunderhead scene (${(error as Error).message})`);
  }
}

export function withScene(png: Uint8Array, scene: Scene): Uint8Array<ArrayBuffer> | undefined {
  return withPngText(png, KEYWORD, sceneToText(scene));
}

// Reads a scene from a file. Throws an Error with a message for people if the file contains no
// scene.
export function sceneOfFile(bytes: Uint8Array): Scene {
  const inside = pngText(bytes, KEYWORD);
  if (inside !== undefined) return sceneOfText(inside);
  if (bytes[0] === 0x89)
    throw new Error("this picture contains no scene; use a PNG that Thunderhead saved");
  return sceneOfText(new TextDecoder().decode(bytes));
}
