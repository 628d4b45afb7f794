"""Checks that each #include in server/ follows the order of rooms in server/rooms.txt."""

import pathlib
import re
import sys
import tempfile
import unittest

SERVER = pathlib.Path(__file__).resolve().parents[2] / "server"
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def rooms_of(server: pathlib.Path) -> list[str]:
    """Returns the rooms in their order."""
    lines = (server / "rooms.txt").read_text().splitlines()
    return [line.split()[1] for line in lines if line and not line.startswith("#")]


def room_of(path: str, rooms: list[str]) -> str | None:
    """Returns the room of a path relative to server/. It is the longest room that the path begins with."""
    inside = [room for room in rooms if path.startswith(room + "/")]
    return max(inside, key=len, default=None)


def find_faults(server: pathlib.Path) -> list[str]:
    """Returns one line for each file outside the rooms, and for each #include of a later room."""
    rooms = rooms_of(server)
    order = {room: place for place, room in enumerate(rooms)}
    faults = []
    for file in sorted(server.rglob("*")):
        if file.suffix not in (".cc", ".h"):
            continue
        path = file.relative_to(server).as_posix()
        room = room_of(path, rooms)
        if room is None:
            faults.append(f"{path} is in no room of rooms.txt; add its folder there")
            continue
        for include in INCLUDE.findall(file.read_text()):
            other = room_of(include, rooms)
            if other is not None and order[other] > order[room]:
                faults.append(f"{path} includes {include}, but {other} comes after {room} in rooms.txt")
    return faults


class RoomsTest(unittest.TestCase):
    def test_every_include_follows_the_order(self) -> None:
        self.assertEqual(find_faults(SERVER), [])

    def test_every_room_is_there(self) -> None:
        for room in rooms_of(SERVER):
            self.assertTrue((SERVER / room).is_dir(), room)

    def test_a_wrong_include_and_a_lost_file_are_found(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            server = pathlib.Path(folder)
            (server / "rooms.txt").write_text("# order\ncore  low\ncore  high\n")
            for room in ("low", "high", "lost"):
                (server / room).mkdir()
            (server / "low" / "a.h").write_text('#include "high/b.h"\n')
            (server / "high" / "b.h").write_text('#include "low/c.h"\n#include <vector>\n')
            (server / "lost" / "d.cc").write_text("")
            self.assertEqual(
                find_faults(server),
                [
                    "lost/d.cc is in no room of rooms.txt; add its folder there",
                    "low/a.h includes high/b.h, but high comes after low in rooms.txt",
                ],
            )


if __name__ == "__main__":
    sys.exit(unittest.main())
