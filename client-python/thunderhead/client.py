"""A client of a server. It lists storms, requests pictures of one or every time, and waits for new times."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import ipaddress
import os
import pathlib
import time
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple, Union

import grpc
import numpy
import numpy.typing
from PIL import Image

from .errors import ThunderheadError, translated
from .picture import Picture
from .scenes import SceneLike, Size, scene_of
from .session import Session
from .v1 import scene_pb2, storm_pb2, thunderhead_pb2, thunderhead_pb2_grpc

_FORMATS = {"png": thunderhead_pb2.IMAGE_FORMAT_PNG, "jpeg": thunderhead_pb2.IMAGE_FORMAT_JPEG}
# Maximum size of a received message. An image of 8192 x 8192 pixels fits into one message.
_MAX_ANSWER_BYTES = 256 << 20


@dataclasses.dataclass(frozen=True)
class Storm:
    """A storm of the server.

    valid_times: its times as ISO 8601 in UTC, in ascending order. An idealised run begins in year 1.
    """

    id: str
    title: str
    valid_times: Tuple[str, ...]


class Client:
    """Calls one server.

    address: "host:port" of its gRPC port (--grpc of `thunderhead serve`).
    token: the access token for a server with --auth; by default $THUNDERHEAD_TOKEN.
    tls_ca: the certificate of the authority that signed the server's certificate, as the path or the bytes of a PEM
        file, or True for the system's authorities. Without it the connection is not encrypted, and a token is sent
        only to a server on this machine.
    allow_plaintext_token: True to send the token to other machines without encryption, where others on the network
        can read it.
    timeout_s: the maximum duration of a call in seconds.
    render_timeout_s: the maximum duration in seconds of a call that returns a picture.

    A call that fails raises ThunderheadError. Several threads may use a client at once.
    """

    def __init__(
        self,
        address: str,
        *,
        token: Optional[str] = None,
        tls_ca: Union[str, "os.PathLike[str]", bytes, bool, None] = None,
        allow_plaintext_token: bool = False,
        timeout_s: float = 30.0,
        render_timeout_s: float = 900.0,
    ) -> None:
        token = os.environ.get("THUNDERHEAD_TOKEN", "") if token is None else token
        if token and not tls_ca and not allow_plaintext_token and not _is_loopback(address):
            raise ThunderheadError(
                f"the token is not sent to {address} without encryption, because others on the network could read it; "
                "give tls_ca, or allow_plaintext_token=True if you trust the network"
            )
        self._metadata: Tuple[Tuple[str, str], ...] = (("authorization", f"Bearer {token.strip()}"),) if token else ()
        self._timeout_s = timeout_s
        self._render_timeout_s = render_timeout_s
        options = [("grpc.max_receive_message_length", _MAX_ANSWER_BYTES)]
        if tls_ca:
            roots = _roots(tls_ca)
            self._channel = grpc.secure_channel(address, grpc.ssl_channel_credentials(roots), options)
        else:
            self._channel = grpc.insecure_channel(address, options)
        # The stub is generated code without types.
        make_stub: Any = thunderhead_pb2_grpc.ThunderheadServiceStub
        self._stub: Any = make_stub(self._channel)

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection. This also ends the streams of its sessions."""
        self._channel.close()

    def _call(self, name: str, request: Any, timeout_s: Optional[float] = None) -> Any:
        with translated():
            return getattr(self._stub, name)(request, timeout=timeout_s or self._timeout_s, metadata=self._metadata)

    def storms(self) -> List[Storm]:
        """Returns the server's storms in the order in which it lists them."""
        listed = self._call("ListStorms", thunderhead_pb2.ListStormsRequest())
        storms = []
        for summary in listed.storms:
            times = self.describe(summary.id).times
            storms.append(Storm(summary.id, summary.title, tuple(each.valid_time for each in times)))
        return storms

    def describe(self, storm: str, time_index: int = 0) -> storm_pb2.StormDescription:
        """Describes a storm: its grid, place and times, and its fields at one time.

        Raises ThunderheadError with code NOT_FOUND for an unknown id.
        """
        request = thunderhead_pb2.DescribeStormRequest(storm_id=storm, time_index=time_index)
        description: storm_pb2.StormDescription = self._call("DescribeStorm", request).storm
        return description

    def server(self) -> thunderhead_pb2.GetServerInfoResponse:
        """Returns the server's version, device, techniques and presets."""
        info: thunderhead_pb2.GetServerInfoResponse = self._call("GetServerInfo", thunderhead_pb2.GetServerInfoRequest())
        return info

    def picture(
        self,
        storm: str = "",
        scene: SceneLike = None,
        size: Optional[Size] = None,
        *,
        time_index: Optional[int] = None,
        format: str = "png",
        error_seconds: float = 0.0,
    ) -> Picture:
        """Renders one picture at full quality. The result also has its scene, cost and estimated error.

        storm: the storm's id; by default the storm of the scene, otherwise the server's first storm.
        size: width and height in pixels; by default the scene's, which is 1280 x 720 unless the scene sets it.
        time_index: the index of the storm's time, from 0; by default the scene's, otherwise the last time.
        format: "png" or "jpeg".
        error_seconds: the time in seconds, 0 to 60, in which the server may trace paths to measure the picture's error;
            at 0 the error is taken from a table.
        """
        if format not in _FORMATS:
            raise ValueError(f"format is '{format}'; it must be one of {', '.join(_FORMATS)}")
        request = thunderhead_pb2.RenderImageRequest(
            scene=scene_of(scene, storm, time_index, size), format=_FORMATS[format], error_seconds=error_seconds
        )
        return Picture(self._call("RenderImage", request, self._render_timeout_s))

    def render(
        self, storm: str = "", scene: SceneLike = None, size: Optional[Size] = None, *, time_index: Optional[int] = None
    ) -> Image.Image:
        """Renders one picture, as `picture` does, for Pillow: mode RGB, 8 bits, sRGB."""
        return self.picture(storm, scene, size, time_index=time_index).image

    def render_array(
        self, storm: str = "", scene: SceneLike = None, size: Optional[Size] = None, *, time_index: Optional[int] = None
    ) -> "numpy.typing.NDArray[numpy.uint8]":
        """Renders one picture, as `picture` does, for numpy: uint8, height x width x 3, sRGB, rows from top to bottom."""
        return self.picture(storm, scene, size, time_index=time_index).array

    def sequence(
        self,
        storm: str,
        scene: SceneLike = None,
        size: Optional[Size] = None,
        *,
        times: Optional[Iterable[int]] = None,
        product: Optional[str] = None,
        jobs: int = 2,
    ) -> Iterator[Picture]:
        """Renders pictures of a storm's times and yields them in the order of the times.

        times: the indices of the times, from 0; by default all times.
        product: the path at which to save each picture, such as "out/{storm}_{valid:%Y%m%d_%H%M}_{time:02d}.png". A file
            that exists is rendered again and replaced.
        jobs: the number of pictures that are requested at a time.

        For unattended runs, use the command `thunderhead sequence`, which keeps a list of finished files (a manifest).
        """
        message = scene_of(scene, storm, None, size)
        valid = [each.valid_time for each in self.describe(storm).times]
        chosen = list(range(len(valid)) if times is None else times)
        names = [None if product is None else product_path(product, storm, valid[index], index) for index in chosen]
        if product is not None and len(set(names)) < len(names):
            raise ValueError(f"product is '{product}', so two pictures would have the same name; add {{valid:...}} or {{time}}")

        def draw(index: int) -> Picture:
            return self.picture(scene=message, time_index=index)

        with concurrent.futures.ThreadPoolExecutor(max_workers=jobs) as pool:
            waiting = [pool.submit(draw, index) for index in chosen]
            try:
                for name, each in zip(names, waiting):
                    picture = each.result()
                    if name is not None:
                        picture.save(name)
                    yield picture
            finally:
                for each in waiting:
                    each.cancel()

    def watch(
        self,
        storm: str,
        scene: SceneLike = None,
        size: Optional[Size] = None,
        *,
        product: Optional[str] = None,
        until: Optional[int] = None,
        timeout_s: Optional[float] = None,
        poll_s: float = 2.0,
    ) -> Iterator[Picture]:
        """Renders pictures of a storm's times: first the times that exist, then each new time that the server finds.

        If the server does not have the storm yet, waits for it.

        product: the path at which to save each picture, as in `sequence`.
        until: the number of pictures after which to end; by default never.
        timeout_s: raises TimeoutError if no new time appears for this many seconds; by default never.
        poll_s: the time in seconds between two requests to the server.
        """
        message = scene_of(scene, storm, None, size)
        drawn: Dict[str, int] = {}
        newest = time.monotonic()
        while until is None or len(drawn) < until:
            for each in self._times(storm):
                if each.valid_time in drawn or (until is not None and len(drawn) >= until):
                    continue
                picture = self.picture(scene=message, time_index=each.index)
                if product is not None:
                    picture.save(product_path(product, storm, each.valid_time, each.index))
                drawn[each.valid_time] = each.index
                newest = time.monotonic()
                yield picture
            if until is not None and len(drawn) >= until:
                return
            if timeout_s is not None and time.monotonic() - newest > timeout_s:
                raise TimeoutError(f"{storm}: no new time appeared for {timeout_s:g} s; {len(drawn)} times are drawn")
            time.sleep(poll_s)

    def _times(self, storm: str) -> List[storm_pb2.StormTime]:
        try:
            return [each for each in self.describe(storm).times if not each.deleted]
        except ThunderheadError as error:
            if error.code != "NOT_FOUND":
                raise
            return []

    def session(self, storm: str = "", scene: SceneLike = None, size: Optional[Size] = None) -> Session:
        """Opens a session: a scene on the server that you change step by step while it shows frames. See Session."""
        message: scene_pb2.Scene = scene_of(scene, storm, None, size)
        return Session(self._stub, self._metadata, message, self._timeout_s, self._render_timeout_s)


