"""Checks the links between the documents: each file and heading that a link names must exist."""

import os
import re
import subprocess
import sys

LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def anchors(path):
    """Returns the anchors that a viewer of Markdown gives to the headings of a document."""
    with open(path, encoding="utf-8") as document:
        headings = HEADING.findall(FENCED.sub("", document.read()))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def broken_links(path):
    with open(path, encoding="utf-8") as document:
        links = LINK.findall(FENCED.sub("", document.read()))
    for target, anchor in links:
        if target.startswith(("http:", "https:", "mailto:")):
            continue
        file = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        if not os.path.exists(file):
            yield f"{path}: {target} is not there"
        elif anchor and file.endswith(".md") and anchor not in anchors(file):
            yield f"{path}: {target} has no heading #{anchor}"


def main():
    documents = subprocess.run(["git", "ls-files", "*.md"], capture_output=True, check=True, text=True)
    broken = [link for path in documents.stdout.split() for link in broken_links(path)]
    print("\n".join(broken), end="\n" if broken else "")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
