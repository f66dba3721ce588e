"""What the generators share: their command line, and writing or comparing what they make."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def run(script, arguments, make, errors, source):
    """Writes the files that make() returns as {path from the root: text}, or with --check compares them.

    script and source are the names of the generator and of what it reads, for messages; errors are the exceptions that
    mean that the source contradicts itself. Returns the exit status: 0, 1 for a file that differs or a bad source, or 2.
    """
    if arguments not in ([], ["--check"]):
        print(f"usage: {script} [--check]", file=sys.stderr)
        return 2
    try:
        texts = make()
    except errors as error:
        print(f"{source}: {error}", file=sys.stderr)
        return 1
    if not arguments:
        for name, text in texts.items():
            write(ROOT / name, text)
        return 0
    stale = [name for name, text in texts.items() if text_of(ROOT / name) != text]
    for name in stale:
        print(f"{name} is not what schemas/{script} makes: run it", file=sys.stderr)
    return 1 if stale else 0


def write(path, text):
    """Writes a file unless it holds the text already: what depends on it is then not built again."""
    if text_of(path) != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")


def text_of(path):
    """The text of a file; None where there is none."""
    return path.read_bytes().decode("utf-8") if path.exists() else None