def _is_loopback(address: str) -> bool:
    """Returns whether "host:port", or a gRPC target such as "unix:/run/socket", is on this machine."""
    if address.startswith(("unix:", "unix-abstract:")):
        return True
    host = address.rpartition(":")[0].rpartition("/")[2].strip("[]")
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _roots(tls_ca: Union[str, "os.PathLike[str]", bytes, bool]) -> Optional[bytes]:
    if isinstance(tls_ca, bytes):
        return tls_ca
    return None if isinstance(tls_ca, bool) else pathlib.Path(tls_ca).read_bytes()


class _Valid:
    """A valid time for str.format, with strftime's %Y %y %m %d %j %H %M %S. Python's dates would not pad year 1 to 0001."""

    def __init__(self, text: str) -> None:
        year, month, day = (int(part) for part in text[:10].split("-"))
        hour, minute, second = (int(part) for part in text[11:19].split(":"))
        days = (0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334)
        leap = month > 2 and year % 4 == 0 and (year % 100 != 0 or year % 400 == 0)
        self._parts = {
            "%Y": f"{year:04d}", "%y": f"{year % 100:02d}", "%m": f"{month:02d}", "%d": f"{day:02d}",
            "%j": f"{days[month - 1] + day + leap:03d}", "%H": f"{hour:02d}", "%M": f"{minute:02d}", "%S": f"{second:02d}",
        }  # fmt: skip

    def __format__(self, format: str) -> str:
        result = format or "%Y%m%d_%H%M%S"
        for letter, value in self._parts.items():
            result = result.replace(letter, value)
        return result


def product_path(product: str, storm: str, valid_time: str, time_index: int) -> pathlib.Path:
    """Returns a picture's path from a template with {storm}, {valid:%Y%m%d_%H%M} and {time:02d}.

    Raises ValueError if the template has another field.
    """
    try:
        return pathlib.Path(product.format(storm=storm, valid=_Valid(valid_time), time=time_index))
    except (KeyError, IndexError) as error:
        raise ValueError(f"product is '{product}'; its fields can be {{storm}}, {{valid:%Y...}} and {{time:02d}}") from error
