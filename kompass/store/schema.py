"""The tables of all files. Each step leads from one version of the schema to the next."""

RULES_ID = 0x6B727331  # "krs1": marks a file as ours
JOURNAL_ID = 0x6B726A31  # "krj1"
PLACES_ID = 0x6B706C31  # "kpl1"
MISSIONS_ID = 0x6B6D6931  # "kmi1"
ZONES_ID = 0x6B7A6F31  # "kzo1"
TIMELINE_ID = 0x6B746C31  # "ktl1"

# Rules are kept once each, by content: a revision is a list of them, so that an edit of one rule
# of a hundred adds one. Nothing in here is ever changed or deleted but pointers and lives.
RULES = (
    """
    CREATE TABLE rules (
        content TEXT PRIMARY KEY,  -- hash of json
        json TEXT NOT NULL
    ) WITHOUT ROWID;
    CREATE TABLE tables (
        content TEXT PRIMARY KEY,  -- hash of rules
        rules TEXT NOT NULL        -- JSON list of contents, in order
    ) WITHOUT ROWID;
    CREATE TABLE revisions (
        number INTEGER PRIMARY KEY AUTOINCREMENT,
        parent INTEGER REFERENCES revisions (number),
        author TEXT NOT NULL,
        role TEXT NOT NULL,
        time REAL NOT NULL,
        reason TEXT NOT NULL,
        origin TEXT NOT NULL,
        content TEXT NOT NULL REFERENCES tables (content),
        table_hash TEXT NOT NULL,
        recipe TEXT NOT NULL,
        restores INTEGER REFERENCES revisions (number),
        diff TEXT NOT NULL
    );
    CREATE INDEX revisions_of_recipe ON revisions (recipe, number);
    CREATE TABLE outcomes (
        revision INTEGER NOT NULL REFERENCES revisions (number),
        outcome TEXT NOT NULL,
        time REAL NOT NULL,
        author TEXT NOT NULL,
        role TEXT NOT NULL
    );
    CREATE INDEX outcomes_of_revision ON outcomes (revision);
    CREATE TABLE pointers (
        recipe TEXT PRIMARY KEY,
        active INTEGER NOT NULL REFERENCES revisions (number),
        confirmed INTEGER REFERENCES revisions (number)
    ) WITHOUT ROWID;
    CREATE TABLE lives (
        id INTEGER PRIMARY KEY,
        epoch TEXT NOT NULL UNIQUE,
        stack TEXT NOT NULL,
        machine TEXT NOT NULL,
        started REAL NOT NULL,
        ended REAL,                -- only of those that ended as they should
        revision INTEGER NOT NULL,
        safe_mode INTEGER NOT NULL
    );
    CREATE TRIGGER revisions_stay BEFORE UPDATE ON revisions
        BEGIN SELECT RAISE (ABORT, 'revisions are never changed'); END;
    CREATE TRIGGER revisions_last BEFORE DELETE ON revisions
        BEGIN SELECT RAISE (ABORT, 'revisions are never deleted'); END;
    CREATE TRIGGER rules_stay BEFORE UPDATE ON rules
        BEGIN SELECT RAISE (ABORT, 'rules are never changed'); END;
    CREATE TRIGGER tables_stay BEFORE UPDATE ON tables
        BEGIN SELECT RAISE (ABORT, 'tables are never changed'); END;
    """,
)

JOURNAL = (
    """
    CREATE TABLE firings (
        number INTEGER PRIMARY KEY,
        epoch TEXT NOT NULL,
        run_id INTEGER NOT NULL,
        rule_id TEXT NOT NULL,
        minor INTEGER NOT NULL,    -- shadows and near misses: bounded apart
        open INTEGER NOT NULL,     -- its actions run
        size INTEGER NOT NULL,     -- bytes of json
        json TEXT NOT NULL
    );
    CREATE INDEX firings_of_rule ON firings (rule_id, number);
    CREATE INDEX firings_of_run ON firings (epoch, run_id);
    CREATE INDEX firings_minor ON firings (minor, number);
    CREATE INDEX firings_open ON firings (open) WHERE open;
    CREATE TABLE counter (reserved INTEGER NOT NULL);
    INSERT INTO counter VALUES (0);
    CREATE TABLE refusals (
        number INTEGER PRIMARY KEY AUTOINCREMENT,
        time REAL NOT NULL,
        author TEXT NOT NULL,
        role TEXT NOT NULL,
        what TEXT NOT NULL,
        text TEXT NOT NULL
    );
    CREATE TABLE used (
        stack TEXT NOT NULL,
        rule_id TEXT NOT NULL,
        rule_hash TEXT NOT NULL,
        time REAL NOT NULL,
        PRIMARY KEY (stack, rule_id, rule_hash)
    ) WITHOUT ROWID;
    """,
)

