#!/usr/bin/env python3
"""Pages are short, begin with an image, can be reached, and their links resolve.

    pages_test.py ROOT

User pages are docs/*.md but the references, the index and accuracy.md, which are generated or lists. A user page has at most 800 words, tables
included. Not counted: fenced code, HTML comments, targets of links, and tables between `<!-- table of FILE -->` and `<!-- end of the table -->`,
which a generator writes. Names of pages in sources (`docs/x.md`) must exist too.
"""
import os
import pathlib
import re
import sys
import tempfile
import unicodedata

MOST_WORDS = 800
NOT_USER_PAGES = {"pxn-reference.md", "pan-format.md", "json-output.md", "server-protocol.md", "accuracy.md", "map.md", "terrain-tiles.md"}
NO_IMAGE = {"versions.md"}
SOURCES = {".h", ".cpp", ".def", ".md", ".toml", ".py", ".glsl", ".pxn", ".txt", ".cmake", ".json", ""}
# not searched for names of pages: history, and the pages of the self-test
OLD = {"CHANGELOG.md", "pages_test.py"}

FENCE = re.compile(r"(?ms)^ *```.*?^ *```[ \t]*$")
COMMENT = re.compile(r"(?s)<!--.*?-->")
TABLE = re.compile(r"(?s)<!-- table of .*?<!-- end of the table -->")
LINK = re.compile(r"\]\(([^()\s]+)\)")
NAMED = re.compile(r"(?<![\w/.-])docs/[\w/-]+\.md\b")


def without_code(text):
    return COMMENT.sub("", FENCE.sub("", TABLE.sub("", text)))


def words(text):
    text = re.sub(r"\]\([^)]*\)", "]", without_code(text))
    return len(re.sub(r"[|]|:?-{3,}:?", " ", text).split())


def anchors(text):
    """Anchors that both GitHub and the site make of the headings."""
    found = set()
    for title in re.findall(r"(?m)^#+ (.*)$", FENCE.sub("", text)):
        title = re.sub(r"\]\([^)]*\)", "]", title).strip()
        github = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        plain = unicodedata.normalize("NFKD", title).encode("ascii", "ignore").decode()
        site = re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower())
        if github == site:
            found.add(site)
    return found


def targets(path, text, root):
    """Files that a page links to or names, with the anchors, as links stand there."""
    text = FENCE.sub("", text)
    for link in LINK.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        yield link, (path.parent / name).resolve() if name else path, anchor
    for name in NAMED.findall(text):
        yield name, root / name, ""


def names_in_sources(root):
    for folder, folders, files in os.walk(root):
        folders[:] = [name for name in folders if name not in (".git", "build", "shared", "generated", "results", "data")]
        for name in files:
            path = pathlib.Path(folder, name)
            if path.suffix in SOURCES and name not in OLD and path.stat().st_size < 1_000_000:
                for page in set(NAMED.findall(path.read_text(encoding="utf-8", errors="replace"))):
                    yield path, page


def problems_of(root):
    root = root.resolve()
    pages = {path: path.read_text(encoding="utf-8") for path in sorted((root / "docs").rglob("*.md"))}
    starts = [root / "README.md", root / "docs/map.md"]
    for path in (*starts, root / "CONTRIBUTING.md"):
        if path.is_file():
            pages[path] = path.read_text(encoding="utf-8")
    out, graph = [], {}
    for path, text in pages.items():
        name = path.relative_to(root)
        if path.parent == root / "docs" and path.name not in NOT_USER_PAGES:
            if words(text) > MOST_WORDS:
                out.append(f"{name}: {words(text)} words, expected at most {MOST_WORDS}: move proofs to docs/accuracy/")
            if path.name not in NO_IMAGE and "![" not in without_code(text).split("\n## ")[0]:
                out.append(f"{name}: no image before the first section")
        graph[path] = set()
        for link, target, anchor in targets(path, text, root):
            graph[path].add(target)
            if not target.exists():
                out.append(f"{name}: no file for {link}")
            elif anchor and target.suffix == ".md" and anchor not in anchors(pages.get(target, "")):
                out.append(f"{name}: no heading for {link}")
    reached, edge = set(), [path for path in starts if path in pages]
    while edge:
        path = edge.pop()
        if path not in reached:
            reached.add(path)
            edge += graph.get(path, ())
    out += [f"{path.relative_to(root)}: not reachable from README.md or docs/map.md"
            for path in pages if (root / "docs") in path.parents and path not in reached]
    out += [f"{path.relative_to(root)}: names {page}, which does not exist"
            for path, page in names_in_sources(root) if path not in pages and not (root / page).is_file()]
    return out


def self_test():
    """Each fault is found, and a page without one is accepted."""
    good = "# A page\n\n![](a.png)\n\n## Next\n\n```sh\n" + "word " * 900 + "\n```\n"
    faults = {
        "words, expected": good + "word " * 893,
        "no image": good.replace("![](a.png)", "").replace("## Next", "## Next\n\n![](a.png)"),
        "no file for b.md": good + "[b](b.md)",
        "no heading for a.md#b": good + "[b](a.md#b)",
        "not reachable": None,
        "which does not exist": "code",
    }
    for fault, text in {"": good + "[a](a.md#next)", **faults}.items():
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "docs").mkdir()
            (root / "docs/a.png").write_bytes(b"")
            (root / "docs/a.md").write_text(text if text and text != "code" else good, encoding="utf-8")
            (root / "README.md").write_text("[a](docs/a.md)" if fault != "not reachable" else "", encoding="utf-8")
            (root / "a.cpp").write_text("// docs/gone.md" if text == "code" else "// docs/a.md", encoding="utf-8")
            found = problems_of(root)
        if len(found) != (1 if fault else 0) or fault not in "".join(found):
            sys.exit(f"self-test: expected '{fault}', found {found}")


if __name__ == "__main__":
    self_test()
    faults = problems_of(pathlib.Path(sys.argv[1]))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)
