# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# What an installed Gridspace needs beside its programs (those install themselves, GridspaceTargets.cmake). The programs find
# qos/ relative to themselves, so that a prefix can be moved.

install(DIRECTORY qos idl configs DESTINATION "${CMAKE_INSTALL_DATADIR}/gridspace"
        FILES_MATCHING PATTERN "*.xml" PATTERN "*.idl" PATTERN "*.yaml" PATTERN "*.json" PATTERN "*.m" PATTERN "*.csv" PATTERN "*.md")
install(DIRECTORY python/gridspace DESTINATION "${CMAKE_INSTALL_DATADIR}/gridspace/python" FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
# Agents that scenarios of configs/ name, at the same place relative to them.
install(DIRECTORY examples/agents/energy_management DESTINATION "${CMAKE_INSTALL_DATADIR}/gridspace/examples/agents" USE_SOURCE_PERMISSIONS PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY templates DESTINATION "${CMAKE_INSTALL_DATADIR}/gridspace" USE_SOURCE_PERMISSIONS)
install(DIRECTORY scripts/board DESTINATION "${CMAKE_INSTALL_DATADIR}/gridspace/scripts" USE_SOURCE_PERMISSIONS)
install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/gridspace")
