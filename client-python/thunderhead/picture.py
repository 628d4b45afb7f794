"""One rendered picture with its scene, cost and error."""

from __future__ import annotations

import io
import os
import pathlib
from typing import Any, Dict, Optional, Tuple, Union

import numpy
import numpy.typing
from PIL import Image

from .v1 import frame_pb2, scene_pb2, thunderhead_pb2


class Picture:
    """A picture that the server rendered. Notebooks show it.

    data: the bytes of the PNG or JPEG file. A PNG contains its scene, storm, time and estimated error as texts.
    scene: the whole scene, with all defaults filled in.
    """

    def __init__(self, response: thunderhead_pb2.RenderImageResponse) -> None:
        self.data: bytes = response.image
        self.scene: scene_pb2.Scene = response.scene
        self._response = response

    @property
    def image(self) -> Image.Image:
        """The picture for Pillow: mode RGB, 8 bits, sRGB. The texts of a PNG are in its `info`."""
        image = Image.open(io.BytesIO(self.data))
        image.load()
        return image if image.mode == "RGB" else image.convert("RGB")

    @property
    def array(self) -> "numpy.typing.NDArray[numpy.uint8]":
        """The picture for numpy: uint8, height x width x 3, sRGB, rows from top to bottom."""
        return numpy.asarray(self.image)

    @property
    def estimated_error(self) -> Optional[float]:
        """The estimated root mean square error of linear radiance, relative to the mean radiance; None if it is unknown."""
        accuracy: frame_pb2.AccuracyReport = self._response.accuracy
        return float(accuracy.estimated_error) if self._response.HasField("accuracy") else None

    @property
    def measured(self) -> bool:
        """True if the error was measured by tracing paths through this picture, False if it comes from a table."""
        return bool(self._response.accuracy.measured)

    @property
    def error_interval(self) -> Optional[Tuple[float, float]]:
        """The 95 % confidence interval of the error; None unless the error was measured."""
        accuracy: frame_pb2.AccuracyReport = self._response.accuracy
        return (float(accuracy.error_low), float(accuracy.error_high)) if accuracy.measured else None

    @property
    def milliseconds(self) -> Dict[str, float]:
        """The time in milliseconds of each stage of rendering, such as "read", "view" and "encode"."""
        names = frame_pb2.Stage
        return {names.Name(cost.stage)[len("STAGE_") :].lower(): float(cost.milliseconds) for cost in self._response.stages}

    def save(self, path: Union[str, "os.PathLike[str]"]) -> pathlib.Path:
        """Writes the picture's file, completely or not at all, and returns its path. Creates missing folders.

        It writes a temporary file next to `path` and renames it. Raises OSError if this fails.
        """
        target = pathlib.Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        partial = target.with_name(target.name + ".partial")
        with open(partial, "wb") as file:
            file.write(self.data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, target)
        return target

    def __array__(self, dtype: Any = None) -> "numpy.typing.NDArray[Any]":
        return numpy.asarray(self.array, dtype)

    def _repr_png_(self) -> Optional[bytes]:
        return self.data if self.data.startswith(b"\x89PNG") else None

    def _repr_jpeg_(self) -> Optional[bytes]:
        return None if self.data.startswith(b"\x89PNG") else self.data

    def __repr__(self) -> str:
        response = self._response
        return f"<Picture of {self.scene.storm_id}, {response.width_px} x {response.height_px} pixels, {len(self.data)} bytes>"
