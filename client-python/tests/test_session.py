"""Tests of a session against a fake stub, without a server."""

import threading
import unittest
from collections.abc import Iterator
from typing import Any, Optional

import grpc

from thunderhead import ThunderheadError
from thunderhead.session import Session
from thunderhead.v1 import frame_pb2, scene_pb2, thunderhead_pb2

# Longest wait before a test counts as hung. It is not a performance requirement.
HANG_LIMIT_S = 600.0


class CallError(grpc.RpcError):
    """An error of a call with a status code."""

    def __init__(self, code: grpc.StatusCode) -> None:
        super().__init__()
        self._code = code

    def code(self) -> grpc.StatusCode:
        return self._code

    def details(self) -> str:
        return f"the fake answers {self._code.name}"

    def trailing_metadata(self) -> None:
        return None


class Stream:
    """The stream of a session's frames. It sends the next frame once the last one is acknowledged."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._acknowledged = 0
        self._active = True

    def __iter__(self) -> Iterator[thunderhead_pb2.WatchFramesResponse]:
        for sequence in (1, 2):
            with self._changed:
                self._changed.wait_for(lambda: not self._active or self._acknowledged == sequence - 1, HANG_LIMIT_S)
                if not self._active:
                    return
            frame = frame_pb2.Frame(sequence=sequence, scene_revision=sequence)
            yield thunderhead_pb2.WatchFramesResponse(viewer_id=7, frame=frame)
        with self._changed:
            self._changed.wait_for(lambda: not self._active, HANG_LIMIT_S)

    def acknowledge(self, sequence: int) -> None:
        with self._changed:
            self._acknowledged = sequence
            self._changed.notify_all()

    def is_active(self) -> bool:
        return self._active

    def cancel(self) -> None:
        with self._changed:
            self._active = False
            self._changed.notify_all()


class Stub:
    """Answers a session's calls. The first acknowledgement fails with `first_answer`."""

    def __init__(self, first_answer: Optional[grpc.StatusCode] = None) -> None:
        self.stream = Stream()
        self.acknowledged: "list[int]" = []
        self.render_timeout_s: Optional[float] = None
        self._first_answer = first_answer

    def CreateSession(self, request: Any, **_: Any) -> thunderhead_pb2.CreateSessionResponse:
        return thunderhead_pb2.CreateSessionResponse(session_id="key", scene=request.scene, scene_revision=1)

    def WatchFrames(self, request: Any, **_: Any) -> Stream:
        return self.stream

    def AcknowledgeFrame(self, request: thunderhead_pb2.AcknowledgeFrameRequest, **_: Any) -> None:
        self.acknowledged.append(request.sequence)
        if self._first_answer is not None and len(self.acknowledged) == 1:
            raise CallError(self._first_answer)
        self.stream.acknowledge(request.sequence)

    def UpdateScene(self, request: Any, **_: Any) -> thunderhead_pb2.UpdateSceneResponse:
        return thunderhead_pb2.UpdateSceneResponse(scene_revision=2)

    def RenderImage(self, request: Any, timeout: float, **_: Any) -> thunderhead_pb2.RenderImageResponse:
        self.render_timeout_s = timeout
        return thunderhead_pb2.RenderImageResponse()

    def CloseSession(self, request: Any, **_: Any) -> None:
        pass


class SessionTest(unittest.TestCase):
    def session(self, stub: Stub) -> Session:
        session = Session(stub, (), scene_pb2.Scene(), HANG_LIMIT_S, 7.5)
        self.addCleanup(session.close)
        return session

    def test_an_acknowledgement_that_a_busy_server_refuses_is_repeated(self) -> None:
        stub = Stub(grpc.StatusCode.RESOURCE_EXHAUSTED)
        session = self.session(stub)
        session.update(scene_pb2.Scene(), wait=False)
        self.assertEqual(session.wait(timeout_s=HANG_LIMIT_S).sequence, 2)
        self.assertEqual(stub.acknowledged[:2], [1, 1])

    def test_an_acknowledgement_that_is_refused_for_good_is_reported(self) -> None:
        stub = Stub(grpc.StatusCode.PERMISSION_DENIED)
        session = self.session(stub)
        session.update(scene_pb2.Scene(), wait=False)
        with self.assertRaisesRegex(ThunderheadError, "PERMISSION_DENIED"):
            session.wait(timeout_s=HANG_LIMIT_S)
        self.assertTrue(stub.stream.is_active(), "the reader has ended")
        stub.stream.acknowledge(1)
        with session._changed:
            self.assertTrue(session._changed.wait_for(lambda: session._problem is None, HANG_LIMIT_S))
        self.assertEqual(session.wait(timeout_s=HANG_LIMIT_S).sequence, 2)

    def test_a_picture_has_the_clients_timeout(self) -> None:
        stub = Stub()
        self.session(stub).picture()
        self.assertEqual(stub.render_timeout_s, 7.5)


if __name__ == "__main__":
    unittest.main()
