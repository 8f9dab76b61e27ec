/**
 * What the console and the robot say in English, to the page as to everybody, and how the page says
 * it in German. `{parts}` stand for anything. A test finds each of them in the sources of both, so
 * none is kept here that is not said any more; what is not here is shown as it was said.
 */
export const SAID: Readonly<Record<string, string>> = {
  // Names of components, streams and states
  Planner: "Planer",
  Controller: "Regler",
  "Local map": "Nahkarte",
  Drive: "Fahrsteuerung",
  Map: "Karte",
  "Motion test": "Fahrtest",
  Simulator: "Simulator",
  Position: "Position",
  "Laser scan": "Laserscan",
  Path: "Weg",
  "rule {name}": "Regel {name}",

  // What a component says of itself
  "Running - Healthy": "Läuft, alles in Ordnung",
  "Inactive - it does nothing until it is started":
    "Nicht aktiv: Es tut nichts, bis es gestartet wird",
  "Failure: Algorithm Level": "Ausfall: Das Verfahren findet nichts",
  "Failure: Component Level": "Ausfall: Die Komponente selbst",
  "Failure: System Level": "Ausfall: Etwas außerhalb fehlt",
  "Failure: General": "Ausfall",

  // The page itself
  "The console did not answer.": "Die Konsole hat nicht geantwortet.",
  "Check the network between this browser and the robot, then try again.":
    "Prüfen Sie das Netz zwischen diesem Browser und dem Roboter, dann versuchen Sie es erneut.",
  "The console answered with error {status}.": "Die Konsole antwortete mit Fehler {status}.",
  "Reload the page; if it stays, look at the console's log on the robot.":
    "Laden Sie die Seite neu; bleibt es so, sehen Sie am Roboter ins Protokoll der Konsole.",
  "Press STOP again; if it keeps moving, use the emergency button on the robot.":
    "Drücken Sie erneut STOPP; fährt er weiter, drücken Sie den Not-Halt am Roboter.",

  // Logging in
  "You are not logged in to this console.": "Sie sind an dieser Konsole nicht angemeldet.",
  "Log in by name, or with the token that the console printed when it started.":
    "Melden Sie sich mit Namen an, oder mit dem Token, den die Konsole beim Start ausgibt.",
  "Copy the token that the console printed when it started.":
    "Kopieren Sie den Token, den die Konsole beim Start ausgegeben hat.",
  "Try again; on the robot, 'kompass-console users passwd' gives a new password.":
    "Versuchen Sie es erneut; am Roboter gibt „kompass-console users passwd“ ein neues Passwort.",
  "This token is not one of this console's.": "Dieser Token gehört nicht zu dieser Konsole.",
  "This name and this password do not fit.": "Name und Passwort passen nicht zusammen.",
  "Too many wrong log-ins came from your address.":
    "Von Ihrer Adresse kamen zu viele falsche Anmeldungen.",
  "Wait {wait} s, then try again.": "Warten Sie {wait} s, dann versuchen Sie es erneut.",
  "Your session has ended.": "Ihre Sitzung ist beendet.",
  "Reload the page.": "Laden Sie die Seite neu.",
  "Reload the page and try again.": "Laden Sie die Seite neu, und versuchen Sie es erneut.",

  // STOP
  "It is asked for again until it is, for {seconds} s. Do not wait for that: use the emergency stop on the robot itself.":
    "Er wird {seconds} s lang weiter angefordert. Warten Sie nicht darauf: Nutzen Sie den Not-Halt am Roboter selbst.",
  "STOP takes a log-in on this console: nothing was stopped.":
    "STOPP verlangt an dieser Konsole eine Anmeldung: Es wurde nichts gestoppt.",
  "Use the emergency stop on the robot itself, or log in.":
    "Nutzen Sie den Not-Halt am Roboter selbst, oder melden Sie sich an.",
  "STOP is not released: {why}.": "Der Stopp ist nicht freigegeben: {why}.",
  "STOP is not confirmed: {why}.": "Der Stopp ist nicht bestätigt: {why}.",
  "Look at the drive manager's health; the robot stays stopped.":
    "Sehen Sie nach dem Zustand der Fahrsteuerung; der Roboter bleibt gestoppt.",

  "{name} pressed STOP": "{name} hat STOPP gedrückt",
  "Stopped: {name} pressed STOP.": "Gestoppt: {name} hat STOPP gedrückt.",
  "Stopped: somebody pressed STOP, or took the wheel, while the planner was held.":
    "Gestoppt: Jemand hat STOPP gedrückt oder das Steuer genommen, während der Planer angehalten war.",
  "somebody pressed STOP, or took the wheel, for a moment":
    "jemand hat kurz STOPP gedrückt oder das Steuer genommen",

  // Goals, before they are sent
  "The robot's program takes points only, so the heading is not used.":
    "Das Programm des Roboters nimmt nur Punkte; die Richtung wird nicht verwendet.",
  "The robot is stopped: release STOP before it can drive there.":
    "Der Roboter ist gestoppt: Geben Sie den Stopp frei, bevor er dorthin fahren kann.",
  "No planner checks goals here: only the map was looked at.":
    "Hier prüft kein Planer die Ziele: Nur die Karte wurde angesehen.",
  "The robot can go there.": "Der Roboter kann dorthin.",
  "The way is clear.": "Der Weg ist frei.",
  "There is no map yet, so no way can be planned.":
    "Es gibt noch keine Karte, also ist kein Weg planbar.",
  "There is no map yet.": "Es gibt noch keine Karte.",
  "This point is outside the map.": "Dieser Punkt liegt außerhalb der Karte.",
  "This point is inside an obstacle.": "Dieser Punkt liegt in einem Hindernis.",
  "This point is too close to an obstacle for the robot.":
    "Dieser Punkt ist für den Roboter zu nah an einem Hindernis.",
  "No free way leads to this point.": "Kein freier Weg führt zu diesem Punkt.",
  "The robot does not know where it is, so no way can be planned.":
    "Der Roboter weiß nicht, wo er ist, also ist kein Weg planbar.",
  "The robot does not know where it is.": "Der Roboter weiß nicht, wo er ist.",
  "The robot stands too close to an obstacle to plan a way.":
    "Der Roboter steht zu nah an einem Hindernis, um einen Weg zu planen.",
  "The planner found no path to this point.": "Der Planer fand keinen Weg zu diesem Punkt.",
  "This is above the horizon; press on the floor.":
    "Das liegt über dem Horizont; drücken Sie auf den Boden.",
  "This is above the horizon; press the floor.":
    "Das liegt über dem Horizont; drücken Sie auf den Boden.",
  "No planner answers. Check that the robot's program is running.":
    "Kein Planer antwortet. Prüfen Sie, ob das Programm des Roboters läuft.",
  "Nobody listens for goals. Check that the robot's program is running.":
    "Niemand nimmt Ziele an. Prüfen Sie, ob das Programm des Roboters läuft.",
  "The goal ({x}, {y}) is outside the map.": "Das Ziel ({x} | {y}) liegt außerhalb der Karte.",
  "The goal ({x}, {y}) is inside an obstacle.": "Das Ziel ({x} | {y}) liegt in einem Hindernis.",
  "The goal ({x}, {y}) is in unexplored space.": "Das Ziel ({x} | {y}) liegt im Unerkundeten.",
  "The goal ({x}, {y}) is {clearance} m from an obstacle; the robot needs {required} m.":
    "Das Ziel ({x} | {y}) ist {clearance} m von einem Hindernis entfernt; der Roboter braucht {required} m.",
  "No way leads from ({from}) to the goal ({to}) for a robot that needs {required} m on every side.":
    "Kein Weg führt von ({from}) zum Ziel ({to}) für einen Roboter, der auf jeder Seite {required} m braucht.",
  "The robot at ({at}) is outside the map.": "Der Roboter bei ({at}) ist außerhalb der Karte.",
  "The robot at ({at}) is {clearance} m from an obstacle on the map, less than its radius of {radius} m.":
    "Der Roboter bei ({at}) ist {clearance} m von einem Hindernis der Karte entfernt, weniger als sein Radius von {radius} m.",
  "No path from ({from}) to ({to}) was found.": "Kein Weg von ({from}) nach ({to}) gefunden.",
  "Load a map, then send the goal again.": "Laden Sie eine Karte, dann senden Sie das Ziel erneut.",
  "Check the robot's localization, then send the goal again.":
    "Prüfen Sie die Lokalisierung des Roboters, dann senden Sie das Ziel erneut.",
  "Move the robot into the open, then send the goal again.":
    "Bringen Sie den Roboter auf freie Fläche, dann senden Sie das Ziel erneut.",
  "Start the robot's program, or look at the planner's health.":
    "Starten Sie das Programm des Roboters, oder sehen Sie nach dem Zustand des Planers.",
  "Choose another point.": "Wählen Sie einen anderen Punkt.",
  "Release STOP when the way is clear, then try again.":
    "Geben Sie den Stopp frei, wenn der Weg frei ist, dann versuchen Sie es erneut.",
  "Release STOP when the way is clear, then send it again.":
    "Geben Sie den Stopp frei, wenn der Weg frei ist, dann senden Sie es erneut.",
  "{name} drives by hand.": "{name} fährt von Hand.",
  "Send the goal again when the wheel has been given up.":
    "Senden Sie das Ziel erneut, wenn das Steuer abgegeben ist.",

  // Goals, on the way
  "The robot has arrived.": "Der Roboter ist angekommen.",
  "Arrived, {off} cm off.": "Angekommen, {off} cm daneben.",
  "Cancelled.": "Abgebrochen.",
  "The goal was cancelled.": "Das Ziel wurde abgebrochen.",
  "The planner gave the goal up without saying why.":
    "Der Planer hat das Ziel aufgegeben, ohne zu sagen, warum.",
  "No planner took the goal. Check that it is running.":
    "Kein Planer hat das Ziel angenommen. Prüfen Sie, ob er läuft.",
  "The planner was deactivated.": "Der Planer wurde abgeschaltet.",
  "A newer goal took over.": "Ein neueres Ziel hat es abgelöst.",
  "Driven by hand: {name} took the wheel.": "Von Hand gefahren: {name} hat das Steuer genommen.",
  "The planner's process died and took the goal with it; the robot drives no farther than the path that it has. Send the goal again.":
    "Der Prozess des Planers ist abgestürzt und das Ziel mit ihm; der Roboter fährt nur noch den Weg, den er hat. Senden Sie das Ziel erneut.",

  "In the way: {what} at ({x}, {y}), {away} m {where}, for {lasted} s.":
    "Im Weg: {what} bei {x} | {y}, {away} m {where}, seit {lasted} s.",
  "In the way: {what} at ({x}, {y}), {away} m {where}.":
    "Im Weg: {what} bei {x} | {y}, {away} m {where}.",
  "No progress for {seconds} s.": "Seit {seconds} s kein Fortschritt.",
  "No progress for {seconds} s{because}.": "Seit {seconds} s kein Fortschritt{because}.",
  "; the drive manager holds the robot back: {what}":
    "; die Fahrsteuerung hält den Roboter zurück: {what}",
  "Nothing is known to be in the way at ({x}, {y}).": "Im Weg ist bei {x} | {y} nichts bekannt.",
  "The drive manager holds the robot back: {what}.":
    "Die Fahrsteuerung hält den Roboter zurück: {what}.",
  "Something stands on all sides of the robot.": "Um den Roboter steht überall etwas.",
  "What it is is not known yet.": "Was es ist, ist noch nicht bekannt.",
  "Look at wheels and floor": "Sehen Sie nach Rädern und Boden",
  "The planner has no scan to look at": "Der Planer hat keinen Scan, den er ansehen könnte",
  "something that the lidar sees": "etwas, das der Laserscanner sieht,",
  "somebody, or something that moved": "jemand, oder etwas, das sich bewegt hat,",
  "what the lidar saw {age} s ago, and does not see from here,":
    "was der Laserscanner vor {age} s sah und von hier nicht sieht,",
  "an obstacle of the map": "ein Hindernis der Karte",
  "the keep-out zone {name}": "die Sperrzone {name}",
  "a keep-out zone": "eine Sperrzone",
  ahead: "voraus",
  "ahead to the {side}": "voraus {side}",
  "behind to the {side}": "hinten {side}",
  "to the {side}": "{side}",
  behind: "hinten",
  left: "links",
  right: "rechts",
  obstacle: "ein Hindernis",
  "keep-out zone": "eine Sperrzone",
  "scan stale": "ein Scanner oder eine Kamera schweigt",
  "odometry stale": "es kommt keine frische Odometrie",
  "place unknown": "sein Ort ist nicht bekannt",
  "second publisher": "jemand anders steuert das Fahrwerk",
  "steered wheels": "gelenkte Räder drehen nicht auf der Stelle",

  // The wheel and control
  "Nobody has the wheel: take it.": "Niemand hat das Steuer: Nehmen Sie es.",
  "Only an engineer takes the wheel over; ask whoever drives for it.":
    "Nur ein Techniker übernimmt das Steuer; bitten Sie den, der fährt.",
  "You do not have the wheel: {why}.": "Sie haben das Steuer nicht: {why}.",
  "The drive manager does not answer: {why}.": "Die Fahrsteuerung antwortet nicht: {why}.",
  "{name} has been asked.": "{name} wurde gebeten.",
  "{name} has control of the robot.": "{name} hat die Kontrolle über den Roboter.",
  "Ask for it, at the top of the page. STOP works for everybody.":
    "Bitten Sie darum, oben auf der Seite. STOPP wirkt bei allen.",
  "Ask for it, or take it and say why, at the top of the page. STOP works for everybody.":
    "Bitten Sie darum, oder übernehmen Sie sie mit einer Begründung, oben auf der Seite. STOPP wirkt bei allen.",
  "You have control on another device.": "Sie haben die Kontrolle auf einem anderen Gerät.",
  "Take it here, at the top of the page. STOP works for everybody.":
    "Übernehmen Sie sie hier, oben auf der Seite. STOPP wirkt bei allen.",
  "{name} has asked for control already.": "{name} hat schon um die Kontrolle gebeten.",
  "Wait for the answer to it.": "Warten Sie die Antwort ab.",
  "Ask for it first.": "Bitten Sie zuerst darum.",
  "{name} has been asked and may still answer.": "{name} wurde gebeten und kann noch antworten.",
  "Wait for {waits} s more.": "Warten Sie noch {waits} s.",
  "You have no control of the robot.": "Sie haben keine Kontrolle über den Roboter.",
  "Look at who has it.": "Sehen Sie, wer sie hat.",

  // Where the robot is
  "That is little: the robot is elsewhere, or looks another way. Press again, nearer to it.":
    "Das ist wenig: Der Roboter ist woanders oder blickt anders. Drücken Sie erneut, näher an ihm.",
  "There is no map to compare the scan with.":
    "Es gibt keine Karte, mit der der Scan vergleichbar wäre.",
  "There is no laser scan to compare with the map.":
    "Es gibt keinen Laserscan, der mit der Karte vergleichbar wäre.",
  "The robot does not say where it is.": "Der Roboter sagt nicht, wo er ist.",
  "Too little of what the robot sees is on the map to compare them.":
    "Zu wenig von dem, was der Roboter sieht, ist auf der Karte.",
  "This place is outside the map.": "Dieser Ort liegt außerhalb der Karte.",
  "This place is inside an obstacle of the map.": "Dieser Ort liegt in einem Hindernis der Karte.",
  "Choose one on the map.": "Wählen Sie einen auf der Karte.",
  "Choose one that is free.": "Wählen Sie einen freien.",
  "The robot is on its way to a goal.": "Der Roboter ist unterwegs zu einem Ziel.",
  "Cancel the goal, then set its place.": "Brechen Sie das Ziel ab, dann setzen Sie seinen Ort.",
  "The robot moves.": "Der Roboter fährt.",
  "Set its place when it stands.": "Setzen Sie seinen Ort, wenn er steht.",

  // Places, zones, missions
  "Set at least three corners.": "Setzen Sie mindestens drei Ecken.",
  "The robot has no map, and places are of a map.":
    "Der Roboter hat keine Karte, und Orte gehören zu einer Karte.",
  "Load a map, then try again.": "Laden Sie eine Karte, dann versuchen Sie es erneut.",
  "Where the robot stands is not known now.": "Wo der Roboter steht, ist gerade nicht bekannt.",
  "Check its localization, or save a point of the map.":
    "Prüfen Sie seine Lokalisierung, oder speichern Sie einen Punkt der Karte.",
  "Look at the list of places as it is now, and try again.":
    "Sehen Sie die Liste der Orte an, wie sie jetzt ist, und versuchen Sie es erneut.",
  "Look at the list of zones as it is now, and try again.":
    "Sehen Sie die Liste der Zonen an, wie sie jetzt ist, und versuchen Sie es erneut.",
  "Look at the missions as they are now, and try again.":
    "Sehen Sie die Aufträge an, wie sie jetzt sind, und versuchen Sie es erneut.",
  "Nobody keeps places on this robot: its monitor has not told of any.":
    "Niemand verwahrt auf diesem Roboter Orte: Sein Monitor hat keine gemeldet.",
  "Nobody keeps zones on this robot: its monitor has not told of any.":
    "Niemand verwahrt auf diesem Roboter Zonen: Sein Monitor hat keine gemeldet.",
  "Nobody keeps missions on this robot: its monitor has not told of any.":
    "Niemand verwahrt auf diesem Roboter Aufträge: Sein Monitor hat keine gemeldet.",
  "The line is empty.": "Die Zeile ist leer.",
  "Write what the log shall say.": "Schreiben Sie, was im Protokoll stehen soll.",
  "The alarm has no name.": "Der Alarm hat keinen Namen.",
  "Name it.": "Geben Sie ihm einen.",
  "No mission is chosen.": "Es ist kein Auftrag gewählt.",
  "Choose which one.": "Wählen Sie einen.",
  "No parameter is chosen.": "Es ist kein Parameter gewählt.",
  "Choose which one to set, and to what.": "Wählen Sie, welcher zu setzen ist und worauf.",
  "STOP was pressed here, as the mission says.":
    "Hier wurde STOPP gedrückt, wie der Auftrag es will.",
  "mission {name}": "Auftrag {name}",
  "somebody at {address}": "jemandem an {address}",
  "The goal {at} is inside the keep-out zone {name}.":
    "Das Ziel {at} liegt in der Sperrzone {name}.",
  "The goal {at} is too close to the keep-out zone {name}.":
    "Das Ziel {at} liegt zu nahe an der Sperrzone {name}.",
  "The robot is inside the keep-out zone {name}; drive it away by hand.":
    "Der Roboter steht in der Sperrzone {name}; fahren Sie ihn von Hand hinaus.",
  "The robot is too close to the keep-out zone {name}; drive it away by hand.":
    "Der Roboter steht zu nahe an der Sperrzone {name}; fahren Sie ihn von Hand weg.",
  "No place was reached in a whole round.": "In einer ganzen Runde wurde kein Ort erreicht.",

  // The timeline; of two that fit, the first counts
  "{what} saved: {name}": "{what} gespeichert: {name}",
  "{what} changed: {name}": "{what} geändert: {name}",
  "{what} deleted: {name}": "{what} gelöscht: {name}",
  "{what} restored: {name}": "{what} wiederhergestellt: {name}",
  "it comes {late} s after its stamp (a slow way, or clocks that differ)":
    "{late} s nach dem Stempel (ein langer Weg, oder Uhren, die voneinander abweichen)",
  "Held: a scanner or camera is silent": "Angehalten: ein Scanner oder eine Kamera schweigt",
  "Held: no fresh odometry arrives": "Angehalten: es kommt keine frische Odometrie",
  "Held: its place is not known": "Angehalten: sein Ort ist nicht bekannt",
  "Held: somebody else commands the base": "Angehalten: jemand anders steuert das Fahrwerk",
  "Held: told to turn on the spot, which steered wheels cannot":
    "Angehalten: soll auf der Stelle drehen, was gelenkte Räder nicht können",
  "Held: an obstacle": "Angehalten: ein Hindernis",
  "Held: a keep-out zone": "Angehalten: eine Sperrzone",
  STOP: "STOPP",
  "Driven by hand": "Von Hand gefahren",
  Failed: "Ausgefallen",
  "Finds no solution": "Findet keine Lösung",
  "Waits for {what}": "Wartet auf {what}",
  Done: "Erledigt",
  Cancelled: "Abgebrochen",
  "Cancelled by {name}": "Abgebrochen von {name}",
  "Ended with its rule: {name}": "Mit seiner Regel beendet: {name}",
  "Acknowledged: {name}": "Bestätigt: {name}",
  "Shelved: {name}": "Zurückgestellt: {name}",
  "Shown again: {name}": "Wieder gezeigt: {name}",
  "the process was killed by {signal}": "der Prozess wurde durch {signal} beendet",
  "the process was stopped by a signal": "der Prozess wurde durch ein Signal angehalten",
  "no sign of life for {seconds} s": "kein Lebenszeichen seit {seconds} s",
  "its loop has not come round for {seconds} s": "seine Schleife steht seit {seconds} s",
  "Whoever pursued it was lost, and the goal with it.":
    "Wer es verfolgte, ist ausgefallen, und mit ihm das Ziel.",
  "Mission {name} waits for a person": "Auftrag {name} wartet auf jemanden",
  "Mission {name} paused": "Auftrag {name} pausiert",
  "Mission {name}": "Auftrag {name}",
  "Goal {x}, {y}": "Ziel {x} | {y}",
  "Revision {number} confirmed": "Revision {number} bestätigt",
  "Revision {number} in force, the rules of revision {other}":
    "Revision {number} in Kraft, die Regeln von Revision {other}",
  "taken back": "zurückgenommen",
  "Revision {number} in force": "Revision {number} in Kraft",
  Place: "Ort",
  Zone: "Zone",
  Mission: "Auftrag",
  Died: "Abgestürzt",
  Hangs: "Hängt",
  "Died too often, and is not started again": "Zu oft abgestürzt, kein neuer Start",
  "It had died, or was asked to start anew.": "Es war abgestürzt oder sollte neu starten.",
  "Started again": "Neu gestartet",
  "Started again.": "Neu gestartet.",
  "Goes on without a new start.": "Läuft ohne Neustart weiter.",
  "Monitor started": "Monitor gestartet",
  "Monitor ended": "Monitor beendet",
  "Sent the robot to ({at})": "Roboter geschickt nach {at}",
  "Sent the robot to {place}": "Roboter geschickt nach {place}",
  "Cancelled the goal": "Ziel abgebrochen",
  "Set the robot's place to ({at})": "Ort des Roboters gesetzt auf {at}",
  "Skipped a step of the mission": "Schritt des Auftrags übersprungen",
  "Confirmed the mission": "Auftrag bestätigt",
  "Resumed the mission": "Auftrag fortgesetzt",
  "Released STOP": "Stopp freigegeben",
  "Took control: {reason}": "Kontrolle übernommen: {reason}",
  "Took control": "Kontrolle übernommen",

  // The scene
  "The scene is not connected.": "Die Szene ist nicht verbunden.",
  "Wait until it is drawn again, then repeat.":
    "Warten Sie, bis sie wieder gezeichnet ist, dann wiederholen Sie es.",

  // A STOP that was kept over a restart
  "{why} (pressed {when}, before this start)": "{why} (gedrückt {when}, vor diesem Start)",
  "no reason given": "ohne Angabe von Gründen",

  // Further layers and cameras
  "{most} further layers are drawn on all pages; switch one off.":
    "{most} weitere Ebenen werden auf allen Seiten gezeichnet; schalten Sie eine aus.",
  "Its frame {frame} is not connected to {scene}: no transform says where it is.":
    "Sein Bezugssystem {frame} hängt nicht mit {scene} zusammen: Keine Transformation sagt, wo es ist.",
  "It comes faster than it can be read: some messages are left out.":
    "Es kommt schneller, als es gelesen werden kann: Manche Nachrichten fehlen.",
  "One in {step} of {all} points is drawn.": "Jeder {step}. von {all} Punkten wird gezeichnet.",
  "{some} of {all} points are drawn.": "{some} von {all} Punkten werden gezeichnet.",
  "It is drawn {coarser} times as coarse as it is.":
    "Es wird {coarser}-mal so grob gezeichnet, wie es ist.",
  "Of {all} areas the first {most} are drawn.":
    "Von {all} Flächen werden die ersten {most} gezeichnet.",
  "Not drawn: {why}.": "Nicht gezeichnet: {why}.",
  "The picture is not shown: {why}.": "Das Bild wird nicht gezeigt: {why}.",
  "it is {width} × {height} pixels: there is nothing to be seen":
    "es hat {width} × {height} Pixel: Da ist nichts zu sehen",
  "{topic} shows no pictures now; choose another camera.":
    "{topic} zeigt gerade keine Bilder; wählen Sie eine andere Kamera.",
  "{count} cameras are looked at on all pages; close one, or choose {topic}.":
    "Auf allen Seiten werden {count} Kameras angesehen; schließen Sie eine, oder wählen Sie {topic}.",
} as const;
