/** The page's frame: log-in, top bar, tools, help, scene, and the widgets of all panels. */
export const FRAME = {
  // Log-in
  Name: "Name",
  Password: "Passwort",
  Token: "Token",
  "From the address that the console printed when it started; the whole address works too.":
    "Aus der Adresse, die die Konsole beim Start ausgibt; die ganze Adresse geht auch.",
  "Open the console": "Konsole öffnen",
  "No account, or no password any more? Whoever looks after the robot gives you one: <c>kompass-console users</c>.":
    "Kein Konto oder Passwort vergessen? Wer den Roboter betreut, gibt Ihnen eines: <c>kompass-console users</c>.",
  "Log in with a token": "Mit Token anmelden",
  "No token at hand? On the robot, look for the line with <c>#token=</c> in the output of <c>kompass-console</c>, or start it again for a new one.":
    "Kein Token zur Hand? Er steht am Roboter in der Ausgabe von <c>kompass-console</c>, in der Zeile mit <c>#token=</c>; ein Neustart gibt einen neuen.",
  "Log in by name": "Mit Namen anmelden",
  "Logged out here only.": "Nur hier abgemeldet.",
  "Your session has ended: it was logged out, unused for long, or the console was started anew. Log in again.":
    "Ihre Sitzung ist beendet: abgemeldet, lange ungenutzt, oder die Konsole wurde neu gestartet. Melden Sie sich erneut an.",

  // Top bar and menu
  Simulation: "Simulation",
  Sim: "Sim",
  silent: "schweigt",
  "Simulated seconds per second": "Simulierte Sekunden je Sekunde",
  "Simulation at {rate}×": "Simulation mit {rate}×",
  "User {user}": "Benutzer {user}",
  "ROS domain {domain}, {middleware}": "ROS-Domain {domain}, {middleware}",
  viewer: "Zuschauer",
  operator: "Bediener",
  engineer: "Techniker",
  "Theme: as the system": "Farben: wie das System",
  "Theme: light": "Farben: hell",
  "Theme: dark": "Farben: dunkel",
  "Language: {name}": "Sprache: {name}",
  "Units: metric (m)": "Einheiten: metrisch (m)",
  "Units: imperial (ft)": "Einheiten: imperial (ft)",
  Notifications: "Benachrichtigungen",
  "Logged out elsewhere": "Anderswo abgemeldet",
  "Log out elsewhere": "Anderswo abmelden",
  "Log out": "Abmelden",

  // Tools
  Tools: "Werkzeuge",
  Drive: "Lenken",
  Locate: "Orten",
  Measure: "Messen",
  Follow: "Folgen",
  "Top view": "Oben",
  Rules: "Regeln",
  Timeline: "Verlauf",
  Help: "Hilfe",
  "Menus and lists": "Menüs und Listen",
  Layers: "Ebenen",
  "Go back to the robot first": "Kehren Sie zuerst zum Roboter zurück",
  "Viewers watch; an operator sends goals": "Zuschauer sehen zu; Ziele sendet ein Bediener",
  "Send the robot somewhere (G)": "Den Roboter irgendwohin schicken (G)",
  "Viewers watch; an operator drives": "Zuschauer sehen zu; es fährt ein Bediener",
  "Drive by hand (D)": "Von Hand fahren (D)",
  "Viewers watch; an operator says where the robot is":
    "Zuschauer sehen zu; wo der Roboter ist, sagt ein Bediener",
  "Say where the robot is (O)": "Sagen, wo der Roboter ist (O)",
  "How far it is from one point to another (M)": "Wie weit es von Punkt zu Punkt ist (M)",
  "Keep the robot in the middle (F)": "Den Roboter in der Mitte halten (F)",
  "A flat map is seen from above": "Eine flache Karte zeigt alles von oben",
  "Look straight down (T)": "Senkrecht von oben (T)",
  "What the robot does when something happens (R)": "Was der Roboter tut, wenn etwas geschieht (R)",
  "What has happened (E)": "Was geschehen ist (E)",
  "Keys and gestures (?)": "Tasten und Gesten (?)",
  "What the scene shows (L)": "Was die Szene zeigt (L)",

  // Help
  "Keys and gestures": "Tasten und Gesten",
  "Close help": "Hilfe schließen",
  Space: "Leertaste",
  Ctrl: "Strg",
  "Ctrl Space": "Strg + Leertaste",
  "Stop the robot, wherever you are not writing text":
    "Roboter stoppen, wo Sie keinen Text schreiben",
  "Stop the robot, in a text field, too, where Space is a blank":
    "Roboter stoppen, auch im Textfeld, wo die Leertaste ein Leerzeichen ist",
  "Goal tool on or off": "Ziel ein oder aus",
  "Locate tool on or off: say where the robot is": "Orten ein oder aus: sagen, wo der Roboter ist",
  "Measure tool on or off: how far it is": "Messen ein oder aus: wie weit es ist",
  "Go or Set, when the card shows it": "Fahren oder Setzen, wenn das Kärtchen es zeigt",
  "Drop the goal, place or points, then leave the tool":
    "Ziel, Ort oder Punkte verwerfen, dann das Werkzeug verlassen",
  "Drive by hand: the panel; with the wheel W A S D or the arrows, Esc gives it up":
    "Von Hand fahren: das Feld; mit dem Steuer W A S D oder die Pfeile, Esc gibt es ab",
  "Follow the robot": "Dem Roboter folgen",
  "Timeline: what has happened": "Verlauf: was geschehen ist",
  "This help": "Diese Hilfe",
  "Tap, goal tool on": "Tippen, mit Ziel",
  "A point; the robot chooses its heading": "Ein Punkt; die Richtung wählt der Roboter",
  "Press, drag, release": "Drücken, ziehen, loslassen",
  "A point with the heading of the drag": "Ein Punkt mit der gezogenen Richtung",
  "The same, Locate tool on": "Dasselbe, mit dem Werkzeug „Orten“",
  "Where the robot is, and which way it looks": "Wo der Roboter ist und wohin er blickt",
  "Taps, Measure tool on": "Mehrmals tippen, mit Messen",
  "How far it is from one to the next": "Wie weit es von einem zum nächsten ist",
  "Drag the scene": "Szene ziehen",
  "Turn; right button or two fingers move it": "Drehen; rechte Taste oder zwei Finger verschieben",
  "Wheel or pinch": "Mausrad oder zwei Finger spreizen",
  "Nearer and farther": "Näher und weiter",
  "Hold the stick": "Stick halten",
  "Drive; the robot stands when you let go": "Fahren; beim Loslassen steht der Roboter",
  "Hold the release": "Freigeben halten",
  "One second, or hold Enter on it": "Eine Sekunde, oder Enter darauf halten",

  // Scene
  "Opening the scene…": "Szene wird geöffnet …",
  "3D scene: map, robot and paths": "3D-Szene: Karte, Roboter und Wege",
  "Map from above: robot, path and laser scan": "Karte von oben: Roboter, Weg und Laserscan",
  Larger: "Größer",
  Smaller: "Kleiner",
  "Whole map": "Ganze Karte",
  "This browser does not draw in three dimensions here (no WebGL): the map is flat.":
    "Dieser Browser zeichnet hier nicht räumlich (kein WebGL): Die Karte ist flach.",
  "The map's picture does not come; it is asked for again.":
    "Das Bild der Karte kommt nicht; es wird erneut angefragt.",
  "Flat map, for weak devices": "Flache Karte, für schwache Geräte",
  Map: "Karte",
  "Local map": "Nahkarte",
  Path: "Weg",
  "Laser scan": "Laserscan",
  Trail: "Spur",
  "Playing a drill: the robot itself is not shown.":
    "Eine Übung läuft ab: Der Roboter selbst ist nicht zu sehen.",
  "Back to the robot": "Zurück zum Roboter",
  "Nothing here drives it, and STOP stops it as always.":
    "Nichts hier fährt ihn, und STOPP stoppt ihn wie immer.",
  Proposed: "Vorschlag",
  "In force": "In Kraft",

  // Frame
  Robot: "Roboter",
  "Rules and goal": "Regeln und Ziel",
  "Places, missions or zones": "Orte, Aufträge oder Zonen",
  Live: "Live",
  "No data": "Keine Daten",
  Disconnected: "Getrennt",
  "scan {age}": "Scan {age}",
  "{viewers, plural, one {only you watch} other {# pages watch}}":
    "{viewers, plural, one {nur Sie sehen zu} other {# Seiten sehen zu}}",
  "map fit {figure}": "Karte passt {figure}",
  "position unknown": "Position unbekannt",
  "{age} old": "{age} alt",
  "The console is {version} now": "Die Konsole ist jetzt {version}",
  Reload: "Neu laden",
  "This page is of {from}: reload it when you can look away for a moment.":
    "Diese Seite ist von {from}: Laden Sie sie neu, wenn Sie kurz wegsehen können.",
  "Look at the robot's disk. STOP and all else work as usual.":
    "Sehen Sie nach der Festplatte des Roboters. STOPP und alles andere wirken wie immer.",
  "Whoever is told by it hears nothing of this robot. STOP and all else work as usual.":
    "Wer darüber benachrichtigt wird, hört nichts von diesem Roboter. STOPP und alles andere wirken wie immer.",
  "Waiting for the robot: no data for {since}.":
    "Wartet auf den Roboter: seit {since} keine Daten.",
  "Waiting for the robot: no data for {since}, connecting…":
    "Wartet auf den Roboter: seit {since} keine Daten, verbindet …",
  "View is frozen: no data from the robot for {since}.":
    "Die Ansicht steht: seit {since} keine Daten vom Roboter.",
  "View is frozen: no data from the robot for {since}, reconnecting…":
    "Die Ansicht steht: seit {since} keine Daten vom Roboter, verbindet neu …",
  "The robot may have moved. STOP still tries to reach it.":
    "Der Roboter ist vielleicht weitergefahren. STOPP versucht weiter, ihn zu erreichen.",
  "This part of the page has failed: {why}.": "Dieser Teil der Seite hat versagt: {why}.",
  "Show it again": "Wieder anzeigen",
  "The page has failed": "Die Seite hat versagt",
  "The robot goes on with what it does. STOP works.":
    "Der Roboter macht weiter, was er tut. STOPP geht.",
  "Reload the page": "Seite neu laden",
  "Position unknown: no odometry received yet.": "Position unbekannt: noch keine Odometrie.",
  "Position is {age} old.": "Die Position ist {age} alt.",
  "The robot may be elsewhere; check its odometry.":
    "Der Roboter ist vielleicht woanders; prüfen Sie seine Odometrie.",

  // Widgets
  "{several} and {last}": "{several} und {last}",
  "It stays {value}.": "Es bleibt bei {value}.",
  "Write it as 2.5 s, 5 min or 1 h.": "Schreiben Sie es als 2.5 s, 5 min oder 1 h.",
  "At least {value}.": "Mindestens {value}.",
  "At most {value}.": "Höchstens {value}.",
  "Fewer messages": "Weniger Meldungen",
  "{more, plural, one {One more message} other {# more messages}}":
    "{more, plural, one {Eine weitere Meldung} other {# weitere Meldungen}}",
} as const;
