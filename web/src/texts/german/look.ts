/** What else the robot shows: its cameras, and layers that are no part of the stack. */
export const LOOK = {
  Camera: "Kamera",
  "Camera: what the robot sees": "Kamera: was der Roboter sieht",
  "What the robot's camera sees (C)": "Was die Kamera des Roboters sieht (C)",
  "Which camera": "Welche Kamera",
  "Larger picture": "Größeres Bild",
  "Smaller picture": "Kleineres Bild",
  "Close the camera": "Kamera schließen",
  "The camera shows no new picture.": "Die Kamera zeigt kein neues Bild.",
  "No camera of this robot shows pictures now.": "Keine Kamera dieses Roboters zeigt jetzt Bilder.",
  "Waiting for the first picture…": "Wartet auf das erste Bild …",
  "No picture for {age}": "Kein Bild seit {age}",
  "What {topic} shows": "Was {topic} zeigt",

  "More on this robot": "Mehr von diesem Roboter",
  "{most} of these at most: switch one off first.":
    "Höchstens {most} davon: zuerst eines ausschalten.",
  "Nobody publishes it now.": "Niemand sendet es jetzt.",
  "Nothing has come yet.": "Noch ist nichts gekommen.",
  Poses: "Posen",
  Markers: "Markierungen",
  "Point cloud": "Punktwolke",
  "Map of cells": "Karte aus Zellen",
  Outline: "Umriss",
} as const;
