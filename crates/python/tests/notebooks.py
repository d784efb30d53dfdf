"""Executes notebooks in their folder; what they assert must hold, and outputs are not kept in the source tree."""

from __future__ import annotations

import json
import pathlib
import sys
import time

import nbformat
from nbclient import NotebookClient


def check(path: pathlib.Path) -> None:
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code" and (cell["outputs"] or cell["execution_count"] is not None):
            sys.exit(f"{path}: holds outputs; clear them before it is committed")
    notebook = nbformat.read(path, as_version=4)
    begin = time.monotonic()
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(path.parent)}}).execute()
    print(f"{path}: {len(notebook.cells)} cells, {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        check(pathlib.Path(name))
