#!/usr/bin/env python3
"""Refuses phrases and openings that the project's style forbids: in comments of headers, help texts and diagnostic codes."""

import pathlib
import re
import sys

# Texts under test, by kind; paths are globs from the root.
CHECKED = {
    "headers": ["*/**/*.h"],
    "help": ["tools/command_*.cpp", "tools/posed_model.cpp", "tools/shared_options.cpp"],
    "codes": ["base/diagnostic_codes.def", "tools/explain_examples.def"],
}
SKIPPED = ("build/", "server/clients/")
MOST_WORDS = 25

OPENING = re.compile(r"(what|where|whether|how|which|that|who|whose)\b(?!:| {2,})", re.I)
# of the first line of a header, which is a noun phrase
VERB = re.compile(r"(reads|writes|holds|says|tells|runs|keeps|makes|gives|shows|decides|collects|looks|finds|builds|answers|returns)\b", re.I)
# words that no text uses; of vocabulary, those of the right column that have no other meaning
BANNED = [re.compile(pattern, re.I) for pattern in (
    r"\b(said|worn|wears|nobody|anybody|somebody|so many|by themselves)\b", r"(?<!stands )(?<!one )\bby itself\b(?! \w)",
    r"texels a side", r"folded with", r"may cost", r"that cannot be\b(?! \w)", r"\b(a|the) (reading|pixel|Sun|model|camera) sees\b",
    r"sees a model", r"\bwhat (is|it|they|(the|a|an|of) \w+)( \w+)? (sees?|costs?|says?|wears?|worth|done with)\b", r"\bhang together\b", r"\bdressed\b",
    r"\bcalled as\b", r"\bpictures?\b", r"\bsquare to\b", r"\bSunFrame\b|\bScenery\b|\bLooker\b|\bEasel\b|\bhonest bars\b|\bFirstNumbers\b|\bSampleName\b",
    r"\ball around the same\b", r"\bgo(es)? on\b(?= as)", r"\b(can't|don't|doesn't|isn't|won't|it's)\b")]

COMMENT = re.compile(r'R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*')
STRING = re.compile(r'"((?:\\.|[^"\\\n])*)"')
# help texts: the last text of add() and flag(), and of command()
OPTION = re.compile(r"\b(?:add|flag|command)\s*(?:<\w+>)?\(((?:[^()\"]|\"(?:\\.|[^\"\\\n])*\")*)")
CODE = re.compile(r"PANWRIGHT_(CODE|EXAMPLE)\(\s*(\w+),((?:\s*,?\s*\"(?:\\.|[^\"\\\n])*\")+)\s*\)")
RELATIVE = re.compile(r"\b(that|which|who|where|whether|what)\b")


def comments(text):
    """(line, trailing, paragraphs) of each comment: full lines that follow one another are one."""
    found = []
    for match in COMMENT.finditer(text):
        if not match.group().startswith("//"):
            continue
        line = text.count("\n", 0, match.start()) + 1
        begin = text.rfind("\n", 0, match.start()) + 1
        full = not text[begin:match.start()].strip()
        column = match.start() - begin
        body = re.sub(r"^//[/!<]?", "", match.group())
        if full and found and found[-1]["last"] == line - 1 and found[-1]["column"] == column:
            found[-1]["last"] = line
            found[-1]["lines"].append(body)
        else:
            found.append({"line": line, "last": line, "column": column, "full": full, "lines": [body]})
    return found


def paragraphs(lines):
    """Flowing texts of a comment: split at empty lines, and where an indented line begins one of its own."""
    out, start, last = [], 0, 0
    for line in lines:
        text = line.strip()
        indent = len(line) - len(line.lstrip())
        joins = out and text and out[-1] and not (indent > 1 and (last <= 1 or indent <= start)) and not (indent <= 1 < start)
        if joins:
            out[-1] += " " + text
        else:
            out.append(text)
            start = indent
        last = indent
    return [text for text in out if text]


def phrase_problems(text):
    for pattern in BANNED:
        match = pattern.search(text)
        if match:
            yield f"'{match.group()[:60]}'"


def length_problems(text):
    plain = re.sub(r"\([^()]*\)", "", text)
    for sentence in re.split(r"(?<=[.;:!?])\s+", plain):
        words = [word for word in sentence.split() if re.search(r"[A-Za-z]", word)]
        if len(words) > MOST_WORDS:
            yield f"a sentence of {len(words)} words: '{' '.join(words[:8])} …'"


def header_problems(text):
    first = True
    for comment in comments(text):
        for paragraph in paragraphs(comment["lines"]):
            opening = OPENING.match(paragraph)
            if opening:
                yield comment["line"], f"a comment opens with '{opening.group()}': '{paragraph[:60]}'"
            if first and VERB.match(paragraph):
                yield comment["line"], f"a header opens with a verb: '{paragraph[:60]}'"
            first = False
            for problem in list(phrase_problems(paragraph)) + list(length_problems(paragraph)):
                yield comment["line"], problem
    if not text.startswith("//"):
        yield 1, "a header begins with a comment: a noun phrase"


def joined(literals):
    return "".join(STRING.findall(literals)).replace('\\"', '"')


def help_problems(text):
    for match in OPTION.finditer(text):
        arguments = [joined(part) for part in re.split(r",(?=\s*[^\"\s]|\s*\")", match.group(1)) if '"' in part]
        if not arguments:
            continue
        line = text.count("\n", 0, match.start()) + 1
        words = arguments[-1]
        opening = re.match(r"(What|Where|Whether|How|Which|That|Let)\b", words)
        if opening:
            yield line, f"a help text opens with '{opening.group()}': '{words[:60]}'"
        for problem in list(phrase_problems(words)) + list(length_problems(words)):
            yield line, problem


def code_problems(text):
    for match in CODE.finditer(text):
        kind, code = match.group(1), match.group(2)
        line = text.count("\n", 0, match.start()) + 1
        texts = [joined(part) for part in re.split(r'(?<="),', match.group(3)) if '"' in part]
        if kind == "CODE":
            title = texts[0]
            if not 2 <= len(title.split()) <= 4:
                yield line, f"{code}: a title has two to four words: '{title}'"
            if RELATIVE.search(title):
                yield line, f"{code}: a title names the problem: '{title}'"
            texts = texts[1:]
        for each in texts:
            opening = OPENING.match(each)
            if opening and kind == "CODE":
                yield line, f"{code}: an explanation opens with '{opening.group()}'"
            for problem in phrase_problems(each):
                yield line, f"{code}: {problem}"
            for problem in length_problems(each) if kind == "CODE" else ():
                yield line, f"{code}: {problem}"


KINDS = {"headers": header_problems, "help": help_problems, "codes": code_problems}


def problems(root):
    for kind, globs in CHECKED.items():
        paths = {path for glob in globs for path in root.glob(glob)}
        for path in sorted(paths):
            where = str(path.relative_to(root))
            if not where.startswith(SKIPPED):
                for line, problem in KINDS[kind](path.read_text(encoding="utf-8")):
                    yield f"{where}:{line}: {problem}"


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "words: ok")
    sys.exit(1 if found else 0)
