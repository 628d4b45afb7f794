"""Saves one picture, and reads its pixels as numbers. Usage: python3 picture.py HOST:PORT FOLDER"""

import sys

from thunderhead import Client

address, folder = sys.argv[1:]
with Client(address) as client:
    for storm in client.storms():
        print(storm.id, storm.title, f"{len(storm.valid_times)} times, from {storm.valid_times[0]}")
    storm_id = client.storms()[0].id

    scene = {"camera": {"spotter": {"focalLengthMm": 35}}, "sun": {"azimuthDeg": 255, "elevationDeg": 12}}
    picture = client.picture(storm_id, scene, size=(320, 180))
    print("saved as", picture.save(f"{folder}/storm.png"))
    print("estimated error", picture.estimated_error, "and milliseconds", picture.milliseconds)

    pixels = client.render_array(storm_id, scene, size=(320, 180), time_index=0)
    print("mean colour at the first time:", pixels.reshape(-1, 3).mean(axis=0).round(1))
