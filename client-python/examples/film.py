"""Saves the pictures of a whole run as files and as one animation. Usage: python3 film.py HOST:PORT FOLDER"""

import sys

from thunderhead import Client

address, folder = sys.argv[1:]
# The scene sets a camera. Otherwise the server would choose a different camera for each time.
scene = {"camera": {"orbit": {"target": {"zM": 7000}, "azimuthDeg": 200, "elevationDeg": 6, "distanceM": 140000}}}
with Client(address) as client:
    storm = client.storms()[0].id
    frames = [picture.image for picture in client.sequence(storm, scene, (320, 180), product=folder + "/{storm}_{time:02d}.png")]
frames[0].save(f"{folder}/film.gif", save_all=True, append_images=frames[1:], duration=200, loop=0)
print(len(frames), "pictures, and", f"{folder}/film.gif")
