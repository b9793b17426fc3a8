# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What mkdocs does not do by itself with our pages (named by mkdocs.yml).

- Pages link to files of the project outside of docs/. Those come into the site below `project/`: pages as pages, others as they are.
- GitHub's Markdown lets a list or a table follow a paragraph at once, and a pipe in a code span of a table is `\\|`; Python-Markdown does not.
"""
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[1]
LINK = re.compile(r"(\]\()([^()\s#]+)(#[^()\s]*)?(\))")
FENCE = re.compile(r"^\s*(```|~~~)")
ITEM = re.compile(r"^\s*(-|\d+\.) ")


def site_path(project_path):
    """Where a file of the project is in the site."""
    return project_path[len("docs/"):] if project_path.startswith("docs/") else "project/" + project_path


def project_path(path_in_site):
    return path_in_site[len("project/"):] if path_in_site.startswith("project/") else "docs/" + path_in_site


def outside_fences(text):
    """Lines of a page, with whether each is text and no code."""
    inside = False
    for line in text.split("\n"):
        fence = FENCE.match(line) is not None
        yield line, not inside and not fence
        inside ^= fence


def targets(page, text):
    """Files and folders of the project that a page links to."""
    for line, is_text in outside_fences(text):
        for link in LINK.finditer(line) if is_text else ():
            if ":" not in link.group(2):
                yield posixpath.normpath(posixpath.join(posixpath.dirname(page), link.group(2)))


def on_files(files, config):
    todo = [project_path(file.src_uri) for file in files.documentation_pages()]
    seen = set(todo)
    while todo:
        page = todo.pop()
        for target in targets(page, (ROOT / page).read_text()):
            if target in seen:
                continue
            seen.add(target)
            there = [p for p in (ROOT / target).iterdir() if p.is_file()] if (ROOT / target).is_dir() else [ROOT / target]
            for path in there:
                name = path.relative_to(ROOT).as_posix()
                if name.startswith("docs/") or not path.exists() or files.get_file_from_path(site_path(name)):
                    continue
                file = File(site_path(name), config["docs_dir"], config["site_dir"], config["use_directory_urls"])
                file.abs_src_path = str(path)
                files.append(file)
                if name.endswith(".md") and name not in seen:
                    seen.add(name)
                    todo.append(name)
    return files


def on_page_markdown(markdown, page, config, files):
    here = page.file.src_uri
    folder = posixpath.dirname(project_path(here))

    def moved(link):
        if ":" in link.group(2):
            return link.group(0)
        target = site_path(posixpath.normpath(posixpath.join(folder, link.group(2))))
        return link.group(1) + posixpath.relpath(target, posixpath.dirname(here) or ".") + (link.group(3) or "") + link.group(4)

    out, before = [], ""
    for line, is_text in outside_fences(markdown):
        if is_text:
            line = LINK.sub(moved, line)
            starts_list = ITEM.match(line) and not ITEM.match(before) and not before.startswith(" ")
            starts_table = line.startswith("|") and not before.startswith("|")
            if before.strip() and (starts_list or starts_table):
                out.append("")
            if line.startswith("|"):
                line = re.sub(r"`[^`]*`", lambda code: code.group(0).replace("\\|", "|"), line)
        out.append(line)
        before = line
    return "\n".join(out)
