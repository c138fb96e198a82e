"""The list of commands. Each entry has the name, the module and one line of help.

The help is also the first line of the command's docstring (a test compares both). The copy here
allows `kinedex --help` to list the commands without importing their modules.
"""

from __future__ import annotations

from app.cli.lazy import CommandEntry

COMMANDS = {
    "serve": CommandEntry(
        "app.cli.serve",
        "serve",
        "Run the API and a worker until you stop them; a process that dies is restarted.",
    ),
    "worker": CommandEntry(
        "app.cli.serve",
        "worker",
        "Do the queued work until you stop it; several workers can share one library.",
    ),
    "demo": CommandEntry(
        "app.cli.demo",
        "demo",
        "Generate the demo library, import it, serve it, and print its address.",
    ),
    "import": CommandEntry(
        "app.cli.library",
        "import_clips",
        "Import a folder (with or without manifest.csv), a ZIP or a file.",
    ),
    "reanalyze": CommandEntry(
        "app.cli.reanalyze", "reanalyze", "Analyze clips again from their stored files."
    ),
    "search": CommandEntry(
        "app.cli.find",
        "search",
        "Find motions that are similar to a file or a stored clip, or motions for words.",
    ),
    "query": CommandEntry(
        "app.cli.query",
        "query",
        "Find motions by several parts together, or say why a clip is a hit of them.",
    ),
    "search-pose": CommandEntry(
        "app.cli.find_pose",
        "search_pose",
        "Find the clips that contain a pose, and the time of the pose in each.",
    ),
    "recognize": CommandEntry(
        "app.cli.find",
        "recognize",
        "Recognize the person and the task of a motion, and describe it with words.",
    ),
    "synthesize": CommandEntry(
        "app.cli.synthesize",
        "synthesize",
        "Synthesize a motion that a person never recorded, as a BVH file, and report its quality.",
    ),
    "clips": CommandEntry("app.cli.clips", "program", "List, show, label and delete stored clips."),
    "edit": CommandEntry(
        "app.cli.edit",
        "edit",
        "Make a new clip from a clip: cut, mirrored, at another rate, in place, or as a loop.",
    ),
    "collections": CommandEntry(
        "app.cli.collections", "program", "Make, fill, show and export collections."
    ),
    "searches": CommandEntry(
        "app.cli.searches", "program", "Save searches, run them again, and see new hits."
    ),
    "labels": CommandEntry(
        "app.cli.labels", "program", "Show and change the tree of tasks and words."
    ),
    "duplicates": CommandEntry(
        "app.cli.duplicates",
        "duplicates",
        "List groups of near-duplicates, each with the clip to keep.",
    ),
    "jobs": CommandEntry(
        "app.cli.jobs", "program", "List, show and cancel work in the background."
    ),
    "status": CommandEntry(
        "app.cli.status",
        "status",
        "Show what the library holds, what waits, the models, and the disk.",
    ),
    "doctor": CommandEntry(
        "app.cli.doctor",
        "doctor",
        "Look for problems of the installation, and say what to do; the exit code is then 1.",
    ),
    "fit": CommandEntry(
        "app.cli.fit",
        "fit",
        "Fit the models on the current library, and show their held-out figures.",
    ),
    "export": CommandEntry(
        "app.cli.export",
        "export",
        "Export clips as BVH, GLB, NPZ, CSV, C3D (Z up) or TRC (for OpenSim).",
    ),
    "annotations": CommandEntry(
        "app.cli.annotations",
        "program",
        "Words and persons for parts of clips, with start and end.",
    ),
    "migrate-to": CommandEntry(
        "app.cli.migrate_to",
        "migrate_to",
        "Copy the library into a PostgreSQL database, and its files to a bucket, while it is in"
        " use.",
    ),
    "backup": CommandEntry(
        "app.cli.backup",
        "backup",
        "Copy the library into a new folder; the library may be in use.",
    ),
    "verify": CommandEntry(
        "app.cli.verify",
        "verify",
        "Check the whole library for damaged or missing data; the exit code is then 1.",
    ),
    "evaluate": CommandEntry(
        "app.cli.evaluate.app", "program", "Measure the methods on your own library."
    ),
    "audit": CommandEntry(
        "app.cli.audit",
        "audit",
        "Show who changed, exported or forgot what, the newest first.",
    ),
    "keys": CommandEntry("app.cli.keys", "program", "Create, list and revoke API keys."),
    "db": CommandEntry(
        "app.cli.db", "program", "Upgrade or restore the database, or connect it to its files."
    ),
}

NEEDS_THIS_MACHINE = frozenset(
    {"serve", "worker", "demo", "reanalyze", "backup", "verify", "evaluate", "keys", "db"}
)
"""Commands that work on a library of this machine, and not with a service elsewhere."""

EVALUATIONS = {
    "retrieval": CommandEntry(
        "app.cli.evaluate.retrieval",
        "retrieval",
        "Search with each clip as the query; clips of the same task are relevant (Sun 2011).",
    ),
    "keyposes": CommandEntry(
        "app.cli.evaluate.keyposes",
        "keyposes",
        "Compare found keyposes with annotated ones (Perera 2009, table 1, figs 3 to 6).",
    ),
    "low-dimensional": CommandEntry(
        "app.cli.evaluate.low_dimensional",
        "low_dimensional",
        "Compare keyposes with uniform poses as basis of low-dimensional motion (Perera 2009).",
    ),
    "symbols": CommandEntry(
        "app.cli.evaluate.symbols",
        "symbols",
        "Measure the errors of the motion symbol space by its dimensions (Takano).",
    ),
    "recognition": CommandEntry(
        "app.cli.evaluate.recognition",
        "recognition",
        "Recognize held-out takes, persons, tasks and sources (Vasilescu; Perera, section 5).",
    ),
    "words": CommandEntry(
        "app.cli.evaluate.words",
        "words",
        "Find words for clips and clips for words, held out and in-sample.",
    ),
    "captions": CommandEntry(
        "app.cli.evaluate.captions",
        "captions",
        "Rank clips by captions that the library does not have, beside chance.",
    ),
}
