"""The table of results: an SQLite file that grows run by run."""

import csv
import datetime
import fcntl
import json
import os
import pathlib
import sqlite3

import numpy as np

from .tables import OWN

FORMAT = "yade-ancf campaign 1"
WAIT = 60  # for a reader that holds the file [s]


class Results:
    """Results of a campaign; `runs` is the table in the file, a row a run:

    run                number, from 1
    ...                its parameters
    finished           when [UTC]; NULL: not yet
    worker             computer and process
    cpuSeconds         what it cost; wall time where the process did not survive it
    error              why it failed; NULL: it did not
    ...                what run() returned; NULL also for nan

    Any program that reads SQLite shows it, also while it grows.
    """

    def __init__(self, path):
        """The results so far in a file. Raises ValueError if it holds none."""
        self.path = pathlib.Path(path)
        if not self.path.is_file():
            raise ValueError(f"{self.path}: there is no such file: give the results of a campaign")
        self._open()
        self._about()

    def _open(self):
        self._data = sqlite3.connect(self.path, timeout=WAIT)

    def _about(self):
        """What the campaign is about. Raises ValueError if the file is something else."""
        try:
            about = dict(self._data.execute("SELECT name, value FROM campaign"))
        except sqlite3.DatabaseError as error:
            raise ValueError(
                f"{self.path}: holds no results of a campaign ({error}): give another file"
            ) from error
        if about.get("format") != FORMAT:
            raise ValueError(
                f"{self.path}: has the format {about.get('format')!r}, this reads {FORMAT!r}: give another file"
            )
        self.parameters = json.loads(about["parameters"])
        return about

    def close(self):
        self._data.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # ---- reading

    @property
    def names(self):
        """Names of all columns."""
        return [row[1] for row in self._data.execute("PRAGMA table_info(runs)")]

    @property
    def results(self):
        """Names of the columns that run() returned."""
        return [n for n in self.names if n not in (*OWN, *self.parameters)]

    def count(self):
        """Numbers of runs: all, those that are finished, and of these the failed ones."""
        return self._data.execute(
            "SELECT COUNT(*), COUNT(finished), COUNT(error) FROM runs"
        ).fetchone()

    def errors(self):
        """{error: number of runs}, the most frequent first."""
        return dict(
            self._data.execute(
                "SELECT error, COUNT(*) AS n FROM runs WHERE error IS NOT NULL GROUP BY error ORDER BY n DESC"
            )
        )

    def columns(self):
        """{name: array} of the runs that were finished without an error, by number; nan where there is
        no number.
        """
        rows = self._data.execute(
            "SELECT * FROM runs WHERE finished IS NOT NULL AND error IS NULL ORDER BY run"
        ).fetchall()
        columns = zip(*rows) if rows else [()] * len(self.names)
        return {name: _array(column) for name, column in zip(self.names, columns)}

    def writeCsv(self, path):
        """Writes the finished runs, the failed ones too, as CSV."""
        rows = self._data.execute("SELECT * FROM runs WHERE finished IS NOT NULL ORDER BY run")
        with open(path, "w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out)
            writer.writerow(self.names)
            writer.writerows(rows)


def _array(column):
    """As numbers where there are only numbers."""
    if any(isinstance(x, str) for x in column):
        return np.array(column, object)
    return np.array([np.nan if x is None else x for x in column])


class Keeper(Results):
    """Results that a campaign adds to: one at a time."""

    def __init__(self, path, scene, digest, table):
        """Opens or makes the file, with a row for each run of the table.

        Raises ValueError if it holds other results, RuntimeError if another campaign is adding to it.
        """
        self.path = pathlib.Path(path)
        if not self.path.parent.is_dir():
            raise ValueError(f"{self.path}: there is no folder {self.path.parent}: make it first")
        self._lock()
        try:
            new = not self.path.exists() or self.path.stat().st_size == 0
            self._open()
            if new:
                self._make(scene, digest, table)
            self._compare(self._about(), scene, digest, table)
            self._extend(table)
        except BaseException:
            self.close()
            raise

    def close(self):
        if hasattr(self, "_data"):
            super().close()
        self._lockFile.unlink(missing_ok=True)
        os.close(self._locked)

    def _lock(self):
        self._lockFile = self.path.with_name(self.path.name + ".lock")
        while True:
            self._locked = os.open(self._lockFile, os.O_CREAT | os.O_RDWR)
            try:
                fcntl.flock(self._locked, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                os.close(self._locked)
                raise RuntimeError(
                    f"{self.path}: another campaign is adding to it: wait for its end, or give another file"
                ) from None
            try:  # it may be one that was taken away in between
                if os.stat(self._lockFile).st_ino == os.fstat(self._locked).st_ino:
                    return
            except FileNotFoundError:
                pass
            os.close(self._locked)

    def _make(self, scene, digest, table):
        about = dict(
            format=FORMAT,
            scene=scene,
            digest=digest,
            parameters=json.dumps(table.names),
            table=table.source,
        )
        own = ("finished TEXT", "worker TEXT", "cpuSeconds REAL", "error TEXT")
        columns = ", ".join(["run INTEGER PRIMARY KEY", *map(_quoted, table.names), *own])
        with self._data:
            self._data.execute("BEGIN")
            self._data.execute(f"CREATE TABLE runs ({columns})")
            self._data.execute("CREATE TABLE campaign (name TEXT PRIMARY KEY, value TEXT)")
            self._data.executemany("INSERT INTO campaign VALUES (?, ?)", about.items())

    def _compare(self, about, scene, digest, table):
        """Refuses to add to what another scene or table has made."""
        other = "give another file for the results; these are kept as they are"
        if pathlib.Path(about["scene"]).name != pathlib.Path(scene).name:
            raise ValueError(
                f"{self.path}: holds results of the scene {about['scene']}, not of {scene}: {other}"
            )
        if about["digest"] != digest:
            raise ValueError(
                f"{self.path}: holds results of {scene} before it was changed: {other}, or undo the change"
            )
        if self.parameters != table.names:
            raise ValueError(
                f"{self.path}: holds results over {', '.join(self.parameters)}, not over "
                f"{', '.join(table.names)} of {table.source}: {other}"
            )
        kept = self._data.execute(
            f"SELECT {self._quotedParameters()} FROM runs ORDER BY run"
        ).fetchall()
        if len(kept) > len(table):
            raise ValueError(
                f"{self.path}: holds {len(kept)} runs of {about['table']}, {table.source} has only "
                f"{len(table)}: {other}"
            )
        for number, (one, two) in enumerate(zip(kept, table.rows), 1):
            if one != two:
                raise ValueError(
                    f"{self.path}: run {number} of {about['table']} has {one}, that of {table.source} "
                    f"{two}: {other}"
                )

    def _quotedParameters(self):
        return ", ".join(map(_quoted, self.parameters)) or "NULL"

    def _extend(self, table):
        """Rows for runs that are not in the file yet."""
        have, _, _ = self.count()
        columns = ", ".join(map(_quoted, ("run", *table.names)))
        marks = ", ".join("?" * (1 + len(table.names)))
        rows = ((number, *row) for number, row in enumerate(table.rows, 1) if number > have)
        with self._data:
            self._data.executemany(f"INSERT INTO runs ({columns}) VALUES ({marks})", rows)

    def forgetFailed(self):
        """Failed runs become unfinished ones."""
        with self._data:
            self._data.execute(
                "UPDATE runs SET finished = NULL, worker = NULL, cpuSeconds = NULL, error = NULL "
                "WHERE error IS NOT NULL"
            )

    def open(self):
        """Numbers of the runs that are not finished."""
        return [
            n
            for (n,) in self._data.execute(
                "SELECT run FROM runs WHERE finished IS NULL ORDER BY run"
            )
        ]

    def keep(self, outcomes):
        """Writes outcomes, (number, outcome) each, once and for all."""
        new = {name for _, outcome in outcomes for name in outcome["results"]}
        have = [name.casefold() for name in self.names]
        with self._data:
            self._data.execute("BEGIN")
            for name in sorted(n for n in new if n.casefold() not in have):
                self._data.execute(f"ALTER TABLE runs ADD COLUMN {_quoted(name)}")
            for number, outcome in outcomes:
                self._write(number, outcome)

    def _write(self, number, outcome):
        now = datetime.datetime.now(datetime.timezone.utc)
        own = {name: outcome[name] for name in ("worker", "cpuSeconds", "error")}
        row = dict(own, finished=now.isoformat(" ", "seconds"), **outcome["results"])
        settings = ", ".join(f"{_quoted(name)} = ?" for name in row)
        self._data.execute(
            f"UPDATE runs SET {settings} WHERE run = ? AND finished IS NULL",
            (*row.values(), number),
        )


def _quoted(name):
    """A name as SQL has it; names of parameters and results are identifiers."""
    return f'"{name}"'
