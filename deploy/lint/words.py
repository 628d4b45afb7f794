"""Looks through comments, docstrings and documents for the phrases of words.txt and for sentences that are hard to read.

    words.py [--count] [PATH...]      the whole tree if no path is given

Reports each phrase with its replacement, each comment that begins with Of, Whose or Where, and each sentence of more than
30 words. Exits with 1 if it finds any. A line that must keep its words ends with "words: keep".
"""

import argparse
import ast
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOST_WORDS = 30
KEEP = "words: keep"
# Start of a comment line, by file extension or, for a file without one, by name. CSS has only comments in /* */.
COMMENTS = {
    **dict.fromkeys([".cc", ".h", ".glsl", ".frag", ".vert", ".comp", ".proto", ".ts", ".tsx", ".mjs"], "//"),
    **dict.fromkeys([".py", ".cmake", ".sh", ".yaml", ".yml", ".toml", ".cfg", ".conf", ".service"], "#"),
    **dict.fromkeys(["CMakeLists.txt", "Dockerfile", "dev"], "#"),
}
# Texts that other people or programs wrote, and the laboratory notes, which stay as they were written.
LEFT_OUT = re.compile(r"^(LICENSE|docs/lab/|samples/|data/)")
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
    indent = 0
    for number, line in enumerate([*text.splitlines(), ""], 1):
        stripped = line.strip()
        is_comment = stripped.startswith(mark) and not stripped.startswith("#!")
        content = stripped[len(mark) :] if is_comment else ""
        own_indent = len(content) - len(content.lstrip())
        # An indented line begins an example or an item. A line that is indented more continues it.
        begins = own_indent < indent or (indent == 1 and own_indent > 2) or (indent > 2 and own_indent == indent)
        if lines and (not content.strip() or begins):
            found.append((first, " ".join(lines).replace(KEEP, "").strip(), any(KEEP in each for each in lines)))
            lines = []
        if content.strip():
            if not lines:
                first, indent = number, own_indent
            lines.append(content.strip())
        # This handles a comment behind code.
        behind = line.find(f"  {mark} ")
        if not is_comment and behind > 0:
            found.append((number, line[behind + len(mark) + 2 :].replace(KEEP, "").strip(), KEEP in line))
    return found


def paragraphs_of_style_sheet(text: str) -> list[tuple[int, str, bool]]:
    """Returns the comments of a style sheet."""
    found = []
    for match in re.finditer(r"/\*(.*?)\*/", text, re.DOTALL):
        lines = [line.strip().lstrip("*").strip() for line in match[1].splitlines()]
        found.append((text.count("\n", 0, match.start()) + 1, " ".join(lines).strip(), KEEP in match[1]))
    return found


def paragraphs_of_docstrings(text: str) -> list[tuple[int, str, bool]]:
    """Returns the paragraphs of a Python source's docstrings."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        docstring = ast.get_docstring(node)
        if not docstring:
            continue
        first = node.body[0].lineno
        lines: list[str] = []
        for number, line in enumerate([*docstring.splitlines(), ""]):
            # An item such as "name: what it is" begins a paragraph, and indented lines continue it. Other indented
            # lines are examples.
            if lines and (not line or re.match(r"- |\w+: ", line)):
                found.append((first + number - len(lines), " ".join(lines), any(KEEP in each for each in lines)))
                lines = []
            if lines or (line and not line.startswith(" ")):
                lines.append(line.strip())
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
    plain = re.sub(r"\]\([^)]*\)", "]", plain).replace("**", "")
    # A sentence may begin with the lower-case name of a variable or file.
    return re.split(r"(?<=[.!?:;])\s+(?=[A-Z\[(*\"-])|(?<=\w{3}\.)\s+(?=[a-z_])", plain)


def faults_in(path: str, text: str, known: list[tuple[re.Pattern[str], str]]) -> list[tuple[int, str, str]]:
    """Returns line, kind and message of each fault of a file."""
    suffix = pathlib.PurePath(path).suffix
    mark = COMMENTS.get(pathlib.PurePath(path).name, COMMENTS.get(suffix))
    if suffix == ".md":
        paragraphs = paragraphs_of_document(text)
    elif suffix == ".css":
        paragraphs = paragraphs_of_style_sheet(text)
    elif mark is not None:
        paragraphs = paragraphs_of_code(text, mark)
    else:
        return []
    if suffix == ".py":
        paragraphs += paragraphs_of_docstrings(text)
    faults = []
    for line, paragraph, keep in paragraphs:
        if keep:
            continue
        prose = re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "code", paragraph))
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
