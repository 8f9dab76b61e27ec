/** Goals, the robot's place, measuring, the wheel, STOP and who has control. */
export const DRIVE = {
  // STOP
  STOP: "STOPP",
  Stop: "Stopp",
  "Stop the robot": "Roboter stoppen",
  "Stopping…": "Stoppt …",
  "Stopping, not confirmed yet. Press to stop again":
    "Stoppt, noch nicht bestätigt. Drücken, um erneut zu stoppen",
  Stopped: "Gestoppt",
  Stopping: "Stoppt",
  "Was stopped": "War gestoppt",
  "Stopped by {by}": "Gestoppt von {by}",
  "Was stopped by {by}": "War gestoppt von {by}",
  "Robot stopped, standstill confirmed. Press to stop again":
    "Roboter gestoppt, Stillstand bestätigt. Drücken, um erneut zu stoppen",
  "Stop the robot. It was stopped when it was last heard of":
    "Roboter stoppen. Als er sich zuletzt meldete, war er gestoppt",
  "Not confirmed": "Unbestätigt",
  "Stop not confirmed. Press to stop again": "Stopp nicht bestätigt. Drücken, um erneut zu stoppen",
  "standstill ✓": "Stillstand ✓",
  "was stopped": "war gestoppt",
  "press again": "erneut drücken",
  "Stop is not confirmed": "Stopp nicht bestätigt",
  "I have looked": "Ich habe nachgesehen",
  "The robot stands, until an operator has logged in and releases it.":
    "Der Roboter steht, bis ein Bediener sich anmeldet und ihn freigibt.",
  "Nothing is heard of the robot now; it stays so until somebody releases it.":
    "Vom Roboter ist gerade nichts zu hören; er bleibt gestoppt, bis ihn jemand freigibt.",
  "Hold to release": "Halten zum Freigeben",
  "Hold to release the stop: press for one second, or hold Enter":
    "Halten zum Freigeben des Stopps: eine Sekunde drücken, oder Enter halten",
  "An operator can release it.": "Ein Bediener kann ihn freigeben.",
  "The robot stays where it is until a person releases it; then resume the mission.":
    "Der Roboter bleibt stehen, bis ihn jemand freigibt; setzen Sie dann den Auftrag fort.",
  "The robot stays where it is until a person releases it; then send it a new goal.":
    "Der Roboter bleibt stehen, bis ihn jemand freigibt; senden Sie ihm dann ein neues Ziel.",
  "Last heard {age} ago; it stays so until somebody releases it.":
    "Zuletzt gehört vor {age}; er bleibt gestoppt, bis ihn jemand freigibt.",
  "The drive manager is silent: nobody confirms that the robot stopped.":
    "Die Fahrsteuerung schweigt: Niemand bestätigt, dass der Roboter steht.",
  "The drive manager has not taken the stop.": "Die Fahrsteuerung hat den Stopp nicht angenommen.",
  "The wheels are blocked but no standstill was measured within 2 s.":
    "Die Räder sind gesperrt, doch binnen 2 s wurde kein Stillstand gemessen.",
  "The console did not answer: STOP is sent again until it does.":
    "Die Konsole hat nicht geantwortet: STOPP wird gesendet, bis sie es tut.",
  "If the robot keeps moving, use the emergency button on it.":
    "Fährt der Roboter weiter, drücken Sie den Notaus an ihm.",
  "Press STOP again; if it keeps moving, use the emergency button on the robot.":
    "Drücken Sie erneut STOPP; fährt er weiter, drücken Sie den Not-Halt am Roboter.",
  "Standstill is no longer confirmed: the odometry reports motion, or is silent.":
    "Der Stillstand ist nicht mehr bestätigt: Die Odometrie meldet Bewegung oder schweigt.",
  "STOP cannot reach the robot from here.": "STOPP erreicht den Roboter von hier aus nicht.",
  "No drive manager was found on the network. Start the stack, or use the robot's own button.":
    "Im Netz ist keine Fahrsteuerung. Starten Sie das Programm des Roboters, oder nutzen Sie seinen eigenen Knopf.",
  "The drive manager was last heard {age} s ago":
    "Die Fahrsteuerung war zuletzt vor {age} s zu hören",
  "{last}. Use the robot's own button; Health says what is wrong.":
    "{last}. Nutzen Sie den Knopf am Roboter; unter Zustand steht, was fehlt.",
  "{last}; the robot was stopped by {by}, and stays so until somebody releases it. Health says what is wrong.":
    "{last}; der Roboter war gestoppt von {by} und bleibt es, bis ihn jemand freigibt. Unter Zustand steht, was fehlt.",
  somebody: "jemandem",

  // Goals
  Goal: "Ziel",
  Go: "Fahren",
  Check: "Prüfen",
  Done: "Fertig",
  Cancel: "Abbrechen",
  "Checking…": "Wird geprüft …",
  "Go to the nearest reachable point": "Zum nächsten erreichbaren Punkt",
  "Save this place": "Diesen Ort speichern",
  "To {name}": "Nach {name}",
  "The nearest reachable point is {distance} from the one you picked.":
    "Der nächste erreichbare Punkt ist {distance} von dem gewählten entfernt.",
  "The running recipe takes points only: the heading is not used.":
    "Das laufende Rezept nimmt nur Punkte: Die Richtung wird nicht verwendet.",
  "The robot is stopped: release the stop first.":
    "Der Roboter ist gestoppt: Geben Sie zuerst den Stopp frei.",
  "{drivenBy} drives by hand: the wheel must be given up first.":
    "{drivenBy} fährt von Hand: Zuerst muss das Steuer abgegeben werden.",
  "Ask for it in the bar at the top.": "Fragen Sie oben in der Leiste danach.",
  "Ask for it in the bar at the top, or take it there and say why.":
    "Fragen Sie oben in der Leiste danach, oder übernehmen Sie sie dort mit einer Begründung.",
  "Take it in the bar at the top.": "Übernehmen Sie sie oben in der Leiste.",
  "Replaces the goal that the robot is driving to.": "Ersetzt das Ziel, zu dem der Roboter fährt.",
  "by {by}": "von {by}",
  "Cancel goal": "Ziel abbrechen",
  "Hide this goal": "Dieses Ziel ausblenden",
  "Send again": "Erneut senden",
  "Type coordinates": "Koordinaten eingeben",
  "Goal coordinates": "Koordinaten des Ziels",
  "Coordinates of the robot": "Koordinaten des Roboters",
  "Heading (°)": "Richtung (°)",
  "Needed: a number of metres": "Nötig: eine Zahl in Metern",
  "Needed: a number of feet": "Nötig: eine Zahl in Fuß",
  "Not a number: {text}": "Keine Zahl: {text}",
  "Tap the floor, or press, drag to the heading and release.":
    "Tippen Sie auf den Boden; oder drücken, in die Richtung ziehen, loslassen.",
  "about {duration}": "etwa {duration}",
  "Clear points": "Punkte löschen",
  Clear: "Frei",
  clear: "frei",
  "{age} ago": "vor {age}",
  "at {time}": "um {time}",
  "{place}, heading {degrees}": "{place}, Richtung {degrees}",
  "{place}, any heading": "{place}, Richtung beliebig",
  "Goal sent": "Ziel gesendet",
  "Sent {duration} ago, not accepted yet": "Vor {duration} gesendet, noch nicht angenommen",
  "Look at the planner's health; cancel the goal or send it again.":
    "Sehen Sie nach dem Zustand des Planers; brechen Sie das Ziel ab, oder senden Sie es erneut.",
  "Goal accepted": "Ziel angenommen",
  Arrived: "Angekommen",
  "Arrived, {off} off": "Angekommen, {off} daneben",
  "The goal failed": "Ziel nicht erreicht",
  "Goal cancelled": "Ziel abgebrochen",
  "Pick another point, or send the goal again.":
    "Wählen Sie einen anderen Punkt, oder senden Sie das Ziel erneut.",
  "{text}. When that is mended, send the goal again.":
    "{text}. Ist das behoben, senden Sie das Ziel erneut.",
  "When STOP is released, send the goal again.":
    "Wenn der Stopp freigegeben ist, senden Sie das Ziel erneut.",
  "That was before {by} stopped the robot.": "Das war, bevor der Roboter von {by} gestoppt wurde.",
  "less than {distance}": "weniger als {distance}",
  "On the way": "Unterwegs",
  "There; turns to its heading": "Dort; dreht in seine Richtung",
  "{distance} left": "noch {distance}",
  "{left}, about {duration}": "{left}, etwa {duration}",
  "Held: {why}": "Angehalten: {why}",
  "Slowed to {percent} %: {why}": "Gebremst auf {percent} %: {why}",
  "an obstacle is close": "ein Hindernis ist nah",
  "a keep-out zone": "eine Sperrzone",
  "a speed zone": "eine Langsamzone",
  "steered wheels turn only while it drives": "gelenkte Räder drehen nur während der Fahrt",
  "it does not know where it is, and there are zones":
    "er weiß nicht, wo er ist, und es gibt Zonen",
  "another program commands it, too": "ein anderes Programm steuert ihn auch",
  "a scanner or camera is silent": "ein Scanner oder eine Kamera schweigt",
  "no fresh odometry arrives": "es kommt keine frische Odometrie",
  "no commands arrive": "es kommen keine Fahrbefehle",

  // Where the robot is
  "Place of the robot": "Ort des Roboters",
  "Comparing…": "Wird verglichen …",
  "Set the best place": "Den besten Ort setzen",
  Set: "Setzen",
  "Set all the same": "Trotzdem setzen",
  "As pressed": "Wie gedrückt",
  "The robot was told": "Dem Roboter mitgeteilt",
  "Scan and map agree {percent} here.": "Scan und Karte stimmen hier zu {percent} überein.",
  "Scan and map agree {percent}": "Scan und Karte stimmen zu {percent} überein",
  "Scan and map agree {figure}": "Scan und Karte stimmen zu {figure} überein",
  "Scan and map agree {figure}.": "Scan und Karte stimmen zu {figure} überein.",
  "Scan and map cannot be compared": "Scan und Karte sind nicht vergleichbar",
  "Press where the robot is, drag to where it looks and release.":
    "Drücken Sie, wo der Roboter ist, ziehen Sie in seine Blickrichtung, lassen Sie los.",
  "{distance} and {degrees}°": "{distance} und {degrees}°",
  "The best place is {by} from the one you pressed.":
    "Der beste Ort liegt {by} von dem gedrückten entfernt.",
  "The best place is {by} from the one you pressed, where they agree {agreement}.":
    "Der beste Ort liegt {by} von dem gedrückten entfernt; dort stimmen sie zu {agreement} überein.",
  "There is no map to compare the scan with.":
    "Es gibt keine Karte, mit der der Scan vergleichbar wäre.",
  "There is no laser scan to compare with the map.":
    "Es gibt keinen Laserscan, der mit der Karte vergleichbar wäre.",
  "The robot does not say where it is.": "Der Roboter sagt nicht, wo er ist.",
  "Too little of what the robot sees is on the map to compare them.":
    "Zu wenig von dem, was der Roboter sieht, ist auf der Karte.",
  "The robot may not be where it thinks, or things around it are not on the map. Set its place: the tool Locate, or O.":
    "Der Roboter ist vielleicht nicht, wo er glaubt, oder was um ihn steht, ist nicht auf der Karte. Setzen Sie seinen Ort: mit dem Werkzeug „Orten“ (O).",

  // Measuring
  "Press two points of the floor, or drag.": "Drücken Sie zwei Punkte am Boden, oder ziehen Sie.",
  "One more point.": "Noch ein Punkt.",
  "Remove last point": "Letzten Punkt entfernen",
  "{length}, to {heading}": "{length}, Richtung {heading}",
  "{length} along {n} points": "{length} über {n} Punkte",
  "{length} the last, to {heading}": "{length} das letzte Stück, Richtung {heading}",
  "{length} straight from the first": "{length} Luftlinie vom ersten",

  // By hand
  "Drive by hand": "Von Hand fahren",
  "You drive": "Sie fahren",
  "Driven by {drivenBy}": "{drivenBy} fährt",
  "Give up": "Abgeben",
  "{askedBy} asks for the wheel.": "{askedBy} bittet um das Steuer.",
  "Hold the stick, W A S D or the arrows. Esc gives up.":
    "Halten Sie den Stick, W A S D oder die Pfeile. Esc gibt ab.",
  "Hold the stick; let go to stand.": "Stick halten; loslassen heißt stehen.",
  "at most {speed}": "höchstens {speed}",
  "Speed limit": "Tempolimit",
  "Hold to go to the left (Q)": "Halten, um nach links zu fahren (Q)",
  "Hold to go to the right (E)": "Halten, um nach rechts zu fahren (E)",
  "Connecting…": "Verbindet …",
  "The drive manager is silent: nobody can drive.":
    "Die Fahrsteuerung schweigt: Niemand kann fahren.",
  "Ask for the wheel, or take it over: the robot stands then.":
    "Bitten Sie um das Steuer, oder übernehmen Sie es: Der Roboter steht dann.",
  "Ask for the wheel; an engineer may take it over.":
    "Bitten Sie um das Steuer; ein Techniker darf es übernehmen.",
  "Taking the wheel ends the goal that the robot drives to.":
    "Wer das Steuer nimmt, beendet das Ziel, zu dem der Roboter fährt.",
  "The robot moves only while you hold the stick or a key.":
    "Der Roboter fährt nur, solange Sie den Stick oder eine Taste halten.",
  "Take the wheel": "Steuer nehmen",
  Ask: "Bitten",
  "Take over": "Übernehmen",
  "Close driving by hand": "Handfahren schließen",
  "Stick: hold it, and push to where the robot is to go. W, A, S, D and the arrows do the same.":
    "Stick: halten und dorthin drücken, wohin der Roboter fahren soll. W, A, S, D und die Pfeile tun dasselbe.",
  "The connection was lost, and the wheel with it. Take it again.":
    "Die Verbindung ist abgerissen, das Steuer mit ihr. Nehmen Sie es erneut.",
  "The drive manager is silent: the robot stands.":
    "Die Fahrsteuerung schweigt: Der Roboter steht.",
  "Stopped: release the stop, then drive.": "Gestoppt: Stopp freigeben, dann fahren.",
  "Its wheels are steered: to turn, push ahead or back, too.":
    "Die Räder sind gelenkt: zum Abbiegen auch vor oder zurück drücken.",
  "Let go first, then drive.": "Erst loslassen, dann fahren.",
  "The hand is not heard: the robot stands.": "Die Hand ist nicht zu hören: Der Roboter steht.",

  // Control
  "You have control": "Sie haben die Kontrolle",
  "{name} has control": "{name} hat die Kontrolle",
  "Another page ({name})": "Eine andere Seite ({name})",
  "You drive this robot. Others look on, may ask you for it, and can always press STOP.":
    "Sie fahren diesen Roboter. Andere sehen zu, können Sie darum bitten und jederzeit STOPP drücken.",
  "Give control up": "Kontrolle abgeben",
  "{text}. STOP works for everybody.": "{text}. STOPP wirkt bei allen.",
  "You have control on another device.": "Sie haben die Kontrolle auf einem anderen Gerät.",
  "Take it here": "Hierher holen",
  "{text}. You can look on, and press STOP.": "{text}. Sie können zusehen und STOPP drücken.",
  "Ask for control": "Um Kontrolle bitten",
  "You have asked for control.": "Sie haben um die Kontrolle gebeten.",
  "{text}, and may answer for {left} s.": "{text} und kann noch {left} s lang antworten.",
  "Nobody has answered.": "Niemand hat geantwortet.",
  "{text}. Take it if you know that nobody is in its way.":
    "{text}. Übernehmen Sie, wenn Sie wissen, dass niemand im Weg ist.",
  "{name} has taken control from you.": "{name} hat Ihnen die Kontrolle genommen.",
  "I know": "Verstanden",
  "{name} asks you for control.": "{name} bittet Sie um die Kontrolle.",
  Keep: "Behalten",
  Give: "Abgeben",
  "What the robot does now goes on, unless you drive it by hand.":
    "Was der Roboter gerade tut, geht weiter; außer Sie fahren ihn von Hand.",
  "Why you take it": "Warum Sie übernehmen",
  "Take control": "Kontrolle übernehmen",
} as const;
