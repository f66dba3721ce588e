#!/usr/bin/env python3
"""Lays out the pages for mkdocs, and checks what it made.

    site_pages.py FOLDER          writes FOLDER/mkdocs.yml and FOLDER/pages/
    site_pages.py --check SITE    every link and image of SITE leads to a file and a heading of it
"""
import html.parser
import pathlib
import re
import shutil
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
JQUERY = pathlib.Path("/usr/share/javascript/jquery/jquery.min.js")
# title, page; what is not here stands under More or Proofs
NAVIGATION = [
    ("Start", "index.md"),
    ("Map", "map.md"),
    ("Language tour", "language-tour.md"),
    ("Whole models", "language-tour-models.md"),
    ("Language reference", "pxn-reference.md"),
    ("CAD files", "importing.md"),
    ("glTF", "importing-gltf.md"),
    ("Cleaning", "cleaning.md"),
    ("Compiling again", "compiling.md"),
    ("Materials", "choosing-a-material.md"),
    ("Foil", "mli.md"),
    ("Joints", "articulation.md"),
    ("Window", "studio.md"),
    ("Samples", "sampling.md"),
    ("Shadows", "shadows.md"),
    ("Sky", "sky.md"),
    ("The sky of a date", "sky-by-date.md"),
    ("Imposters", "imposters.md"),
    ("Many views", "views.md"),
    ("Scenarios", "scenarios.md"),
    ("Sources of scenarios", "scenario-sources.md"),
    ("Rendezvous", "rendezvous.md"),
    ("Ephemerides", "ephemerides.md"),
    ("Exposures", "exposures.md"),
    ("Cameras", "cameras.md"),
    ("Detectors", "detector.md"),
    ("Data sets", "datasets.md"),
    ("Reference renderer", "reference-renderer.md"),
    ("Accuracy", "accuracy.md"),
    ("Conventions", "conventions.md"),
    ("File format", "pan-format.md"),
    ("Libraries", "using-the-library.md"),
]


def title_of(text):
    found = re.search(r"(?m)^# (.*)$", text)
    return found[1].strip() if found else "Page"


def with_lists(text):
    """Lists and tables directly under a paragraph get the empty line that Python's Markdown wants."""
    out, code = [], False
    for line in text.split("\n"):
        if line.startswith("```"):
            code = not code
        before = out[-1] if out else ""
        item = re.match(r"([-*]|\d+[a-z]?\.) ", line)
        if not code and item and before.strip() and not re.match(r"\s*([-*]|\d+[a-z]?\.) |\s{2,}", before):
            out.append("")
        out.append(line)
    return "\n".join(out)


def lay_out(folder):
    pages = folder / "pages"
    shutil.copytree(ROOT / "docs", pages)
    (pages / "index.md").write_text(re.sub(r"\]\(docs/", "](", (ROOT / "README.md").read_text(encoding="utf-8")),
                                    encoding="utf-8")
    for name, target in (("CHANGELOG.md", "changes.md"), ("CONTRIBUTING.md", "contributing.md")):
        shutil.copy(ROOT / name, pages / target)
    # Debian 12's theme names two scripts that its package has under another name, or not at all
    (pages / "js").mkdir()
    shutil.copy(JQUERY, pages / "js/jquery-3.6.0.min.js")
    (pages / "js/theme_extra.js").write_text("", encoding="utf-8")
    known = {page for _, page in NAVIGATION}
    more, proofs = [], []
    for page in sorted(pages.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        # what lies outside of the site is named and not linked
        up = r"\.\./" * len(page.relative_to(pages).parts)
        text = re.sub(rf"\[([^\]]+)\]\((?:{up}|bench/|examples/|schemas/)[^)]*\)", r"\1", text)
        page.write_text(with_lists(text), encoding="utf-8")
        name = page.relative_to(pages).as_posix()
        if name.startswith("accuracy/"):
            proofs.append((title_of(text), name))
        elif name not in known:
            more.append((title_of(text), name))
    quote = lambda words: '"' + words.replace("\\", "\\\\").replace('"', '\\"') + '"'
    lines = ["site_name: Panwright", "docs_dir: pages", "theme:", "  name: readthedocs", "use_directory_urls: false",
             "plugins:", "  - search", "markdown_extensions:", "  - tables", "  - fenced_code", "  - toc:", "      permalink: true", "nav:"]
    lines += [f"  - {quote(title)}: {page}" for title, page in NAVIGATION if (pages / page).is_file()]
    for group, members in (("More", more), ("Proofs", proofs)):
        lines += [f"  - {group}:"] + [f"    - {quote(title)}: {page}" for title, page in members]
    (folder / "mkdocs.yml").write_text("\n".join(lines) + "\n", encoding="utf-8")


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            if name in ("href", "src") and value:
                self.links.append(value)


def check(site):
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    problems = 0
    for path, page in pages.items():
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc or path.name == "404.html":
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            anchor = urllib.parse.unquote(parts.fragment)
            wrong = not target.is_file() or (anchor and target in pages and anchor not in pages[target].anchors)
            if wrong:
                print(f"site: {path.relative_to(site)} links to {link}, which is not there", file=sys.stderr)
                problems += 1
    if not (site / "search/search_index.json").is_file():
        print("site: there is no search index", file=sys.stderr)
        problems += 1
    return problems


if __name__ == "__main__":
    if sys.argv[1] == "--check":
        sys.exit(1 if check(pathlib.Path(sys.argv[2]).resolve()) else 0)
    lay_out(pathlib.Path(sys.argv[1]))
