"""CHANGELOG.md in the form of Keep a Changelog (https://keepachangelog.com/en/1.1.0).

    changelog_test.py SOURCE VERSION

Headings: `## [Unreleased]`, then `## [VERSION] - DATE`, newest first, the newest that of project(VERSION); in each
the kinds of change of that form. A bullet has at most 25 words.
"""
import datetime
import pathlib
import re
import sys

WORDS = 25
KINDS = ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")


def number(version):
    return tuple(int(part) for part in version.split("."))


def problems_of(text, version):
    """What is wrong with a change log: 'line: what' each."""
    problems, releases, dates = [], [], []
    bullet, start, kind = [], 0, None

    def end_bullet():
        nonlocal bullet
        if len(bullet) > WORDS:
            problems.append(f"{start}: {len(bullet)} words in a bullet, expected at most {WORDS}")
        bullet = []

    lines = text.splitlines()
    if not lines or not lines[0].startswith("# "):
        problems.append("1: expected a title")
    for at, line in enumerate(lines, 1):
        if line.startswith("- "):
            end_bullet()
            bullet, start = line[2:].split(), at
            if kind is None:
                problems.append(f"{at}: a bullet below none of {', '.join(KINDS)}")
        elif line.startswith("  ") and bullet:
            bullet += line.split()
        else:
            end_bullet()
        if line.startswith("## "):
            kind = None
            title = line[3:]
            known = re.fullmatch(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)", title)
            if not releases and not known and title == "[Unreleased]":
                releases.append(title)
            elif known and releases:
                releases.append(known[1])
                try:
                    dates.append(datetime.date.fromisoformat(known[2]))
                except ValueError:
                    problems.append(f"{at}: {known[2]} is no date")
            else:
                problems.append(f"{at}: '{title}', expected [Unreleased] first, then [VERSION] - YEAR-MONTH-DAY")
        elif line.startswith("### "):
            kind = line[4:]
            if kind not in KINDS:
                problems.append(f"{at}: '{kind}', expected {', '.join(KINDS)}")
        elif re.match(r"\s+- |\* |#{4}", line):
            problems.append(f"{at}: expected bullets of one level and no deeper headings")
    end_bullet()
    versions = releases[1:]
    if not versions or versions[0] != version:
        problems.append(f"the newest release is {versions[0] if versions else 'missing'}, and project(VERSION) {version}")
    if versions != sorted(versions, key=number, reverse=True) or dates != sorted(dates, reverse=True):
        problems.append("expected the newest release first")
    return problems


GOOD = """# Changes

## [Unreleased]

## [0.2.0] - 2027-01-02

### Fixed

- One.
  Two.

## [0.1.0] - 2026-12-01

### Added

- Three.
"""
# replacements that make it wrong
BAD = (("## [Unreleased]\n\n", ""), ("### Fixed", "### Repaired"), ("[0.2.0] - 2027-01-02", "[0.2.0]"), ("0.2.0", "0.0.9"),
       ("2027-01-02", "2027-13-02"), ("2027-01-02", "2025-01-02"), ("- One.", "- " + "One " * WORDS), ("### Added\n", ""))


def main():
    source, version = sys.argv[1:]
    assert not problems_of(GOOD, "0.2.0")
    for old, new in BAD:
        assert problems_of(GOOD.replace(old, new), "0.0.9" if new == "0.0.9" else "0.2.0"), f"not noticed: {old} as {new}"
    assert problems_of(GOOD, "0.3.0")
    found = problems_of((pathlib.Path(source) / "CHANGELOG.md").read_text(encoding="utf-8"), version)
    print("\n".join("CHANGELOG.md:" + problem for problem in found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
