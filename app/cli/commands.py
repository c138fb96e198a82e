"""The list of commands: the name, the module and one line of help of each.

The help is the first line of the command's docstring (a test compares them). It is written here
too, so that `kinedex --help` does not import what the commands need.
"""

from __future__ import annotations

from app.cli.lazy import CommandPlace

COMMANDS = {
    "serve": CommandPlace(
        "app.cli.serve",
        "serve",
        "Serve the API and do the work, until stopped; each process is restarted if it dies.",
    ),
    "worker": CommandPlace(
        "app.cli.serve",
        "worker",
        "Do the queued work, until stopped; any number of workers share one library.",
    ),
    "demo": CommandPlace(
        "app.cli.demo", "demo", "Make the demo library, ingest it, serve it, and print where."
    ),
    "import": CommandPlace(
        "app.cli.library",
        "import_clips",
        "Import a folder (with or without manifest.csv), a ZIP or a file.",
    ),
    "reanalyze": CommandPlace(
        "app.cli.reanalyze", "reanalyze", "Analyze clips again from their stored files."
    ),
    "search": CommandPlace(
        "app.cli.find",
        "search",
        "Find motions like one (a file or a stored clip), or motions for words.",
    ),
    "search-pose": CommandPlace(
        "app.cli.find_pose", "search_pose", "Find the clips that take a pose, and when they do."
    ),
    "recognize": CommandPlace(
        "app.cli.find", "recognize", "Say who it is, what they do, and in which words."
    ),
    "synthesize": CommandPlace(
        "app.cli.synthesize",
        "synthesize",
        "Make a motion that a person never recorded, as a BVH file, and judge its quality.",
    ),
    "fit": CommandPlace(
        "app.cli.fit",
        "fit",
        "Fit the models on the library as it is now, and show their held-out figures.",
    ),
    "export": CommandPlace(
        "app.cli.export",
        "export",
        "Export clips as BVH, GLB, NPZ, CSV, C3D (Z up) or TRC (for OpenSim).",
    ),
    "backup": CommandPlace(
        "app.cli.backup",
        "backup",
        "Copy the library as it is now, while it is in use, into a new folder.",
    ),
    "verify": CommandPlace(
        "app.cli.verify",
        "verify",
        "Read the whole library and say what is damaged or missing; the exit code is then 1.",
    ),
    "evaluate": CommandPlace("app.cli.evaluate.app", "program", "Figures on your own library."),
    "keys": CommandPlace("app.cli.keys", "program", "API keys."),
    "db": CommandPlace("app.cli.db", "program", "The database."),
}

EVALUATIONS = {
    "retrieval": CommandPlace(
        "app.cli.evaluate.retrieval",
        "retrieval",
        "Each clip is a query; clips with the same task are relevant (Sun 2011).",
    ),
    "keyposes": CommandPlace(
        "app.cli.evaluate.keyposes",
        "keyposes",
        "Keyposes found against those that people named (Perera 2009, table 1, figs 3 to 6).",
    ),
    "low-dimensional": CommandPlace(
        "app.cli.evaluate.low_dimensional",
        "low_dimensional",
        "Motions drawn from few dimensions of keyposes, and of uniform poses (Perera 2009).",
    ),
    "symbols": CommandPlace(
        "app.cli.evaluate.symbols",
        "symbols",
        "How many dimensions motion symbols need, and how well new ones are placed (Takano).",
    ),
    "recognition": CommandPlace(
        "app.cli.evaluate.recognition",
        "recognition",
        "Person and task, held out by take, person, task and source (Vasilescu; Perera, 5).",
    ),
    "words": CommandPlace(
        "app.cli.evaluate.words",
        "words",
        "Words for clips and clips for words, held out and in-sample, and by frequency.",
    ),
}
