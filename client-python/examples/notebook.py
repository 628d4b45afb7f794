"""The cells of a notebook as a script. Paste each into a cell. Usage: python3 notebook.py HOST:PORT FOLDER"""

# %% Open a session of a storm. The session exists until it is closed.
import sys

from thunderhead import Client

address, folder = sys.argv[1:]
client = Client(address)
session = client.session(client.storms()[0].id, {"camera": {"orbit": {}}}, size=(480, 270))

# %% Look from the west, in the evening. The cell's last line makes a notebook show the picture. To get sliders too, call:
# session.display()
session.set_all({"camera.orbit.azimuth_deg": 270, "sun.elevation_deg": 6})
session

# %% A value of the scene can be read by its path.
print("the camera stands", session.get("camera.orbit.distance_m"), "m away")

# %% Go through the storm's times.
for time_index in range(len(client.storms()[0].valid_times)):
    frame = session.set("time_index", time_index).wait()
    print("time", time_index, "at revision", frame.scene_revision, len(frame.jpeg), "bytes")

# %% Save the view at full quality. The PNG contains its scene, so that the command line can draw it again.
session.picture().save(f"{folder}/notebook.png")

# %% Close the session, so that the server has memory for others.
session.close()
client.close()
