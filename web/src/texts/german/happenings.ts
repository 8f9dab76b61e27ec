/** What happens: bands, alarms, firings, notifications, timeline, log. */
export const HAPPENINGS = {
  // Alarms
  "Alarm: {name}": "Alarm: {name}",
  Acknowledge: "Bestätigen",
  Shelve: "Zurückstellen",
  "for 15 minutes": "für 15 Minuten",
  "for an hour": "für eine Stunde",
  "for 8 hours": "für 8 Stunden",
  "Show again": "Wieder zeigen",
  "{n, plural, one {One alarm is shelved} other {# alarms are shelved}}":
    "{n, plural, one {Ein Alarm ist zurückgestellt} other {# Alarme sind zurückgestellt}}",
  Hide: "Ausblenden",
  Look: "Ansehen",
  "Acknowledged by {by}": "Bestätigt von {by}",
  "Shelved by {by}, for {left} more": "Zurückgestellt von {by}, noch {left}",
  'Raised by "{name}"': "Ausgelöst von „{name}“",
  "{count} times": "{count}-mal",
  "{count} times in {duration}": "{count}-mal in {duration}",

  // Probation, revisions
  Understood: "Verstanden",
  "Revision {revision} is on probation: {left} left.":
    "Revision {revision} ist auf Probe: noch {left}.",
  "Take it back": "Zurücknehmen",
  "Keep it": "Behalten",
  "Unless it is kept, the robot goes back to revision {confirmed} by itself.":
    "Wird sie nicht behalten, kehrt der Roboter von selbst zu Revision {confirmed} zurück.",
  "The recipe has changed since the rules were edited.":
    "Das Rezept hat sich geändert, seit die Regeln bearbeitet wurden.",
  "Review the merge": "Zusammenführung prüfen",
  "The recipe's rules are in force; the edits of revision {revision} are kept and can be laid over them.":
    "Die Regeln des Rezepts sind in Kraft; die Änderungen von Revision {revision} sind aufgehoben und lassen sich darüberlegen.",
  "probation {left}": "Probe {left}",
  confirmed: "bestätigt",
  "not confirmed": "nicht bestätigt",
  "Open the rules (R)": "Regeln öffnen (R)",
  "rev {revision}": "Rev. {revision}",
  "Unsaved changes": "Ungespeicherte Änderungen",
  "unsaved changes": "ungespeicherte Änderungen",
  "Safe mode: the recipe's own rules are in force.":
    "Abgesicherter Modus: Die Regeln des Rezepts sind in Kraft.",
  "Edits of before are kept. Start the stack without safe mode to have them again.":
    "Frühere Änderungen sind aufgehoben. Starten Sie ohne abgesicherten Modus, um sie wieder zu haben.",
  "Try again": "Erneut versuchen",
  "Somebody changed the rules: revision {revision} is in force.":
    "Jemand hat die Regeln geändert: Revision {revision} ist in Kraft.",
  Compare: "Vergleichen",
  "Your changes began from revision {base}. Nothing you typed is lost.":
    "Ihre Änderungen gehen von Revision {base} aus. Nichts davon ist verloren.",
  "This browser cannot keep your changes over a reload.":
    "Dieser Browser hebt Ihre Änderungen beim Neuladen nicht auf.",
  "Apply them, or allow the page to store data.":
    "Wenden Sie sie an, oder erlauben Sie der Seite, Daten zu speichern.",
  "No word from the rules.": "Keine Nachricht von den Regeln.",
  "Waiting for the console.": "Wartet auf die Konsole.",
  "What you see is as it was before.": "Was Sie sehen, ist der Stand von vorher.",
  "No monitor was found: rules cannot be read.":
    "Kein Monitor gefunden: Die Regeln sind nicht lesbar.",
  "The rules have been silent for {age}.": "Die Regeln schweigen seit {age}.",
  "Start the stack, or wait until it is up.":
    "Starten Sie das Programm des Roboters, oder warten Sie, bis es läuft.",
  "They may be restarting. What you typed stays.":
    "Vielleicht starten sie neu. Was Sie eingegeben haben, bleibt.",
  "Why?": "Warum?",

  // Firings
  Firings: "Auslösungen",
  "No rule has fired yet.": "Noch keine Regel hat ausgelöst.",
  "All firings": "Alle Auslösungen",
  "just now": "gerade eben",
  "shadow: did not act": "Schatten: tat nichts",
  running: "läuft",
  "ok, {took}": "ok, {took}",
  "failed, {took}": "fehlgeschlagen, {took}",
  "near miss": "beinahe",
  outranked: "nachrangig",
  note: "Notiz",
  shadow: "Schatten",

  firings: "Auslösungen",
  failed: "fehlgeschlagen",
  "still running": "läuft noch",
  "near misses": "beinahe",
  notes: "Notizen",
  "Of which rule": "Von welcher Regel",
  "of any rule": "von jeder Regel",
  "Which outcome": "Mit welchem Ausgang",
  "Reading the journal…": "Die Auslösungen werden gelesen …",
  "Nothing has fired yet.": "Noch nichts hat ausgelöst.",
  "Nothing like that lately.": "Nichts dergleichen in letzter Zeit.",

  // Notifications
  "This is how you will be told.": "So werden Sie benachrichtigt.",
  "Close notifications": "Benachrichtigungen schließen",
  "This browser tells you when the robot stops, fails, gives a goal up, or waits for a person.":
    "Dieser Browser meldet, wenn der Roboter stoppt, ausfällt, ein Ziel aufgibt oder auf jemanden wartet.",
  "With a sound": "Mit Ton",
  "With a message, while I look elsewhere": "Mit Meldung, während ich woanders hinsehe",
  "Browsers allow it over https only, or on the robot itself.":
    "Browser erlauben das nur über https oder am Roboter selbst.",
  "This browser refuses it. Allow notifications for this page in its settings, if it has them.":
    "Dieser Browser lehnt ab. Erlauben Sie Benachrichtigungen für diese Seite in seinen Einstellungen, falls er sie hat.",
  "Not during quiet hours": "Nicht während der Ruhezeit",
  from: "von",
  to: "bis",
  "It stays where it is until a person releases STOP.":
    "Er bleibt stehen, bis jemand den Stopp freigibt.",
  "Resume it, or cancel it.": "Setzen Sie ihn fort, oder brechen Sie ihn ab.",
  "A mission did not begin": "Ein Auftrag hat nicht begonnen",
  "{alarms, plural, one {A rule has raised an alarm} other {# alarms are raised}}":
    "{alarms, plural, one {Eine Regel hat Alarm ausgelöst} other {# Alarme sind ausgelöst}}",
  "Look at what it says, above the scene.": "Was er sagt, steht über der Szene.",
  "Probation of revision {revision} has ended": "Probe von Revision {revision} beendet",
  "Rules went back: revision {revision} is in force":
    "Regeln zurückgesetzt: Revision {revision} ist in Kraft",
  "Send it home, or charge it.": "Schicken Sie ihn nach Hause, oder laden Sie ihn.",
  "{askedBy} asks you for control": "{askedBy} bittet Sie um die Kontrolle",
  "Give it or keep it; after 20 s it may be taken.":
    "Geben Sie sie ab, oder behalten Sie sie; nach 20 s darf sie genommen werden.",
  "{by} has taken control from you": "{by} hat Ihnen die Kontrolle genommen",
  "Nothing is heard of the robot": "Vom Roboter ist nichts zu hören",
  "Look at the network, and whether its program runs.":
    "Sehen Sie nach dem Netz, und ob sein Programm läuft.",

  // The sheet of rules, timeline and log
  "Rules and timeline": "Regeln und Verlauf",
  "Close rules and timeline": "Regeln und Verlauf schließen",
  "Close (Esc)": "Schließen (Esc)",
  History: "Versionen",
  Recordings: "Aufnahmen",
  Audit: "Audit",

  // Timeline
  Faults: "Störungen",
  Alarms: "Alarme",
  Alarm: "Alarm",
  Rule: "Regel",
  Goals: "Ziele",
  "By hand": "Von Hand",
  Edits: "Änderungen",
  People: "Personen",
  "A note for the timeline": "Eine Notiz für den Verlauf",
  "Write a note: wheel changed, door stood open…":
    "Notiz schreiben: Rad gewechselt, Tür stand offen …",
  Add: "Hinzufügen",
  "What happened from {since} to {until}: arrows go earlier and later, plus and minus closer and wider":
    "Was von {since} bis {until} geschah: Pfeile gehen früher und später, Plus und Minus näher und weiter",
  "How far back": "Wie weit zurück",
  "1 h": "1 h",
  "8 h": "8 h",
  "24 h": "24 h",
  "7 d": "7 Tage",
  Earlier: "Früher",
  Later: "Später",
  Closer: "Näher",
  Wider: "Weiter",
  "Only what has these words": "Nur, was diese Wörter hat",
  "only with …": "nur mit …",
  "How bad at least": "Mindestens wie schlimm",
  everything: "alles",
  "warnings and worse": "Warnungen und Schlimmeres",
  "errors only": "nur Fehler",
  Export: "Exportieren",
  "Reading the timeline…": "Der Verlauf wird gelesen …",
  "Nothing like that in this time.": "Nichts dergleichen in dieser Zeit.",
  "Nothing happened in this time.": "In dieser Zeit ist nichts geschehen.",
  "What happened": "Was geschah",
  Older: "Ältere",
  "for {duration} by now": "seit {duration}",
  "end not seen": "Ende nicht gesehen",

  // Levels of a log line
  debug: "Debug",
  info: "Info",
  warning: "Warnung",
  error: "Fehler",
  fatal: "fatal",

  // Log
  Log: "Protokoll",
  "The whole log": "Ganzes Protokoll",
  "Log of the robot": "Protokoll des Roboters",
  "without debug": "ohne Debug",
  "Only lines with these words": "Nur Zeilen mit diesen Wörtern",
  "Only of this node": "Nur von diesem Node",
  "all nodes": "alle Nodes",
  "Paused. Nothing has come since.": "Angehalten. Seitdem ist nichts gekommen.",
  "Paused. {n, plural, one {One line has} other {{count} lines have}} come since, of all kinds.":
    "Angehalten. Seitdem {n, plural, one {ist eine Zeile} other {sind {count} Zeilen}} aller Art gekommen.",
  "Reading the log…": "Das Protokoll wird gelesen …",
  "No node of the robot writes a log: nothing publishes on /rosout.":
    "Kein Node des Roboters schreibt ein Protokoll: Auf /rosout sendet niemand.",
  "No node of the robot writes a log.": "Kein Node des Roboters schreibt ein Protokoll.",
  "No line like that.": "Keine solche Zeile.",
  "Nothing was logged since the console was started.":
    "Seit dem Start der Konsole wurde nichts protokolliert.",
  "Older lines are not shown: ask for fewer kinds of them.":
    "Ältere Zeilen werden nicht gezeigt: Grenzen Sie weiter ein.",
  "No warnings, and no errors.": "Keine Warnungen, keine Fehler.",
  "Here one line was left out: they came too fast.": "Hier fehlt eine Zeile: Sie kamen zu schnell.",
  "Here at least {count} lines were left out: they came too fast.":
    "Hier fehlen mindestens {count} Zeilen: Sie kamen zu schnell.",
} as const;
