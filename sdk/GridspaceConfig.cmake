# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# find_package(Gridspace): the target gridspace::agent (docs/how_to/write_an_agent.md).
include("${CMAKE_CURRENT_LIST_DIR}/GridspaceTargets.cmake")
