/** How the robot is: health, causes, data, battery. */
export const ROBOT = {
  Healthy: "OK",
  "No solution": "Keine Lösung",
  Failed: "Ausgefallen",
  Waits: "Wartet",
  Silent: "Schweigt",
  Dead: "Abgestürzt",
  Stuck: "Hängt",
  "Given up": "Aufgegeben",
  "Restarted {age} ago": "Neustart vor {age}",
  Connecting: "Verbindet",
  "No data for {age}": "Seit {age} keine Daten",
  "No components found": "Keine Komponenten gefunden",
  "{name}, and {others} more": "{name}, und {others} weitere",
  "{n, plural, one {{first} failed} other {# components failed}}":
    "{n, plural, one {{first} ausgefallen} other {# Komponenten ausgefallen}}",
  "{n, plural, one {{first} degraded} other {# components degraded}}":
    "{n, plural, one {{first} eingeschränkt} other {# Komponenten eingeschränkt}}",
  "{n, plural, one {{first} silent} other {# components silent}}":
    "{n, plural, one {{first} schweigt} other {# Komponenten schweigen}}",
  "Position unknown": "Position unbekannt",
  "{alarms, plural, one {One alarm} other {# alarms}}":
    "{alarms, plural, one {Ein Alarm} other {# Alarme}}",
  "Rules silent for {age}": "Regeln schweigen seit {age}",
  "Battery low": "Akku schwach",
  "No faults": "Fehlerfrei",
  "All well": "Alles OK",

  // Causes
  "{label} restarted {age} ago": "{label} vor {age} neu gestartet",
  "{label} died": "{label} abgestürzt",
  "{label} hangs": "{label} hängt",
  "{label} died too often and is not started again": "{label} zu oft abgestürzt, kein neuer Start",
  "It is being started again by itself. If it dies again, look at its log.":
    "Es startet von selbst neu. Stürzt es wieder ab, sehen Sie ins Protokoll.",
  "If it does not come back, it is ended and started again by itself.":
    "Kommt es nicht zurück, wird es von selbst beendet und neu gestartet.",
  "Look at its log for the reason, then start the robot's program anew.":
    "Der Grund steht im Protokoll; starten Sie dann das Programm des Roboters neu.",
  "{label} missing": "{label} fehlt",
  "{label}: nothing received yet": "{label}: noch nichts empfangen",
  "{label} is late": "{label} verspätet",
  "{label} lost": "{label} verloren",
  "{label} lost {age} ago": "{label} seit {age} verloren",
  "its topic": "sein Topic",
  "Check the scanner's power and cable, and the driver that publishes {topic}.":
    "Prüfen Sie Strom und Kabel des Scanners und den Treiber, der {topic} sendet.",
  "Check the base and the localization, which publish {topic}.":
    "Prüfen Sie Fahrwerk und Lokalisierung, die {topic} senden.",
  "Load a map, or start the map server.":
    "Laden Sie eine Karte, oder starten Sie den Kartenserver.",
  "Check the map server.": "Prüfen Sie den Kartenserver.",
  "Check who publishes {topic}.": "Prüfen Sie, wer {topic} sendet.",
  "Robot's program silent": "Programm des Roboters schweigt",
  "Nothing heard of the robot's program for {age}":
    "Seit {age} nichts vom Programm des Roboters gehört",
  "Check that it runs, and the network between it and this console.":
    "Prüfen Sie, ob es läuft, und das Netz bis zu dieser Konsole.",
  "{label} silent": "{label} schweigt",
  "{label} silent for {age}": "{label} schweigt seit {age}",
  "{label} failed": "{label} ausgefallen",
  "{label} finds no solution": "{label} findet keine Lösung",
  "Move what is in the way, or pick another goal.":
    "Räumen Sie weg, was im Weg steht, oder wählen Sie ein anderes Ziel.",
  "{label} is not ready": "{label} nicht bereit",
  "{label} has not heard {what} yet": "{label} hat noch nichts gehört von: {what}",
  "{label}, restarted {age} ago, has not heard {what} yet":
    "{label}, vor {age} neu gestartet, hat noch nichts gehört von: {what}",
  "It is sent, so this should pass by itself; if not, restart this component.":
    "Es wird gesendet und sollte also von selbst kommen; sonst starten Sie diese Komponente neu.",
  "{what} comes too late": "{what} kommt zu spät",
  "Check the network to the machine that sends it, and that machine's clock.":
    "Prüfen Sie das Netz zu dem Rechner, der es sendet, und dessen Uhr.",
  "{label} gets nothing": "{label} bekommt nichts",
  "{label} gets nothing on {what}": "{label} bekommt nichts auf {what}",
  "Place doubtful": "Ort zweifelhaft",
  "robot stopped": "Roboter gestoppt",
  "robot held": "Roboter angehalten",
  "robot slowed to {percent} %": "Roboter auf {percent} % gebremst",
  "{n, plural, one {{list} waits for it} other {{list} wait for it}}":
    "{n, plural, one {{list} wartet darauf} other {{list} warten darauf}}",
  "the {label}": "{label}",
  "Health has the details; if it does not pass, restart this component.":
    "Unter Zustand stehen Einzelheiten; vergeht es nicht, starten Sie diese Komponente neu.",
  "{others} more in Health": "{others} weitere unter Zustand",

  // Health and data
  Health: "Zustand",
  Topics: "Topics",
  Components: "Komponenten",
  Algorithms: "Algorithmen",
  "No message.": "Keine Meldung.",
  Inputs: "Eingänge",
  never: "nie",
  late: "verspätet",
  Topic: "Topic",
  Data: "Daten",
  "Nothing heard yet.": "Noch nichts gehört.",
  "Scan fits map": "Scan passt zur Karte",
  Unknown: "Unbekannt",
  "No component reports its status. Is the stack running on this ROS domain?":
    "Keine Komponente meldet sich. Läuft das Programm des Roboters in dieser ROS-Domain?",
  Process: "Prozess",
  Processes: "Prozesse",
  Takes: "Braucht",
  "{percent} of a core": "{percent} eines Kerns",
  "{bytes} of memory": "{bytes} Speicher",
  Restarts: "Neustarts",
  "last: {reason}": "zuletzt: {reason}",
  Core: "Kern",
  Memory: "Speicher",
  "none found": "keines gefunden",
  Rate: "Takt",
  Deadline: "Frist",
  "none: sent when it changes": "keine: kommt bei Änderung",
  "{deadline} s; older is late": "{deadline} s; danach verspätet",
  "None yet": "Noch keiner",
  "Not received": "Nicht empfangen",
  Lost: "Verloren",
  Late: "Verspätet",

  // States of a process
  active: "läuft",
  busy: "beschäftigt",
  starting: "startet",
  dead: "abgestürzt",
  stuck: "hängt",
  "given up": "aufgegeben",
  unknown: "unbekannt",

  // Battery
  Charging: "Lädt",
  charging: "lädt",
  Battery: "Akku",
  "Battery {charge}": "Akku {charge}",
  "Battery low: {charge}": "Akku schwach: {charge}",
  "as told {age} ago": "Stand vor {age}",
  "Go home": "Nach Hause",
  "Charge it. A place can be made its home, in the place's menu: then this leads there.":
    "Laden Sie ihn. Ein Ort lässt sich in seinem Menü zum Heimplatz machen: Dann führt dies dorthin.",
  "Its home on this map is {name}.": "Sein Heimplatz auf dieser Karte ist {name}.",
} as const;
