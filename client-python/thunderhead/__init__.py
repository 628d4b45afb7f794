"""Pictures of storms from a Thunderhead server.

    from thunderhead import Client
    with Client("localhost:50051") as client:
        client.render("supercell", {"camera": {"spotter": {}}}, size=(1280, 720)).save("storm.png")

A scene holds all settings that decide how a picture looks. It is one of:

- a dict with the names of Protobuf JSON, such as {"sun": {"elevationDeg": 10}} or {"sun": {"elevation_deg": 10}}
- a message of thunderhead.v1.scene_pb2
- the path of a JSON file, or of a PNG that Thunderhead made

Settings that a scene omits take their defaults.
"""

from .client import Client, Storm
from .errors import ThunderheadError
from .picture import Picture
from .scenes import SceneLike, scene_of
from .session import Session

__all__ = ["Client", "Picture", "SceneLike", "Session", "Storm", "ThunderheadError", "scene_of"]
