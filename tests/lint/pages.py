# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether pages keep their word: links and anchors lead somewhere, commands are those that there are, the site has every page.

Each check yields lines `page:line: what was found`. Called by lint.py.
"""
import pathlib
import posixpath
import re

FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^()\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
CODE_SPAN = re.compile(r"(?<!`)(`+)(?!`)((?:[^\n]|\n(?!\s*\n))+?)(?<!`)\1(?!`)")  # may end on the next line, not in the next paragraph
HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*\s*$")
HTML_ANCHOR = re.compile(r"<a\s+(?:id|name)=\"([^\"]+)\"")
HTML_LINK = re.compile(r"<(?:a|img)\s[^>]*(?:href|src)=\"([^\"]+)\"")
COMMAND = re.compile(r"^\s*(?:\$ )?(?:sudo )?(?:[A-Z_]+=\S+ )*(?:\./)?gridspace +(.*)$")
VERB = re.compile(r"\bapp\.add_subcommand\(\s*\"([a-z][a-z0-9-]*)\"")
VERBS_BY_NAME = re.compile(r"\bapp\.add_subcommand\(name\b.*?\n}", re.S)  # a function that adds several: add("pause", ...)
PICTURE = re.compile(r"\bpicture\(\w+, \"([\w-]+)\"")
OPTION = re.compile(r"--[a-z][a-z0-9-]*")
SCRIPT_VERBS = re.compile(r"^  ([a-z][a-z0-9-]*)\)", re.M)


def parts(text):
    """Lines of a page: (number, line, whether it is in a fence)."""
    inside = False
    for number, line in enumerate(text.split("\n"), 1):
        if FENCE.match(line):
            inside = not inside
            continue
        yield number, line, inside


def anchors(text):
    """The anchors of a page, as GitHub makes them of its headings."""
    found, times = set(), {}
    for _, line, inside in parts(text):
        heading = None if inside else HEADING.match(line)
        if heading:
            words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(2))
            slug = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
            found.add(slug if slug not in times else f"{slug}-{times[slug]}")
            times[slug] = times.get(slug, 0) + 1
        found.update(HTML_ANCHOR.findall(line))
    return found


def prose(text):
    """The page without its fences, line by line where it was."""
    lines = [""] * (text.count("\n") + 1)
    for number, line, inside in parts(text):
        if not inside:
            lines[number - 1] = line
    return "\n".join(lines)


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def links(text):
    words = prose(text)
    words = CODE_SPAN.sub(lambda code: re.sub(r"[^\n]", " ", code.group()) if "](" in code.group() else code.group(), words)
    for pattern in (LINK, HTML_LINK):
        for link in pattern.finditer(words):
            yield line_of(words, link.start()), link.group(1)


def check_links(root, pages):
    """`pages` is {path: text} of all pages of the tree."""
    anchors_of = {}
    for path, text in pages.items():
        for number, target in links(text):
            if re.match(r"[a-z]+:", target):
                continue
            file, _, anchor = target.partition("#")
            other = posixpath.normpath(posixpath.join(posixpath.dirname(path), file)) if file else path
            if other.startswith("..") or not (root / other).exists():
                yield f"{path}:{number}: links to '{target}', which is not there"
            elif anchor and other in pages:
                if other not in anchors_of:
                    anchors_of[other] = anchors(pages[other])
                if anchor not in anchors_of[other]:
                    near = ", ".join(sorted(a for a in anchors_of[other] if anchor.split("-")[0] in a)[:3])
                    yield f"{path}:{number}: links to '{target}', and {other} has no heading of that name" + (f" (near: {near})" if near else "")


def commands(text):
    """What a page tells its reader to type: (number, what follows `gridspace`), from fences, indented code and code spans."""
    waiting = None
    for number, line, inside in parts(text):
        if waiting:
            number, line = waiting[0], waiting[1] + " " + line.strip()
            waiting = None
        if inside or line.startswith("    "):
            if line.rstrip().endswith("\\"):
                waiting = (number, line.rstrip()[:-1].rstrip())
                continue
            for piece in re.split(r"\s(?:&&|\||;)\s|;\s", re.sub(r"\s#\s.*", "", line)):
                command = COMMAND.match(piece)
                if command:
                    yield number, command.group(1)
    words = prose(text)
    for code in CODE_SPAN.finditer(words):
        command = COMMAND.match(" ".join(code.group(2).split()))
        if command:
            yield line_of(words, code.start()), command.group(1)


def command_line(root):
    """Verbs and options of the command line, as its sources and the script at the root name them."""
    verbs, options = set(), {"--help", "--help-all", "--version"}
    for path in [*(root / "launcher/cli").glob("*.cpp"), *(root / "scripts").glob("*.sh")]:
        text = path.read_text(errors="replace")
        if path.suffix == ".cpp":
            verbs.update(VERB.findall(text))
            for function in VERBS_BY_NAME.findall(text):
                verbs.update(re.findall(r"\badd\(\"([a-z-]+)\"", function))
        options.update(OPTION.findall(text))
        options.update("--" + word for word in re.findall(r"format\(\"([a-z]+)\"", text))
    if (root / "gridspace").exists():
        verbs.update(SCRIPT_VERBS.findall((root / "gridspace").read_text()))
    return verbs, options


def check_commands(root, pages):
    verbs, options = command_line(root)
    if not verbs:
        return  # a tree without a command line
    tops = {entry.name for entry in root.iterdir() if entry.is_dir() and entry.name not in ("build", "runs")}
    examples = {path: (root / path).read_text() for path in ["launcher/cli/help.cpp"] if (root / path).exists()}
    for path, text in {**pages, **examples}.items():
        for number, command in commands(text):
            ours = re.split(r"\s--\s", command)[0]  # behind it: somebody else's program
            words = ours.split()
            if words and re.fullmatch(r"[a-z][a-z0-9-]*", words[0]) and words[0] not in verbs:
                yield f"{path}:{number}: `gridspace {words[0]}`: there is no such verb"
                continue
            for option in OPTION.findall(" ".join(word for word in words if word.startswith(("--", "[--")))):
                if option not in options:
                    yield f"{path}:{number}: `gridspace {words[0]} {option}`: no verb has this option"
            for word in words[1:]:
                name = word.strip("'\"[],").removesuffix(":")
                if re.fullmatch(r"[a-z_]+/[A-Za-z0-9_./-]+", name) and name.split("/")[0] in tops and not (root / name).exists():
                    yield f"{path}:{number}: the command names '{name}', which is not there"


def check_site(root, pages):
    """The navigation of the site has each page of docs/, and nothing else."""
    if not (root / "mkdocs.yml").exists():
        return
    settings = (root / "mkdocs.yml").read_text()
    named = re.findall(r"([\w/.-]+\.md)\s*$", settings, re.M)
    of_project = [name.removeprefix("project/") if name.startswith("project/") else "docs/" + name for name in named]
    for path in sorted(p for p in pages if p.startswith("docs/")):
        if path not in of_project:
            yield f"{path}:1: not in the navigation of mkdocs.yml"
    for path in of_project:
        if path not in pages:
            yield f"mkdocs.yml:1: its navigation names {path}, which is not there"


def check_pictures(root, pages):
    """Screenshots of the documentation are those that tests make of the pages they open, and each of them is shown."""
    if not (root / "tests/e2e").is_dir():
        return
    made = {name for test in (root / "tests/e2e").glob("*.mjs") for name in PICTURE.findall(test.read_text())}
    shown = set()
    for path, text in pages.items():
        for number, target in links(text):
            picture = re.search(r"images/([\w-]+)\.png$", target)
            if picture and not re.match(r"[a-z]+:", target):
                shown.add(picture.group(1))
                if picture.group(1) not in made:
                    yield f"{path}:{number}: shows '{target}', which no test in tests/e2e makes: picture(page, \"{picture.group(1)}\")"
    for name in sorted(made - shown):
        yield f"tests/e2e:1: makes the picture '{name}', which no page shows"
    for file in sorted((root / "docs/images").glob("*.png")):
        if file.stem not in made:
            yield f"docs/images/{file.name}:1: no test in tests/e2e makes it"


def check_pages(root, pages):
    root = pathlib.Path(root)
    yield from check_links(root, pages)
    yield from check_commands(root, pages)
    yield from check_site(root, pages)
    yield from check_pictures(root, pages)
