"""The server's errors as exceptions."""

from __future__ import annotations

import contextlib
from typing import Iterator, Optional

import grpc

from .rpc import error_details_pb2, status_pb2


class ThunderheadError(Exception):
    """A call that failed. Its text is the server's message: what is wrong, where, and what to do.

    code: gRPC's status code in capitals, such as "INVALID_ARGUMENT" or "UNAVAILABLE".
    reason: the server's name for the reason, such as "VALUE_OUT_OF_RANGE"; empty if the server gave none.
    field: the path of the value that is wrong, such as "scene.sun.elevation_deg"; empty if no value is wrong.
    retry_after_s: the time in seconds after which to try again; None if the server names no time.
    """

    def __init__(
        self, message: str, code: str = "UNKNOWN", reason: str = "", field: str = "", retry_after_s: Optional[float] = None
    ) -> None:
        super().__init__(message)
        self.code = code
        self.reason = reason
        self.field = field
        self.retry_after_s = retry_after_s


def error_of(error: grpc.RpcError) -> ThunderheadError:
    """Returns the exception for a failed call, with the details in the call's trailers."""
    code = error.code()
    result = ThunderheadError(error.details() or code.name, code.name)
    trailers = {item[0]: item[1] for item in error.trailing_metadata() or ()}
    status = status_pb2.Status.FromString(trailers.get("grpc-status-details-bin", b""))
    for detail in status.details:
        # The server's type names are those of google.rpc, but these classes are in thunderhead.rpc (setup.py). Only the
        # last part of the name is therefore compared.
        kind = detail.type_url.rpartition(".")[2]
        if kind == "ErrorInfo":
            result.reason = error_details_pb2.ErrorInfo.FromString(detail.value).reason
        elif kind == "BadRequest":
            violations = error_details_pb2.BadRequest.FromString(detail.value).field_violations
            result.field = violations[0].field if violations else ""
        elif kind == "RetryInfo":
            delay = error_details_pb2.RetryInfo.FromString(detail.value).retry_delay
            result.retry_after_s = delay.seconds + 1e-9 * delay.nanos
    return result


@contextlib.contextmanager
def translated() -> Iterator[None]:
    """Converts gRPC's errors in the body of its `with` statement to ThunderheadError."""
    try:
        yield
    except grpc.RpcError as error:
        raise error_of(error) from error