# A deleted place stays for a while, to be restored; its name is free at once.
PLACES = (
    """
    CREATE TABLE places (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        version INTEGER NOT NULL,
        name TEXT NOT NULL,
        same_name TEXT NOT NULL,
        note TEXT NOT NULL,
        x REAL NOT NULL,
        y REAL NOT NULL,
        yaw REAL,                  -- none: any heading
        map TEXT NOT NULL,         -- digest
        map_label TEXT NOT NULL,
        author TEXT NOT NULL,
        time REAL NOT NULL,
        deleted REAL               -- when; none of those that are there
    );
    CREATE UNIQUE INDEX names_of_map ON places (map, same_name) WHERE deleted IS NULL;
    CREATE TABLE counter (revision INTEGER NOT NULL);
    INSERT INTO counter VALUES (0);
    """,
    """
    ALTER TABLE places ADD COLUMN home INTEGER NOT NULL DEFAULT 0;
    CREATE UNIQUE INDEX home_of_map ON places (map) WHERE home AND deleted IS NULL;
    """,
)

# What a mission is stands in one text: whoever reads a part of it reads the whole.
MISSIONS = (
    """
    CREATE TABLE missions (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        version INTEGER NOT NULL,
        same_name TEXT NOT NULL,
        plan TEXT NOT NULL,        -- JSON: MissionPlan
        author TEXT NOT NULL,
        role TEXT NOT NULL,
        time REAL NOT NULL,
        deleted REAL               -- when; none of those that are there
    );
    CREATE UNIQUE INDEX names ON missions (same_name) WHERE deleted IS NULL;
    CREATE TABLE counter (revision INTEGER NOT NULL);
    INSERT INTO counter VALUES (0);
    CREATE TABLE state (json TEXT NOT NULL);  -- MissionState; at most one row
    """,
)

ZONES = (
    """
    CREATE TABLE zones (
        id INTEGER PRIMARY KEY AUTOINCREMENT,
        version INTEGER NOT NULL,
        same_name TEXT NOT NULL,   -- map and name
        plan TEXT NOT NULL,        -- JSON: ZonePlan
        author TEXT NOT NULL,
        role TEXT NOT NULL,
        time REAL NOT NULL,
        deleted REAL               -- when; none of those that are there
    );
    CREATE UNIQUE INDEX names ON zones (same_name) WHERE deleted IS NULL;
    CREATE TABLE counter (revision INTEGER NOT NULL);
    INSERT INTO counter VALUES (0);
    """,
)

# What is searched has columns of its own; the rest of an entry is in its text.
TIMELINE = (
    """
    CREATE TABLE entries (
        number INTEGER PRIMARY KEY,
        kind TEXT NOT NULL,
        level INTEGER NOT NULL,    -- 0 info … 3 critical
        time REAL NOT NULL,
        ended REAL,                -- none: it lasts, or nobody saw the end
        lasts INTEGER NOT NULL,
        words TEXT NOT NULL,       -- to be searched; lower case
        json TEXT NOT NULL         -- TimelineEntry
    );
    CREATE INDEX entries_of_kind ON entries (kind, number);
    CREATE INDEX entries_by_time ON entries (time);
    CREATE INDEX entries_that_last ON entries (number) WHERE lasts;
    CREATE TABLE shelves (
        alarm TEXT PRIMARY KEY,
        until REAL NOT NULL,
        author TEXT NOT NULL
    ) WITHOUT ROWID;
    """,
)
