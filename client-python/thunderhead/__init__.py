"""Pictures of storms from a Thunderhead server.

    from thunderhead import Client
    with Client("localhost:50051") as client:
        client.render("supercell", {"camera": {"spotter": {}}}, size=(1280, 720)).save("storm.png")

A scene is what decides how a picture looks: a dict of Protobuf JSON's names ({"sun": {"elevationDeg": 10}}; names with
underscores do as well), a message of thunderhead.v1.scene_pb2, or the path of a JSON file or of a PNG that Thunderhead made.
What it leaves out takes its default.
"""

from .client import Client, Storm
from .errors import ThunderheadError
from .picture import Picture
from .scenes import SceneLike, scene_of
from .session import Session

__all__ = ["Client", "Picture", "SceneLike", "Session", "Storm", "ThunderheadError", "scene_of"]
