"""Holds the XSDs against every shipped pxn and against the bad ones.

xsd_test.py XMLLINT SOURCE_DIR    each file is validated by the schema of its level

Good files must be valid. Of the bad ones, a schema sees what is wrong with elements, attributes and plain numbers; the
list below says which kinds, and the others must be valid, so that an editor never calls right what is wrong or wrong
what is right without this test knowing it.
"""

import pathlib
import re
import subprocess
import sys

# kinds of errors that a schema sees
SEEN = {"E1101", "E1102", "E1103", "E1104", "E1105", "E1106", "E1107", "E1201", "E1202", "E1203", "E1204", "E1212", "E1213"}
# those of these kinds that it does not see, and why
UNSEEN = {
    "E1202-huge",  # a length: its range is in metres, the number in the root's units
    "E1212-area", "E1212-clash", "E1212-count", "E1212-count-sum", "E1212-trigonometry", "E1213-expression",  # expressions are any text in braces
}
# those of other kinds that it sees, and why
OTHERS = set()
# no XML, or more of it than validators read
NOT_READ = {"E1001", "E1002", "E1003", "E1004", "E1005", "E1006", "E1007"}


def level_of(path):
    match = re.search(rb"""<pangu_model[^>]*\bver\s*=\s*["'](\d+)["']""", path.read_bytes())
    return match.group(1).decode() if match else "0"


def valid(xmllint, schemas, path):
    schema = schemas / ("pxn.xsd" if level_of(path) == "1" else "pxn-0.xsd")
    run = subprocess.run([xmllint, "--huge", "--noout", "--schema", schema, path], capture_output=True, check=False)
    if run.returncode not in (0, 3):
        sys.exit(f"{path}: {run.stderr.decode()}")
    return run.returncode == 0, run.stderr.decode()


def main(xmllint, source):
    source = pathlib.Path(source)
    schemas = source / "schemas"
    problems = []
    data = source / "tests" / "pxn" / "data"
    good = sorted([*(source / "examples").rglob("*.pxn"), *(data / "good").rglob("*.pxn")])
    for path in good:
        fine, words = valid(xmllint, schemas, path)
        if not fine:
            problems.append(f"{path.relative_to(source)} should be valid:\n{words}")
    checked = 0
    for path in sorted((data / "bad").glob("*.pxn")):
        name = path.stem
        code = name[:5]
        if code in NOT_READ:
            continue
        checked += 1
        expected = code not in SEEN if name not in UNSEEN and name not in OTHERS else name in UNSEEN
        fine, words = valid(xmllint, schemas, path)
        if fine != expected:
            problems.append(f"{path.relative_to(source)} should {'' if expected else 'not '}be valid\n{words}")
    if len(good) < 10 or checked < 50:
        problems.append(f"only {len(good)} good and {checked} bad files")
    print("\n".join(problems), file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
