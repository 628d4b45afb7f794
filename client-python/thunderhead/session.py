"""A session: a scene on the server that is changed step by step and shows frames. It is mainly for notebooks."""

from __future__ import annotations

import threading
import time
import warnings
from typing import Any, Iterator, Optional, Sequence, Tuple

import grpc

from .errors import ThunderheadError, error_of, translated
from .picture import Picture
from .scenes import field_of, limits_of
from .v1 import frame_pb2, scene_pb2, thunderhead_pb2

# The parameters that most people change first.
_SLIDERS = ("camera.orbit.azimuth_deg", "camera.orbit.elevation_deg", "sun.azimuth_deg", "sun.elevation_deg")

# Errors of a call that may succeed if it is repeated.
_PASSING = (
    grpc.StatusCode.ABORTED,
    grpc.StatusCode.DEADLINE_EXCEEDED,
    grpc.StatusCode.RESOURCE_EXHAUSTED,
    grpc.StatusCode.UNAVAILABLE,
)
_ACKNOWLEDGE_AGAIN_S = 0.2


class Session:
    """A session, which Client.session opens. A notebook shows its newest frame, and `widget()` adds sliders.

        session = client.session("supercell", size=(960, 540))
        session.set("camera.orbit.azimuth_deg", 250)     # returns when a frame shows the change
        session                                          # shows the frame
        session.close()

    After a change a coarse frame comes at once. If the scene is larger than 640 x 360 pixels, that frame may be smaller
    than the scene. Finer frames follow while the scene does not change. The session ends with `close` or with the client.
    The server also ends a session that no one has used for a time.
    """

    def __init__(
        self,
        stub: Any,
        metadata: Tuple[Tuple[str, str], ...],
        scene: scene_pb2.Scene,
        timeout_s: float,
        render_timeout_s: float,
    ) -> None:
        self._stub = stub
        self._metadata = metadata
        self._timeout_s = timeout_s
        self._render_timeout_s = render_timeout_s
        with translated():
            created = stub.CreateSession(
                thunderhead_pb2.CreateSessionRequest(scene=scene), timeout=timeout_s, metadata=metadata
            )
        #: The presenter's key. Anyone who has it may change the scene.
        self.id: str = created.session_id
        #: The viewers' key. It lets others watch, and change the scene while they are in control.
        self.viewer_key: str = created.viewer_key
        #: False if the server could not save the session, for example on a full disk; None if it saves no sessions.
        self.durable: Optional[bool] = created.durable if created.HasField("durable") else None
        if self.durable is False:
            warnings.warn("this session is not saved: it ends with the server, unless the server can save it later", stacklevel=3)
        self._changed = threading.Condition()
        self._scene: scene_pb2.Scene = created.scene
        self._revision: int = created.scene_revision
        self._frame: Optional[frame_pb2.Frame] = None
        self._problem: Optional[ThunderheadError] = None
        self._ended = False
        self._frames = stub.WatchFrames(thunderhead_pb2.WatchFramesRequest(session_id=self.id), metadata=metadata)
        self._reader = threading.Thread(target=self._read, name="thunderhead frames", daemon=True)
        self._reader.start()

    def _read(self) -> None:
        try:
            for message in self._frames:
                self._take(message)
        except grpc.RpcError as error:
            with self._changed:
                if not self._ended:
                    self._problem = error_of(error)
        with self._changed:
            self._ended = True
            self._changed.notify_all()

    def _take(self, message: thunderhead_pb2.WatchFramesResponse) -> None:
        with self._changed:
            if message.HasField("scene") and message.scene_revision >= self._revision:
                self._scene, self._revision = message.scene, message.scene_revision
            if message.HasField("frame"):
                self._frame, self._problem = message.frame, None
            elif message.HasField("problem"):
                self._problem = ThunderheadError(message.problem.message, "FAILED_PRECONDITION")
            self._changed.notify_all()
        if message.HasField("frame"):
            self._acknowledge(message.viewer_id, message.frame.sequence)

    def _acknowledge(self, viewer_id: int, sequence: int) -> None:
        """Acknowledges a frame. Retries after errors that may pass, because the server waits for acknowledgements."""
        request = thunderhead_pb2.AcknowledgeFrameRequest(session_id=self.id, viewer_id=viewer_id, sequence=sequence)
        while self._frames.is_active():
            try:
                self._stub.AcknowledgeFrame(request, timeout=self._timeout_s, metadata=self._metadata)
                return
            except grpc.RpcError as error:
                with self._changed:
                    if self._ended:
                        return
                    if error.code() not in _PASSING:
                        # The stream may continue. If it has ended with an error, _read() replaces this error.
                        self._problem = error_of(error)
                        self._changed.notify_all()
                        return
                    self._changed.wait_for(lambda: self._ended, _ACKNOWLEDGE_AGAIN_S)

    @property
    def scene(self) -> scene_pb2.Scene:
        """A copy of the newest scene. Its defaults are filled in once the server has sent it."""
        with self._changed:
            copy = scene_pb2.Scene()
            copy.CopyFrom(self._scene)
            return copy

    def get(self, path: str) -> Any:
        """Returns the scene's value at a path such as "sun.elevation_deg". Raises KeyError if the path does not exist."""
        message, field = field_of(self.scene, path)
        return getattr(message, field.name)

    def set(self, path: str, value: Any, *, wait: bool = True) -> "Session":
        """Changes one value of the scene, such as "sun.elevation_deg".

        wait: False to return at once, True to wait until a frame shows the change.
        """
        return self.set_all({path: value}, wait=wait)

    def set_all(self, values: "dict[str, Any]", *, wait: bool = True) -> "Session":
        """Changes several values at once. The keys are paths, as in `set`."""
        scene = self.scene
        for path, value in values.items():
            message, field = field_of(scene, path)
            setattr(message, field.name, value)
        return self.update(scene, wait=wait)

    def update(self, scene: scene_pb2.Scene, *, wait: bool = True) -> "Session":
        """Replaces the whole scene. Settings that the scene omits take their defaults."""
        request = thunderhead_pb2.UpdateSceneRequest(session_id=self.id, scene=scene)
        with translated():
            revision = self._stub.UpdateScene(request, timeout=self._timeout_s, metadata=self._metadata).scene_revision
        with self._changed:
            if revision >= self._revision:
                self._scene, self._revision = scene, revision
        if wait:
            self.wait()
        return self

    def wait(self, *, refined: bool = False, timeout_s: float = 120.0) -> frame_pb2.Frame:
        """Waits for a frame of the newest scene and returns it.

        refined: True to wait for a frame at full quality.

        Raises TimeoutError after `timeout_s` seconds, and ThunderheadError if the scene cannot be drawn or the session
        has ended.
        """
        end = time.monotonic() + timeout_s
        with self._changed:
            wanted = self._revision
            while True:
                frame = self._frame
                if frame is not None and frame.scene_revision >= wanted and (frame.refined or not refined):
                    return frame
                if self._problem is not None:
                    raise self._problem
                if self._ended:
                    raise ThunderheadError("the session has ended; open another", "NOT_FOUND")
                if not self._changed.wait(max(0.0, end - time.monotonic())):
                    raise TimeoutError(f"no frame of the newest scene came within {timeout_s:g} s; wait longer with timeout_s")

    def frames(self) -> Iterator[frame_pb2.Frame]:
        """Yields new frames until the session ends. Skips frames that are replaced by a newer one before they are used."""
        shown = 0
        while True:
            with self._changed:
                while not self._ended and (self._frame is None or self._frame.sequence == shown):
                    self._changed.wait()
                if self._frame is None or self._frame.sequence == shown:
                    return
                frame = self._frame
            shown = frame.sequence
            yield frame

    @property
    def jpeg(self) -> bytes:
        """A frame of the newest scene as a JPEG file. Waits for it and raises errors as `wait` does."""
        jpeg: bytes = self.wait().jpeg
        return jpeg

    def picture(self) -> Picture:
        """Renders the newest scene at full quality, as Client.picture does, within the client's render_timeout_s."""
        request = thunderhead_pb2.RenderImageRequest(scene=self.scene)
        with translated():
            return Picture(self._stub.RenderImage(request, timeout=self._render_timeout_s, metadata=self._metadata))

    def _repr_jpeg_(self) -> bytes:
        return self.jpeg

    def widget(self, paths: Sequence[str] = _SLIDERS) -> Any:
        """Returns a widget with the session's frames and a slider for each number in `paths`.

        A slider has the range that the server allows. Raises RuntimeError if ipywidgets is not installed. Use `set`
        in this case.
        """
        try:
            import ipywidgets
        except ImportError as error:
            raise RuntimeError("sliders need ipywidgets: pip install 'thunderhead[notebook]'; or use Session.set") from error
        image = ipywidgets.Image(value=self.jpeg, format="jpeg")
        sliders = [self._slider(ipywidgets, path) for path in paths]

        def show() -> None:
            for frame in self.frames():
                image.value = frame.jpeg

        threading.Thread(target=show, name="thunderhead widget", daemon=True).start()
        return ipywidgets.VBox([image, *sliders])

    def _slider(self, ipywidgets: Any, path: str) -> Any:
        limits = limits_of(path)
        value = self.get(path)
        # Integers such as time, seeds and slices must stay integers.
        kind = ipywidgets.IntSlider if isinstance(value, int) else ipywidgets.FloatSlider
        slider = kind(
            value=value,
            min=limits.minimum,
            max=limits.maximum,
            step=1 if isinstance(value, int) else (limits.maximum - limits.minimum) / 1000.0,
            description=path.rpartition(".")[0].rpartition(".")[2] + " " + path.rpartition(".")[2],
        )

        def moved(change: Any) -> None:
            self.set(path, change["new"], wait=False)

        slider.observe(moved, names="value")
        return slider

    def display(self) -> None:
        """Shows the session in a notebook: with sliders if ipywidgets is installed, otherwise its newest frame."""
        from IPython.display import display

        try:
            display(self.widget())
        except RuntimeError:
            display(self)

    def close(self) -> None:
        """Ends the session. Does nothing if the session has already ended."""
        with self._changed:
            self._ended = True
        try:
            self._stub.CloseSession(
                thunderhead_pb2.CloseSessionRequest(session_id=self.id), timeout=self._timeout_s, metadata=self._metadata
            )
        except grpc.RpcError as error:
            if error.code() is not grpc.StatusCode.NOT_FOUND:
                raise error_of(error) from error
        finally:
            self._frames.cancel()
            self._reader.join(5.0)

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
