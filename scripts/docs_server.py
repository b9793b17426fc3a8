#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""docs_server.py FOLDER PORT: serves a folder to this machine alone, until Ctrl-C. Files of the project are shown as text."""
import functools
import http.server
import mimetypes
import sys


class Handler(http.server.SimpleHTTPRequestHandler):
    def guess_type(self, path):
        known = mimetypes.guess_type(path)[0] or ""
        shown = known.startswith(("image/", "font/")) or known in ("text/html", "text/css", "text/javascript", "application/javascript", "application/json")
        return known if shown else "text/plain; charset=utf-8"

    def log_message(self, *_):
        pass


def main():
    folder, port = sys.argv[1], int(sys.argv[2])
    try:
        server = http.server.ThreadingHTTPServer(("127.0.0.1", port), functools.partial(Handler, directory=folder))
    except OSError as error:
        print(f"gridspace: docs: port {port} on 127.0.0.1: {error.strerror}; choose another with --port", file=sys.stderr)
        return 3
    print(f"documentation: http://127.0.0.1:{server.server_port}  (Ctrl-C ends it)", flush=True)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
