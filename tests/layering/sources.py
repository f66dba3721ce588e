"""C++ sources without comments, texts and preprocessor lines; and their blocks."""

import re
import subprocess

TOKEN = re.compile(
    r"//[^\n]*|/\*.*?\*/"
    r'|R"(?P<end>[^()\\ ]{0,16})\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-zA-Z_])'(?:\\.|[^'\\\n])+'"
    r"|^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
GENERATED = re.compile(r"(^|/)generated/")


def listed(root, endings=(".cpp", ".h")):
    """Sources of the project from the root; generated ones are left out."""
    out = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True)
    paths = out.stdout.splitlines() if out.returncode == 0 else \
        [str(path.relative_to(root)) for path in sorted(root.rglob("*")) if "build" not in path.parts]
    return [path for path in paths
            if path.endswith(endings) and not GENERATED.search(path) and (root / path).is_file()]


def bare(text):
    """The text with blanks in place of comments and preprocessor lines, and "" for texts; as many lines."""
    def blank(match):
        found = match.group()
        lines = "\n" * found.count("\n")
        return ('""' if found[0] in "\"'R" else "") + lines
    return TOKEN.sub(blank, text)


def blocks(text):
    """Yields (head, line, last line, enclosing heads) of all blocks of bare text; a line that is None: a statement."""
    heads = []
    start = 0
    line = 1
    begin = None  # line of the head's first letter
    for match in re.finditer(r"[{};\n]|[^\s{};]+", text):
        mark = match.group()
        if mark == "\n":
            line += 1
            continue
        if mark not in "{};":
            begin = begin or line
            continue
        head = text[start:match.start()].strip()
        if mark == "{":
            heads.append((head, begin or line))
        elif mark == "}":
            if not heads:
                raise ValueError(f"line {line}: a brace closes nothing")
            opened, first = heads.pop()
            yield opened, first, line, [each for each, _ in heads]
        elif head:
            yield head, begin, None, [each for each, _ in heads]
        start = match.end()
        begin = None
    if heads:
        raise ValueError(f"line {heads[-1][1]}: a brace is not closed")
