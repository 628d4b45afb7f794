"""Looks through comments and documents for the phrases of words.txt and for sentences that are hard to read.

    words.py [--count] [PATH...]      the whole tree if no path is given

Reports each phrase with its replacement, each comment that begins with Of, Whose or Where, and each sentence of more than
30 words. Exits with 1 if it finds any. A line that must keep its words ends with "words: keep".
"""

import argparse
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_WORDS = 30
KEEP = "words: keep"
# Start of a comment line, by file extension.
COMMENTS = {".cc": "//", ".h": "//", ".glsl": "//", ".proto": "//", ".ts": "//", ".mjs": "//", ".py": "#", ".cmake": "#", ".sh": "#"}
# Texts that other people or programs wrote.
LEFT_OUT = re.compile(r"^(LICENSE|docs/lab/|docs/gallery/|docs/accuracy/|samples/|data/|docs/decisions/)")
BEGINNINGS = re.compile(r"^(Of|Whose|Where) ")


def phrases() -> list[tuple[re.Pattern[str], str]]:
    """Returns the phrases of words.txt with their replacements."""
    found = []
    for line in (ROOT / "deploy/lint/words.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            pattern, replacement = line.split("\t")
            found.append((re.compile(pattern, re.IGNORECASE), replacement))
    return found


def paragraphs_of_code(text: str, mark: str) -> list[tuple[int, str, bool]]:
    """Returns the comments of a source: the line each begins in, its text, and whether lines of it are kept."""
    found: list[tuple[int, str, bool]] = []
    lines: list[str] = []
    first = 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        stripped = line.strip()
        is_comment = stripped.startswith(mark) and not stripped.startswith("#!")
        if is_comment:
            if not lines:
                first = number
            lines.append(stripped[len(mark) :].strip())
        if lines and (not is_comment or not lines[-1]):
            found.append((first, " ".join(lines).replace(KEEP, "").strip(), any(KEEP in each for each in lines)))
            lines = []
        # This handles a comment behind code.
        behind = line.find(f"  {mark} ")
        if not is_comment and behind > 0:
            found.append((number, line[behind + len(mark) + 2 :].replace(KEEP, "").strip(), KEEP in line))
    return found


def paragraphs_of_document(text: str) -> list[tuple[int, str, bool]]:
    """Returns the paragraphs, items and table rows of a Markdown document."""
    found: list[tuple[int, str, bool]] = []
    lines: list[str] = []
    first = 0
    in_code = False

    def end() -> None:
        if lines:
            found.append((first, " ".join(lines), any(KEEP in each for each in lines)))
            lines.clear()

    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            in_code = not in_code
            end()
            continue
        if in_code or not stripped or stripped.startswith(("|", "#")) or re.match(r"([-*+]|\d+\.) ", stripped):
            end()
        if in_code or not stripped:
            continue
        if stripped.startswith("|"):
            for cell in stripped.strip("|").split("|"):
                found.append((number, cell.strip(), KEEP in line))
            continue
        if not lines:
            first = number
        lines.append(stripped)
    end()
    return found


def sentences(paragraph: str) -> list[str]:
    """Returns the sentences, without code, links' addresses and footnotes."""
    plain = re.sub(r"`[^`]*`", "code", paragraph)
    plain = re.sub(r"\]\([^)]*\)", "]", plain)
    return re.split(r"(?<=[.!?:;])\s+(?=[A-Z\[(*\"-])", plain)


def faults_in(path: str, text: str, known: list[tuple[re.Pattern[str], str]]) -> list[tuple[int, str, str]]:
    """Returns line, kind and message of each fault of a file."""
    suffix = pathlib.PurePath(path).suffix
    if suffix == ".md":
        paragraphs = paragraphs_of_document(text)
    elif suffix in COMMENTS:
        paragraphs = paragraphs_of_code(text, COMMENTS[suffix])
    else:
        return []
    faults = []
    for line, paragraph, keep in paragraphs:
        if keep:
            continue
        prose = re.sub(r"`[^`]*`", "code", paragraph)
        for pattern, replacement in known:
            for match in pattern.finditer(prose):
                faults.append((line, "phrase", f"'{match.group(0)}': write {replacement}"))
        if suffix != ".md" and BEGINNINGS.match(paragraph):
            faults.append((line, "beginning", f"begins with '{paragraph.split()[0]}': begin with the subject"))
        for sentence in sentences(paragraph):
            words = len(re.findall(r"[\w'’-]+", sentence))
            if words > MOST_WORDS:
                faults.append((line, "length", f"a sentence of {words} words: '{sentence[:60]}...'"))
    return faults


def files(paths: list[str]) -> list[str]:
    """Returns the files of the tree, or those under the paths."""
    listed = subprocess.run(
        ["git", "ls-files", "--", *paths], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.splitlines()
    return [path for path in listed if not LEFT_OUT.match(path) and (ROOT / path).is_file()]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", action="store_true", help="only count, by folder and kind")
    parser.add_argument("paths", nargs="*")
    arguments = parser.parse_args()
    known = phrases()
    counts: collections.Counter[tuple[str, str]] = collections.Counter()
    total = 0
    for path in files(arguments.paths):
        for line, kind, message in faults_in(path, (ROOT / path).read_text(errors="replace"), known):
            total += 1
            counts["/".join(path.split("/")[:2]), kind] += 1
            if not arguments.count:
                print(f"{path}:{line}: {message}")
    if arguments.count:
        for (folder, kind), count in sorted(counts.items()):
            print(f"{count:6} {kind:10} {folder}")
    if total:
        print(f"{total} faults; deploy/lint/words.txt has the phrases", file=sys.stderr)
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
