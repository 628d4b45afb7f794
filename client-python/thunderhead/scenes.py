"""Converts between the forms of scenes: dict, message, JSON file and PNG."""

from __future__ import annotations

import json
import os
import pathlib
from typing import Any, Mapping, Optional, Tuple, Union

from google.protobuf import json_format
from PIL import Image

from .v1 import limits_pb2, scene_pb2

SceneLike = Union[Mapping[str, Any], scene_pb2.Scene, str, "os.PathLike[str]", None]
Size = Tuple[int, int]

# Keyword of the PNG text that contains the picture's scene.
_SCENE_TEXT = "thunderhead.scene"


def scene_of(
    scene: SceneLike = None, storm: str = "", time_index: Optional[int] = None, size: Optional[Size] = None
) -> scene_pb2.Scene:
    """Returns a scene in any form as a message.

    scene: a PNG gives its scene without the storm, so that the scene can be used for another storm.
    storm, time_index, size: replace the scene's values if they are given. size is width and height in pixels.

    Raises ValueError if `scene` is not a scene, and OSError if its file cannot be read.
    """
    message = scene_pb2.Scene()
    if isinstance(scene, scene_pb2.Scene):
        message.CopyFrom(scene)
    elif isinstance(scene, (str, os.PathLike)):
        _read(pathlib.Path(scene), message)
    elif scene is not None:
        _parse(json.dumps(scene), message, "the scene")
    if storm:
        message.storm_id = storm
    if time_index is not None:
        message.time_index = time_index
    if size is not None:
        message.output.width_px, message.output.height_px = size
    return message


def _read(path: pathlib.Path, message: scene_pb2.Scene) -> None:
    data = path.read_bytes()
    if not data.startswith(b"\x89PNG"):
        _parse(data.decode(errors="replace"), message, str(path))
        return
    with Image.open(path) as image:
        image.load()
        text = image.info.get(_SCENE_TEXT)
    if text is None:
        raise ValueError(f"{path} is a PNG without a scene in it; give one that Thunderhead made, or a scene's JSON")
    _parse(text, message, str(path))
    # The storm is removed, so that the scene can be used for another storm.
    message.storm_id = ""


def _parse(text: str, message: scene_pb2.Scene, what: str) -> None:
    try:
        json_format.Parse(text, message)
    except json_format.ParseError as error:
        raise ValueError(f"{what} is not a scene: {error}; see proto/thunderhead/v1/scene.proto for its fields") from error


def json_of(scene: scene_pb2.Scene) -> str:
    """Returns the scene as Protobuf JSON, which the flag --scene of the command line reads."""
    return str(json_format.MessageToJson(scene))


def field_of(scene: scene_pb2.Scene, path: str) -> Tuple[Any, Any]:
    """Returns the message that contains the value at a path such as "camera.orbit.azimuth_deg", and its descriptor.

    Creates the messages that the path passes through. Raises KeyError if a part of the path does not exist.
    """
    message: Any = scene
    names = path.split(".")
    for i, name in enumerate(names):
        field = message.DESCRIPTOR.fields_by_name.get(name)
        if field is None:
            known = ", ".join(sorted(message.DESCRIPTOR.fields_by_name))
            raise KeyError(f"'{path}' has no part '{name}'; the parts are {known}")
        if i + 1 == len(names):
            return message, field
        if field.message_type is None or field.label == field.LABEL_REPEATED:
            raise KeyError(f"'{path}': '{name}' has no parts; end the path there")
        holder = message
        message = getattr(holder, name)
        message.SetInParent()
    raise KeyError("the path is empty; give one such as 'sun.elevation_deg'")


def limits_of(path: str) -> limits_pb2.NumberLimits:
    """Returns the range, default and unit of a number in a scene, as the server checks it.

    Raises KeyError if the path does not exist or its value is not a number with limits.
    """
    _, field = field_of(scene_pb2.Scene(), path)
    options = field.GetOptions()
    if not options.HasExtension(limits_pb2.number):
        raise KeyError(f"'{path}' is not a number with limits")
    limits: limits_pb2.NumberLimits = options.Extensions[limits_pb2.number]
    return limits
