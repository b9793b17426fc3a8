# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes the wheel (PEP 517, PEP 427) of a package without anything to compile, so that pip needs no network."""
import base64
import hashlib
import pathlib
import tomllib
import zipfile

HERE = pathlib.Path(__file__).resolve().parent


def _metadata(project):
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}", f"Summary: {project['description']}",
             f"Requires-Python: {project['requires-python']}", f"License: {project['license']['text']}"]
    for extra, packages in project.get("optional-dependencies", {}).items():
        lines += [f"Provides-Extra: {extra}"] + [f"Requires-Dist: {package}; extra == '{extra}'" for package in packages]
    return "\n".join(lines) + "\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    package = tomllib.loads((HERE / "pyproject.toml").read_text())["project"]["name"]
    return _wheel(wheel_directory, {f"{package}/{file.name}": file.read_bytes() for file in sorted((HERE / package).glob("*")) if file.is_file()})


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """For `pip install -e` (PEP 660): the package stays here, and a line leads to it."""
    return _wheel(wheel_directory, {"gridspace.pth": f"{HERE}\n".encode()})


def _wheel(wheel_directory, files):
    project = tomllib.loads((HERE / "pyproject.toml").read_text())["project"]
    stem = f"{project['name']}-{project['version']}"
    files[f"{stem}.dist-info/METADATA"] = _metadata(project).encode()
    files[f"{stem}.dist-info/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: wheel_of_tree\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    record = f"{stem}.dist-info/RECORD"
    rows = []
    for name, octets in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(octets).digest()).rstrip(b"=").decode()
        rows.append(f"{name},sha256={digest},{len(octets)}")
    files[record] = "\n".join([*rows, f"{record},,"]).encode() + b"\n"
    wheel = f"{stem}-py3-none-any.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, octets in files.items():
            archive.writestr(zipfile.ZipInfo(name, (2026, 1, 1, 0, 0, 0)), octets)
    return wheel
